import { h } from '../base/dom';
import type { Session } from '../document/session';
import { tool } from './controls';

/** What went wrong and what to do, at the foot of the page until it is read. */
export function toastFailures(place: HTMLElement, session: Session): void {
  let shown: HTMLElement | null = null;
  let timer = 0;
  const say = (message: string, hint: string | null, seconds: number) => {
    shown?.remove();
    clearTimeout(timer);
    const close = tool('close', 'Close', () => toast.remove());
    close.classList.add('small');
    const toast = h('div', { class: 'toast', role: 'alert' }, h('span', { style: 'flex:1' }, message, hint ? h('span', { class: 'soft' }, ` ${hint}`) : null), close);
    place.append(toast);
    shown = toast;
    timer = window.setTimeout(() => toast.remove(), 1000 * seconds);
  };
  session.store.failed.subscribe((refused) => refused && say(refused.message, refused.hint, 12));
  session.problem.subscribe((problem) => {
    if (problem) say(problem.message, problem.hint, 12);
    else shown?.remove();
  });
}
