import { css, rampAt } from '../base/colour';
import { fit, h, onResize, painter } from '../base/dom';
import type { Vec2 } from '../base/maths';
import { theme } from '../base/theme';
import type { Session } from '../document/session';
import type { Ui } from '../document/ui';
import type { Carry } from './carry';
import { newKey } from '../document/keys';
import { button, section, Switch } from './controls';

/** The clip laid out so that what is alike is near: poses to look at and to drag, and a line that is drawn over it. */
export function mapPanel(session: Session, ui: Ui, carry: Carry): HTMLElement {
  const canvas = h('canvas', { role: 'img', 'aria-label': 'Map of the clip: moments that are alike lie near each other' });
  const note = h('p', { class: 'help' });
  const view = new MapView(session, ui, canvas);
  const draw = painter(() => {
    view.draw();
    const stress = session.suggestions.value?.map.stress;
    note.textContent = stress === undefined ? '' : `Near is alike; the map bends distances by ${(100 * stress).toFixed(0)} %.`;
  }, canvas);
  for (const signal of [session.suggestions, session.used, session.player.seconds, theme, ui.pointed, session.store.document]) signal.subscribe(draw);
  onResize(canvas, draw);
  canvas.addEventListener('pointermove', (event) => (ui.pointed.value = view.frameAt(event)));
  canvas.addEventListener('pointerleave', () => (ui.pointed.value = null));
  carry.from(canvas, (event) => {
    const frame = view.frameAt(event);
    const found = frame === null ? null : session.source.value.find(frame);
    return found ? { clip: found.part.clip.id, frame: found.frame } : null;
  });
  const under = new Switch('Lay it under the drawing', (on) => (ui.underlay.value = on));
  ui.underlay.watch((on) => (under.value = on));
  const hold = button('Hold the drawing to it', () => holdToMap(session), 'quiet wide');
  hold.title = 'The suggested poses become soft keys where they lie on the map';
  return h(
    'div',
    {},
    section('Map of the clip', h('div', { class: 'map' }, canvas), note),
    h('p', { class: 'help' }, 'Point at the map to see the pose in red. Drag from it to the drawing or the timeline to make a key of it.'),
    h('div', { style: 'margin-top:10px' }, under.element, hold),
  );
}

/** As soft keys of weight 3 at their places on the map, so that a line drawn over it passes those poses. */
function holdToMap(session: Session): void {
  const { candidates } = session.suggestions.value ?? { candidates: [] };
  const others = session.store.document.value.keys.filter((key) => !key.id.startsWith('map'));
  const keys = candidates.map(({ clip, frame, x, y }, i) => ({ ...newKey('soft', { clip, frame }, { kind: 'point', point: [x, y] }), id: `map${i}`, weight: 3 }));
  session.store.edit('Hold the drawing to the map', [{ type: 'setKeys', keys: [...others, ...keys] }]);
}

class MapView {
  #places: { frame: number; at: Vec2 }[] = [];

  constructor(
    readonly session: Session,
    readonly ui: Ui,
    readonly canvas: HTMLCanvasElement,
  ) {}

  frameAt(event: PointerEvent): number | null {
    const box = this.canvas.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    let [found, least]: [number | null, number] = [null, 24];
    for (const { frame, at } of this.#places) {
      const apart = Math.hypot(at[0] - x, at[1] - y);
      if (apart < least) [found, least] = [frame, apart];
    }
    return found;
  }

  draw(): void {
    const { context, width, height } = fit(this.canvas);
    const { suggestions, source, used, player } = this.session;
    const map = suggestions.value?.map;
    const now = theme.value;
    if (!map || map.frames.length < 2) {
      this.#places = [];
      return;
    }
    this.#places = this.#layOut(map.frames, width, height);
    const total = Math.max(source.value.frames - 1, 1);
    context.lineWidth = 1.6;
    context.lineCap = 'round';
    this.#places.forEach(({ frame, at }, i) => {
      const next = this.#places[i + 1];
      if (!next || next.frame - frame > 60 || next.frame < frame) return;
      context.beginPath();
      context.moveTo(...at);
      context.lineTo(...next.at);
      context.strokeStyle = css(rampAt(now.ramp, frame / total), 0.75);
      context.stroke();
    });
    suggestions.value?.candidates.forEach((candidate, i) => {
      const at = this.#near(source.value.count(candidate.clip, candidate.frame) ?? 0);
      if (at) this.#label(context, at, String(i + 1), css(rampAt(now.ramp, (source.value.count(candidate.clip, candidate.frame) ?? 0) / total)));
    });
    for (const key of this.session.store.document.value.keys) {
      const at = key.pose ? this.#near(source.value.count(key.pose.clip, key.pose.frame) ?? -1) : null;
      if (at) this.#ring(context, at, 10, css(now.key));
    }
    const index = used.value ? Math.round(player.seconds.value * used.value.rate) : -1;
    const playing = used.value?.frames[Math.min(Math.max(index, 0), used.value.frames.length - 1)];
    const at = playing === undefined ? null : this.#near(playing);
    if (at) {
      this.#ring(context, at, 5, css(now.ink));
    }
    const pointed = this.ui.pointed.value === null ? null : this.#near(this.ui.pointed.value);
    if (pointed) this.#ring(context, pointed, 7, css(now.key));
  }

  #layOut(frames: readonly { clip: string; frame: number; x: number; y: number }[], width: number, height: number): { frame: number; at: Vec2 }[] {
    const xs = frames.map(({ x }) => x);
    const ys = frames.map(({ y }) => y);
    const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    const scale = Math.min((width - 44) / Math.max(x1 - x0, 1e-6), (height - 44) / Math.max(y1 - y0, 1e-6));
    return frames.map(({ clip, frame, x, y }) => ({
      frame: this.session.source.value.count(clip, frame) ?? frame,
      at: [width / 2 + scale * (x - (x0 + x1) / 2), height / 2 - scale * (y - (y0 + y1) / 2)] as const,
    }));
  }

  #near(frame: number): Vec2 | null {
    let [found, least]: [Vec2 | null, number] = [null, 40];
    for (const place of this.#places) {
      const apart = Math.abs(place.frame - frame);
      if (apart < least) [found, least] = [place.at, apart];
    }
    return found;
  }

  #label(context: CanvasRenderingContext2D, [x, y]: Vec2, text: string, style: string): void {
    context.beginPath();
    context.arc(x, y, 8, 0, 2 * Math.PI);
    context.fillStyle = style;
    context.fill();
    context.font = '600 10px Arial, sans-serif';
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    context.fillStyle = theme.value.dark ? '#101113' : '#ffffff';
    context.fillText(text, x, y + 0.5);
  }

  #ring(context: CanvasRenderingContext2D, [x, y]: Vec2, radius: number, style: string): void {
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    context.lineWidth = 2;
    context.strokeStyle = style;
    context.stroke();
  }
}
