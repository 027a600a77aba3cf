import { h } from '../base/dom';
import type { Session } from '../document/session';
import { tool } from './controls';

/** A video to match, played in time beside the character. */
export class Reference {
  readonly element: HTMLElement;
  readonly #video = h('video', { muted: true, playsinline: true, preload: 'auto' });

  constructor(session: Session) {
    this.#video.muted = true;
    const close = tool('close', 'Remove the reference video', () => this.#hide());
    close.classList.add('small');
    this.element = h('div', { class: 'reference', hidden: true }, this.#video, close);
    const { player } = session;
    player.seconds.subscribe((seconds) => {
      if (this.element.hidden || !Number.isFinite(this.#video.duration)) return;
      const at = Math.min(seconds, this.#video.duration);
      if (Math.abs(this.#video.currentTime - at) > (player.playing.value ? 0.15 : 0.01) && !this.#video.seeking) this.#video.currentTime = at;
    });
    player.speed.watch((speed) => (this.#video.defaultPlaybackRate = this.#video.playbackRate = speed));
    player.playing.subscribe((is) => {
      if (this.element.hidden) return;
      if (is) void this.#video.play().catch(() => undefined);
      else this.#video.pause();
    });
  }

  show(file: File): void {
    this.#hide();
    this.#video.src = URL.createObjectURL(file);
    this.element.hidden = false;
  }

  #hide(): void {
    this.element.hidden = true;
    this.#video.pause();
    if (this.#video.src) URL.revokeObjectURL(this.#video.src);
    this.#video.removeAttribute('src');
  }
}
