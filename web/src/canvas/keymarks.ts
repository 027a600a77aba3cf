import type { Key } from '../api/types';
import { css } from '../base/colour';
import type { Vec2 } from '../base/maths';
import type { Theme } from '../base/theme';
import { placeAt, type Line } from '../document/curve';
import { KEY_NAMES, newKey, timeOf } from '../document/keys';
import type { Session } from '../document/session';
import type { Ui } from '../document/ui';
import { drawMark } from './marks';
import type { Paper } from './paper';

const GRIP = 13;
/** Keys without a place wait in a row at the foot of the paper. */
const TRAY = { x: 26, y: 28, step: 30 };

/** The keys on the paper: drawn, found under the pointer, dragged. */
export class KeyMarks {
  grabbed: { id: string; gesture: string; from: Vec2; moved: boolean } | null = null;

  constructor(
    readonly session: Session,
    readonly ui: Ui,
    readonly paper: Paper,
    readonly line: () => Line,
  ) {}

  /** A new key of the chosen kind at a pixel. Exact keys snap to the time of the line there. */
  add(pose: { clip: string; frame: number }, at: Vec2): void {
    const kind = this.ui.keyKind.value;
    const drawn = this.line().count > 1;
    const time = this.#time(at);
    const place = kind === 'hard' || !drawn ? { kind: 'time' as const, seconds: time } : { kind: 'point' as const, point: this.#units(at) };
    const key = newKey(kind, pose, place);
    this.session.store.edit(`${KEY_NAMES[kind]} key`, [{ type: 'putKey', key }]);
    this.ui.selected.value = key.id;
  }

  at([x, y]: Vec2): Key | null {
    let [found, least]: [Key | null, number] = [null, GRIP];
    for (const { key, at } of this.#placed()) {
      const apart = Math.hypot(at[0] - x, at[1] - y);
      if (apart < least) [found, least] = [key, apart];
    }
    return found;
  }

  grab(key: Key | null, from: Vec2): void {
    this.ui.selected.value = key?.id ?? null;
    this.grabbed = key ? { id: key.id, gesture: `move ${key.id} ${Date.now()}`, from, moved: false } : null;
  }

  drag(at: Vec2, time: number | null): void {
    const { grabbed } = this;
    const key = this.session.store.document.value.keys.find((candidate) => candidate.id === grabbed?.id);
    if (!grabbed || !key?.place) return;
    grabbed.moved ||= Math.hypot(at[0] - grabbed.from[0], at[1] - grabbed.from[1]) > 4;
    if (!grabbed.moved) return;
    const place = key.place.kind === 'point' ? { kind: 'point' as const, point: this.#units(at) } : key.place.kind === 'time' && time !== null ? { kind: 'time' as const, seconds: time } : key.place;
    this.session.store.edit('Move key', [{ type: 'putKey', key: { ...key, place } }], grabbed.gesture);
  }

  release(): void {
    this.grabbed = null;
  }

  draw(context: CanvasRenderingContext2D, theme: Theme): void {
    const placed = this.#placed();
    for (const { key, at } of placed) {
      context.globalAlpha = key.enabled ? 1 : 0.4;
      drawMark(context, key.kind === 'fixed' ? 'hard' : key.kind, at, theme.key, theme.paper, { selected: key.id === this.ui.selected.value, accent: theme.accent });
    }
    context.globalAlpha = 1;
    const tray = placed.filter(({ key }) => key.kind === 'avoid' || key.kind === 'never').length;
    if (tray > 0) {
      context.font = '11px system-ui, sans-serif';
      context.fillStyle = css(theme.soft);
      context.textBaseline = 'middle';
      context.fillText('kept away from', TRAY.x + TRAY.step * tray - 8, this.paper.height - TRAY.y);
    }
  }

  /** Where the pose in the hand would become a key. */
  drawCarried(context: CanvasRenderingContext2D, theme: Theme, pointer: Vec2 | null): void {
    if (!this.ui.carried.value || !pointer) return;
    const kind = this.ui.keyKind.value;
    const total = this.session.player.duration.value;
    const snapped = kind === 'hard' && total > 0 ? placeAt(this.line(), this.#time(pointer) / total) : null;
    drawMark(context, kind, snapped ? this.paper.toPixels(snapped[0], snapped[1]) : pointer, theme.key, theme.paper, { size: 8 });
  }

  #placed(): { key: Key; at: Vec2 }[] {
    const total = this.session.player.duration.value;
    let free = 0;
    return this.session.store.document.value.keys.flatMap((key) => {
      if (key.kind === 'avoid' || key.kind === 'never') {
        free += 1;
        return [{ key, at: [TRAY.x + TRAY.step * (free - 1), this.paper.height - TRAY.y] as Vec2 }];
      }
      if (key.place?.kind === 'point') return [{ key, at: this.paper.toPixels(key.place.point[0], key.place.point[1]) }];
      const time = timeOf(key);
      const on = time !== null && total > 0 ? placeAt(this.line(), time / total) : null;
      return on ? [{ key, at: this.paper.toPixels(on[0], on[1]) }] : [];
    });
  }

  #units(at: Vec2): [number, number] {
    const [x, y] = this.paper.toUnits(at[0], at[1]);
    return [Number(x.toFixed(4)), Number(y.toFixed(4))];
  }

  #time(at: Vec2): number {
    const { player } = this.session;
    const line = this.line();
    if (line.count < 2) return player.seconds.value;
    let [best, least] = [0, Infinity];
    for (let i = 0; i < line.count; i += 1) {
      const [x, y] = this.paper.toPixels(line.points[2 * i] ?? 0, line.points[2 * i + 1] ?? 0);
      const apart = Math.hypot(x - at[0], y - at[1]);
      if (apart < least) [best, least] = [line.parts[i] ?? 0, apart];
    }
    return best * player.duration.value;
  }
}
