import type { Control } from '../api/types';
import { lowerBound, mix, type Vec2 } from '../base/maths';

/** A drawing as one line: places in canvas units (y up), and the part (0 to 1) of the whole time at each. */
export interface Line {
  readonly points: Float64Array;
  readonly pressure: Float32Array;
  readonly parts: Float64Array;
  /** Where a stroke begins, rising; 0 is always one. */
  readonly starts: readonly number[];
  readonly count: number;
}

export const NO_LINE: Line = { points: new Float64Array(), pressure: new Float32Array(), parts: new Float64Array(), starts: [], count: 0 };

/** The line of a drawing; timed by the pen or walked evenly. */
export function lineOf(control: Control | null): Line {
  if (control?.kind !== 'curve') return NO_LINE;
  const count = control.strokes.reduce((sum, stroke) => sum + stroke.length, 0);
  const [points, pressure, grown] = [new Float64Array(2 * count), new Float32Array(count), new Float64Array(count)];
  const starts: number[] = [];
  let [i, total] = [0, 0];
  for (const stroke of control.strokes) {
    if (stroke.length > 0) starts.push(i);
    stroke.forEach(([x, y, t, p], j) => {
      const before = stroke[j - 1];
      if (before) {
        if (control.timing === 'even') total += Math.hypot(x - before[0], y - before[1]);
        else total += t !== null && before[2] !== null ? Math.max(t - before[2], 0) : 1 / 60;
      }
      points[2 * i] = x;
      points[2 * i + 1] = y;
      pressure[i] = p ?? 0.5;
      grown[i] = total;
      i += 1;
    });
  }
  if (total > 0) for (let j = 0; j < count; j += 1) grown[j] = (grown[j] ?? 0) / total;
  return { points, pressure, parts: grown, starts, count };
}

/** Where the line is at a part of its time. */
export function placeAt(line: Line, part: number): Vec2 | null {
  if (line.count === 0) return null;
  const high = Math.min(lowerBound(line.parts, part), line.count - 1);
  const low = Math.max(high - 1, 0);
  const [a, b] = [line.parts[low] ?? 0, line.parts[high] ?? 0];
  const share = b > a ? Math.min(Math.max((part - a) / (b - a), 0), 1) : 1;
  const at = (axis: number) => mix(line.points[2 * low + axis] ?? 0, line.points[2 * high + axis] ?? 0, share);
  return [at(0), at(1)];
}

/** The part of the time at which the line is nearest to a place, and how far off that is. Among passages, that nearest in time to `now`. */
export function nearestPart(line: Line, [x, y]: Vec2, now = 0, size = 1): { part: number; apart: number } | null {
  let best: { part: number; apart: number; cost: number } | null = null;
  for (let i = 0; i < line.count; i += 1) {
    const apart = Math.hypot((line.points[2 * i] ?? 0) - x, (line.points[2 * i + 1] ?? 0) - y);
    const part = line.parts[i] ?? 0;
    const cost = apart + 0.03 * size * Math.abs(part - now);
    if (!best || cost < best.cost) best = { part, apart, cost };
  }
  return best;
}

export function boundsOf(line: Line): { low: Vec2; high: Vec2 } | null {
  if (line.count === 0) return null;
  let [x0, y0, x1, y1] = [Infinity, Infinity, -Infinity, -Infinity];
  for (let i = 0; i < line.count; i += 1) {
    const [x, y] = [line.points[2 * i] ?? 0, line.points[2 * i + 1] ?? 0];
    [x0, y0, x1, y1] = [Math.min(x0, x), Math.min(y0, y), Math.max(x1, x), Math.max(y1, y)];
  }
  return { low: [x0, y0], high: [x1, y1] };
}

export function boundsOfPlaces(places: readonly { x: number; y: number }[]): { low: Vec2; high: Vec2 } {
  const [xs, ys] = [places.map(({ x }) => x), places.map(({ y }) => y)];
  return { low: [Math.min(...xs), Math.min(...ys)], high: [Math.max(...xs), Math.max(...ys)] };
}
