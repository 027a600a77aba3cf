import { h } from '../base/dom';
import { freshId, tool } from './controls';

/** A dialog over the page; closed by its cross, Escape or a click beside it. */
export function openDialog(title: string, content: HTMLElement, foot: readonly HTMLElement[] = []): HTMLDialogElement {
  const id = freshId();
  const close = tool('close', 'Close', () => dialog.close());
  close.classList.add('small');
  const dialog = h('dialog', { 'aria-labelledby': id }, h('header', {}, h('span', { id, role: 'heading', 'aria-level': 2 }, title), close), h('div', { tabindex: 0, autofocus: true }, content), foot.length > 0 ? h('footer', {}, ...foot) : null);
  dialog.addEventListener('close', () => dialog.remove());
  dialog.addEventListener('click', (event) => {
    if (event.target === dialog) dialog.close();
  });
  document.getElementById('over')?.append(dialog);
  dialog.showModal();
  return dialog;
}
