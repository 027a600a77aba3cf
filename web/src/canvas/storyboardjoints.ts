import { css, type Rgb } from '../base/colour';
import type { Vec2 } from '../base/maths';
import { theme } from '../base/theme';
import type { Storyboard } from '../document/storyboard';
import type { BoardFrame } from '../document/storyboardfile';
import { toPixels, toUnits, type View } from './storyboardview';

/** Bones between joints that were read. */
const BONES: readonly (readonly [string, string])[] = [
  ['pelvis', 'spine3'], ['spine3', 'neck'], ['neck', 'head'],
  ['pelvis', 'left_hip'], ['left_hip', 'left_knee'], ['left_knee', 'left_ankle'], ['left_ankle', 'left_foot'],
  ['pelvis', 'right_hip'], ['right_hip', 'right_knee'], ['right_knee', 'right_ankle'], ['right_ankle', 'right_foot'],
  ['neck', 'left_shoulder'], ['left_shoulder', 'left_elbow'], ['left_elbow', 'left_wrist'],
  ['neck', 'right_shoulder'], ['right_shoulder', 'right_elbow'], ['right_elbow', 'right_wrist'],
];

/** How near to a joint, in CSS pixels, takes hold of it. */
const NEAR = 16;
/** Two taps within this time, milliseconds, take a pin away. */
const TWICE = 400;
/** A step of an arrow key, canvas units; ten with Shift. */
const STEP = 2;

interface Joint {
  readonly name: string;
  readonly at: Vec2;
  readonly confidence: number;
  readonly pinned: boolean;
}

/** The joints of a figure over its ink: those that were read, and those that were put where they belong by hand. */
export class Joints {
  /** Whether they can be taken hold of. */
  held = false;
  #chosen: string | null = null;
  #tapped = { name: '', at: 0 };
  #moved: { name: string; at: Vec2 } | null = null;

  constructor(
    readonly story: Storyboard,
    readonly view: () => View,
    readonly draw: () => void,
    readonly say: (text: string) => void,
  ) {
    story.chosen.subscribe(() => (this.#chosen = this.#moved = null));
  }

  /** Takes hold of the joint under a place, in CSS pixels; whether there is one. */
  grab(at: Vec2): boolean {
    const joint = this.#near(at);
    this.#chosen = joint?.name ?? null;
    this.draw();
    if (!joint) return false;
    this.#moved = { name: joint.name, at: joint.at };
    return true;
  }

  drag([x, y]: Vec2): void {
    if (!this.#moved) return;
    this.#moved = { name: this.#moved.name, at: toUnits(this.view(), x, y) };
    this.draw();
  }

  /** Lets go: the joint is pinned where it is now. A tap chooses it, two take its pin away. */
  release(cancelled: boolean): void {
    const moved = this.#moved;
    this.#moved = null;
    if (!moved || cancelled) return;
    const was = this.#all(this.story.frame).find(({ name }) => name === moved.name);
    const apart = was ? this.view().scale * Math.hypot(was.at[0] - moved.at[0], was.at[1] - moved.at[1]) : Infinity;
    if (apart > 3) this.#pin(moved.name, moved.at);
    else if (this.#tapped.name === moved.name && performance.now() - this.#tapped.at < TWICE) this.story.unpin(moved.name);
    this.#tapped = { name: apart > 3 ? '' : moved.name, at: performance.now() };
  }

  /** Keys while the sheet has the focus: J chooses, arrows move, Delete takes the pin away. */
  key(key: string, shift: boolean): boolean {
    const all = this.#all(this.story.frame);
    const at = all.findIndex(({ name }) => name === this.#chosen);
    const joint = all[at];
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[key];
    if (key.toLowerCase() === 'j' && all.length > 0) {
      const next = all[(at + (shift ? -1 : 1) + all.length + (at < 0 && shift ? 1 : 0)) % all.length];
      this.#chosen = next?.name ?? null;
      this.say(next ? `${said(next.name)}${next.pinned ? ', pinned' : ''}` : '');
      this.draw();
    } else if (joint && way) {
      const step = shift ? 10 * STEP : STEP;
      this.#pin(joint.name, [joint.at[0] + step * (way[0] ?? 0), joint.at[1] + step * (way[1] ?? 0)]);
    } else if (joint && (key === 'Delete' || key === 'Backspace')) {
      this.story.unpin(joint.name);
      this.say(`${said(joint.name)} is free`);
    } else return false;
    return true;
  }

  /** Left red and right blue as on sheets, pale where they are not sure; pins are squares in a ring. */
  paint(context: CanvasRenderingContext2D, frame: BoardFrame): void {
    const all = this.#all(frame);
    const places = new Map(all.map((joint) => [joint.name, joint]));
    const view = this.view();
    for (const [from, to] of BONES) {
      const [a, b] = [places.get(from), places.get(to)];
      if (!a || !b) continue;
      context.beginPath();
      context.moveTo(...toPixels(view, ...a.at));
      context.lineTo(...toPixels(view, ...b.at));
      context.lineWidth = 1.5;
      context.strokeStyle = css(colourOf(to), 0.35 + 0.5 * Math.min(a.confidence, b.confidence));
      context.stroke();
    }
    for (const joint of all) {
      const [x, y] = toPixels(view, ...joint.at);
      const size = this.held ? 5 : 4;
      context.beginPath();
      if (joint.pinned) context.rect(x - 4.5, y - 4.5, 9, 9);
      else context.arc(x, y, size, 0, 2 * Math.PI);
      context.fillStyle = css(colourOf(joint.name), joint.pinned ? 1 : 0.3 + 0.7 * joint.confidence);
      context.fill();
      const chosen = this.held && joint.name === this.#chosen;
      if (!joint.pinned && !chosen) continue;
      context.beginPath();
      context.arc(x, y, chosen ? 11 : 9, 0, 2 * Math.PI);
      context.lineWidth = chosen ? 2 : 1.5;
      context.strokeStyle = css(chosen ? theme.value.accent : theme.value.ink, 0.9);
      context.stroke();
      if (!chosen) continue;
      context.font = '12px system-ui, sans-serif';
      context.textBaseline = 'middle';
      context.lineWidth = 3;
      context.strokeStyle = css(theme.value.paper);
      context.fillStyle = css(theme.value.ink);
      context.strokeText(said(joint.name), x + 16, y);
      context.fillText(said(joint.name), x + 16, y);
    }
  }

  #pin(name: string, [x, y]: Vec2): void {
    this.story.pin(name, [Number(x.toFixed(1)), Number(y.toFixed(1))]);
  }

  #near([x, y]: Vec2): Joint | null {
    let [found, least]: [Joint | null, number] = [null, NEAR];
    for (const joint of this.#all(this.story.frame)) {
      const [jx, jy] = toPixels(this.view(), ...joint.at);
      const apart = Math.hypot(jx - x, jy - y);
      if (apart < least) [found, least] = [joint, apart];
    }
    return found;
  }

  #all(frame: BoardFrame): Joint[] {
    const pins = new Map((frame.pins ?? []).map(({ joint, at }) => [joint, at]));
    const read = this.story.told()?.made.joints ?? [];
    const all = read.map(({ name, x, y, confidence }): Joint => ({ name, at: pins.get(name) ?? [x, y], confidence, pinned: pins.has(name) }));
    for (const [name, at] of pins) if (!read.some((joint) => joint.name === name)) all.push({ name, at, confidence: 1, pinned: true });
    const moved = this.#moved;
    return moved ? all.map((joint) => (joint.name === moved.name ? { ...joint, at: moved.at, pinned: true } : joint)) : all;
  }
}

function colourOf(name: string): Rgb {
  return name.startsWith('left') ? [222, 70, 70] : name.startsWith('right') ? [70, 120, 235] : [140, 140, 150];
}

function said(name: string): string {
  return name.replaceAll('_', ' ');
}
