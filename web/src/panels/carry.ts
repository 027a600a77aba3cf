import { h } from '../base/dom';
import { theme } from '../base/theme';
import type { Session } from '../document/session';
import type { Ui } from '../document/ui';
import { drawPose } from '../viewport/thumbnail';

export interface Target {
  drop(pose: { clip: string; frame: number }, clientX: number, clientY: number): boolean;
}

/** Poses that are dragged from a panel onto the canvas or the timeline, with any pointer. */
export class Carry {
  readonly targets: Target[] = [];

  constructor(
    readonly session: Session,
    readonly ui: Ui,
  ) {}

  /** Makes an element the handle of a pose. `pick` says which, at a place on the page. */
  from(handle: HTMLElement, pick: (event: PointerEvent) => { clip: string; frame: number } | null): void {
    handle.addEventListener('pointerdown', (down) => {
      if (down.button !== 0) return;
      const pose = pick(down);
      if (!pose) return;
      handle.setPointerCapture(down.pointerId);
      let picture: HTMLElement | null = null;
      const move = (event: PointerEvent) => {
        if (!picture && Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) < 6) return;
        picture ??= this.#picture(pose);
        picture.style.left = `${event.clientX}px`;
        picture.style.top = `${event.clientY}px`;
        this.ui.carried.value = { ...pose, x: event.clientX, y: event.clientY };
      };
      const end = (event: PointerEvent) => {
        handle.removeEventListener('pointermove', move);
        handle.removeEventListener('pointerup', end);
        handle.removeEventListener('pointercancel', end);
        picture?.remove();
        if (picture && event.type === 'pointerup') this.targets.some((target) => target.drop(pose, event.clientX, event.clientY));
        this.ui.carried.value = null;
      };
      handle.addEventListener('pointermove', move);
      handle.addEventListener('pointerup', end);
      handle.addEventListener('pointercancel', end);
    });
  }

  #picture(pose: { clip: string; frame: number }): HTMLElement {
    const canvas = h('canvas');
    const element = h('div', { class: 'carried' }, canvas);
    document.body.append(element);
    paintPose(this.session, canvas, pose);
    return element;
  }
}

/** Draws a pose of a source clip; nothing while the clip is not there. */
export function paintPose(session: Session, canvas: HTMLCanvasElement, pose: { clip: string; frame: number }, red = false): void {
  const part = session.source.value.parts.find((candidate) => candidate.clip.id === pose.clip);
  const places = session.source.value.pose(pose.clip, pose.frame);
  if (part && places) drawPose(canvas, part.motion.body, places, theme.value, red);
}
