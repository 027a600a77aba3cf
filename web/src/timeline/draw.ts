import type { Control, Key, Result } from '../api/types';
import { css, rampAt, type Rgb } from '../base/colour';
import { ticks } from '../base/maths';
import type { Theme } from '../base/theme';
import { drawMark } from '../canvas/marks';
import { labelColour, labelText } from '../document/labels';
import { timeOf } from '../document/keys';
import type { Used } from '../document/session';
import type { SourceClips } from '../document/source';
import { GUTTER, type Lanes, type Scale } from './scale';

export interface TimelineView {
  readonly context: CanvasRenderingContext2D;
  readonly scale: Scale;
  readonly lanes: Lanes;
  readonly theme: Theme;
}

export const FONT = '11px -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif';

export function drawRuler({ context, scale, lanes, theme }: TimelineView): void {
  const { top, height } = lanes.ruler;
  context.font = FONT;
  context.textBaseline = 'middle';
  context.textAlign = 'left';
  const marks = ticks(scale.seconds, scale.inner / 90);
  const step = marks[1] ?? scale.seconds;
  for (const mark of marks) {
    const x = Math.round(scale.x(mark)) + 0.5;
    line(context, x, top + 6, x, top + height, css(theme.line));
    context.fillStyle = css(theme.soft);
    if (mark > 0 && x < scale.x(scale.seconds) - 26) context.fillText(`${mark} s`, x + 4, top + 10);
    for (let i = 1; i < 5 && step > 0; i += 1) {
      const minor = Math.round(scale.x(mark + (i * step) / 5)) + 0.5;
      if (mark + (i * step) / 5 < scale.seconds) line(context, minor, top + height - 4, minor, top + height, css(theme.line));
    }
  }
}

export function drawNames({ context, lanes, theme }: TimelineView, lane: Control['kind'] | 'storyboard' | null, source: SourceClips): void {
  context.font = FONT;
  context.textAlign = 'right';
  context.textBaseline = 'middle';
  context.fillStyle = css(theme.soft);
  const right = GUTTER - 16;
  if (lane) context.fillText(CONTROL_NAMES[lane], right, lanes.control.top + lanes.control.height / 2);
  context.fillText('Keys', right, lanes.keys.top + lanes.keys.height / 2);
  const { top, height } = lanes.plan;
  for (let i = 0; i < height; i += 1) {
    context.fillStyle = css(rampAt(theme.ramp, 1 - i / height));
    context.fillRect(GUTTER - 9, top + i, 4, 1.5);
  }
  context.fillStyle = css(theme.soft);
  const seconds = source.parts.reduce((sum, part) => sum + part.clip.seconds, 0);
  if (height < 40) return;
  context.fillText('Clip', right, top + height / 2);
  context.fillText(`${seconds.toFixed(0)} s`, right, top + 6);
  context.fillText('0 s', right, top + height - 6);
}

const CONTROL_NAMES: Readonly<Record<Control['kind'] | 'storyboard', string>> = {
  curve: 'Drawing',
  wave: 'Wave',
  drawnWave: 'Wave',
  labels: 'Labels',
  sound: 'Sound',
  motion: 'Motion',
  storyboard: 'Frames',
};

export function drawPlan({ context, scale, lanes, theme }: TimelineView, heat: HTMLCanvasElement | null, source: SourceClips, keys: readonly Key[], stale: boolean, empty = 'Draw, and the plan shows which part of the clip is used when'): void {
  const { top, height } = lanes.plan;
  context.fillStyle = css(theme.ink, theme.dark ? 0.04 : 0.045);
  context.fillRect(GUTTER, top, scale.inner, height);
  if (heat) {
    context.globalAlpha = stale ? 0.35 : 1;
    context.imageSmoothingQuality = 'high';
    context.drawImage(heat, GUTTER, top, scale.inner, height);
    context.globalAlpha = 1;
  } else {
    context.font = FONT;
    context.fillStyle = css(theme.soft);
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    context.fillText(empty, GUTTER + scale.inner / 2, top + height / 2);
  }
  context.font = FONT;
  context.textAlign = 'left';
  const y = (frame: number) => top + height * (1 - frame / Math.max(source.frames - 1, 1));
  if (source.parts.length > 1) {
    for (const part of source.parts) {
      if (part.first > 0) line(context, GUTTER, y(part.first), GUTTER + scale.inner, y(part.first), css(theme.ink, 0.3));
      context.fillStyle = css(theme.soft);
      context.textBaseline = 'bottom';
      context.fillText(part.clip.name, GUTTER + 6, y(part.first) - 3);
    }
  }
  for (const key of keys) {
    if ((key.kind !== 'never' && key.kind !== 'avoid') || !key.pose || !key.enabled) continue;
    const frame = source.count(key.pose.clip, key.pose.frame);
    if (frame === null) continue;
    context.setLineDash(key.kind === 'avoid' ? [4, 4] : []);
    line(context, GUTTER, y(frame), GUTTER + scale.inner, y(frame), css(theme.key, 0.8));
    context.setLineDash([]);
  }
}

/** Which frame is used when, as a line over the plan that breaks where the clip is cut. */
export function drawUsed({ context, scale, lanes, theme }: TimelineView, used: Used | null, frames: number): void {
  if (!used || frames < 2) return;
  const { top, height } = lanes.plan;
  context.save();
  context.beginPath();
  context.rect(GUTTER, top - 2, scale.inner + 2, height + 4);
  context.clip();
  context.lineWidth = 2;
  context.lineCap = 'round';
  for (let i = 0; i + 1 < used.frames.length; i += 1) {
    const [a, b] = [used.frames[i] ?? 0, used.frames[i + 1] ?? 0];
    if (Math.abs(b - a) > 12) continue;
    const y = (frame: number) => top + height * (1 - frame / (frames - 1));
    context.strokeStyle = css(rampAt(theme.ramp, a / (frames - 1)));
    context.beginPath();
    context.moveTo(scale.x(i / used.rate), y(a));
    context.lineTo(scale.x((i + 1) / used.rate), y(b));
    context.stroke();
  }
  context.restore();
}

export function drawControl({ context, scale, lanes, theme }: TimelineView, control: Control | null, wave: readonly number[]): void {
  const { top, height } = lanes.control;
  const [low, high] = [top + 3, top + height - 3];
  if (control?.kind === 'labels') {
    const total = control.segments.reduce((sum, label) => sum + label.seconds, 0) || 1;
    let at = 0;
    for (const label of control.segments) {
      const [x0, x1] = [GUTTER + (at / total) * scale.inner, GUTTER + ((at + label.seconds) / total) * scale.inner];
      context.fillStyle = labelColour(control.segments, label, theme.dark);
      context.fillRect(x0, low, Math.max(x1 - x0 - 1, 1), high - low);
      context.fillStyle = labelText(label, theme.dark);
      context.font = `600 ${FONT}`;
      context.textAlign = 'left';
      context.textBaseline = 'middle';
      context.fillText(label.name, x0 + 7, (low + high) / 2, Math.max(x1 - x0 - 12, 1));
      at += label.seconds;
    }
    return;
  }
  if (wave.length < 2) return;
  context.beginPath();
  const middle = (low + high) / 2;
  if (control?.kind === 'sound') {
    const width = scale.inner / wave.length;
    wave.forEach((value, i) => {
      const half = Math.max(0.5, (value * (high - low)) / 2);
      context.rect(GUTTER + i * width, middle - half, Math.max(width * 0.7, 0.6), 2 * half);
    });
    context.fillStyle = css(theme.accent, 0.8);
    context.fill();
    return;
  }
  wave.forEach((value, i) => context.lineTo(GUTTER + (i / (wave.length - 1)) * scale.inner, high - value * (high - low)));
  context.strokeStyle = css(theme.accent);
  context.lineWidth = 1.5;
  context.stroke();
}

export function drawKeys({ context, scale, lanes, theme }: TimelineView, keys: readonly Key[], selected: string | null, result: Result | null): void {
  const { top, height } = lanes.keys;
  const y = top + height / 2;
  line(context, GUTTER, y, GUTTER + scale.inner, y, css(theme.line));
  for (const key of keys) {
    context.globalAlpha = key.enabled ? 1 : 0.4;
    if (key.kind === 'fixed' && key.fixed) {
      const [x0, x1] = [scale.x(key.fixed.from), scale.x(key.fixed.to)];
      context.fillStyle = css(theme.accent, key.id === selected ? 0.9 : 0.55);
      context.fillRect(x0, y - 5, Math.max(x1 - x0, 2), 10);
      continue;
    }
    const time = timeOf(key) ?? result?.keys.find((row) => row.id === key.id && key.kind === 'soft')?.seconds ?? null;
    if (time === null || key.kind === 'fixed') continue;
    drawMark(context, key.kind, [scale.x(time), y], theme.key, theme.panel, { size: 6, selected: key.id === selected, accent: theme.accent });
  }
  context.globalAlpha = 1;
}

/** Frames that jump, slide or stand still for too long: red below the plan. */
export function drawBad({ context, scale, lanes, theme }: TimelineView, result: Result | null): void {
  if (!result) return;
  const y = lanes.plan.top + lanes.plan.height + 3;
  const width = Math.max(scale.inner / Math.max(result.frames, 1), 1.5);
  context.fillStyle = css(theme.bad);
  for (const frames of Object.values(result.badFrames)) {
    for (const frame of frames) context.fillRect(scale.x(frame / result.frameRate), y, width, 5);
  }
}

export function drawPlayhead({ context, scale, lanes, theme }: TimelineView, seconds: number, y: number | null, frame: number | null, frames: number): void {
  const x = scale.x(seconds);
  const bottom = lanes.plan.top + lanes.plan.height + 8;
  line(context, x, lanes.ruler.top + 12, x, bottom, css(theme.ink), 1.5);
  context.beginPath();
  context.moveTo(x - 5.5, lanes.ruler.top + 3);
  context.lineTo(x + 5.5, lanes.ruler.top + 3);
  context.lineTo(x + 5.5, lanes.ruler.top + 10);
  context.lineTo(x, lanes.ruler.top + 16);
  context.lineTo(x - 5.5, lanes.ruler.top + 10);
  context.closePath();
  context.fillStyle = css(theme.ink);
  context.fill();
  if (y === null || frame === null) return;
  dot(context, x, y, rampAt(theme.ramp, frame / Math.max(frames - 1, 1)), theme.panel);
}

/** A link from a time to the part of the clip it uses; while it is dragged, to where it will be. */
export function drawLink({ context, scale, lanes, theme }: TimelineView, seconds: number, from: number | null, to: number | null): void {
  const x = scale.x(seconds);
  line(context, x, lanes.ruler.top + 12, x, lanes.plan.top + lanes.plan.height, css(theme.ink, 0.35));
  if (from !== null) dot(context, x, from, to === null ? theme.ink : theme.soft, theme.panel);
  if (from === null || to === null) return;
  line(context, x, from, x, to, css(theme.key), 2);
  dot(context, x, to, theme.key, theme.panel);
}

function dot(context: CanvasRenderingContext2D, x: number, y: number, tone: Rgb, ground: Rgb): void {
  for (const [radius, style] of [[6, css(ground)], [4.2, css(tone)]] as const) {
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    context.fillStyle = style;
    context.fill();
  }
}

function line(context: CanvasRenderingContext2D, x0: number, y0: number, x1: number, y1: number, style: string, width = 1): void {
  context.beginPath();
  context.moveTo(x0, y0);
  context.lineTo(x1, y1);
  context.strokeStyle = style;
  context.lineWidth = width;
  context.stroke();
}
