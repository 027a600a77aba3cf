import { DirectionalLight, Fog, HemisphereLight, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from 'three';

import type { MadeFrame } from '../api/types';
import { blend } from '../base/colour';
import { drawByProcessor, onResize, painter } from '../base/dom';
import type { Vec3 } from '../base/maths';
import { theme, type Theme } from '../base/theme';
import { FINE, PLAIN } from './capsule';
import { Drawn } from './drawn';
import { colour, Figure, type Tint } from './figure';
import { Ground } from './ground';
import { duration, facing, outline, poseAt, type Motion } from './motion';
import { Orbit } from './orbit';
import { endJoints, Trails } from './trails';

/** What may be switched in the viewport. */
export interface View {
  readonly follow: boolean;
  readonly ground: boolean;
  readonly ghosts: boolean;
  readonly trails: boolean;
  readonly compare: boolean;
  readonly drawn: boolean;
}

const GHOSTS = [-0.5, -0.25, 0.25, 0.5];

/** The picture of the character: drawn when something changed, never else. */
export class Stage {
  readonly canvas: HTMLCanvasElement;
  /** Whether more pictures follow at once: then none is worth being drawn finely. */
  moving = false;
  /** After each picture. */
  onrender: () => void = () => undefined;
  readonly draw: () => void;
  readonly orbit: Orbit;
  readonly #renderer: WebGLRenderer;
  readonly #scene = new Scene();
  readonly #camera = new PerspectiveCamera(32, 1, 0.02, 1000);
  readonly #sky = new HemisphereLight(0xffffff, 0x8890a0, 1.9);
  readonly #sun = new DirectionalLight(0xffffff, 2.1);
  readonly #trails = new Trails();
  readonly #drawn = new Drawn();
  #ground: Ground | null = null;
  #motion: Motion | null = null;
  #source: Motion | null = null;
  #figure: Figure | null = null;
  #compare: Figure | null = null;
  #red: Figure | null = null;
  #ghosts: Figure[] = [];
  #view: View = { follow: true, ground: true, ghosts: false, trails: false, compare: false, drawn: true };
  #board: { frames: readonly MadeFrame[]; chosen: MadeFrame | null } = { frames: [], chosen: null };
  #seconds = 0;
  #sourceSeconds = 0;
  #keyPose: Float32Array | null = null;
  #keyTimes: readonly number[] = [];
  #size = { tall: 1.7, reach: 0.6 };
  #density = Math.min(window.devicePixelRatio || 1, 2);
  #slow = 0;
  #sharpen = 0;
  #sharp = false;
  readonly #software: boolean;
  #skin: { update(seconds: number): void } | null = null;

  constructor(canvas: HTMLCanvasElement) {
    this.canvas = canvas;
    const software = isSoftware();
    this.#software = software;
    if (software) {
      drawByProcessor();
      this.#density = 1;
    }
    // Smooth edges cost four times the pixels: too much for a processor that the solver shares.
    this.#renderer = new WebGLRenderer({ canvas, antialias: !software, stencil: true, powerPreference: 'high-performance' });
    this.draw = painter(() => this.#render());
    this.orbit = new Orbit(this.#camera, canvas, this.draw);
    this.#sun.position.set(0.42, 1, 0.28);
    this.#scene.add(this.#sky, this.#sun, this.#trails.object, this.#drawn.object);
    onResize(canvas, () => this.#resize());
    theme.subscribe(() => this.#restyle());
    this.#restyle();
  }

  get motion(): Motion | null {
    return this.#motion;
  }

  get scene(): Scene {
    return this.#scene;
  }

  /** Another motion. Of the same character, the camera stays where it is. */
  show(motion: Motion): void {
    const before = this.#motion;
    this.#motion = motion;
    if (before === null || !sameBody(before, motion)) {
      this.#size = outline(motion);
      this.#build();
      this.frame();
    } else if (before.body.size !== motion.body.size) {
      this.#build();
    }
    this.#retrail();
    this.#redrawn();
    this.draw();
  }

  /** The clip that poses are taken of, shown beside the result. */
  showSource(source: Motion | null): void {
    this.#source = source;
    this.#build();
    this.draw();
  }

  set view(view: View) {
    this.#view = view;
    this.#build();
    this.#retrail();
    this.#redrawn();
    this.draw();
  }

  get view(): View {
    return this.#view;
  }

  /** The moments of the result and of the source that are seen. */
  seek(seconds: number, sourceSeconds: number): void {
    this.#seconds = seconds;
    this.#sourceSeconds = sourceSeconds;
    this.draw();
  }

  /** Exact keys of the motion, at whose times the body turns red. */
  set keyTimes(times: readonly number[]) {
    this.#keyTimes = times;
    this.draw();
  }

  /** A pose of the source shown in red instead of the character's own; null shows that again. */
  set keyPose(pose: Float32Array | null) {
    this.#keyPose = pose;
    this.draw();
  }

  /** What was drawn of the motion that is shown; nothing where it is of no storyboard. */
  set board(board: { frames: readonly MadeFrame[]; chosen: MadeFrame | null }) {
    this.#board = board;
    this.#redrawn();
    this.draw();
  }

  get board(): { frames: readonly MadeFrame[]; chosen: MadeFrame | null } {
    return this.#board;
  }

  /** What shows the character instead of capsules. */
  set skin(skin: { update(seconds: number): void } | null) {
    this.#skin = skin;
    this.draw();
  }

  get skin(): { update(seconds: number): void } | null {
    return this.#skin;
  }

  /** The joints as they are seen now. */
  pose(): Float32Array {
    const motion = this.#motion;
    return motion ? poseAt(motion, this.#seconds, new Float32Array(3 * motion.body.names.length)) : new Float32Array(0);
  }

  /** Where a place is on the canvas, CSS pixels, and how deep. */
  screen([x, y, z]: Vec3): Vec3 {
    right.set(x, y, z).project(this.#camera);
    return [((right.x + 1) / 2) * this.canvas.clientWidth, ((1 - right.y) / 2) * this.canvas.clientHeight, right.z];
  }

  /** The place that is there on the canvas, so deep. */
  world(x: number, y: number, depth: number): Vec3 {
    right.set((2 * x) / this.canvas.clientWidth - 1, 1 - (2 * y) / this.canvas.clientHeight, depth).unproject(this.#camera);
    return [right.x, right.y, right.z];
  }

  /** Puts the camera back: the character whole, seen from the front. */
  frame(): void {
    if (!this.#motion) return;
    const pose = poseAt(this.#motion, this.#seconds, new Float32Array(3 * this.#motion.body.names.length));
    this.#aim(pose);
    this.orbit.frame(facing(this.#motion.body, pose), this.#size.tall, this.#size.reach, this.#aside());
    this.draw();
  }

  #aside(): number {
    return this.#view.compare && this.#source ? Math.max(1.7 * this.#size.reach, 0.5 * this.#size.tall) : 0;
  }

  #aim(pose: Float32Array): void {
    if (!this.#motion) return;
    const joint = 3 * this.#motion.body.travel;
    this.orbit.target.set(pose[joint] ?? 0, 0.5 * this.#size.tall, pose[joint + 2] ?? 0);
    if (this.#aside() > 0) this.orbit.target.addScaledVector(this.orbit.right(right), this.#aside() / 2);
  }

  #build(): void {
    for (const figure of [this.#figure, this.#compare, this.#red, ...this.#ghosts]) figure?.dispose();
    this.#ground?.dispose();
    [this.#figure, this.#compare, this.#red, this.#ghosts, this.#ground] = [null, null, null, [], null];
    const motion = this.#motion;
    if (!motion) return;
    const now = theme.value;
    const look = { shadow: shade(now), detail: this.#software ? PLAIN : FINE };
    this.#figure = new Figure(motion, sides(now), look);
    this.#red = new Figure(motion, one(now.key), look);
    if (this.#view.compare && this.#source) {
      this.#compare = new Figure(this.#source, one(blend(now.ghost, now.stage, 0.15)), look);
    }
    if (this.#view.ghosts) this.#ghosts = GHOSTS.map((_, i) => new Figure(motion, one(now.ghost), { opacity: 0.2, order: 2 + i, detail: look.detail }));
    for (const figure of [this.#figure, this.#red, this.#compare, ...this.#ghosts]) if (figure) this.#scene.add(figure.object);
    if (this.#view.ground) {
      this.#ground = new Ground(this.#size.tall, now.grid);
      this.#scene.add(this.#ground.object);
    }
  }

  #retrail(): void {
    const shown = this.#view.trails ? this.#motion : null;
    this.#trails.show(shown, shown ? endJoints(shown) : [], theme.value.trail);
  }

  #redrawn(): void {
    this.#drawn.show(this.#view.drawn ? this.#motion : null, this.#board.frames, this.#board.chosen, theme.value, PLAIN);
  }

  #restyle(): void {
    const now = theme.value;
    this.#scene.background = colour(now.stage);
    this.#scene.fog = new Fog(colour(now.stage), 1, 10);
    this.#sky.groundColor = colour(blend(now.stage, now.middle, 0.4));
    this.#sky.intensity = now.dark ? 1.7 : 2.1;
    this.#build();
    this.#retrail();
    this.#redrawn();
    this.draw();
  }

  #resize(): void {
    const [width, height] = [Math.max(this.canvas.clientWidth, 1), Math.max(this.canvas.clientHeight, 1)];
    this.#sharp = false;
    this.#fit(this.#density);
    this.#camera.aspect = width / height;
    this.#camera.updateProjectionMatrix();
    this.#trails.resize(width, height);
    this.#drawn.resize(width, height);
    this.#render();
  }

  #render(): void {
    this.#sharpenLater();
    const begin = performance.now();
    const motion = this.#motion;
    if (motion) this.#place(motion);
    this.orbit.apply();
    const far = this.orbit.distance;
    if (this.#scene.fog instanceof Fog) {
      this.#scene.fog.near = far * 0.9;
      this.#scene.fog.far = far * 3 + 4 * this.#size.tall;
    }
    this.#camera.near = far * 0.02;
    this.#camera.far = far * 6 + 10 * this.#size.tall;
    this.#camera.updateProjectionMatrix();
    this.#renderer.render(this.#scene, this.#camera);
    this.onrender();
    this.#adapt(performance.now() - begin);
  }

  /** Without a graphics card the picture is coarse while it moves, and drawn once more finely when it rests. */
  #sharpenLater(): void {
    if (!this.#software) return;
    window.clearTimeout(this.#sharpen);
    if (this.#sharp) {
      this.#sharp = false;
      this.#fit(this.#density);
    }
    if (this.moving) return;
    this.#sharpen = window.setTimeout(() => {
      this.#sharp = true;
      this.#fit(2);
      this.#renderer.render(this.#scene, this.#camera);
    }, 400);
  }

  #fit(density: number): void {
    this.#renderer.setPixelRatio(density);
    this.#renderer.setSize(Math.max(this.canvas.clientWidth, 1), Math.max(this.canvas.clientHeight, 1), false);
  }

  #place(motion: Motion): void {
    const width = 3 * motion.body.names.length;
    const pose = poseAt(motion, this.#seconds, scratch(0, width));
    if (this.#view.follow) this.#aim(pose);
    const joint = 3 * motion.body.travel;
    this.#ground?.follow(pose[joint] ?? 0, pose[joint + 2] ?? 0);
    const keyed = this.#keyTimes.some((time) => Math.abs(time - this.#seconds) < 0.6 / motion.rate);
    const red = this.#keyPose ?? (keyed ? pose : null);
    if (this.#figure) {
      this.#figure.pose(pose);
      this.#figure.object.visible = this.#skin === null && red === null;
    }
    this.#skin?.update(this.#seconds);
    if (this.#view.trails) this.#trails.seek(this.#seconds);
    if (this.#red) {
      this.#red.object.visible = red !== null;
      if (red) this.#red.pose(red === pose ? pose : onto(red, pose, motion, scratch(1, width)));
    }
    this.#ghosts.forEach((ghost, i) => {
      const at = this.#seconds + (GHOSTS[i] ?? 0);
      ghost.object.visible = at >= 0 && at <= duration(motion);
      ghost.pose(poseAt(motion, at, scratch(1, width)));
    });
    if (this.#compare && this.#source) {
      const source = poseAt(this.#source, this.#sourceSeconds, scratch(2, 3 * this.#source.body.names.length));
      const moved = onto(source, pose, motion, scratch(3, source.length), this.#source);
      this.#compare.pose(moved, right.copy(this.orbit.right(right)).multiplyScalar(this.#aside()));
    }
  }

  /** Without a graphics card fewer pixels keep the motion smooth. */
  #adapt(took: number): void {
    this.#slow = took > 26 ? this.#slow + 1 : Math.max(this.#slow - 0.5, 0);
    if (this.#slow < 8 || this.#density <= 1) return;
    this.#slow = 0;
    this.#density = Math.max(1, this.#density * 0.75);
    this.#resize();
  }
}

/** Whether the browser computes 3D on the processor; asked of a context that is given back at once. */
function isSoftware(): boolean {
  const gl = document.createElement('canvas').getContext('webgl2');
  const names = gl?.getExtension('WEBGL_debug_renderer_info');
  const found = gl && names ? String(gl.getParameter(names.UNMASKED_RENDERER_WEBGL)) : '';
  gl?.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|software/i.test(found);
}

const right = new Vector3();
const scratches: Float32Array[] = [];

function scratch(slot: number, length: number): Float32Array {
  const held = scratches[slot];
  if (held?.length === length) return held;
  return (scratches[slot] = new Float32Array(length));
}

/** A pose moved and turned on the ground so that it stands and faces as another does. */
function onto(pose: Float32Array, like: Float32Array, motion: Motion, out: Float32Array, own: Motion = motion): Float32Array {
  const [a, b] = [3 * own.body.travel, 3 * motion.body.travel];
  const turn = facing(motion.body, like) - facing(own.body, pose);
  const [c, s] = [Math.cos(turn), Math.sin(turn)];
  for (let i = 0; i < pose.length; i += 3) {
    const [x, z] = [(pose[i] ?? 0) - (pose[a] ?? 0), (pose[i + 2] ?? 0) - (pose[a + 2] ?? 0)];
    out[i] = (like[b] ?? 0) + c * x + s * z;
    out[i + 1] = pose[i + 1] ?? 0;
    out[i + 2] = (like[b + 2] ?? 0) + c * z - s * x;
  }
  return out;
}

/** Bones of motions that were made of a storyboard differ by a little from one to the next. */
function sameBody(a: Motion, b: Motion): boolean {
  return a.body === b.body || (a.body.names.length === b.body.names.length && a.body.names.every((name, i) => name === b.body.names[i]) && Math.abs(a.body.size - b.body.size) < 0.05 * a.body.size);
}

function sides(theme: Theme): Tint {
  return { left: theme.left, right: theme.right, middle: theme.middle };
}

function one(rgb: Theme['ink']): Tint {
  return { left: rgb, right: rgb, middle: rgb };
}

function shade(theme: Theme): Theme['ink'] {
  return theme.dark ? [0, 0, 0] : blend(theme.ink, theme.stage, 0.1);
}
