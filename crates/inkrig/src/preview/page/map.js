// The clip as a map: moments that are alike are near to each other.

class MapView {
  constructor(canvas, data) {
    this.canvas = canvas;
    this.data = data;
    this.spots = data.guide === null ? [] : data.guide.map.map(([frame, seconds, x, y]) => ({ frame, seconds, at: [x, y] }));
    this.candidates = data.guide === null ? [] : data.guide.candidates.map(([[frame, seconds, x, y], share], index) => (
      { frame, seconds, at: [x, y], share, number: index + 1 }));
    /** The picked moment, and the time of the clip that is pointed at elsewhere; or null. */
    this.marked = null;
    this.hovered = null;
  }

  resize(theme, table) {
    this.surface = fitCanvas(this.canvas);
    this.theme = theme;
    this.table = table;
    this.fit();
    this.still = stillLayer(this.surface, (context) => this.drawStill(context));
  }

  /** One scale for both axes, y upwards. */
  fit() {
    const { width, height } = this.surface;
    const [left, top, right, bottom] = [20, 36, 20, 32];
    const range = [0, 1].map((axis) => this.spots.reduce(
      ([low, high], spot) => [Math.min(low, spot.at[axis]), Math.max(high, spot.at[axis])], [Infinity, -Infinity]));
    const span = range.map(([low, high]) => Math.max(high - low, 1e-6));
    const room = [Math.max(width - left - right, 1), Math.max(height - top - bottom, 1)];
    const scale = Math.min(room[0] / span[0], room[1] / span[1]);
    this.place = ([x, y]) => [
      left + room[0] / 2 + scale * (x - (range[0][0] + range[0][1]) / 2),
      top + room[1] / 2 - scale * (y - (range[1][0] + range[1][1]) / 2),
    ];
  }

  colour(seconds) {
    return rampAt(this.table, sourcePart(this.data, seconds));
  }

  /** The clip's way over the map, and the numbered candidates. */
  drawStill(context) {
    context.lineCap = "round";
    context.lineJoin = "round";
    context.lineWidth = 2;
    const starts = this.data.guide === null ? [] : this.data.guide.clips.map(([, start]) => start);
    for (let i = 0; i + 1 < this.spots.length;) {
      const first = this.spots[i];
      const colour = this.colour(first.seconds);
      context.strokeStyle = css(mix(colour, this.theme.panel, 0.4));
      context.beginPath();
      context.moveTo(...this.place(first.at));
      // A cut is a cut: nothing moves from one clip to the next.
      do {
        const [from, to] = [this.spots[i], this.spots[i + 1]];
        i += 1;
        if (starts.some((start) => from.seconds < start && to.seconds >= start)) break;
        context.lineTo(...this.place(to.at));
      } while (i + 1 < this.spots.length && alike(this.colour(this.spots[i].seconds), colour));
      context.stroke();
    }
    for (const candidate of this.candidates) this.drawNumber(context, candidate, false);
  }

  drawNumber(context, { at, seconds, number }, strong) {
    const spot = this.place(at);
    context.fillStyle = css(this.theme.panel);
    disc(context, spot, strong ? 13 : 10);
    context.fillStyle = css(strong ? this.theme.ink : mix(this.colour(seconds), this.theme.ink, 0.25));
    disc(context, spot, strong ? 11 : 8.5);
    context.fillStyle = css(this.theme.panel);
    context.font = "600 11px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillText(String(number), spot[0], spot[1] + 0.5);
  }

  draw(seconds) {
    const { context, width, height } = this.surface;
    context.clearRect(0, 0, width, height);
    context.drawImage(this.still, 0, 0, width, height);
    this.drawTrail(context, seconds);
    if (this.marked !== null) {
      if (this.marked.number) this.drawNumber(context, this.marked, true);
      else this.drawRing(context, this.marked);
    }
    const hovered = this.spotOf(this.hovered);
    if (hovered !== null) this.drawRing(context, hovered);
    const now = this.spotOf(sourceAt(this.data, seconds));
    if (now === null) return;
    context.fillStyle = css(this.theme.panel);
    disc(context, this.place(now.at), 8);
    context.fillStyle = css(this.colour(now.seconds));
    disc(context, this.place(now.at), 6);
  }

  /** Where the result was in the last second, paler the longer ago. */
  drawTrail(context, seconds) {
    const steps = 30;
    let before = null;
    context.lineWidth = 3;
    for (let step = steps; step >= 0; step -= 1) {
      const time = seconds - step / steps;
      const spot = time < 0 ? null : this.spotOf(sourceAt(this.data, time));
      if (before && spot) {
        context.strokeStyle = css(this.theme.ink, 0.75 * (1 - step / steps));
        context.beginPath();
        context.moveTo(...this.place(before.at));
        context.lineTo(...this.place(spot.at));
        context.stroke();
      }
      before = spot;
    }
  }

  drawRing(context, { at }) {
    context.beginPath();
    context.arc(...this.place(at), 9, 0, 2 * Math.PI);
    context.lineWidth = 2;
    context.strokeStyle = css(this.theme.ink);
    context.stroke();
  }

  /** The moment of the map at a time of the clip. */
  spotOf(seconds) {
    if (seconds === null || this.spots.length === 0) return null;
    let [low, high] = [0, this.spots.length - 1];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.spots[middle].seconds < seconds - 1e-6) low = middle + 1;
      else high = middle;
    }
    return this.spots[low];
  }

  /** The candidate under a place of the picture, else the moment nearest to it, else nothing. */
  spotAt(x, y) {
    const apart = (spot) => {
      const at = this.place(spot.at);
      return Math.hypot(at[0] - x, at[1] - y);
    };
    const nearest = (spots, reach) => spots.reduce(
      ([best, least], spot) => (apart(spot) < least ? [spot, apart(spot)] : [best, least]), [null, reach])[0];
    return nearest(this.candidates, 12) ?? nearest(this.spots, 24);
  }
}

