import type { LabelSegment } from '../api/types';
import { h } from '../base/dom';
import { icon } from '../base/icons';
import { theme } from '../base/theme';
import type { Controls } from '../document/controls';
import { labelColour, labelText, moveBorder } from '../document/labels';
import type { Session } from '../document/session';

/** Movements by name: a strip with borders to drag, and a row for each segment. */
export class LabelBoard {
  readonly element: HTMLElement;
  readonly #strip = h('div', { class: 'strip' });
  readonly #rows = h('div', { class: 'list label-rows' });
  readonly #head = h('i', { class: 'strip-head' });
  #segments: readonly LabelSegment[] = [];
  #gesture: string | null = null;

  constructor(
    readonly session: Session,
    readonly controls: Controls,
  ) {
    const add = h('button', { type: 'button', class: 'quiet', onclick: () => this.#add() }, 'Add a segment');
    this.element = h('div', { class: 'board editor labels' }, h('p', { class: 'soft' }, 'The same name asks for the same movement. Which one it is, the clip decides; a key can say it.'), h('div', { class: 'strip-box' }, this.#strip, this.#head), this.#rows, h('div', {}, add));
    session.store.document.watch(({ control }) => {
      if (control?.kind !== 'labels') return;
      this.#segments = control.segments;
      this.#build();
    });
    theme.subscribe(() => this.#build());
    const { seconds, duration } = session.player;
    const place = () => (this.#head.style.left = `${(100 * seconds.value) / Math.max(duration.value, 1e-6)}%`);
    for (const signal of [seconds, duration]) signal.watch(place);
  }

  #set(segments: readonly LabelSegment[], label: string): void {
    this.controls.set({ kind: 'labels', segments: [...segments] }, label, this.#gesture);
  }

  #add(): void {
    const names = new Set(this.#segments.map(({ name }) => name));
    const fresh = [...'ABCDEFGHIJKLMNOPQRSTUVWXYZ'].find((letter) => !names.has(letter)) ?? 'New';
    this.#set([...this.#segments, { name: fresh, seconds: 2, colour: null }], 'Add a label');
  }

  #build(): void {
    // While a border is dragged only sizes change, so that the pointer keeps what it holds.
    if (this.#gesture !== null) {
      [...this.#strip.children].forEach((child, i) => ((child as HTMLElement).style.flexGrow = String(this.#segments[i]?.seconds ?? 1)));
      return;
    }
    const typing = document.activeElement instanceof HTMLInputElement && this.#rows.contains(document.activeElement);
    this.#strip.replaceChildren(...this.#segments.map((label, i) => this.#block(label, i)));
    if (!typing) this.#rows.replaceChildren(...this.#segments.map((label, i) => this.#row(label, i)));
  }

  #block(label: LabelSegment, i: number): HTMLElement {
    const colour = labelColour(this.#segments, label, theme.value.dark);
    const border = h('span', { class: 'border', role: 'separator', tabindex: 0, 'aria-orientation': 'vertical', 'aria-label': `End of ${label.name}, segment ${i + 1}`, 'aria-valuenow': label.seconds, 'aria-valuemin': 0, 'aria-valuetext': `${label.seconds} seconds` });
    border.addEventListener('keydown', (event) => {
      const by = event.key === 'ArrowRight' ? 0.1 : event.key === 'ArrowLeft' ? -0.1 : 0;
      if (by === 0) return;
      event.preventDefault();
      event.stopPropagation();
      this.#set(moveBorder(this.#segments, i, by), 'Move a border');
      (this.#strip.children[i]?.querySelector('.border') as HTMLElement | null)?.focus();
    });
    border.addEventListener('pointerdown', (down) => {
      down.preventDefault();
      border.setPointerCapture(down.pointerId);
      const before = this.#segments;
      const total = before.reduce((sum, { seconds }) => sum + seconds, 0);
      const scale = total / Math.max(this.#strip.clientWidth, 1);
      this.#gesture = `border ${i} ${Date.now()}`;
      const move = (event: PointerEvent) => this.#set(moveBorder(before, i, (event.clientX - down.clientX) * scale), 'Move a border');
      const end = () => {
        border.removeEventListener('pointermove', move);
        this.#gesture = null;
        this.#build();
      };
      border.addEventListener('pointermove', move);
      border.addEventListener('pointerup', end, { once: true });
      border.addEventListener('pointercancel', end, { once: true });
    });
    const block = h('div', { class: 'block', style: `flex-grow:${label.seconds};background:${colour};color:${labelText(label, theme.value.dark)}` }, h('b', {}, label.name), h('span', {}, `${label.seconds} s`), border);
    return block;
  }

  #row(label: LabelSegment, i: number): HTMLElement {
    const change = (what: Partial<LabelSegment>, text: string) => this.#set(this.#segments.map((other, j) => (j === i ? { ...other, ...what } : other)), text);
    const name = h('input', { type: 'text', value: label.name, maxlength: 40, 'aria-label': `Name of segment ${i + 1}`, style: 'flex:1' });
    name.addEventListener('change', () => change({ name: name.value.trim() || label.name }, 'Rename a label'));
    const seconds = h('input', { type: 'number', value: label.seconds, min: 0.1, step: 0.1, 'aria-label': `Seconds of segment ${i + 1}` });
    seconds.addEventListener('change', () => change({ seconds: Math.max(0.1, Number(seconds.value) || 0.1) }, 'Length of a label'));
    const colour = h('input', { type: 'color', value: label.colour ?? toHex(labelColour(this.#segments, label, theme.value.dark)), 'aria-label': `Colour of ${label.name}` });
    colour.addEventListener('change', () => this.#set(this.#segments.map((other) => (other.name === label.name ? { ...other, colour: colour.value } : other)), 'Colour of a label'));
    const gone = h('button', { type: 'button', class: 'tool small', 'aria-label': `Remove segment ${i + 1}`, title: 'Remove' }, icon('close'));
    gone.addEventListener('click', () => this.#set(this.#segments.filter((_, j) => j !== i), 'Remove a label'));
    gone.disabled = this.#segments.length < 2;
    return h('div', { class: 'row' }, colour, name, seconds, h('span', { class: 'soft' }, 's'), gone);
  }
}

/** Any CSS colour as #rrggbb, by letting the browser draw it. */
function toHex(colour: string): string {
  const context = document.createElement('canvas').getContext('2d', { willReadFrequently: true });
  if (!context) return '#888888';
  context.fillStyle = colour;
  context.fillRect(0, 0, 1, 1);
  const [r = 0, g = 0, b = 0] = context.getImageData(0, 0, 1, 1).data;
  return `#${[r, g, b].map((value) => value.toString(16).padStart(2, '0')).join('')}`;
}
