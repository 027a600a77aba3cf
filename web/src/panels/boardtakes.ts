import { css } from '../base/colour';
import { fit, h, painter } from '../base/dom';
import { theme } from '../base/theme';
import type { MadeTake } from '../api/types';
import type { Storyboard } from '../document/storyboard';
import { pressed } from './controls';

/** The motions that were made of the frame, the best first; another one is taken by a press. */
export function boardTakes(story: Storyboard): HTMLElement {
  const list = h('div', { class: 'takes', role: 'group', 'aria-label': 'Motions of the frame' });
  let shown: readonly MadeTake[] = [];
  const draw = painter(() => shown.forEach((take, i) => paint(list.children[i]?.querySelector('canvas'), take)), list);
  const build = () => {
    const told = story.told();
    // Of a frame that was changed, others would come now.
    const takes = told?.made.takes ?? [];
    if (takes !== shown) {
      shown = takes;
      list.replaceChildren(
        ...takes.map((take, i) => {
          const miss = take.meanMiss === null ? '' : `${(100 * take.meanMiss).toFixed(1)} cm`;
          const name = `Motion ${i + 1} of ${takes.length}${i === 0 ? ', the best' : ''}${miss ? `, sampled ${miss} off the drawing` : ''}`;
          return h('button', { type: 'button', class: 'take', title: name, 'aria-label': name, onclick: () => story.take(i) }, h('canvas', { 'aria-hidden': 'true' }), h('span', { 'aria-hidden': 'true' }, miss || `${i + 1}`));
        }),
      );
    }
    list.hidden = takes.length < 2;
    const stale = story.running || !told;
    [...list.children].forEach((one, i) => {
      if (!(one instanceof HTMLButtonElement)) return;
      pressed(one, i === (story.frame.take ?? 0));
      one.disabled = stale;
    });
    draw();
  };
  for (const signal of [story.file, story.chosen, story.made, story.job]) signal.subscribe(build);
  theme.subscribe(draw);
  build();
  return list;
}

/** Its poses side by side, each where it stands, left red and right blue. */
function paint(canvas: HTMLCanvasElement | null | undefined, take: MadeTake): void {
  if (!canvas) return;
  const { context, width, height } = fit(canvas);
  const spans = take.poses.map((pose) => {
    const ys = pose.flat().map(([, y]) => y);
    return { low: Math.min(...ys), high: Math.max(...ys) };
  });
  const [low, high] = [Math.min(...spans.map((span) => span.low)), Math.max(...spans.map((span) => span.high))];
  const tall = Math.max(...spans.map((span) => span.high - span.low));
  // Whoever comes near on the picture, or goes far, would be small: then each stands for itself.
  const apart = high - low > 1.5 * tall;
  const column = width / take.poses.length;
  const { ink } = theme.value;
  const shades = [ink, [222, 70, 70], [70, 120, 235], [222, 70, 70], [70, 120, 235]] as const;
  context.lineCap = context.lineJoin = 'round';
  take.poses.forEach((pose, i) => {
    const xs = pose.flat().map(([x]) => x);
    const [left, right] = [Math.min(...xs), Math.max(...xs)];
    const scale = Math.min((height - 6) / Math.max(apart ? tall : high - low, 0.1), (1.25 * column) / Math.max(right - left, 0.1));
    pose.forEach((line, part) => {
      context.beginPath();
      for (const [x, y] of line) context.lineTo(column * (i + 0.5) + scale * (x - (left + right) / 2), height - 3 - scale * (y - (apart ? (spans[i]?.low ?? low) : low)));
      context.lineWidth = 1.4;
      context.strokeStyle = css(shades[part] ?? ink, 0.95);
      context.stroke();
    });
  });
}
