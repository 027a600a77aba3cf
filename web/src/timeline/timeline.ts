import type { Key } from '../api/types';
import { calm, fit, onResize, painter } from '../base/dom';
import { clamp, type Vec2 } from '../base/maths';
import { theme } from '../base/theme';
import { newKey, timeOf } from '../document/keys';
import type { Session } from '../document/session';
import type { Ui } from '../document/ui';
import { drawBad, drawControl, drawKeys, drawLink, drawNames, drawPlan, drawPlayhead, drawRuler, drawUsed } from './draw';
import { heatImage } from './heat';
import { drawStory, type Story } from './story';
import { lanes, Scale, within, type Lanes } from './scale';

type Drag = { kind: 'scrub' } | { kind: 'key'; key: Key; gesture: string } | { kind: 'link'; seconds: number; frame: number };

/** Time: ruler, control, keys, and the plan of which part of the clip is used when. */
export class Timeline {
  readonly scale = new Scale();
  readonly #still: HTMLCanvasElement;
  readonly #top: HTMLCanvasElement;
  readonly #drawStill: () => void;
  readonly #drawTop: () => void;
  #lanes: Lanes = lanes(200, false);
  #heat: HTMLCanvasElement | null = null;
  #drag: Drag | null = null;
  #wave: readonly number[] = [];
  #story: Story | null = null;
  /** A frame of the storyboard was pressed. */
  onpart: (index: number) => void = () => undefined;

  constructor(
    readonly session: Session,
    readonly ui: Ui,
    still: HTMLCanvasElement,
    top: HTMLCanvasElement,
  ) {
    [this.#still, this.#top] = [still, top];
    this.#drawStill = painter(() => this.#renderStill());
    this.#drawTop = painter(() => this.#renderTop());
    onResize(top, () => this.redraw());
    const reheat = () => {
      const plan = session.plan.value;
      this.#heat = plan ? heatImage(plan, theme.value) : null;
      this.redraw();
    };
    session.plan.watch(reheat);
    theme.subscribe(reheat);
    for (const signal of [session.store.document, session.result, session.source, session.stale, ui.selected]) {
      signal.subscribe(() => this.redraw());
    }
    const drawing = () => session.live.active !== 0;
    for (const signal of [session.used, session.player.duration]) signal.subscribe(calm(drawing, () => this.redraw()));
    session.player.seconds.subscribe(calm(drawing, () => this.#drawTop()));
    for (const signal of [ui.hover, ui.pointed]) signal.subscribe(() => this.#drawTop());
    this.#listen();
  }

  /** Values (0 to 1, evenly over the whole time) that are drawn in the control's lane. */
  set wave(values: readonly number[]) {
    this.#wave = values;
    this.#drawStill();
  }

  /** The storyboard whose animation is shown. */
  set story(story: Story | null) {
    this.#story = story;
    this.redraw();
  }

  redraw(): void {
    this.#drawStill();
    this.#drawTop();
  }

  /** Places an exact key where a pose was dropped, in page coordinates; whether it was dropped here. */
  drop(pose: { clip: string; frame: number }, clientX: number, clientY: number): boolean {
    const box = this.#top.getBoundingClientRect();
    if (clientX < box.left || clientX > box.right || clientY < box.top || clientY > box.bottom) return false;
    const kind = this.ui.keyKind.value;
    const key = newKey(kind, pose, { kind: 'time', seconds: this.scale.time(clientX - box.left) });
    this.session.store.edit('Key on the timeline', [{ type: 'putKey', key }]);
    this.ui.selected.value = key.id;
    return true;
  }

  #listen(): void {
    const top = this.#top;
    const at = (event: PointerEvent): Vec2 => {
      const box = top.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    };
    top.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      top.setPointerCapture(event.pointerId);
      this.#press(at(event));
    });
    top.addEventListener('pointermove', (event) => this.#move(at(event)));
    const end = (event: PointerEvent) => this.#release(at(event), event.type === 'pointerup');
    top.addEventListener('pointerup', end);
    top.addEventListener('pointercancel', end);
    top.addEventListener('pointerleave', () => {
      if (this.#drag) return;
      this.ui.hover.value = null;
      this.ui.pointed.value = null;
    });
  }

  #press([x, y]: Vec2): void {
    const key = within(this.#lanes.keys, y) ? this.#keyAt(x) : null;
    if (key) {
      this.ui.selected.value = key.id;
      this.#drag = { kind: 'key', key, gesture: `time ${key.id} ${Date.now()}` };
      return;
    }
    const linked = this.#linkAt([x, y]);
    if (linked !== null) {
      this.session.player.pause();
      this.#drag = { kind: 'link', seconds: this.scale.time(x), frame: linked };
      return;
    }
    this.session.player.pause();
    this.#drag = { kind: 'scrub' };
    this.ui.pointed.value = null;
    this.session.player.seek(this.scale.time(x));
    const time = this.scale.time(x);
    const part = within(this.#lanes.control, y) ? this.#story?.parts.findIndex(({ from, to }) => time >= from && time < to) : undefined;
    if (part !== undefined && part >= 0) this.onpart(part);
  }

  #move([x, y]: Vec2): void {
    const time = this.scale.time(x);
    const drag = this.#drag;
    if (!drag) {
      this.ui.hover.value = time;
      this.ui.pointed.value = within(this.#lanes.plan, y) && this.#heat ? this.#frameAt(y) : null;
      this.#top.style.cursor = this.#linkAt([x, y]) !== null || (within(this.#lanes.keys, y) && this.#keyAt(x)) ? 'grab' : 'col-resize';
    } else if (drag.kind === 'scrub') this.session.player.seek(time);
    else if (drag.kind === 'key') {
      const key = { ...drag.key, place: { kind: 'time' as const, seconds: time } };
      this.session.store.edit('Move key', [{ type: 'putKey', key }], drag.gesture);
    } else {
      drag.frame = this.#frameAt(y);
      this.ui.pointed.value = drag.frame;
      this.#drawTop();
    }
  }

  #release([, y]: Vec2, done: boolean): void {
    const drag = this.#drag;
    this.#drag = null;
    if (drag?.kind === 'link') {
      const frame = this.#frameAt(y);
      const found = this.session.source.value.find(frame);
      const moved = Math.abs(y - this.#y(this.#usedAt(drag.seconds) ?? 0)) > 5;
      if (done && found && moved) {
        const kind = this.ui.keyKind.value === 'soft' ? 'soft' : 'hard';
        const key = newKey(kind, { clip: found.part.clip.id, frame: found.frame }, { kind: 'time', seconds: drag.seconds });
        this.session.store.edit('Key from a link', [{ type: 'putKey', key }]);
        this.ui.selected.value = key.id;
      }
      this.ui.pointed.value = null;
    }
    this.#drawTop();
  }

  #keyAt(x: number): Key | null {
    let [found, least]: [Key | null, number] = [null, 10];
    for (const key of this.session.store.document.value.keys) {
      const time = timeOf(key);
      if (time === null) continue;
      const apart = Math.abs(this.scale.x(time) - x);
      if (apart < least) [found, least] = [key, apart];
    }
    return found;
  }

  /** The source frame used at that time when the pointer is on it. */
  #linkAt([x, y]: Vec2): number | null {
    if (!this.#heat || !within(this.#lanes.plan, y)) return null;
    const frame = this.#usedAt(this.scale.time(x));
    return frame !== null && Math.abs(this.#y(frame) - y) < 8 ? frame : null;
  }

  #usedAt(seconds: number): number | null {
    const used = this.session.used.value;
    if (!used || used.frames.length === 0) return null;
    return used.frames[clamp(Math.round(seconds * used.rate), 0, used.frames.length - 1)] ?? null;
  }

  #y(frame: number): number {
    const { top, height } = this.#lanes.plan;
    return top + height * (1 - frame / Math.max(this.session.source.value.frames - 1, 1));
  }

  #frameAt(y: number): number {
    const { top, height } = this.#lanes.plan;
    return Math.round(clamp(1 - (y - top) / height, 0, 1) * Math.max(this.session.source.value.frames - 1, 0));
  }

  #renderStill(): void {
    const { context, width, height } = fit(this.#still);
    const { store, player, result, source } = this.session;
    const document = store.document.value;
    this.scale.width = width;
    this.scale.seconds = player.duration.value;
    const banded = document.control !== null && document.control.kind !== 'curve' && document.control.kind !== 'motion';
    const story = document.control === null ? this.#story : null;
    this.#lanes = lanes(height, banded || story !== null);
    const view = { context, scale: this.scale, lanes: this.#lanes, theme: theme.value };
    drawRuler(view);
    drawPlan(view, this.#heat, source.value, document.keys, this.session.stale.value, story ? 'A clip of the storyboard: draw a line (1) to arrange it' : undefined);
    drawUsed(view, this.session.plan.value ? this.session.used.value : null, source.value.frames);
    if (banded) drawControl(view, document.control, this.#wave);
    if (story) drawStory(view, story);
    drawKeys(view, document.keys, this.ui.selected.value, result.value);
    drawBad(view, result.value);
    drawNames(view, document.control && banded ? document.control.kind : story ? 'storyboard' : null, source.value);
  }

  #renderTop(): void {
    const { context } = fit(this.#top);
    const { player } = this.session;
    const view = { context, scale: this.scale, lanes: this.#lanes, theme: theme.value };
    const link = this.#drag?.kind === 'link' ? this.#drag : null;
    const now = this.#usedAt(player.seconds.value);
    drawPlayhead(view, player.seconds.value, this.#heat && now !== null ? this.#y(now) : null, now, this.session.source.value.frames);
    const hovered = this.ui.hover.value;
    if (link) drawLink(view, link.seconds, this.#y(this.#usedAt(link.seconds) ?? 0), this.#y(link.frame));
    else if (hovered !== null) {
      const used = this.#usedAt(hovered);
      drawLink(view, hovered, used === null || !this.#heat ? null : this.#y(used), null);
    }
  }
}
