import type { Ui } from '../document/ui';
import type { Paper } from './paper';

/** Moves and scales the paper: wheel, middle button, the hand, two fingers; not the palm beside a pen. */
export class Navigate {
  readonly #fingers = new Map<number, { x: number; y: number }>();
  #penDown = false;

  constructor(element: HTMLElement, paper: Paper, ui: Ui, changed: () => void) {
    element.addEventListener(
      'wheel',
      (event) => {
        event.preventDefault();
        const box = element.getBoundingClientRect();
        if (event.shiftKey) paper.move(-event.deltaY, -event.deltaX);
        else paper.zoomAt(event.clientX - box.left, event.clientY - box.top, Math.exp(-event.deltaY * 0.0015));
        changed();
      },
      { passive: false },
    );
    element.addEventListener('pointerdown', (event) => {
      if (event.pointerType === 'pen') {
        this.#penDown = true;
        this.#fingers.clear();
      }
      if (event.pointerType === 'touch' && this.#penDown) return;
      const moves = event.button === 1 || (event.button === 0 && (ui.tool.value === 'hand' || event.altKey)) || event.pointerType === 'touch';
      if (!moves) return;
      this.#fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
      if (event.pointerType !== 'touch') element.setPointerCapture(event.pointerId);
    });
    element.addEventListener('pointermove', (event) => {
      const before = this.#fingers.get(event.pointerId);
      if (!before) return;
      const other = [...this.#fingers].find(([id]) => id !== event.pointerId)?.[1];
      const alone = event.pointerType === 'touch' && !other && ui.tool.value !== 'hand';
      if (!alone) {
        const half = other ? 0.5 : 1;
        paper.move((event.clientX - before.x) * half, (event.clientY - before.y) * half);
        if (other) {
          const box = element.getBoundingClientRect();
          const was = Math.hypot(before.x - other.x, before.y - other.y);
          const is = Math.hypot(event.clientX - other.x, event.clientY - other.y);
          if (was > 1) paper.zoomAt((event.clientX + other.x) / 2 - box.left, (event.clientY + other.y) / 2 - box.top, is / was);
        }
        changed();
      }
      this.#fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    });
    const end = (event: PointerEvent) => {
      this.#fingers.delete(event.pointerId);
      if (event.pointerType === 'pen') this.#penDown = false;
    };
    element.addEventListener('pointerup', end);
    element.addEventListener('pointercancel', end);
  }
}
