import { Vector3 } from 'three';

import { h } from '../base/dom';
import type { Vec3 } from '../base/maths';
import type { Stage } from './stage';

/** How near to a joint, in CSS pixels, takes hold of it. */
const NEAR = 15;

/** A step of a key, metres; five with Shift. */
const STEP = 0.01;
/** To the right, up and away from who looks on. */
const KEYS: Record<string, Vec3> = {
  ArrowRight: [1, 0, 0],
  ArrowLeft: [-1, 0, 0],
  ArrowUp: [0, 1, 0],
  ArrowDown: [0, -1, 0],
  PageUp: [0, 0, 1],
  PageDown: [0, 0, -1],
};
const WAYS = [
  ['right', 'left'],
  ['up', 'down'],
  ['away', 'nearer'],
] as const;

/** Joints of the character that are moved in space: dragged in the plane of the screen, or chosen and moved by keys. */
export class Grab {
  #joints: ReadonlySet<string> = new Set();
  readonly #handle = h('i', { class: 'handle', 'aria-hidden': 'true' }, h('b'));
  /** What is moved by keys: the joint, and how far to the right, up and away, in whole steps, as the camera stands. */
  #chosen: { name: string; steps: [number, number, number] } | null = null;
  #held: { pointer: number; name: string; depth: number; x: number; y: number; dx: number; dy: number; moved: boolean } | null = null;

  constructor(
    readonly stage: Stage,
    readonly begun: () => void,
    /** Where a joint was put; whether it goes there. */
    readonly done: (joint: string, place: Vec3) => boolean,
    readonly say: (text: string) => void,
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
      this.#chosen = null;
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
        if (found && !this.#choice) this.#show(found.name, found.x, found.y, false);
        else this.#rest();
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
      this.#rest();
      if (held.moved && event.type === 'pointerup') done(held.name, stage.world(event.offsetX + held.dx, event.offsetY + held.dy, held.depth));
    };
    canvas.addEventListener('pointerup', end, capture);
    canvas.addEventListener('pointercancel', end, capture);
    canvas.addEventListener('pointerleave', () => !this.#held && this.#rest());
    canvas.addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || !this.#key(event.key, event.shiftKey)) return;
      event.preventDefault();
      event.stopImmediatePropagation();
    }, capture);
    stage.onrender = () => !this.#held && this.#choice && this.#rest();
  }

  /** Names of the joints that can be moved; none for none. */
  set joints(joints: ReadonlySet<string>) {
    this.#joints = joints;
    const keys = joints.size > 0 ? '. J chooses a joint, arrows and Page keys move it, Enter makes the motion' : '';
    this.stage.canvas.setAttribute('aria-label', `The character in 3D: drag or use the arrow keys to look around${keys}`);
    this.#rest();
  }

  /** What is moved by keys, where it can be: while another motion comes, it waits. */
  get #choice() {
    return this.#chosen && this.#joints.has(this.#chosen.name) ? this.#chosen : null;
  }

  /** J chooses, arrows and Page keys move, Enter puts it there, Escape lets go. */
  #key(key: string, shift: boolean): boolean {
    const chosen = this.#choice;
    const way = KEYS[key];
    if (key.toLowerCase() === 'j' && this.#joints.size > 0) {
      const names = this.stage.motion?.body.names.filter((name) => this.#joints.has(name)) ?? [];
      const at = chosen ? names.indexOf(chosen.name) + (shift ? -1 : 1) : shift ? -1 : 0;
      const name = names[(at + names.length) % names.length];
      if (!name) return false;
      this.begun();
      this.#chosen = { name, steps: [0, 0, 0] };
      this.say(`${said(name)}: arrows and Page keys move it`);
    } else if (chosen && way) {
      chosen.steps = chosen.steps.map((step, i) => step + (shift ? 5 : 1) * (way[i] ?? 0)) as [number, number, number];
      this.begun();
      const far = chosen.steps.flatMap((step, i) => (step === 0 ? [] : [`${Math.abs(step)} cm ${WAYS[i]?.[step > 0 ? 0 : 1]}`]));
      this.say(`${said(chosen.name)}: ${far.length > 0 ? `${far.join(', ')}; Enter puts it there` : 'where it was'}`);
    } else if (chosen && key === 'Enter') {
      if (chosen.steps.some((step) => step !== 0) && this.done(chosen.name, this.#place(chosen))) chosen.steps = [0, 0, 0];
    } else if (chosen && key === 'Escape') {
      this.#chosen = null;
      this.say(`${said(chosen.name)} is let go`);
    } else return false;
    this.#rest();
    return true;
  }

  /** Where what is moved by keys would be. */
  #place({ name, steps: [right, up, away] }: { name: string; steps: [number, number, number] }): Vec3 {
    const { stage } = this;
    const [x, y, z] = this.#joint(name);
    const { x: rx, z: rz } = stage.orbit.right(side);
    return [x + STEP * (right * rx + away * rz), y + STEP * up, z + STEP * (right * rz - away * rx)];
  }

  /** Where a joint is now. */
  #joint(name: string): Vec3 {
    const pose = this.stage.pose();
    const at = 3 * (this.stage.motion?.body.names.indexOf(name) ?? -1);
    return [pose[at] ?? 0, pose[at + 1] ?? 0, pose[at + 2] ?? 0];
  }

  /** Without a pointer the mark is at the joint that is chosen, or nowhere. */
  #rest(): void {
    const chosen = this.#choice;
    const [x, y, depth] = chosen ? this.stage.screen(this.#place(chosen)) : [0, 0, 2];
    if (chosen && depth <= 1) this.#show(chosen.name, x, y, chosen.steps.some((step) => step !== 0));
    else this.#handle.hidden = true;
  }

  #near({ offsetX, offsetY }: PointerEvent): { name: string; x: number; y: number; depth: number } | null {
    const { motion } = this.stage;
    if (!motion || this.#joints.size === 0) return null;
    const pose = this.stage.pose();
    let [found, least]: [{ name: string; x: number; y: number; depth: number } | null, number] = [null, NEAR];
    motion.body.names.forEach((name, joint) => {
      if (!this.#joints.has(name)) return;
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
    if (text) text.textContent = said(name);
  }
}

const side = new Vector3();

function said(name: string): string {
  return name.replaceAll('_', ' ');
}
