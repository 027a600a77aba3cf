import { h, painter } from '../base/dom';
import { theme } from '../base/theme';
import type { Controls } from '../document/controls';
import type { Session } from '../document/session';
import { poseAt } from '../viewport/motion';
import { drawPose } from '../viewport/thumbnail';

const PICTURES = 12;

/** Another motion that steers, as a strip of moments. */
export class MotionBoard {
  readonly element: HTMLElement;
  readonly #name = h('select', { 'aria-label': 'Motion that steers' });
  readonly #film = h('div', { class: 'film' });
  readonly #empty: HTMLElement;
  readonly #bar: HTMLElement;
  #shown = '';

  constructor(
    readonly session: Session,
    readonly controls: Controls,
    pick: () => void,
  ) {
    this.#empty = h('div', { class: 'nothing' }, h('b', {}, 'Another motion steers this one'), h('span', {}, 'Drop a motion of any skeleton, then choose it here.'), h('button', { type: 'button', class: 'quiet', onclick: pick }, 'Choose a motion'));
    this.#bar = h('div', { class: 'editor-foot' }, h('span', { class: 'soft' }, 'Like'), this.#name);
    this.element = h('div', { class: 'board editor' }, this.#film, this.#empty, this.#bar);
    this.#name.addEventListener('change', () => this.#name.value && controls.set({ kind: 'motion', clip: this.#name.value }, 'Follow a motion'));
    const draw = painter(() => void this.#show(true));
    theme.subscribe(draw);
    session.store.document.watch(({ control, clips }) => {
      const motions = clips.filter((clip) => clip.role === 'motion');
      this.#name.replaceChildren(h('option', { value: '' }, 'Choose a motion'), ...motions.map((clip) => h('option', { value: clip.id }, clip.name)));
      this.#name.value = control?.kind === 'motion' ? control.clip : '';
      this.#empty.hidden = control?.kind === 'motion' || motions.length > 1;
      void this.#show(false);
    });
  }

  async #show(again: boolean): Promise<void> {
    const { control } = this.session.store.document.value;
    const id = control?.kind === 'motion' ? control.clip : '';
    if (id === this.#shown && !again) return;
    this.#shown = id;
    if (id === '') {
      this.#film.replaceChildren();
      return;
    }
    const { motion, clip } = await this.session.clip(id);
    if (id !== this.#shown) return;
    const pictures = Array.from({ length: PICTURES }, (_, i) => {
      const canvas = h('canvas');
      const seconds = (clip.seconds * i) / (PICTURES - 1);
      requestAnimationFrame(() => drawPose(canvas, motion.body, poseAt(motion, seconds, new Float32Array(3 * motion.body.names.length)), theme.value));
      return h('figure', {}, canvas, h('figcaption', { class: 'soft' }, `${seconds.toFixed(1)} s`));
    });
    this.#film.replaceChildren(...pictures);
  }
}
