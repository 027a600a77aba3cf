import { h } from '../base/dom';
import { openDialog } from './dialog';

const KEYS: readonly (readonly [string, string])[] = [
  ['Space', 'Play, pause'],
  ['D', 'Draw a new line'],
  [', .', 'A frame back, on'],
  ['R', 'Redraw a stretch'],
  ['Home End', 'Start, end'],
  ['A', 'One more stroke'],
  ['L', 'Loop the playback'],
  ['V', 'Move keys, scrub'],
  ['K', 'Key the pose here'],
  ['H', 'Move the paper'],
  ['Delete', 'Remove the key'],
  ['F', 'Show the whole drawing'],
  ['Ctrl Z', 'Undo'],
  ['Shift F', 'Put the camera back'],
  ['Ctrl Shift Z', 'Redo'],
  ['C G O T P B', 'What the view shows'],
  ['Ctrl E', 'Export'],
  ['1 … 6', 'What steers'],
  ['Ctrl O', 'Open a file'],
  ['Shift D', 'Light or dark'],
  ['Tab', 'Next control'],
  ['\\', 'Panels'],
  ['?', 'This list'],
  ['Esc', 'Let go'],
];

/** Where the storyboard is drawn. */
const BOARD_KEYS: readonly (readonly [string, string])[] = [
  ['D R Q S', 'Pens: figure, way, speed, scene'],
  ['V E', 'Move joints, erase'],
  ['[ ]', 'The frame before, after'],
  ['{ }', 'Move the frame back, on'],
  ['N', 'Add a frame'],
  ['Shift N', 'Copy the frame'],
  ['Delete', 'Delete the frame'],
  ['M', 'Generate the frame'],
  ['Ctrl Enter', 'Generate all'],
  ['Esc', 'Stop'],
  ['J', 'Next joint (on the sheet with V, or in 3D)'],
  ['← ↑ ↓ →', 'Move it; Shift: farther'],
  ['Delete', 'Free it (sheet)'],
  ['PgUp PgDn', 'Away, nearer (3D)'],
  ['Enter', 'Put it there (3D)'],
  ['Ctrl Z', 'Undo in the storyboard'],
];

export function showShortcuts(): void {
  const table = (all: typeof KEYS) => h('div', { class: 'keys-table' }, ...all.map(([keys, what]) => h('div', { class: 'row' }, h('span', { class: 'text' }, what), ...keys.split(' ').map((key) => h('kbd', {}, key)))));
  openDialog('Keyboard shortcuts', h('div', {}, table(KEYS), h('h3', { class: 'keys-head' }, 'On a storyboard'), table(BOARD_KEYS))).classList.add('broad');
}

export interface ShortcutActs {
  readonly [key: string]: () => void;
}

/** Keys of the whole page; not while somebody types, and not in a dialog. */
export function listenToKeys(acts: ShortcutActs): void {
  window.addEventListener('keydown', (event) => {
    const target = event.target instanceof HTMLElement ? event.target : null;
    if (document.querySelector('dialog[open]')) return;
    const typing = target?.matches('input:not([type="checkbox"]):not([type="radio"]):not([type="range"]), select, textarea') ?? false;
    const command = event.ctrlKey || event.metaKey;
    if (typing && !(command && event.key.toLowerCase() === 'e')) return;
    // A button that has the focus is pressed by the space bar.
    if (event.key === ' ' && target?.matches('button, input')) return;
    if (/^(Home|End|Arrow)/.test(event.key) && target?.matches('input, [role="tab"], [role="separator"]')) return;
    const name = `${command ? 'Ctrl+' : ''}${event.shiftKey && event.key.length === 1 && /[a-z]/i.test(event.key) ? 'Shift+' : ''}${event.key.length === 1 ? event.key.toUpperCase() : event.key}`;
    const act = acts[name];
    if (!act) return;
    event.preventDefault();
    act();
  });
}
