import { fit, h, onResize, painter } from '../base/dom';
import { theme } from '../base/theme';
import { Signal } from '../base/signal';
import type { Storyboard } from '../document/storyboard';
import { linesOf, without, type BoardFrame, type Ink, type Row } from '../document/storyboardfile';
import { listenToPen, type PenSample } from './pen';
import { Joints } from './storyboardjoints';
import { drawFrame, drawLineOf, toPixels, toUnits, viewOf, type View } from './storyboardview';

export type BoardTool = Ink | 'eraser' | 'joints';

/** How near to a line, in CSS pixels, the eraser takes it. */
const NEAR = 9;
/** Points of a pen that are nearer than this to the one before are left out, CSS pixels. */
const APART = 1.2;

/** The sheet on which one frame is drawn. */
export class StoryboardCanvas {
  readonly element: HTMLElement;
  readonly tool = new Signal<BoardTool>('body');
  /** Whether ways keep the pen's own time. */
  readonly timed = new Signal(true);
  /** Whether joints that were read are shown. */
  readonly shows = new Signal(true);
  readonly #canvas = h('canvas', { tabindex: 0, role: 'img' });
  readonly #hint = h('p', { class: 'invite' });
  readonly #draw: () => void;
  readonly #joints: Joints;
  #view: View = { scale: 1, x: 0, y: 0 };
  #frame: BoardFrame | null = null;
  #line: Row[] | null = null;
  /** What the eraser has left of the frame. */
  #rest: BoardFrame | null = null;

  /** `say` tells who cannot see it which joint is chosen. */
  constructor(
    readonly story: Storyboard,
    say: (text: string) => void,
  ) {
    this.element = h('div', { class: 'sheet' }, this.#canvas, this.#hint);
    this.#draw = painter(() => this.#render(), this.#canvas);
    this.#joints = new Joints(story, () => this.#view, this.#draw, say);
    onResize(this.#canvas, () => this.#look());
    listenToPen(this.#canvas, { begin: (sample) => this.#begin(sample), move: (samples) => this.#move(samples), end: (cancelled) => this.#end(cancelled) });
    this.tool.watch((tool) => {
      this.#canvas.dataset['tool'] = tool;
      this.#joints.held = tool === 'joints';
    });
    this.#canvas.addEventListener('keydown', (event) => {
      if (this.tool.value !== 'joints' || event.ctrlKey || event.metaKey || event.altKey || !this.#joints.key(event.key, event.shiftKey)) return;
      event.preventDefault();
      event.stopPropagation();
    });
    story.chosen.subscribe(() => this.#look());
    story.file.subscribe(() => this.#draw());
    for (const signal of [theme, story.made, this.shows]) signal.subscribe(this.#draw);
    const name = () => {
      const { frame } = story;
      const count = (list: readonly unknown[] | undefined, what: string) => `${list?.length ?? 0} ${what}`;
      this.#canvas.setAttribute('aria-label', `Frame ${story.chosen.value + 1}: ${count(frame.body, 'body lines')}, ${count(frame.trajectories, 'ways')}. Draw here with a pen, a finger or the mouse`);
      this.#hint.hidden = linesOf(frame).length > 0;
    };
    this.#hint.append(h('b', {}, 'Draw a figure'), 'Then, with the cyan pen, the way of a hand or a foot');
    story.file.watch(name);
    story.chosen.subscribe(name);
  }

  /** Shows the whole of the frame that is chosen. While one draws nothing moves. */
  #look(): void {
    const { clientWidth: width, clientHeight: height } = this.#canvas;
    this.#frame = null;
    this.#view = viewOf(this.story.frame, Math.max(width, 1), Math.max(height, 1), 18);
    this.#draw();
  }

  #begin(sample: PenSample): boolean {
    if (this.tool.value === 'joints') return this.#joints.grab([sample.x, sample.y]);
    if (this.tool.value === 'eraser') {
      this.#rest = this.story.frame;
      this.#erase(sample);
    } else {
      this.#hint.hidden = true;
      this.#line = [this.#row(sample)];
    }
    this.#draw();
    return true;
  }

  #move(samples: readonly PenSample[]): void {
    const last = samples.at(-1);
    if (last) this.#joints.drag([last.x, last.y]);
    for (const sample of samples) {
      if (this.#rest) this.#erase(sample);
      const last = this.#line?.at(-1);
      if (!last || !this.#line) continue;
      const [x, y] = toPixels(this.#view, last[0] ?? 0, last[1] ?? 0);
      if (Math.hypot(sample.x - x, sample.y - y) >= APART) this.#line.push(this.#row(sample));
    }
    this.#draw();
  }

  #end(cancelled: boolean): void {
    const [line, rest] = [this.#line, this.#rest];
    [this.#line, this.#rest] = [null, null];
    this.#joints.release(cancelled);
    if (!cancelled && line && this.tool.value !== 'eraser' && this.tool.value !== 'joints') this.story.draw(this.tool.value, line);
    if (!cancelled && rest && rest !== this.story.frame) this.story.change(difference(this.story.frame, rest));
    this.#draw();
  }

  #row({ x, y, t }: PenSample): Row {
    const [u, v] = toUnits(this.#view, x, y);
    const place = [Number(u.toFixed(1)), Number(v.toFixed(1))];
    return this.tool.value === 'trajectory' && this.timed.value ? [...place, Number(t.toFixed(3))] : place;
  }

  #erase({ x, y }: PenSample): void {
    const frame = this.#rest;
    if (!frame) return;
    const pin = (this.shows.value ? (frame.pins ?? []) : []).find(({ at: [u, v] }) => Math.hypot(toPixels(this.#view, u, v)[0] - x, toPixels(this.#view, u, v)[1] - y) < NEAR);
    if (pin) {
      this.#rest = { ...frame, pins: (frame.pins ?? []).filter((other) => other !== pin) };
      return;
    }
    const touched = linesOf(frame).find(({ line }) => line.some((row, i) => this.#near(x, y, row, line[i + 1] ?? row)));
    if (touched) this.#rest = { ...frame, ...without(frame, touched.ink, touched.at) };
  }

  #near(x: number, y: number, from: Row, to: Row): boolean {
    const [ax, ay] = toPixels(this.#view, from[0] ?? 0, from[1] ?? 0);
    const [bx, by] = toPixels(this.#view, to[0] ?? 0, to[1] ?? 0);
    const [dx, dy] = [bx - ax, by - ay];
    const part = Math.min(Math.max(((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1), 0), 1);
    return Math.hypot(x - ax - part * dx, y - ay - part * dy) < NEAR;
  }

  #render(): void {
    const { context, width, height } = fit(this.#canvas);
    const frame = this.#rest ?? this.story.frame;
    // A frame that came from elsewhere is seen whole.
    if (this.#frame === null && !this.#line) this.#view = viewOf(frame, width, height, 18);
    this.#frame = frame;
    this.#canvas.dataset['view'] = JSON.stringify(this.#view);
    drawFrame(context, this.#view, frame, 3);
    if (this.#line && this.tool.value !== 'eraser' && this.tool.value !== 'joints') drawLineOf(context, this.#view, this.tool.value, this.#line, 3);
    if (this.shows.value || this.tool.value === 'joints') this.#joints.paint(context, frame);
  }
}

/** What the eraser took, so that what is known of a figure that it did not touch stays. */
function difference(before: BoardFrame, after: BoardFrame): Partial<BoardFrame> {
  return Object.fromEntries(Object.entries(after).filter(([name, value]) => before[name as keyof BoardFrame] !== value));
}
