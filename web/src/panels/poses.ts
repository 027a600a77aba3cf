import type { Key } from '../api/types';
import { css, rampAt } from '../base/colour';
import { h, onResize, painter } from '../base/dom';
import { theme } from '../base/theme';
import { KEY_HELP, KEY_KINDS, KEY_NAMES, newKey, timeOf } from '../document/keys';
import type { Session } from '../document/session';
import type { Ui } from '../document/ui';
import { paintPose, type Carry } from './carry';
import { button, row, section, Segments, Slider, tool } from './controls';
import { markSign } from './marksign';

/** Poses to ask for or to keep away from, and the keys that there are. */
export function posesPanel(session: Session, ui: Ui, carry: Carry): HTMLElement {
  const kinds = new Segments(
    'Kind of the next key',
    KEY_KINDS.map((kind) => ({ value: kind, text: KEY_NAMES[kind], title: KEY_HELP[kind] })),
    (kind) => (ui.keyKind.value = kind),
    true,
  );
  const help = h('p', { class: 'help' });
  ui.keyKind.watch((kind) => {
    kinds.value = kind;
    help.textContent = KEY_HELP[kind];
  });
  const grid = h('div', { class: 'poses' });
  const keys = h('div', {});
  const drawPoses = painter(() => suggest(grid, session, ui, carry));
  let shown = 0;
  // Pictures that were asked for while the panel was hidden.
  onResize(help, () => {
    if (help.offsetWidth > 0 && shown === 0) [drawPoses, drawKeys].forEach((draw) => draw());
    shown = help.offsetWidth;
  });
  session.suggestions.subscribe(drawPoses);
  session.source.subscribe(drawPoses);
  theme.subscribe(drawPoses);
  drawPoses();
  const drawKeys = painter(() => list(keys, session, ui));
  for (const signal of [session.store.document, session.result, session.source, ui.selected, theme]) signal.subscribe(drawKeys);
  drawKeys();
  return h(
    'div',
    {},
    section('Key poses', kinds.element, help),
    section('Suggested', grid, h('p', { class: 'help' }, 'Drag one onto the drawing or the timeline. The percentage is how much of the clip is like it.'), here(session, ui)),
    keys,
  );
}

/** A key of what the character does now: the pose used at the playhead. */
function here(session: Session, ui: Ui): HTMLElement {
  return h(
    'div',
    { style: 'margin-top:8px' },
    button('Key the pose at the playhead', () => keyHere(session, ui), 'quiet wide'),
  );
}

export function keyHere(session: Session, ui: Ui): void {
  const { player, used, source } = session;
  const index = used.value ? Math.round(player.seconds.value * used.value.rate) : 0;
  const frame = used.value ? (used.value.frames[Math.min(index, used.value.frames.length - 1)] ?? 0) : Math.round(player.seconds.value * player.rate);
  const found = source.value.find(frame);
  if (!found) return;
  const key = newKey(ui.keyKind.value, { clip: found.part.clip.id, frame: found.frame }, { kind: 'time', seconds: player.seconds.value });
  session.store.edit(`${KEY_NAMES[key.kind]} key`, [{ type: 'putKey', key }]);
  ui.selected.value = key.id;
}

function suggest(grid: HTMLElement, session: Session, ui: Ui, carry: Carry): void {
  const candidates = session.suggestions.value?.candidates ?? [];
  const { source } = session;
  if (session.suggestions.value === null && source.value.frames > 0) {
    grid.replaceChildren(...Array.from({ length: 8 }, () => h('div', { class: 'pose empty', 'aria-hidden': 'true' })));
    return;
  }
  grid.replaceChildren(
    ...candidates.map((candidate, i) => {
      const canvas = h('canvas');
      const global = source.value.count(candidate.clip, candidate.frame) ?? 0;
      const dot = h('i', { style: `background:${css(rampAt(theme.value.ramp, global / Math.max(source.value.frames - 1, 1)))}` });
      const label = `Pose ${i + 1}, at ${candidate.seconds.toFixed(1)} seconds of the clip, like ${Math.round(100 * candidate.share)} percent of it`;
      const thumb = h('button', { type: 'button', class: 'pose', 'aria-label': `${label}. Enter makes it a key.`, title: label }, dot, canvas, h('span', { class: 'soft' }, `${Math.round(100 * candidate.share)} %`));
      thumb.addEventListener('pointerenter', () => (ui.pointed.value = global));
      thumb.addEventListener('pointerleave', () => (ui.pointed.value = null));
      thumb.addEventListener('focus', () => (ui.pointed.value = global));
      thumb.addEventListener('blur', () => (ui.pointed.value = null));
      thumb.addEventListener('keydown', (event) => {
        if (event.key !== 'Enter' && event.key !== ' ') return;
        event.preventDefault();
        const key = newKey(ui.keyKind.value, candidate, { kind: 'time', seconds: session.player.seconds.value });
        session.store.edit(`${KEY_NAMES[key.kind]} key`, [{ type: 'putKey', key: { ...key, pose: { clip: candidate.clip, frame: candidate.frame } } }]);
        ui.selected.value = key.id;
      });
      carry.from(thumb, () => ({ clip: candidate.clip, frame: candidate.frame }));
      requestAnimationFrame(() => paintPose(session, canvas, candidate));
      return thumb;
    }),
  );
}

function list(place: HTMLElement, session: Session, ui: Ui): void {
  const { keys } = session.store.document.value;
  const focused = document.activeElement instanceof HTMLElement && place.contains(document.activeElement);
  // A slider that is being dragged stays where it is.
  if (focused && document.activeElement instanceof HTMLInputElement && document.activeElement.type === 'range' && place.childElementCount > 0) return;
  if (keys.length === 0) {
    place.replaceChildren();
    return;
  }
  const items = keys.map((key) => item(key, session, ui));
  const clear = tool('clear', 'Remove all keys', () => session.store.edit('Remove all keys', [{ type: 'setKeys', keys: [] }]));
  clear.classList.add('small');
  const whole = section('', h('div', { class: 'list' }, ...items));
  whole.querySelector('h2')?.replaceChildren(`Keys (${keys.length})`, clear);
  place.replaceChildren(whole);
}

function item(key: Key, session: Session, ui: Ui): HTMLElement {
  const canvas = h('canvas', { class: 'thumb' });
  const chosen = ui.selected.value === key.id;
  const met = session.result.value?.keys.find((rowOf) => rowOf.id === key.id);
  const text = h('button', { type: 'button', style: 'flex:1;justify-content:flex-start;padding:0 4px;height:34px', 'aria-expanded': String(chosen), onclick: () => (ui.selected.value = chosen ? null : key.id) }, markSign(key.kind), describe(key), met ? h('span', { class: `soft ${met.met}` }, met.waits ? ' waits' : ` ${MET[met.met] ?? ''}`) : null);
  const off = h('input', { type: 'checkbox', 'aria-label': 'In use', title: 'In use' });
  off.checked = key.enabled;
  off.addEventListener('change', () => session.store.edit(off.checked ? 'Use key' : 'Leave key out', [{ type: 'putKey', key: { ...key, enabled: off.checked } }]));
  const gone = tool('close', `Remove ${describe(key)}`, () => session.store.edit('Remove key', [{ type: 'removeKey', id: key.id }]));
  gone.classList.add('small');
  if (key.pose) requestAnimationFrame(() => key.pose && paintPose(session, canvas, key.pose, true));
  const line = h('div', { class: chosen ? 'row chosen' : 'row' }, canvas, text, off, gone);
  if (met?.waits) text.title = `Waits: ${met.waits}`;
  return chosen ? h('div', {}, line, met?.waits ? h('p', { class: 'note warn' }, `It waits: ${met.waits}.`) : null, details(key, session)) : line;
}

const MET: Readonly<Record<string, string>> = { good: '', fair: 'nearly met', poor: 'not met' };

function describe(key: Key): string {
  const time = timeOf(key);
  const where = time !== null ? ` ${time.toFixed(2)} s` : key.place?.kind === 'label' ? ` ${key.place.label}` : '';
  return `${KEY_NAMES[key.kind]}${where}`;
}

function details(key: Key, session: Session): HTMLElement {
  const gesture = `strength ${key.id} ${Date.now()}`;
  const put = (change: Partial<Key>, label: string, drag: string | null = gesture) => session.store.edit(label, [{ type: 'putKey', key: { ...key, ...change } }], drag);
  const rows: HTMLElement[] = [];
  if (key.weight !== null) rows.push(slider('Weight', key.weight, 0.05, 3, (weight) => put({ weight }, 'Weight of a key')));
  if (key.distance !== null) rows.push(slider('Distance', key.distance, 0.1, 2, (distance) => put({ distance }, 'Distance of a key')));
  if (key.radius !== null) rows.push(slider('Radius', key.radius, 0.05, 1, (radius) => put({ radius }, 'Radius of a key')));
  const pose = key.pose;
  if (pose) {
    const frame = h('input', { type: 'number', min: 0, step: 1, value: pose.frame });
    frame.addEventListener('change', () => put({ pose: { ...pose, frame: Math.max(0, Math.round(Number(frame.value) || 0)) } }, 'Pose of a key', null));
    rows.push(row('Clip frame', frame));
  }
  if (key.kind !== 'fixed') {
    const kind = h('select', {}, ...KEY_KINDS.map((name) => h('option', { value: name }, KEY_NAMES[name])));
    kind.value = key.kind;
    kind.addEventListener('change', () => {
      const made = newKey(kind.value as (typeof KEY_KINDS)[number], key.pose ?? { clip: '', frame: 0 }, key.place?.kind === 'point' && kind.value === 'hard' ? { kind: 'time', seconds: session.player.seconds.value } : key.place ?? { kind: 'time', seconds: session.player.seconds.value });
      put({ ...made, id: key.id }, 'Kind of a key', null);
    });
    rows.push(row('Kind', kind));
  }
  return h('div', { style: 'padding:2px 6px 8px 48px' }, ...rows);
}

function slider(label: string, value: number, low: number, high: number, changed: (value: number) => void): HTMLElement {
  const shown = h('span', { style: 'width:34px;text-align:right' }, value.toFixed(2));
  const made = new Slider(label, { low, high, step: 0.05 }, (now) => {
    shown.textContent = now.toFixed(2);
    changed(now);
  });
  made.value = value;
  return h('div', { class: 'row' }, h('span', { style: 'width:56px' }, label), made.element, shown);
}
