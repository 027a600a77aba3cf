// The plan as a heat map: drawing time to the right, clip time upwards.

/** Room for the axes. The scrubber's style keeps the same gutter. */
const GUTTER = 76;
const FOOT = 44;
const STRIP = 14;

class PlanView {
  constructor(canvas, data) {
    this.canvas = canvas;
    this.data = data;
  }

  resize(theme, table) {
    this.surface = fitCanvas(this.canvas);
    this.theme = theme;
    this.table = table;
    const { width, height } = this.surface;
    this.box = { left: GUTTER, top: 4, width: Math.max(width - GUTTER, 1), height: Math.max(height - FOOT - 4, 1) };
    this.still = stillLayer(this.surface, (context) => this.drawStill(context));
  }

  x(seconds) {
    return this.box.left + (this.data.seconds > 0 ? clamp(seconds / this.data.seconds, 0, 1) : 0) * this.box.width;
  }

  y(part) {
    return this.box.top + (1 - part) * this.box.height;
  }

  timeAt(x) {
    return clamp((x - this.box.left) / this.box.width, 0, 1) * this.data.seconds;
  }

  drawStill(context) {
    const { left, top, width, height } = this.box;
    context.save();
    context.beginPath();
    context.roundRect(left, top, width, height, 5);
    context.fillStyle = css(mix(this.theme.panel, this.theme.ink, this.theme.dark ? 0.03 : 0.025));
    context.fill();
    context.clip();
    const image = this.heatImage();
    if (image) {
      context.imageSmoothingQuality = "high";
      context.drawImage(image, left, top, this.x(this.controlSeconds()) - left, height);
    }
    context.restore();
    this.drawCuts(context);
    this.drawClipAxis(context);
    this.drawConfidence(context);
    this.drawDrawingAxis(context);
  }

  controlSeconds() {
    return Math.max(this.data.control.points.length - 1, 0) / this.data.controlRate;
  }

  /** One pixel a cell; its hue is the clip's moment, its strength the weight. */
  heatImage() {
    const { width: sources, height: controls, values } = this.data.heatMap;
    if (values.length === 0) return null;
    const canvas = document.createElement("canvas");
    canvas.width = controls;
    canvas.height = sources;
    const context = canvas.getContext("2d");
    const image = context.createImageData(controls, sources);
    for (let source = 0; source < sources; source += 1) {
      const colour = rampAt(this.table, (source + 0.5) / sources);
      for (let control = 0; control < controls; control += 1) {
        const pixel = 4 * ((sources - 1 - source) * controls + control);
        image.data.set(colour, pixel);
        image.data[pixel + 3] = values[control * sources + source];
      }
    }
    context.putImageData(image, 0, 0);
    return canvas;
  }

  drawClipAxis(context) {
    const { left, top, height } = this.box;
    for (let i = 0; i < height; i += 1) {
      context.fillStyle = css(rampAt(this.table, 1 - i / height));
      context.fillRect(left - 10, top + i, 4, 1.5);
    }
    context.fillStyle = css(this.theme.soft);
    context.font = "11px system-ui, sans-serif";
    context.textAlign = "right";
    context.textBaseline = "middle";
    const total = this.data.sourceSeconds;
    for (const tick of ticks(total, height / 26)) {
      const y = clamp(this.y(total > 0 ? tick / total : 0), top + 6, top + height - 6);
      context.fillText(tickLabel(tick), left - 16, y);
    }
    context.save();
    context.translate(7, top + height / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = "center";
    context.fillText("clip time", 0, 0);
    context.restore();
  }

  /** Where one clip of several begins, with its name. */
  drawCuts(context) {
    if (this.data.guide === null || this.data.guide.clips.length < 2) return;
    const { left, width } = this.box;
    context.font = "11px system-ui, sans-serif";
    context.textAlign = "left";
    context.textBaseline = "bottom";
    for (const [name, start] of this.data.guide.clips) {
      const y = this.y(sourcePart(this.data, start));
      context.fillStyle = css(this.theme.ink, 0.35);
      if (start > 0) context.fillRect(left, y - 0.5, width, 1);
      context.fillStyle = css(this.theme.soft);
      context.fillText(name, left + 6, y - 3, width - 12);
    }
  }

  drawDrawingAxis(context) {
    const { left, top, width, height } = this.box;
    const y = top + height + STRIP + 20;
    context.fillStyle = css(this.theme.soft);
    context.font = "11px system-ui, sans-serif";
    context.textBaseline = "middle";
    context.textAlign = "left";
    const title = "drawing time";
    const end = left + width - context.measureText(title).width;
    context.fillText(title, end, y);
    context.textAlign = "center";
    for (const tick of ticks(this.data.seconds, width / 90)) {
      const label = tickLabel(tick);
      const half = context.measureText(label).width / 2;
      const x = Math.max(this.x(tick), left + half);
      if (x + half < end - 12) context.fillText(label, x, y);
    }
  }

  /** A strip below the map: the taller and fuller, the surer. */
  drawConfidence(context) {
    const { left, top, height } = this.box;
    const values = this.data.confidence;
    if (values.length === 0) return;
    const foot = top + height + 6 + STRIP;
    context.beginPath();
    context.moveTo(left, foot);
    values.forEach((value, i) => context.lineTo(this.x(i / this.data.sampleRate), foot - STRIP * value));
    context.lineTo(this.x((values.length - 1) / this.data.sampleRate), foot);
    context.closePath();
    context.fillStyle = css(this.theme.soft, 0.35);
    context.fill();
    context.fillStyle = css(this.theme.soft);
    context.font = "11px system-ui, sans-serif";
    context.textAlign = "right";
    context.textBaseline = "middle";
    context.fillText("confidence", left - 10, foot - STRIP / 2);
  }

  draw(seconds) {
    const { context, width, height } = this.surface;
    context.clearRect(0, 0, width, height);
    context.drawImage(this.still, 0, 0, width, height);
    const x = this.x(seconds);
    context.fillStyle = css(this.theme.ink, 0.75);
    context.fillRect(x - 0.75, this.box.top, 1.5, this.box.height + 6 + STRIP);
    const source = sourceAt(this.data, seconds);
    if (source === null) return;
    const part = sourcePart(this.data, source);
    context.fillStyle = css(this.theme.panel);
    disc(context, [x, this.y(part)], 6.5);
    context.fillStyle = css(rampAt(this.table, part));
    disc(context, [x, this.y(part)], 4.5);
  }
}

/** Round times from 0 to `total`, about `count` of them. */
function ticks(total, count) {
  if (!(total > 0)) return [0];
  const rough = total / Math.max(count, 1);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= rough * 0.999);
  return Array.from({ length: Math.floor(total / step + 1e-6) + 1 }, (_, i) => i * step);
}

function tickLabel(seconds) {
  return `${Number(seconds.toPrecision(4))} s`;
}

