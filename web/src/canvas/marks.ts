import { css, type Rgb } from '../base/colour';
import type { KeyKind } from '../api/types';

/** The sign of a kind of key: ring, diamond, ring with a bar, square with a cross. Shapes differ, not only colours. */
export function drawMark(
  context: CanvasRenderingContext2D,
  kind: KeyKind,
  [x, y]: readonly [number, number],
  tone: Rgb,
  ground: Rgb,
  options: { size?: number; selected?: boolean; accent?: Rgb } = {},
): void {
  const r = options.size ?? 7;
  context.save();
  context.translate(x, y);
  if (options.selected) {
    context.beginPath();
    context.arc(0, 0, r + 5, 0, 2 * Math.PI);
    context.strokeStyle = css(options.accent ?? tone);
    context.lineWidth = 1.5;
    context.stroke();
  }
  path(context, kind, r);
  context.fillStyle = css(kind === 'hard' ? tone : ground);
  context.fill();
  context.lineJoin = 'round';
  context.lineWidth = 2;
  context.strokeStyle = css(tone);
  context.stroke();
  inner(context, kind, r, tone);
  context.restore();
}

function path(context: CanvasRenderingContext2D, kind: KeyKind, r: number): void {
  context.beginPath();
  if (kind === 'hard') {
    context.moveTo(0, -r);
    context.lineTo(r, 0);
    context.lineTo(0, r);
    context.lineTo(-r, 0);
    context.closePath();
  } else if (kind === 'never') context.rect(-0.85 * r, -0.85 * r, 1.7 * r, 1.7 * r);
  else context.arc(0, 0, 0.92 * r, 0, 2 * Math.PI);
}

function inner(context: CanvasRenderingContext2D, kind: KeyKind, r: number, tone: Rgb): void {
  context.beginPath();
  const k = 0.42 * r;
  if (kind === 'soft') {
    context.arc(0, 0, 0.3 * r, 0, 2 * Math.PI);
    context.fillStyle = css(tone);
    context.fill();
    return;
  }
  if (kind === 'avoid') {
    context.moveTo(-k, 0);
    context.lineTo(k, 0);
  }
  if (kind === 'never') {
    context.moveTo(-k, -k);
    context.lineTo(k, k);
    context.moveTo(k, -k);
    context.lineTo(-k, k);
  }
  context.stroke();
}
