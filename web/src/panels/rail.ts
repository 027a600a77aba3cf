import type { Board } from '../canvas/board';
import { h } from '../base/dom';
import type { IconName } from '../base/icons';
import type { Controls } from '../document/controls';
import type { Session } from '../document/session';
import type { Tool, Ui } from '../document/ui';
import { pressed, tool } from './controls';

const TOOLS: readonly { tool: Tool; icon: IconName; label: string; key: string }[] = [
  { tool: 'draw', icon: 'draw', label: 'Draw a new line', key: 'D' },
  { tool: 'redraw', icon: 'redraw', label: 'Redraw the nearest stretch', key: 'R' },
  { tool: 'add', icon: 'add', label: 'Go on with one more stroke', key: 'A' },
  { tool: 'select', icon: 'select', label: 'Move keys, scrub along the line', key: 'V' },
  { tool: 'hand', icon: 'hand', label: 'Move the paper', key: 'H' },
];

/** The tools of the canvas. */
export function rail(place: HTMLElement, pen: HTMLElement, session: Session, ui: Ui, board: Board, controls: Controls): void {
  const buttons = TOOLS.map(({ tool: name, icon, label, key }) => {
    const button = tool(icon, label, () => (ui.tool.value = name), key);
    button.dataset['tool'] = name;
    return button;
  });
  const clear = tool('clear', 'Clear the drawing', () => controls.set(null, 'Clear the drawing'));
  place.append(...buttons, h('hr'), tool('fit', 'Show the whole drawing', () => board.frame(), 'F'), clear);
  ui.tool.watch((now) => {
    for (const button of buttons) pressed(button, button.dataset['tool'] === now);
    pen.dataset['tool'] = now;
  });
  session.store.document.watch(({ control }) => {
    const empty = control?.kind !== 'curve';
    clear.disabled = empty;
    for (const button of buttons) if (button.dataset['tool'] === 'redraw' || button.dataset['tool'] === 'add') button.disabled = empty;
    if (empty && (ui.tool.value === 'redraw' || ui.tool.value === 'add')) ui.tool.value = 'draw';
  });
}
