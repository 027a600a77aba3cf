import { css, type Rgb } from '../base/colour';

/** A sample in pixels, with the half width of the ink there. */
export interface Drop {
  readonly x: number;
  readonly y: number;
  readonly half: number;
}

/**
 * Draws ink as one outline per run of equal colour: two offset lines and round ends. `colours` has one entry a drop, or
 * one for all.
 */
export function drawInk(context: CanvasRenderingContext2D, drops: readonly Drop[], colours: readonly Rgb[], alpha = 1): void {
  const only = colours.length === 1;
  const [first] = drops;
  if (!first) return;
  if (drops.length === 1) {
    disc(context, first, colours[0] ?? [0, 0, 0], alpha);
    return;
  }
  for (let i = 0; i + 1 < drops.length; ) {
    const colour = colours[only ? 0 : i] ?? [0, 0, 0];
    let end = i + 1;
    while (end + 1 < drops.length && (only || alike(colours[end] ?? colour, colour))) end += 1;
    // Runs overlap by a drop, so that no seam shows between two colours.
    ribbon(context, drops, Math.max(i - 1, 0), end, css(colour, alpha));
    i = end;
  }
}

function ribbon(context: CanvasRenderingContext2D, drops: readonly Drop[], from: number, to: number, style: string): void {
  const [left, right]: [number[], number[]] = [[], []];
  for (let i = from; i <= to; i += 1) {
    const here = drops[i];
    if (!here) continue;
    const [before, after] = [drops[Math.max(i - 1, 0)] ?? here, drops[Math.min(i + 1, drops.length - 1)] ?? here];
    const [dx, dy] = [after.x - before.x, after.y - before.y];
    const length = Math.hypot(dx, dy) || 1;
    const [nx, ny] = [(-dy / length) * here.half, (dx / length) * here.half];
    left.push(here.x + nx, here.y + ny);
    right.push(here.x - nx, here.y - ny);
  }
  context.beginPath();
  context.moveTo(left[0] ?? 0, left[1] ?? 0);
  for (let i = 2; i < left.length; i += 2) context.lineTo(left[i] ?? 0, left[i + 1] ?? 0);
  for (let i = right.length - 2; i >= 0; i -= 2) context.lineTo(right[i] ?? 0, right[i + 1] ?? 0);
  context.closePath();
  context.fillStyle = style;
  context.fill();
  // Apart from the outline: wound the other way, an end would be a hole in it.
  context.beginPath();
  for (const end of [drops[from], drops[to]]) {
    if (!end) continue;
    context.moveTo(end.x + end.half, end.y);
    context.arc(end.x, end.y, end.half, 0, 2 * Math.PI);
  }
  context.fill();
}

/** Drops in between where they lie far apart, on a Catmull-Rom spline: quick strokes stay round. */
export function dense<T extends Drop>(drops: readonly T[], between: (from: T, to: T, part: number, drop: Drop) => T): T[] {
  const out: T[] = [];
  drops.forEach((b, i) => {
    const c = drops[i + 1];
    out.push(b);
    if (!c) return;
    const [a, d] = [drops[i - 1] ?? b, drops[i + 2] ?? c];
    const steps = Math.min(Math.ceil(Math.hypot(c.x - b.x, c.y - b.y) / 4), 24);
    for (let step = 1; step < steps; step += 1) {
      const u = step / steps;
      const at = (axis: 'x' | 'y') => spline(a[axis], b[axis], c[axis], d[axis], u);
      out.push(between(b, c, u, { x: at('x'), y: at('y'), half: b.half + u * (c.half - b.half) }));
    }
  });
  return out;
}

function spline(a: number, b: number, c: number, d: number, u: number): number {
  return b + 0.5 * u * (c - a + u * (2 * a - 5 * b + 4 * c - d + u * (3 * (b - c) + d - a)));
}

function disc(context: CanvasRenderingContext2D, { x, y, half }: Drop, colour: Rgb, alpha: number): void {
  context.beginPath();
  context.arc(x, y, half, 0, 2 * Math.PI);
  context.fillStyle = css(colour, alpha);
  context.fill();
}

function alike(a: Rgb, b: Rgb): boolean {
  return Math.abs(a[0] - b[0]) < 6 && Math.abs(a[1] - b[1]) < 6 && Math.abs(a[2] - b[2]) < 6;
}
