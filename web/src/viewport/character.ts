import { bytes, post, postFor, Refused } from '../api/http';
import type { ExportAsked, RetargetAsked, RetargetDone } from '../api/types';
import { Signal } from '../base/signal';
import type { Session } from '../document/session';
import { showSkin } from './skin';
import type { Stage } from './stage';

/**
 * The user's own mesh instead of capsules: that of the clip, or of another character that the result is put on. While
 * something is being drawn there are capsules, which take every new pose at once.
 */
export class Character {
  /** The clip whose mesh is wanted; null for none. */
  readonly chosen = new Signal<string | null>(null);
  #turn = 0;
  #remove: (() => void) | null = null;

  constructor(
    readonly session: Session,
    readonly stage: Stage,
  ) {
    this.chosen.subscribe(() => void this.#load());
    session.result.subscribe(() => void this.#load());
    session.stale.subscribe((is) => is && this.#capsules());
    session.store.document.subscribe(({ clips }) => {
      if (!clips.some((clip) => clip.id === this.chosen.value)) this.chosen.value = null;
    });
  }

  async #load(): Promise<void> {
    const clip = this.chosen.value;
    if (clip === null) {
      this.#capsules();
      return;
    }
    const turn = (this.#turn += 1);
    try {
      const glb = await this.#file(clip);
      if (turn !== this.#turn) return;
      const remove = await showSkin(this.stage, glb);
      if (turn === this.#turn) {
        this.#remove?.();
        this.#remove = remove;
      } else remove();
    } catch (error) {
      if (turn !== this.#turn) return;
      this.session.store.failed.value = error instanceof Refused ? error : new Refused('skin', `The character cannot be shown: ${String(error)}`, null);
      this.chosen.value = null;
    }
  }

  /** The character's own file with what is shown in it as its last clip. */
  async #file(clip: string): Promise<ArrayBuffer> {
    const result = this.session.result.value;
    if (!result) return bytes(`clips/${clip}/file`);
    const own = this.session.store.document.value.source.clips[0] === clip;
    const of = own ? result.id : (await post<RetargetDone>('retarget', { of: result.id, onto: clip } satisfies RetargetAsked)).result;
    return (await postFor('export', { of, format: 'glb', fps: result.frameRate } satisfies ExportAsked)).arrayBuffer();
  }

  #capsules(): void {
    this.#turn += 1;
    this.#remove?.();
    this.#remove = null;
  }
}
