import { type PerspectiveCamera, Vector3 } from 'three';

import { clamp, mix } from '../base/maths';

/** A camera that turns about a place: by drag, wheel, two fingers and arrow keys. */
export class Orbit {
  readonly target = new Vector3();
  readonly #camera: PerspectiveCamera;
  readonly #pointers = new Map<number, { x: number; y: number }>();
  #yaw = 0.5;
  #pitch = 0.2;
  #distance = 4;
  #pan = new Vector3();

  constructor(camera: PerspectiveCamera, element: HTMLElement, changed: () => void) {
    this.#camera = camera;
    element.addEventListener('pointerdown', (event) => {
      element.setPointerCapture(event.pointerId);
      this.#pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    });
    element.addEventListener('pointermove', (event) => {
      const before = this.#pointers.get(event.pointerId);
      if (!before) return;
      this.#drag(event, before);
      this.#pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
      changed();
    });
    const end = (event: PointerEvent) => this.#pointers.delete(event.pointerId);
    element.addEventListener('pointerup', end);
    element.addEventListener('pointercancel', end);
    element.addEventListener('wheel', (event) => {
      event.preventDefault();
      this.#zoom(Math.exp(clamp(event.deltaY, -200, 200) * 0.0016));
      changed();
    }, { passive: false });
    element.addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || !this.#key(event.key)) return;
      event.preventDefault();
      event.stopPropagation();
      changed();
    });
    element.addEventListener('contextmenu', (event) => event.preventDefault());
  }

  /** Stands so far away that a figure `tall` metres high and reaching `reach` metres aside is seen whole. */
  frame(yaw: number, tall: number, reach: number, aside = 0): void {
    const half = Math.tan(((this.#camera.fov / 2) * Math.PI) / 180);
    this.#yaw = yaw + 0.5;
    this.#pitch = 0.16;
    this.#pan.set(0, 0, 0);
    this.#distance = Math.max((0.72 * tall) / half, ((1.1 * reach + aside / 2) * 1.15) / (half * Math.max(this.#camera.aspect, 0.2)));
  }

  turn(yaw: number, pitch: number): void {
    this.#yaw += yaw;
    this.#pitch = clamp(this.#pitch + pitch, -0.15, 1.5);
  }

  /** To the right of the camera, on the ground. */
  right(out: Vector3): Vector3 {
    return out.set(Math.cos(this.#yaw), 0, -Math.sin(this.#yaw));
  }

  get distance(): number {
    return this.#distance;
  }

  apply(): void {
    const level = Math.cos(this.#pitch) * this.#distance;
    at.copy(this.target).add(this.#pan);
    const height = Math.max(at.y + Math.sin(this.#pitch) * this.#distance, 0.02 * this.#distance);
    this.#camera.position.set(at.x + level * Math.sin(this.#yaw), height, at.z + level * Math.cos(this.#yaw));
    this.#camera.lookAt(at);
  }

  #drag(event: PointerEvent, before: { x: number; y: number }): void {
    const [dx, dy] = [event.clientX - before.x, event.clientY - before.y];
    const other = [...this.#pointers].find(([id]) => id !== event.pointerId)?.[1];
    if (other) {
      const was = Math.hypot(before.x - other.x, before.y - other.y);
      const is = Math.hypot(event.clientX - other.x, event.clientY - other.y);
      if (was > 1 && is > 1) this.#zoom(was / is);
      this.#move(dx / 2, dy / 2);
    } else if (event.buttons & 6 || event.shiftKey) this.#move(dx, dy);
    else this.turn(-dx * 0.008, dy * 0.006);
  }

  #move(dx: number, dy: number): void {
    const scale = this.#distance * 0.0012;
    this.#pan.addScaledVector(this.right(side), -dx * scale);
    this.#pan.y += dy * scale;
  }

  #zoom(factor: number): void {
    this.#distance = clamp(this.#distance * factor, 0.05, 2000);
  }

  #key(key: string): boolean {
    const step = mix(0, Math.PI, 1 / 24);
    if (key === 'ArrowLeft') this.turn(-step, 0);
    else if (key === 'ArrowRight') this.turn(step, 0);
    else if (key === 'ArrowUp') this.turn(0, step / 2);
    else if (key === 'ArrowDown') this.turn(0, -step / 2);
    else if (key === '+' || key === '=') this.#zoom(0.9);
    else if (key === '-') this.#zoom(1 / 0.9);
    else return false;
    return true;
  }
}

const [at, side] = [new Vector3(), new Vector3()];
