import { h } from '../base/dom';
import { scheme, setScheme } from '../base/theme';
import type { Session } from '../document/session';
import type { ControlKind, Controls } from '../document/controls';
import { Segments, tool } from './controls';

const KINDS: readonly { value: ControlKind; text: string; title: string }[] = [
  { value: 'curve', text: 'Draw', title: 'A drawn line: its shape and speed (1)' },
  { value: 'wave', text: 'Wave', title: 'A value over time, drawn or as an expression (2)' },
  { value: 'labels', text: 'Labels', title: 'Movements by name (3)' },
  { value: 'sound', text: 'Sound', title: 'Music or speech (4)' },
  { value: 'motion', text: 'Motion', title: 'Another motion, of any skeleton (5)' },
  { value: 'storyboard', text: 'Storyboard', title: 'Drawn frames become one animation (6)' },
];

export interface ToolbarActs {
  export(): void;
  help(): void;
  guide(): void;
  side(): void;
}

/** The top line: whose project, what steers it, undo, export. */
export function toolbar(bar: HTMLElement, session: Session, controls: Controls, acts: ToolbarActs): void {
  const { store } = session;
  const name = h('input', { type: 'text', class: 'name wide-only', 'aria-label': 'Name of the project', spellcheck: 'false', maxlength: 80 });
  name.addEventListener('change', () => store.edit('Rename', [{ type: 'setName', name: name.value.trim() || 'Untitled' }]));
  name.addEventListener('keydown', (event) => {
    if (event.key === 'Enter' || event.key === 'Escape') name.blur();
  });
  const kinds = new Segments('What steers the motion', KINDS, (kind) => controls.choose(kind));
  const undo = tool('undo', 'Undo', () => void store.undo(), 'Ctrl+Z');
  const redo = tool('redo', 'Redo', () => void store.redo(), 'Ctrl+Shift+Z');
  const sun = tool('sun', 'Light or dark', () => setScheme(scheme() === 'dark' ? 'light' : 'dark'), 'Shift+D');
  const out = h('button', { type: 'button', class: 'primary', onclick: acts.export, 'aria-keyshortcuts': 'Control+E' }, 'Export');
  const mark = h('h1', { class: 'brand' });
  mark.innerHTML =
    '<svg viewBox="0 0 20 20" aria-hidden="true"><path d="M2.500 15.500c3.500-13 7.500-12 7.500-5s4 7 7.500-6" fill="none" stroke="var(--accent)" stroke-width="2.600" stroke-linecap="round"/></svg><span>inkrig</span>';
  bar.append(
    mark,
    name,
    h('div', { class: 'spring' }),
    kinds.element,
    h('div', { class: 'spring' }),
    h('div', { class: 'group' }, undo, redo),
    h('div', { class: 'group' }, sun, tool('keyboard', 'Keyboard shortcuts', acts.help, '?'), tool('help', 'Guided tour', acts.guide), tool('side', 'Panels', acts.side, '\\')),
    out,
  );
  store.document.watch((document) => {
    if (name.ownerDocument.activeElement !== name) name.value = document.name;
  });
  controls.kind.watch((kind) => (kinds.value = kind));
  store.history.watch(({ undo: past, redo: future }) => {
    undo.disabled = past.length === 0;
    redo.disabled = future.length === 0;
    undo.title = past.length > 0 ? `Undo: ${past.at(-1) ?? ''} (Ctrl+Z)` : 'Nothing to undo';
    redo.title = future.length > 0 ? `Redo: ${future.at(-1) ?? ''} (Ctrl+Shift+Z)` : 'Nothing to redo';
  });
}
