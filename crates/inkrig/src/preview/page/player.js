// Time: playing, stepping, scrubbing.

class Player {
  /** `changed` is called whenever time or playing has changed. */
  constructor(seconds, frameRate, changed) {
    this.seconds = seconds;
    this.frameRate = frameRate;
    this.changed = changed;
    this.now = 0;
    this.playing = false;
    this.speed = 1;
    this.loop = true;
    this.before = 0;
  }

  play() {
    if (this.playing || !(this.seconds > 0)) return;
    if (this.now >= this.seconds) this.now = 0;
    this.playing = true;
    this.before = performance.now();
    requestAnimationFrame((at) => this.tick(at));
    this.changed();
  }

  pause() {
    this.playing = false;
    this.changed();
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  seek(seconds) {
    this.now = clamp(seconds, 0, this.seconds);
    this.changed();
  }

  /** Goes on by whole frames, and stays there. */
  step(frames) {
    this.playing = false;
    const frame = Math.round(this.now * this.frameRate) + frames;
    this.seek(frame / this.frameRate);
  }

  tick(at) {
    if (!this.playing) return;
    // A page in the background gets no frames: do not jump when it comes back.
    this.now += clamp((at - this.before) / 1000, 0, 0.1) * this.speed;
    this.before = at;
    if (this.now >= this.seconds) {
      this.now = this.loop ? this.now % this.seconds : this.seconds;
      this.playing = this.loop;
    }
    this.changed();
    if (this.playing) requestAnimationFrame((next) => this.tick(next));
  }
}

