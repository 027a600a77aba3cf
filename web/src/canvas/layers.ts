import { blend, css, rampAt, type Rgb } from '../base/colour';
import { clamp, type Vec2 } from '../base/maths';
import type { Theme } from '../base/theme';
import { placeAt, type Line } from '../document/curve';
import type { Used } from '../document/session';
import { dense, drawInk, type Drop } from './ink';
import type { Paper } from './paper';

/** What colours a line: which source frame each part of it uses. */
export interface Colours {
  readonly used: Used | null;
  readonly frames: number;
  readonly theme: Theme;
}

/** A quiet grid of dots, always about 28 pixels apart. */
export function drawPaper(context: CanvasRenderingContext2D, paper: Paper, theme: Theme): void {
  const step = 2 ** Math.round(Math.log2(28 / paper.scale));
  const gap = step * paper.scale;
  const [x0, y0] = paper.toPixels(0, 0);
  context.fillStyle = css(theme.grid, theme.dark ? 0.55 : 0.6);
  for (let x = x0 % gap; x < paper.width; x += gap) {
    for (let y = y0 % gap; y < paper.height; y += gap) context.fillRect(Math.round(x), Math.round(y), 1, 1);
  }
}

/** The map of the clip under the drawing, in its own coordinates: a line drawn over it passes its moments. */
export function drawMap(context: CanvasRenderingContext2D, paper: Paper, map: MapPaths, theme: Theme): void {
  context.lineWidth = 1.2;
  for (const { from, to, part } of map) {
    context.beginPath();
    context.moveTo(...paper.toPixels(from[0], from[1]));
    context.lineTo(...paper.toPixels(to[0], to[1]));
    context.strokeStyle = css(rampAt(theme.ramp, part), 0.4);
    context.stroke();
  }
}

export function drawLine(context: CanvasRenderingContext2D, paper: Paper, line: Line, colours: Colours): void {
  strokes(line).forEach(([from, to]) => {
    const sparse: Timed[] = [];
    for (let i = from; i < to; i += 1) {
      const [x, y] = paper.toPixels(line.points[2 * i] ?? 0, line.points[2 * i + 1] ?? 0);
      const ends = Math.min(1, 0.45 + 0.14 * Math.min(i - from, to - 1 - i));
      sparse.push({ x, y, half: halfWidth(line.pressure[i] ?? 0.5) * ends, part: line.parts[i] ?? 0 });
    }
    const drops = dense(sparse, (a, b, u, drop) => ({ ...drop, part: a.part + u * (b.part - a.part) }));
    drawInk(context, drops, drops.map((drop) => toneAt(colours, drop.part)));
  });
}

/** A band beside the line: the wider, the less sure it is which part of the clip is meant. */
export function drawDoubt(context: CanvasRenderingContext2D, paper: Paper, line: Line, colours: Colours): void {
  const { used, theme } = colours;
  const confidence = used?.confidence;
  if (!used || !confidence || confidence.length === 0) return;
  strokes(line).forEach(([from, to]) => {
    const sparse: Timed[] = [];
    for (let i = from; i < to; i += 1) {
      const part = line.parts[i] ?? 0;
      const doubt = 1 - (confidence[Math.round(part * (confidence.length - 1))] ?? 1);
      const [x, y] = paper.toPixels(line.points[2 * i] ?? 0, line.points[2 * i + 1] ?? 0);
      sparse.push({ x, y, half: halfWidth(line.pressure[i] ?? 0.5) + 9 * clamp(doubt, 0, 1), part });
    }
    const drops = dense(sparse, (a, b, u, drop) => ({ ...drop, part: a.part + u * (b.part - a.part) }));
    drawInk(context, drops, drops.map((drop) => blend(toneAt(colours, drop.part), theme.paper, 0.78)));
  });
}

/** An open end tells where the line begins, an arrow which way it goes. */
export function drawStart(context: CanvasRenderingContext2D, paper: Paper, line: Line, theme: Theme): void {
  if (line.count < 4) return;
  const [x, y] = paper.toPixels(line.points[0] ?? 0, line.points[1] ?? 0);
  context.beginPath();
  context.arc(x, y, 5.5, 0, 2 * Math.PI);
  context.fillStyle = css(theme.paper);
  context.fill();
  context.lineWidth = 2;
  context.strokeStyle = css(theme.ink);
  context.stroke();
}

export function drawDot(context: CanvasRenderingContext2D, paper: Paper, line: Line, part: number, colours: Colours): void {
  const at = placeAt(line, part);
  if (!at) return;
  const [x, y] = paper.toPixels(at[0], at[1]);
  const tone = toneAt(colours, part);
  disc(context, x, y, 16, css(tone, 0.22));
  disc(context, x, y, 9.5, css(colours.theme.paper));
  disc(context, x, y, 6.5, css(tone));
}

export function drawRing(context: CanvasRenderingContext2D, paper: Paper, line: Line, part: number, theme: Theme): void {
  const at = placeAt(line, part);
  if (!at) return;
  const [x, y] = paper.toPixels(at[0], at[1]);
  context.beginPath();
  context.arc(x, y, 9, 0, 2 * Math.PI);
  context.lineWidth = 1.5;
  context.strokeStyle = css(theme.ink, 0.8);
  context.stroke();
}

/** The colour of the source frame that is used at a part of the time; ink where nothing is known yet. */
export function toneAt({ used, frames, theme }: Colours, part: number): Rgb {
  if (!used || used.frames.length === 0 || frames < 2) return theme.ink;
  const frame = used.frames[Math.round(clamp(part, 0, 1) * (used.frames.length - 1))] ?? 0;
  return rampAt(theme.ramp, frame / (frames - 1));
}

/** Pieces of the map, each with the part (0 to 1) of the clip it is of. */
export type MapPaths = readonly { from: Vec2; to: Vec2; part: number }[];

interface Timed extends Drop {
  readonly part: number;
}

function halfWidth(pressure: number): number {
  return 1.1 + 3 * clamp(pressure, 0, 1);
}

function strokes(line: Line): [number, number][] {
  return line.starts.map((from, i) => [from, line.starts[i + 1] ?? line.count]);
}

function disc(context: CanvasRenderingContext2D, x: number, y: number, radius: number, style: string): void {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fillStyle = style;
  context.fill();
}
