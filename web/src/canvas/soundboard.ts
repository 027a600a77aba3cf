import { bytes, get } from '../api/http';
import type { Outline } from '../api/types';
import { css, rampAt } from '../base/colour';
import { fit, h, onResize, painter } from '../base/dom';
import { theme } from '../base/theme';
import type { Controls } from '../document/controls';
import type { Session } from '../document/session';

/** A sound that steers: its outline, coloured by what the clip does, heard in time with the motion. */
export class SoundBoard {
  readonly element: HTMLElement;
  readonly values: { onchange: (values: readonly number[]) => void } = { onchange: () => undefined };
  readonly #canvas = h('canvas', { role: 'img', 'aria-label': 'Outline of the sound' });
  readonly #audio = h('audio', { preload: 'auto' });
  readonly #name = h('select', { 'aria-label': 'Sound' });
  readonly #outline = h('input', { type: 'checkbox', role: 'switch' });
  readonly #empty: HTMLElement;
  readonly #bar: HTMLElement;
  readonly #draw: () => void;
  #peaks: readonly number[] = [];
  #seconds = 0;
  #shown = '';

  constructor(
    readonly session: Session,
    readonly controls: Controls,
    pick: () => void,
  ) {
    this.#empty = h('div', { class: 'nothing' }, h('b', {}, 'Music or speech steers the motion'), h('span', {}, 'Drop a WAV, MP3, FLAC or Ogg file anywhere.'), h('button', { type: 'button', class: 'quiet', onclick: pick }, 'Choose a sound'));
    this.#bar = h('div', { class: 'editor-foot' }, this.#name, h('label', { class: 'switch' }, this.#outline, h('span', {}, 'Follow the waveform only')), h('button', { type: 'button', class: 'quiet', onclick: pick }, 'Other'));
    this.element = h('div', { class: 'board editor' }, this.#canvas, this.#empty, this.#bar, this.#audio);
    this.#draw = painter(() => this.#render(), this.#canvas);
    onResize(this.#canvas, this.#draw);
    for (const signal of [theme, session.used, session.player.seconds]) signal.subscribe(this.#draw);
    const change = () => controls.set({ kind: 'sound', sound: this.#name.value, smooth: null, outline: this.#outline.checked }, 'Sound');
    this.#name.addEventListener('change', change);
    this.#outline.addEventListener('change', change);
    session.store.document.watch(({ control, sounds }) => {
      this.#name.replaceChildren(...sounds.map((sound) => h('option', { value: sound.id }, sound.name)));
      const sound = control?.kind === 'sound' ? control.sound : '';
      this.#empty.hidden = sound !== '';
      this.#bar.hidden = sound === '';
      if (control?.kind === 'sound') {
        this.#name.value = sound;
        this.#outline.checked = control.outline;
      }
      void this.#show(sound);
    });
    this.#keepTime();
  }

  async #show(sound: string): Promise<void> {
    if (sound === this.#shown) return;
    this.#shown = sound;
    this.#peaks = [];
    this.#audio.pause();
    if (sound === '') {
      this.#audio.removeAttribute('src');
      this.#draw();
      return;
    }
    const [file, { peaks, seconds }] = await Promise.all([bytes(`sounds/${sound}/file`), get<Outline>(`sounds/${sound}/outline?points=400`)]);
    if (sound !== this.#shown) return;
    // Whole in memory: browsers find no place in a file that comes as a stream, and begin anew instead.
    URL.revokeObjectURL(this.#audio.src);
    this.#audio.src = URL.createObjectURL(new Blob([file]));
    [this.#peaks, this.#seconds] = [peaks, seconds];
    this.values.onchange(peaks);
    this.#draw();
  }

  /** The sound goes with the motion; it is put right when it is more than a tenth of a second off. */
  #keepTime(): void {
    const { player } = this.session;
    const place = () => (player.duration.value > 0 ? (player.seconds.value / player.duration.value) * this.#seconds : 0);
    const active = () => this.#shown !== '' && this.controls.kind.value === 'sound' && this.#seconds > 0;
    player.playing.subscribe((is) => {
      if (!active()) return;
      if (!is) {
        this.#audio.pause();
        return;
      }
      this.#audio.currentTime = place();
      // A browser may refuse sound before the first click: then it is silent, and says so nowhere.
      void this.#audio.play().catch(() => undefined);
    });
    player.speed.subscribe((speed) => (this.#audio.playbackRate = speed * this.#stretch()));
    player.duration.subscribe(() => (this.#audio.playbackRate = player.speed.value * this.#stretch()));
    player.seconds.subscribe(() => {
      if (active() && Math.abs(this.#audio.currentTime - place()) > (player.playing.value ? 0.12 : 0.01) && !this.#audio.seeking) this.#audio.currentTime = place();
    });
    this.controls.kind.subscribe(() => this.#audio.pause());
  }

  #stretch(): number {
    const { duration } = this.session.player;
    return duration.value > 0 && this.#seconds > 0 ? Math.min(Math.max(this.#seconds / duration.value, 0.0625), 16) : 1;
  }

  #render(): void {
    const { context, width, height } = fit(this.#canvas);
    const count = this.#peaks.length;
    if (count === 0) return;
    const now = theme.value;
    const { used, source, player } = this.session;
    const frames = used.value?.frames;
    const [left, inner, middle] = [66, width - 90, (height - 60) / 2 + 20];
    const part = player.duration.value > 0 ? player.seconds.value / player.duration.value : 0;
    this.#peaks.forEach((peak, i) => {
      const at = i / count;
      const frame = frames?.[Math.round(at * (frames.length - 1))];
      const tone = frame === undefined ? now.ink : rampAt(now.ramp, frame / Math.max(source.value.frames - 1, 1));
      const half = Math.max(0.8, peak * middle * 0.62);
      context.fillStyle = css(tone, at <= part ? 1 : 0.5);
      context.fillRect(left + at * inner, middle - half, Math.max((inner / count) * 0.66, 0.8), 2 * half);
    });
    context.fillStyle = css(now.ink);
    context.fillRect(left + part * inner, 40, 1.5, height - 120);
  }
}
