import { h } from '../base/dom';
import { icon, type IconName } from '../base/icons';

let ids = 0;

/** A new id for an element of the page. */
export function freshId(): string {
  ids += 1;
  return `e${ids}`;
}

/** A button that is only an icon; its name is said and shown as a tip with its key. */
export function tool(name: IconName, label: string, act: () => void, key = ''): HTMLButtonElement {
  const title = key ? `${label} (${key})` : label;
  const button = h('button', { type: 'button', class: 'tool', title, 'aria-label': label, onclick: act });
  if (key) button.setAttribute('aria-keyshortcuts', key);
  button.append(icon(name));
  return button;
}

export function pressed(button: HTMLElement, is: boolean): void {
  button.setAttribute('aria-pressed', String(is));
}

/** One of a few, as radio buttons side by side. */
export class Segments<T extends string> {
  readonly element: HTMLElement;
  readonly #inputs = new Map<T, HTMLInputElement>();

  constructor(label: string, options: readonly { value: T; text: string; title?: string; sign?: Node }[], chosen: (value: T) => void, wide = false) {
    const group = freshId();
    this.element = h('div', { class: wide ? 'segments wide' : 'segments', role: 'radiogroup', 'aria-label': label });
    for (const { value, text, title, sign } of options) {
      const input = h('input', { type: 'radio', name: group, value, onchange: () => chosen(value) });
      this.#inputs.set(value, input);
      this.element.append(h('label', { title }, input, h('span', {}, sign ?? null, text)));
    }
  }

  set value(value: T) {
    for (const [name, input] of this.#inputs) input.checked = name === value;
  }

  disable(value: T, is: boolean): void {
    const input = this.#inputs.get(value);
    if (input) input.disabled = is;
  }
}

/** On or off, with its name to the right. */
export class Switch {
  readonly element: HTMLElement;
  readonly #input: HTMLInputElement;

  constructor(label: string, changed: (on: boolean) => void, title = '') {
    this.#input = h('input', { type: 'checkbox', role: 'switch' });
    this.#input.addEventListener('change', () => changed(this.#input.checked));
    this.element = h('label', { class: 'switch', title }, h('span', { class: 'text' }, label), this.#input);
  }

  set value(on: boolean) {
    this.#input.checked = on;
  }

  set disabled(is: boolean) {
    this.#input.disabled = is;
  }
}

export interface SliderOptions {
  readonly low: number;
  readonly high: number;
  readonly step: number;
  readonly text?: (value: number) => string;
}

/** A slider: `changed` at every move, `done` when it is let go. */
export class Slider {
  readonly element: HTMLElement;
  readonly #input: HTMLInputElement;
  readonly #options: SliderOptions;

  constructor(label: string, options: SliderOptions, changed: (value: number) => void, done: () => void = () => undefined) {
    this.#options = options;
    const { low, high, step } = options;
    this.#input = h('input', { type: 'range', min: low, max: high, step, 'aria-label': label });
    this.#input.addEventListener('input', () => {
      this.#paint();
      changed(Number(this.#input.value));
    });
    this.#input.addEventListener('change', done);
    this.element = this.#input;
  }

  set value(value: number) {
    this.#input.value = String(value);
    this.#paint();
  }

  set disabled(is: boolean) {
    this.#input.disabled = is;
  }

  #paint(): void {
    const { low, high, text } = this.#options;
    const value = Number(this.#input.value);
    this.#input.style.setProperty('--done', `${(100 * (value - low)) / (high - low)}%`);
    if (text) this.#input.setAttribute('aria-valuetext', text(value));
  }
}

export function section(title: string, ...children: (Node | string | null)[]): HTMLElement {
  return h('section', { class: 'section' }, h('h2', {}, title), ...children);
}

/** A row: name on the left, control on the right, joined for screen readers. */
export function row(label: string, control: HTMLElement): HTMLElement {
  const input = control.matches('input, select') ? control : control.querySelector('input, select');
  if (!input) return h('div', { class: 'row' }, h('span', { class: 'text' }, label), control);
  input.id ||= freshId();
  return h('div', { class: 'row' }, h('label', { class: 'text', for: input.id }, label), control);
}

export function button(text: string, act: () => void, kind = 'quiet', name: IconName | null = null): HTMLButtonElement {
  return h('button', { type: 'button', class: kind, onclick: act }, name ? icon(name) : null, text);
}
