import { Signal } from '../base/signal';
import { clamp } from '../base/maths';

export const SPEEDS = [0.25, 0.5, 1, 2] as const;

/** Where in time one is, and whether it goes on. */
export class Player {
  readonly seconds = new Signal(0);
  readonly playing = new Signal(false);
  readonly looping = new Signal(true);
  readonly speed = new Signal(1);
  readonly duration = new Signal(0);
  /** Frames a second of what is played: the length of a step. */
  rate = 30;
  #before = 0;
  #frame = 0;

  play(): void {
    if (this.playing.value || this.duration.value <= 0) return;
    if (this.seconds.value >= this.duration.value - 1e-3) this.seconds.value = 0;
    this.playing.value = true;
    this.#before = performance.now();
    this.#frame = requestAnimationFrame((now) => this.#tick(now));
  }

  pause(): void {
    cancelAnimationFrame(this.#frame);
    this.playing.value = false;
  }

  toggle(): void {
    if (this.playing.value) this.pause();
    else this.play();
  }

  seek(seconds: number): void {
    this.seconds.value = clamp(seconds, 0, this.duration.value);
  }

  /** To the next whole frame in a direction; stops. */
  step(frames: number): void {
    this.pause();
    this.seek((Math.round(this.seconds.value * this.rate) + frames) / this.rate);
  }

  setDuration(seconds: number): void {
    this.duration.value = seconds;
    if (this.seconds.value > seconds) this.seek(seconds);
    if (seconds <= 0) this.pause();
  }

  #tick(now: number): void {
    if (!this.playing.value) return;
    // A page that was in the background does not leap.
    const passed = Math.min((now - this.#before) / 1000, 0.25) * this.speed.value;
    this.#before = now;
    const end = this.duration.value;
    const next = this.seconds.value + passed;
    if (next >= end && !this.looping.value) {
      this.seconds.value = end;
      this.playing.value = false;
      return;
    }
    this.seconds.value = end > 0 ? next % end : 0;
    this.#frame = requestAnimationFrame((at) => this.#tick(at));
  }
}
