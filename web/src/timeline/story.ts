import { css } from '../base/colour';
import { FONT, type TimelineView } from './draw';

/** A frame of a storyboard on the timeline, seconds. */
export interface StoryPart {
  readonly from: number;
  readonly to: number;
  readonly text: string;
  readonly chosen: boolean;
}

/** The clips of a storyboard's animation, and what leads from one to the next. */
export interface Story {
  readonly parts: readonly StoryPart[];
  readonly transitions: readonly { readonly from: number; readonly to: number }[];
}

/** Clips as blocks, transitions hatched over them. */
export function drawStory({ context, scale, lanes, theme }: TimelineView, { parts, transitions }: Story): void {
  const { top, height } = lanes.control;
  const [low, tall] = [top + 3, height - 6];
  context.font = FONT;
  context.textAlign = 'left';
  context.textBaseline = 'middle';
  for (const { from, to, chosen } of parts) {
    const [x0, x1] = [scale.x(from), scale.x(Math.min(to, scale.seconds))];
    context.fillStyle = css(theme.accent, chosen ? 0.38 : 0.18);
    context.fillRect(x0 + 0.5, low, Math.max(x1 - x0 - 1, 1), tall);
    if (chosen) {
      context.strokeStyle = css(theme.accent);
      context.lineWidth = 1.5;
      context.strokeRect(x0 + 1.25, low + 0.75, Math.max(x1 - x0 - 2.5, 1), tall - 1.5);
    }
  }
  context.lineWidth = 1;
  for (const { from, to } of transitions) {
    const [x0, x1] = [scale.x(from), scale.x(to)];
    context.save();
    context.beginPath();
    context.rect(x0, low, x1 - x0, tall);
    context.clip();
    context.fillStyle = css(theme.panel, 0.55);
    context.fillRect(x0, low, x1 - x0, tall);
    context.beginPath();
    for (let x = x0 - tall; x < x1; x += 6) {
      context.moveTo(x, low + tall);
      context.lineTo(x + tall, low);
    }
    context.strokeStyle = css(theme.soft, 0.8);
    context.stroke();
    context.restore();
  }
  for (const { from, to, text } of parts) {
    const [x0, x1] = [scale.x(from), scale.x(Math.min(to, scale.seconds))];
    const first = transitions.find((one) => one.from <= from && one.to > from);
    const x = (first ? scale.x(first.to) : x0) + 8;
    if (x1 - x < 16) continue;
    context.fillStyle = css(theme.ink);
    context.fillText(text, x, low + tall / 2, x1 - x - 6);
  }
}
