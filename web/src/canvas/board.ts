import type { LivePoint } from '../api/live';
import { fit, onResize, painter, wantsCalm } from '../base/dom';
import type { Vec2 } from '../base/maths';
import { theme } from '../base/theme';
import { boundsOf, boundsOfPlaces, lineOf, nearestPart, NO_LINE, type Line } from '../document/curve';
import type { Session } from '../document/session';
import type { Ui } from '../document/ui';
import { KeyMarks } from './keymarks';
import { drawDoubt, drawDot, drawLine, drawMap, drawPaper, drawRing, drawStart, type MapPaths } from './layers';
import { Navigate } from './navigate';
import { Paper } from './paper';
import { listenToPen, type PenSample } from './pen';

/** How near to a line, in CSS pixels, is on it. */
const NEAR = 16;
/** Width of the tools at the left edge, CSS pixels. */
const RAIL = 56;

/** The paper that is drawn on: the line, the keys on it, the dot that runs along. */
export class Board {
  readonly paper = new Paper();
  readonly marks: KeyMarks;
  readonly #ink: HTMLCanvasElement;
  readonly #top: HTMLCanvasElement;
  readonly #drawInk: () => void;
  readonly #drawTop: () => void;
  #line: Line = NO_LINE;
  #stroke: { number: number; messages: number; points: LivePoint[]; unsent: LivePoint[] } | null = null;
  #pointer: Vec2 | null = null;
  #fitted = false;
  #grows = false;

  constructor(
    readonly session: Session,
    readonly ui: Ui,
    ink: HTMLCanvasElement,
    top: HTMLCanvasElement,
  ) {
    this.#ink = ink;
    this.#top = top;
    this.#drawInk = painter(() => this.#renderInk(), ink);
    this.#drawTop = painter(() => this.#renderTop(), top);
    this.marks = new KeyMarks(session, ui, this.paper, () => this.#line);
    new Navigate(top, this.paper, ui, () => this.redraw());
    listenToPen(top, { begin: (sample, event) => this.#begin(sample, event), move: (samples, at) => this.#move(samples, at), end: (cancelled) => this.#end(cancelled) });
    top.addEventListener('pointermove', (event) => this.#hover(event));
    top.addEventListener('pointerleave', () => this.#leave());
    onResize(top, () => this.#resize());
    const relined = () => {
      this.#line = lineOf(session.drawing.value ?? session.store.document.value.control);
      this.redraw();
    };
    session.store.document.watch(relined);
    session.drawing.subscribe(relined);
    // While a line is drawn the character does what the newest end of it asks for.
    session.motion.subscribe(() => {
      if (this.#stroke && this.#grows) session.player.seek(session.player.duration.value);
    });
    for (const signal of [session.result, theme, ui.selected, ui.tool, ui.carried]) signal.subscribe(() => this.redraw());
    // A new stroke is on the upper sheet: what is under it stays as it is.
    session.used.subscribe(() => (this.#stroke && ui.tool.value === 'draw' ? this.#drawTop() : this.redraw()));
    ui.underlay.subscribe(() => this.frame());
    for (const signal of [session.player.seconds, ui.hover]) signal.subscribe(() => this.#drawTop());
  }

  get line(): Line {
    return this.#line;
  }

  redraw(): void {
    this.#drawInk();
    this.#drawTop();
  }

  /** Shows the whole drawing, or the map under it. */
  frame(): void {
    const map = this.ui.underlay.value ? (this.session.suggestions.value?.map.frames ?? []) : [];
    const box = map.length > 1 ? boundsOfPlaces(map) : boundsOf(this.#line);
    if (box) this.paper.show(box.low, box.high, RAIL);
    else [this.paper.zoom, this.paper.pan] = [1, [0, 0]];
    this.redraw();
  }

  /** Places a key of the chosen kind where a pose was dropped, in page coordinates; whether it was dropped here. */
  drop(pose: { clip: string; frame: number }, clientX: number, clientY: number): boolean {
    const box = this.#top.getBoundingClientRect();
    const [x, y] = [clientX - box.left, clientY - box.top];
    if (x < 0 || y < 0 || x > box.width || y > box.height) return false;
    this.marks.add(pose, [x, y]);
    return true;
  }

  /** The time of the line under a pixel; null when the line is not near. */
  timeUnder([x, y]: Vec2, near = NEAR): number | null {
    const total = this.session.player.duration.value;
    const now = total > 0 ? this.session.player.seconds.value / total : 0;
    const hit = nearestPart(this.#line, this.paper.toUnits(x, y), now, 1 / this.paper.zoom);
    return hit && hit.apart * this.paper.scale <= near ? hit.part * total : null;
  }

  #resize(): void {
    this.paper.width = Math.max(this.#top.clientWidth, 1);
    this.paper.height = Math.max(this.#top.clientHeight, 1);
    if (!this.#fitted && this.#line.count > 0) {
      this.#fitted = true;
      this.frame();
    }
    this.#renderInk();
    this.#renderTop();
  }

  #begin(sample: PenSample, event: PointerEvent): boolean {
    const { tool } = this.ui;
    if (tool.value === 'hand' || event.altKey) return false;
    const mark = this.marks.at([sample.x, sample.y]);
    if (mark || tool.value === 'select') {
      this.marks.grab(mark, [sample.x, sample.y]);
      if (!mark) this.#scrub([sample.x, sample.y]);
      return true;
    }
    if (!this.session.connected.value) {
      this.ui.said.value = 'The studio is not connected; drawing waits for it.';
      return false;
    }
    const line = this.#line.count > 0;
    const mode = tool.value === 'redraw' && line ? 'redraw' : tool.value === 'add' && line ? 'add' : 'draw';
    const control = this.session.store.document.value.control;
    const timing = control?.kind === 'curve' ? control.timing : 'pen';
    const first = this.#point(sample);
    this.#stroke = { number: this.session.live.begin(mode, timing), messages: 0, points: [first], unsent: [first] };
    this.#fitted = true;
    this.#grows = mode !== 'redraw';
    this.session.player.pause();
    this.session.drawing.value = mode === 'draw' ? { kind: 'curve', strokes: [[]], timing, smooth: null } : this.session.drawing.value ?? control;
    this.#send(event.timeStamp);
    return true;
  }

  #move(samples: readonly PenSample[], at: number): void {
    if (this.marks.grabbed) {
      const last = samples.at(-1);
      if (last) this.marks.drag([last.x, last.y], this.timeUnder([last.x, last.y], Infinity));
      return;
    }
    if (!this.#stroke) {
      const last = samples.at(-1);
      if (last && this.ui.tool.value === 'select') this.#scrub([last.x, last.y]);
      return;
    }
    for (const sample of samples) {
      const point = this.#point(sample);
      this.#stroke.points.push(point);
      this.#stroke.unsent.push(point);
    }
    this.#send(at);
    this.#drawTop();
  }

  #end(cancelled: boolean): void {
    this.marks.release();
    const stroke = this.#stroke;
    if (!stroke) return;
    if (cancelled || stroke.points.length < 2) {
      this.session.live.cancel(stroke.number);
      this.session.abandon();
    } else {
      this.#send(performance.now());
      this.session.live.end(stroke.number);
      const control = this.session.drawing.value;
      // Until the server's own line is there, the stroke as it was drawn.
      if (control?.kind === 'curve' && control.strokes.every((points) => points.length === 0)) {
        this.session.drawing.value = { ...control, strokes: [stroke.points.map(([x, y, t, p]) => [x, y, t ?? 0, p ?? 0.5])] };
      }
      if (!wantsCalm()) {
        if (this.#grows) this.session.player.seek(0);
        this.session.player.play();
      }
    }
    this.#stroke = null;
    this.redraw();
  }

  /** Says what the pen drew until `at`. Browsers call once a picture, however many points a pen gives. */
  #send(at: number): void {
    const stroke = this.#stroke;
    if (!stroke || stroke.unsent.length === 0) return;
    stroke.messages += 1;
    this.session.live.points(stroke.number, stroke.unsent);
    this.session.sent(stroke.number, stroke.messages, at);
    stroke.unsent = [];
  }

  #point({ x, y, t, p }: PenSample): LivePoint {
    const [ux, uy] = this.paper.toUnits(x, y);
    return [Number(ux.toFixed(5)), Number(uy.toFixed(5)), Number(t.toFixed(4)), Number(p.toFixed(3))];
  }

  #scrub(at: Vec2): void {
    const time = this.timeUnder(at, 3 * NEAR);
    if (time === null) return;
    this.session.player.pause();
    this.session.player.seek(time);
  }

  #hover(event: PointerEvent): void {
    const box = this.#top.getBoundingClientRect();
    this.#pointer = [event.clientX - box.left, event.clientY - box.top];
    if (!this.#stroke) this.ui.hover.value = this.timeUnder(this.#pointer);
    this.#drawTop();
  }

  #leave(): void {
    this.#pointer = null;
    this.ui.hover.value = null;
    this.#drawTop();
  }

  #mapPaths(): MapPaths {
    const { source, suggestions } = this.session;
    const frames = suggestions.value?.map.frames ?? [];
    return frames.flatMap((place, i) => {
      const next = frames[i + 1];
      if (!next || next.clip !== place.clip || next.frame < place.frame || next.frame - place.frame > 60) return [];
      const part = (source.value.count(place.clip, place.frame) ?? 0) / Math.max(source.value.frames - 1, 1);
      return [{ from: [place.x, place.y] as const, to: [next.x, next.y] as const, part }];
    });
  }

  #renderInk(): void {
    const { context } = fit(this.#ink);
    const now = theme.value;
    drawPaper(context, this.paper, now);
    if (this.ui.underlay.value) drawMap(context, this.paper, this.#mapPaths(), now);
    const { used, source, result } = this.session;
    const colours = { used: used.value, frames: source.value.frames, theme: now };
    const replaced = this.#stroke !== null && this.ui.tool.value === 'draw';
    if (!replaced) {
      if (result.value && used.value?.confidence) drawDoubt(context, this.paper, this.#line, colours);
      drawLine(context, this.paper, this.#line, colours);
      drawStart(context, this.paper, this.#line, now);
    }
    this.marks.draw(context, now);
  }

  #renderTop(): void {
    const { context } = fit(this.#top);
    const now = theme.value;
    const { player, used, source } = this.session;
    const total = player.duration.value;
    if (this.#stroke) {
      const fresh = lineOf({ kind: 'curve', strokes: [this.#stroke.points.map(([x, y, t, p]) => [x, y, t ?? 0, p ?? 0.5])], timing: 'pen', smooth: null });
      const follows = this.ui.tool.value === 'draw' ? used.value : null;
      drawLine(context, this.paper, fresh, { used: follows, frames: source.value.frames, theme: now });
      return;
    }
    if (this.#line.count > 1 && total > 0) {
      if (this.ui.hover.value !== null) drawRing(context, this.paper, this.#line, this.ui.hover.value / total, now);
      drawDot(context, this.paper, this.#line, player.seconds.value / total, { used: used.value, frames: source.value.frames, theme: now });
    }
    this.marks.drawCarried(context, now, this.#pointer);
  }
}
