import { clamp, type Vec2 } from '../base/maths';

/** The view of the paper: canvas units (1 is half the shorter side at zoom 1, y up) to CSS pixels. */
export class Paper {
  width = 1;
  height = 1;
  zoom = 1;
  pan: Vec2 = [0, 0];

  get scale(): number {
    return 0.5 * Math.min(this.width, this.height) * this.zoom;
  }

  toPixels(x: number, y: number): Vec2 {
    return [this.width / 2 + this.scale * (x - this.pan[0]), this.height / 2 - this.scale * (y - this.pan[1])];
  }

  toUnits(x: number, y: number): Vec2 {
    return [this.pan[0] + (x - this.width / 2) / this.scale, this.pan[1] - (y - this.height / 2) / this.scale];
  }

  /** Zooms so that what is under a pixel stays there. */
  zoomAt(x: number, y: number, factor: number): void {
    const [ux, uy] = this.toUnits(x, y);
    this.zoom = clamp(this.zoom * factor, 0.1, 20);
    const [vx, vy] = this.toUnits(x, y);
    this.pan = [this.pan[0] + ux - vx, this.pan[1] + uy - vy];
  }

  move(dx: number, dy: number): void {
    this.pan = [this.pan[0] - dx / this.scale, this.pan[1] + dy / this.scale];
  }

  /** Shows a box of the paper whole, with a margin and beside the tools, which cover `left` pixels. */
  show(low: Vec2, high: Vec2, left: number): void {
    const [w, h] = [Math.max(high[0] - low[0], 0.05), Math.max(high[1] - low[1], 0.05)];
    const half = 0.5 * Math.min(this.width, this.height);
    this.zoom = clamp(Math.min((0.88 * (this.width - left)) / w, (0.84 * this.height) / h) / half, 0.1, 20);
    this.pan = [(low[0] + high[0]) / 2 - left / 2 / this.scale, (low[1] + high[1]) / 2];
  }
}
