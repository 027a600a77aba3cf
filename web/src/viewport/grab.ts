import { h } from '../base/dom';
import type { Vec3 } from '../base/maths';
import type { Stage } from './stage';

/** How near to a joint, in CSS pixels, takes hold of it. */
const NEAR = 15;

/** Joints of the character that are dragged in the plane of the screen. */
export class Grab {
  /** Names of the joints that can be dragged; none for none. */
  joints: ReadonlySet<string> = new Set();
  readonly #handle = h('i', { class: 'handle', 'aria-hidden': 'true' }, h('b'));
  #held: { pointer: number; name: string; depth: number; x: number; y: number; dx: number; dy: number; moved: boolean } | null = null;

  constructor(
    readonly stage: Stage,
    begun: () => void,
    done: (joint: string, place: Vec3) => void,
  ) {
    const { canvas } = stage;
    this.#handle.hidden = true;
    canvas.after(this.#handle);
    // Before the camera sees them.
    const capture = { capture: true };
    canvas.addEventListener('pointerdown', (event) => {
      if (this.#held) {
        event.stopImmediatePropagation();
        return;
      }
      const found = event.button === 0 && !event.shiftKey ? this.#near(event) : null;
      if (!found) return;
      event.stopImmediatePropagation();
      canvas.setPointerCapture(event.pointerId);
      const [x, y] = [event.offsetX, event.offsetY];
      this.#held = { pointer: event.pointerId, name: found.name, depth: found.depth, x, y, dx: found.x - x, dy: found.y - y, moved: false };
      begun();
      this.#show(found.name, found.x, found.y, true);
    }, capture);
    canvas.addEventListener('pointermove', (event) => {
      const held = this.#held;
      if (!held) {
        const found = event.buttons === 0 ? this.#near(event) : null;
        canvas.style.cursor = found ? 'move' : '';
        if (found) this.#show(found.name, found.x, found.y, false);
        else this.#handle.hidden = true;
        return;
      }
      event.stopImmediatePropagation();
      if (event.pointerId !== held.pointer) return;
      held.moved ||= Math.hypot(event.offsetX - held.x, event.offsetY - held.y) > 3;
      this.#show(held.name, event.offsetX + held.dx, event.offsetY + held.dy, true);
    }, capture);
    const end = (event: PointerEvent) => {
      const held = this.#held;
      if (!held) return;
      event.stopImmediatePropagation();
      if (event.pointerId !== held.pointer) return;
      this.#held = null;
      this.#handle.hidden = true;
      if (held.moved && event.type === 'pointerup') done(held.name, stage.world(event.offsetX + held.dx, event.offsetY + held.dy, held.depth));
    };
    canvas.addEventListener('pointerup', end, capture);
    canvas.addEventListener('pointercancel', end, capture);
    canvas.addEventListener('pointerleave', () => !this.#held && (this.#handle.hidden = true));
  }

  #near({ offsetX, offsetY }: PointerEvent): { name: string; x: number; y: number; depth: number } | null {
    const { motion } = this.stage;
    if (!motion || this.joints.size === 0) return null;
    const pose = this.stage.pose();
    let [found, least]: [{ name: string; x: number; y: number; depth: number } | null, number] = [null, NEAR];
    motion.body.names.forEach((name, joint) => {
      if (!this.joints.has(name)) return;
      const [x, y, depth] = this.stage.screen([pose[3 * joint] ?? 0, pose[3 * joint + 1] ?? 0, pose[3 * joint + 2] ?? 0]);
      // Behind the camera.
      if (depth > 1) return;
      const apart = Math.hypot(x - offsetX, y - offsetY);
      if (apart < least) [found, least] = [{ name, x, y, depth }, apart];
    });
    return found;
  }

  #show(name: string, x: number, y: number, held: boolean): void {
    this.#handle.hidden = false;
    this.#handle.classList.toggle('held', held);
    this.#handle.style.translate = `${x}px ${y}px`;
    const [text] = this.#handle.children;
    if (text) text.textContent = name.replaceAll('_', ' ');
  }
}
