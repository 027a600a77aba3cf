import type { LivePoint } from '../api/live';
import { post, Refused } from '../api/http';
import type { Control, WaveSeen } from '../api/types';
import { css, rampAt } from '../base/colour';
import { fit, h, onResize, painter } from '../base/dom';
import { clamp, ticks } from '../base/maths';
import { theme } from '../base/theme';
import type { Controls } from '../document/controls';
import type { Session } from '../document/session';
import type { Ui } from '../document/ui';
import { listenToPen, type PenSample } from './pen';

const EXAMPLES = ['sine(0.5Hz..2Hz) for 10s', 'saw(1Hz) for 8s', 'square(0.5Hz) for 8s', 'sine(1Hz) + 0.5*sine(3Hz) for 10s'];
const EDGE = { left: 66, right: 24, top: 40, bottom: 92 };

/** A value over time: drawn with the pen, or an expression. */
export class WaveBoard {
  readonly element: HTMLElement;
  readonly values: { onchange: (values: readonly number[]) => void } = { onchange: () => undefined };
  readonly #canvas = h('canvas', { tabindex: 0, role: 'img', 'aria-label': 'Wave: draw a value over time here' });
  readonly #input = h('input', { type: 'text', class: 'mono', style: 'flex:1', 'aria-label': 'Expression of the wave', spellcheck: 'false', list: 'waves' });
  readonly #error = h('span', { class: 'soft', role: 'status' });
  readonly #draw: () => void;
  #points: readonly (readonly [number, number])[] = [];
  #seconds = 10;
  #stroke: { number: number; messages: number; unsent: LivePoint[]; seconds: number } | null = null;
  #asked = '';

  constructor(
    readonly session: Session,
    readonly ui: Ui,
    readonly controls: Controls,
  ) {
    const list = h('datalist', { id: 'waves' }, ...EXAMPLES.map((value) => h('option', { value })));
    const foot = h('div', { class: 'editor-foot' }, h('span', { class: 'soft' }, 'Expression'), this.#input, this.#error, list);
    this.element = h('div', { class: 'board editor' }, this.#canvas, foot);
    this.#draw = painter(() => this.#render(), this.#canvas);
    onResize(this.#canvas, this.#draw);
    for (const signal of [theme, session.used, session.player.seconds]) signal.subscribe(this.#draw);
    session.store.document.watch(({ control }) => void this.#take(control));
    session.drawing.subscribe((control) => control?.kind === 'drawnWave' && this.#set(control.points));
    this.#input.addEventListener('change', () => controls.set({ kind: 'wave', expression: this.#input.value }, 'Expression'));
    listenToPen(this.#canvas, { begin: (sample, event) => this.#begin(sample, event.timeStamp), move: (samples, at) => this.#move(samples, at), end: (cancelled) => this.#end(cancelled) });
  }

  async #take(control: Control | null): Promise<void> {
    if (control?.kind === 'drawnWave') this.#set(control.points);
    if (control?.kind !== 'wave' || control.expression === this.#asked) return;
    this.#asked = control.expression;
    if (document.activeElement !== this.#input) this.#input.value = control.expression;
    try {
      const { values, rate } = await post<WaveSeen>('waves', { expression: control.expression, seconds: 10 });
      this.#error.textContent = '';
      this.#set(values.map((value, i) => [i / rate, value]));
    } catch (error) {
      this.#error.textContent = error instanceof Refused ? error.message : String(error);
    }
  }

  #set(points: readonly (readonly [number, number])[]): void {
    this.#points = points;
    this.#seconds = Math.max(points.at(-1)?.[0] ?? 10, 1);
    const { low, high } = this.#range();
    const step = Math.max(1, Math.floor(points.length / 600));
    this.values.onchange(points.filter((_, i) => i % step === 0).map(([, value]) => (value - low) / (high - low)));
    this.#draw();
  }

  #range(): { low: number; high: number } {
    const values = this.#points.map(([, value]) => value);
    return { low: Math.min(-1, ...values), high: Math.max(1, ...values) };
  }

  #begin(sample: PenSample, at: number): boolean {
    if (!this.session.connected.value) return false;
    const first = this.#point(sample);
    this.session.player.pause();
    this.#stroke = { number: this.session.live.begin('wave'), messages: 0, unsent: [first], seconds: this.#seconds };
    this.#send(at);
    return true;
  }

  #move(samples: readonly PenSample[], at: number): void {
    for (const sample of samples) {
      const point = this.#point(sample);
      this.#stroke?.unsent.push(point);
      this.#over(point);
    }
    this.#send(at);
    this.#draw();
  }

  #end(cancelled: boolean): void {
    const stroke = this.#stroke;
    if (!stroke) return;
    this.#send(performance.now());
    this.#stroke = null;
    if (cancelled) this.session.live.cancel(stroke.number);
    else this.session.live.end(stroke.number);
  }

  #send(at: number): void {
    const stroke = this.#stroke;
    if (!stroke || stroke.unsent.length === 0) return;
    stroke.messages += 1;
    this.session.live.points(stroke.number, stroke.unsent);
    this.session.sent(stroke.number, stroke.messages, at);
    stroke.unsent = [];
  }

  /** What the pen does is seen at once: values between the last point and this one are replaced. */
  #over(point: LivePoint): void {
    const [t, v] = point;
    const near = 0.6 / 60;
    const kept = this.#points.filter(([time]) => Math.abs(time - t) > near);
    const at = kept.findIndex(([time]) => time > t);
    this.#points = at < 0 ? [...kept, [t, v]] : [...kept.slice(0, at), [t, v], ...kept.slice(at)];
  }

  #point({ x, y }: PenSample): LivePoint {
    const { width, height } = this.#inner();
    const t = clamp((x - EDGE.left) / width, 0, 1) * this.#seconds;
    return [Number(t.toFixed(4)), Number((1 - 2 * clamp((y - EDGE.top) / height, 0, 1)).toFixed(4))];
  }

  #inner(): { width: number; height: number } {
    return { width: Math.max(this.#canvas.clientWidth - EDGE.left - EDGE.right, 1), height: Math.max(this.#canvas.clientHeight - EDGE.top - EDGE.bottom, 1) };
  }

  #render(): void {
    const { context } = fit(this.#canvas);
    const { width, height } = this.#inner();
    const now = theme.value;
    const { low, high } = this.#range();
    const x = (t: number) => EDGE.left + (t / this.#seconds) * width;
    const y = (v: number) => EDGE.top + (1 - (v - low) / (high - low)) * height;
    context.font = '11px Arial, sans-serif';
    context.textBaseline = 'middle';
    for (const value of [low, 0, high]) {
      context.strokeStyle = css(now.line);
      context.beginPath();
      context.moveTo(EDGE.left, Math.round(y(value)) + 0.5);
      context.lineTo(EDGE.left + width, Math.round(y(value)) + 0.5);
      context.stroke();
      context.fillStyle = css(now.soft);
      context.textAlign = 'right';
      context.fillText(value.toFixed(value === 0 ? 0 : 1), EDGE.left - 8, y(value));
    }
    context.textAlign = 'center';
    for (const tick of ticks(this.#seconds, width / 80)) context.fillText(`${tick} s`, x(tick), EDGE.top + height + 18);
    const { used, source, player } = this.session;
    const frames = used.value?.frames;
    context.lineWidth = 2.6;
    context.lineJoin = context.lineCap = 'round';
    for (let i = 0; i + 1 < this.#points.length; i += 1) {
      const [a, b] = [this.#points[i], this.#points[i + 1]];
      if (!a || !b) continue;
      const frame = frames?.[Math.min(Math.round((a[0] / this.#seconds) * (frames.length - 1)), frames.length - 1)];
      context.strokeStyle = css(frame === undefined ? now.ink : rampAt(now.ramp, frame / Math.max(source.value.frames - 1, 1)));
      context.beginPath();
      context.moveTo(x(a[0]), y(a[1]));
      context.lineTo(x(b[0]), y(b[1]));
      context.stroke();
    }
    const part = player.duration.value > 0 ? player.seconds.value / player.duration.value : 0;
    const at = this.#points[Math.round(part * (this.#points.length - 1))];
    if (!at) return;
    context.beginPath();
    context.arc(x(at[0]), y(at[1]), 6.5, 0, 2 * Math.PI);
    context.fillStyle = css(now.ink);
    context.fill();
    context.lineWidth = 2;
    context.strokeStyle = css(now.paper);
    context.stroke();
  }
}
