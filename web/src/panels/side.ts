import { h } from '../base/dom';
import { freshId } from './controls';

export interface Tab {
  readonly name: string;
  readonly text: string;
  readonly panel: HTMLElement;
}

/** Panels behind tabs; arrow keys go from one to the next. */
export function side(place: HTMLElement, tabs: readonly Tab[]): (name: string) => void {
  const strip = h('div', { class: 'tabs', role: 'tablist', 'aria-label': 'Panels' });
  const buttons = tabs.map((tab) => {
    const [own, other] = [freshId(), freshId()];
    const button = h('button', { type: 'button', role: 'tab', id: own, 'aria-controls': other, 'data-tab': tab.name, onclick: () => choose(tab.name) }, tab.text);
    tab.panel.classList.add('panel');
    tab.panel.id = other;
    tab.panel.setAttribute('role', 'tabpanel');
    tab.panel.setAttribute('aria-labelledby', own);
    tab.panel.tabIndex = 0;
    return button;
  });
  const choose = (name: string) => {
    tabs.forEach((tab, i) => {
      const is = tab.name === name;
      tab.panel.hidden = !is;
      buttons[i]?.setAttribute('aria-selected', String(is));
      if (buttons[i]) buttons[i].tabIndex = is ? 0 : -1;
    });
  };
  strip.addEventListener('keydown', (event) => {
    const at = buttons.findIndex((button) => button === document.activeElement);
    const next = event.key === 'ArrowRight' ? at + 1 : event.key === 'ArrowLeft' ? at - 1 : -1;
    if (at < 0 || (event.key !== 'ArrowRight' && event.key !== 'ArrowLeft')) return;
    event.preventDefault();
    event.stopPropagation();
    const tab = tabs[(next + tabs.length) % tabs.length];
    if (!tab) return;
    choose(tab.name);
    buttons[tabs.indexOf(tab)]?.focus();
  });
  strip.append(...buttons);
  place.append(strip, ...tabs.map((tab) => tab.panel));
  choose(tabs[0]?.name ?? '');
  return choose;
}
