import { css, type Rgb } from '../base/colour';
import type { Vec2 } from '../base/maths';
import { theme } from '../base/theme';
import { linesOf, type BoardFrame, type Ink, type Line } from '../document/storyboardfile';

/** A box of the canvas that is always seen, canvas units: a standing figure and room for its ways. */
const PAGE: { low: Vec2; high: Vec2 } = { low: [-220, -50], high: [220, 350] };
/** Canvas units to CSS pixels. */
export interface View {
  readonly scale: number;
  readonly x: number;
  readonly y: number;
}

/** Shows a whole frame within a picture of that size. */
export function viewOf(frame: BoardFrame, width: number, height: number, edge: number): View {
  const [low, high]: [number[], number[]] = [[...PAGE.low], [...PAGE.high]];
  for (const { line } of linesOf(frame)) {
    for (const [x = 0, y = 0] of line) {
      [low[0], low[1]] = [Math.min(low[0] ?? x, x), Math.min(low[1] ?? y, y)];
      [high[0], high[1]] = [Math.max(high[0] ?? x, x), Math.max(high[1] ?? y, y)];
    }
  }
  const [x0 = 0, y0 = 0] = low;
  const [x1 = 1, y1 = 1] = high;
  const scale = Math.max(Math.min((width - 2 * edge) / (x1 - x0), (height - 2 * edge) / (y1 - y0)), 1e-6);
  return { scale, x: width / 2 - (scale * (x0 + x1)) / 2, y: height / 2 + (scale * (y0 + y1)) / 2 };
}

export function toPixels(view: View, x: number, y: number): Vec2 {
  return [view.x + view.scale * x, view.y - view.scale * y];
}

export function toUnits(view: View, x: number, y: number): Vec2 {
  return [(x - view.x) / view.scale, (view.y - y) / view.scale];
}

export function inkColour(ink: Ink): Rgb {
  const { dark, ink: body, soft } = theme.value;
  if (ink === 'trajectory') return dark ? [54, 208, 236] : [0, 132, 168];
  if (ink === 'speed') return dark ? [240, 150, 80] : [200, 90, 20];
  return ink === 'body' ? body : soft;
}

export function drawLineOf(context: CanvasRenderingContext2D, view: View, ink: Ink, line: Line, width: number, alpha = 1): void {
  context.beginPath();
  line.forEach(([x = 0, y = 0], i) => {
    const at = toPixels(view, x, y);
    if (i === 0) context.moveTo(...at);
    else context.lineTo(...at);
  });
  if (line.length === 1) context.lineTo(...toPixels(view, (line[0]?.[0] ?? 0) + 0.1, line[0]?.[1] ?? 0));
  context.lineWidth = width;
  context.lineCap = context.lineJoin = 'round';
  context.strokeStyle = css(inkColour(ink), alpha);
  context.stroke();
}

/** All lines of a frame; a way ends in an arrow. */
export function drawFrame(context: CanvasRenderingContext2D, view: View, frame: BoardFrame, width: number): void {
  for (const { ink, line } of linesOf(frame)) {
    drawLineOf(context, view, ink, line, ink === 'body' || ink === 'trajectory' ? width : 0.6 * width);
    if (ink === 'trajectory') drawArrow(context, view, line, width);
  }
}

function drawArrow(context: CanvasRenderingContext2D, view: View, line: Line, width: number): void {
  const [x, y] = pixelsOf(view, line, line.length - 1);
  let from = line.length - 1;
  let [dx, dy] = [0, 0];
  while (from > 0 && Math.hypot(dx, dy) < 3 * width) {
    from -= 1;
    const [bx, by] = pixelsOf(view, line, from);
    [dx, dy] = [x - bx, y - by];
  }
  const length = Math.hypot(dx, dy);
  if (length === 0) return;
  const angle = Math.atan2(dy, dx);
  const size = 3.6 * width;
  context.beginPath();
  for (const turn of [2.6, -2.6]) {
    context.moveTo(x, y);
    context.lineTo(x + size * Math.cos(angle + turn), y + size * Math.sin(angle + turn));
  }
  context.stroke();
}

function pixelsOf(view: View, line: Line, at: number): Vec2 {
  const [x = 0, y = 0] = line[at] ?? [];
  return toPixels(view, x, y);
}
