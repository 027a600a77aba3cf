// The drawn curve with its moving dot.

/** Fits a canvas to its place on the page and gives its context in CSS pixels. */
function fitCanvas(canvas) {
  const box = canvas.getBoundingClientRect();
  const density = Math.min(window.devicePixelRatio || 1, 2);
  const [width, height] = [Math.max(Math.round(box.width), 1), Math.max(Math.round(box.height), 1)];
  canvas.width = Math.round(width * density);
  canvas.height = Math.round(height * density);
  const context = canvas.getContext("2d");
  context.setTransform(density, 0, 0, density, 0, 0);
  return { context, width, height, density };
}

/** What stands still is drawn once and kept. */
function stillLayer({ width, height, density }, draw) {
  const canvas = document.createElement("canvas");
  canvas.width = Math.round(width * density);
  canvas.height = Math.round(height * density);
  const context = canvas.getContext("2d");
  context.setTransform(density, 0, 0, density, 0, 0);
  draw(context);
  return canvas;
}

class CurveView {
  constructor(canvas, data) {
    this.canvas = canvas;
    this.data = data;
    this.points = data.control.points;
  }

  resize(theme, table) {
    this.surface = fitCanvas(this.canvas);
    this.theme = theme;
    this.table = table;
    this.places = this.place();
    this.still = stillLayer(this.surface, (context) => this.drawStill(context));
  }

  /** Points in pixels: one scale for both axes, y upwards. */
  place() {
    const { width, height } = this.surface;
    const [left, top, right, bottom] = [36, 48, 36, 52];
    const span = [0, 1].map((axis) => this.points.reduce((most, point) => Math.max(most, point[axis]), 0));
    const room = [Math.max(width - left - right, 1), Math.max(height - top - bottom, 1)];
    const scale = Math.min(room[0] / Math.max(span[0], 1e-6), room[1] / Math.max(span[1], 1e-6), 4 * Math.max(...room));
    const x = left + (room[0] - scale * span[0]) / 2;
    const y = top + (room[1] + scale * span[1]) / 2;
    return this.points.map((point) => [x + scale * point[0], y - scale * point[1]]);
  }

  drawStill(context) {
    const places = this.places;
    if (places.length === 0) {
      context.fillStyle = css(this.theme.soft);
      context.font = "13px system-ui, sans-serif";
      context.textAlign = "center";
      context.fillText("No drawing to show", this.surface.width / 2, this.surface.height / 2);
      return;
    }
    context.lineCap = "round";
    context.lineJoin = "round";
    this.drawDoubt(context);
    context.lineWidth = 4.5;
    for (let i = 0; i + 1 < places.length;) {
      const colour = this.colour(i);
      context.strokeStyle = css(colour);
      context.beginPath();
      context.moveTo(...places[i]);
      // One line for a run of nearly one colour: the ends of many short ones would look like beads.
      do context.lineTo(...places[(i += 1)]);
      while (i + 1 < places.length && alike(this.colour(i), colour));
      context.stroke();
    }
    context.lineWidth = 2;
    context.fillStyle = css(this.theme.panel);
    context.strokeStyle = css(this.colour(0));
    disc(context, places[0], 5);
    context.stroke();
  }

  /** A band around the line: the wider, the less sure the plan is there. */
  drawDoubt(context) {
    if (this.data.confidence.length === 0) return;
    for (let i = 0; i + 1 < this.places.length; i += 1) {
      const doubt = 1 - confidenceAt(this.data, (i + 0.5) / this.data.controlRate);
      if (doubt < 0.04) continue;
      // Opaque, since overlapping ends would show.
      context.strokeStyle = css(mix(this.colour(i), this.theme.panel, 0.78));
      context.lineWidth = 4.5 + 18 * doubt;
      context.beginPath();
      context.moveTo(...this.places[i]);
      context.lineTo(...this.places[i + 1]);
      context.stroke();
    }
  }

  colour(index) {
    const best = this.data.bestSource;
    if (best.length === 0) return this.theme.accent;
    const sample = Math.round((index / this.data.controlRate) * this.data.sampleRate);
    return rampAt(this.table, sourcePart(this.data, best[Math.min(sample, best.length - 1)]));
  }

  draw(seconds) {
    const { context, width, height } = this.surface;
    context.clearRect(0, 0, width, height);
    context.drawImage(this.still, 0, 0, width, height);
    if (this.places.length === 0) return;
    const [low, high, part] = around(seconds, this.data.controlRate, this.places.length);
    const at = mix(this.places[low], this.places[high], part);
    const colour = this.colour(part < 0.5 ? low : high);
    context.fillStyle = css(colour, 0.22);
    disc(context, at, 17);
    context.fillStyle = css(this.theme.panel);
    disc(context, at, 10);
    context.fillStyle = css(colour);
    disc(context, at, 7);
  }

  /** The time of the curve under the pointer, or null where there is none. */
  timeUnder(x, y) {
    let [best, least] = [null, 14];
    this.places.forEach((place, i) => {
      const apart = Math.hypot(place[0] - x, place[1] - y);
      if (apart < least) [best, least] = [i / this.data.controlRate, apart];
    });
    return best;
  }

  /** The time whose point is nearest to a place; among crossings the one nearest in time. */
  timeAt(x, y, now) {
    const { controlRate } = this.data;
    let [best, least] = [0, Infinity];
    this.places.forEach((place, i) => {
      const apart = Math.hypot(place[0] - x, place[1] - y) + 1.5 * Math.abs(i / controlRate - now);
      if (apart < least) [best, least] = [i / controlRate, apart];
    });
    return best;
  }
}

function alike(a, b) {
  return a.every((value, i) => Math.abs(value - b[i]) < 7);
}

function disc(context, [x, y], radius) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fill();
}

