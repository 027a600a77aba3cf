import {
  Color,
  DoubleSide,
  KeepStencilOp,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  NotEqualStencilFunc,
  Object3D,
  Quaternion,
  ReplaceStencilOp,
  SRGBColorSpace,
  Vector3,
} from 'three';

import type { Rgb } from '../base/colour';
import { BodyGeometry, FINE, type Detail } from './capsule';
import type { Motion } from './motion';

/** Colours of the sides of a body. */
export interface Tint {
  readonly left: Rgb;
  readonly right: Rgb;
  readonly middle: Rgb;
}

const UP = new Vector3(0, 1, 0);
/** Towards where shadows fall: across the ground for each metre of height. */
const SHADOW = { x: -0.42, z: -0.28 };

/** A body of capsules that takes any pose of its motion. Optionally see-through, optionally with a shadow on y = 0. */
export class Figure {
  readonly object = new Object3D();
  readonly #places: Matrix4[];
  readonly #lengths: number[];
  readonly #geometry: BodyGeometry;
  readonly #meshes: Mesh[] = [];
  readonly #limbs: Motion['body']['limbs'];

  constructor(motion: Motion, tint: Tint, options: { opacity?: number; shadow?: Rgb; order?: number; detail?: Detail } = {}) {
    this.#limbs = motion.body.limbs;
    this.#lengths = this.#limbs.map((limb) => distance(motion.positions, limb.from, limb.to));
    this.#places = this.#limbs.map(() => new Matrix4());
    const colours = this.#limbs.map((limb) => colour(tint[limb.side]));
    this.#geometry = new BodyGeometry(motion.body, this.#lengths, colours, options.detail ?? FINE, options.shadow ? SHADOW : null);
    const opacity = options.opacity ?? 1;
    const order = options.order ?? 0;
    this.#add(this.#geometry.body, new MeshLambertMaterial({ vertexColors: true, transparent: opacity < 1, opacity }), order);
    // Depth first, so that limbs do not shine through each other.
    if (opacity < 1) this.#add(this.#geometry.body, new MeshBasicMaterial({ colorWrite: false, transparent: true }), order - 0.5);
    if (options.shadow && this.#geometry.shadow) this.#add(this.#geometry.shadow, shadowMaterial(options.shadow), -1);
  }

  /** Puts limbs where `pose` (joints x 3) has its joints, moved by `aside`. */
  pose(pose: Float32Array, aside: Vector3 = ZERO): void {
    this.#limbs.forEach((limb, place) => {
      from.set(pose[3 * limb.from] ?? 0, pose[3 * limb.from + 1] ?? 0, pose[3 * limb.from + 2] ?? 0);
      to.set(pose[3 * limb.to] ?? 0, pose[3 * limb.to + 1] ?? 0, pose[3 * limb.to + 2] ?? 0);
      along.subVectors(to, from);
      const length = along.length();
      const rest = this.#lengths[place] ?? 0;
      turn.setFromUnitVectors(UP, length > 1e-6 ? along.multiplyScalar(1 / length) : UP);
      scale.set(1, rest > 1e-6 && length > 1e-6 ? length / rest : 1, 1);
      this.#places[place]?.compose(from.add(aside), turn, scale);
    });
    this.#geometry.place(this.#places);
  }

  dispose(): void {
    this.object.removeFromParent();
    this.#geometry.dispose();
    for (const mesh of this.#meshes) if (!Array.isArray(mesh.material)) mesh.material.dispose();
  }

  #add(geometry: BodyGeometry['body'], material: MeshLambertMaterial | MeshBasicMaterial, order: number): void {
    const mesh = new Mesh(geometry, material);
    // What is posed is where it is told, and never out of sight by its bounds at rest.
    mesh.frustumCulled = mesh.matrixAutoUpdate = false;
    mesh.renderOrder = order;
    this.#meshes.push(mesh);
    this.object.add(mesh);
  }
}

const ZERO = new Vector3();
const [from, to, along, scale, turn] = [new Vector3(), new Vector3(), new Vector3(), new Vector3(), new Quaternion()];
export function colour(rgb: Rgb): Color {
  return new Color().setRGB(rgb[0] / 255, rgb[1] / 255, rgb[2] / 255, SRGBColorSpace);
}

/** Each pixel of the ground is darkened once, however many limbs are above it. */
function shadowMaterial(shade: Rgb): MeshBasicMaterial {
  return new MeshBasicMaterial({
    color: colour(shade),
    transparent: true,
    opacity: 0.28,
    side: DoubleSide,
    depthWrite: false,
    stencilWrite: true,
    stencilRef: 1,
    stencilFunc: NotEqualStencilFunc,
    stencilFail: KeepStencilOp,
    stencilZFail: KeepStencilOp,
    stencilZPass: ReplaceStencilOp,
  });
}

function distance(positions: Float32Array, a: number, b: number): number {
  const at = (joint: number, axis: number) => positions[3 * joint + axis] ?? 0;
  return Math.hypot(at(a, 0) - at(b, 0), at(a, 1) - at(b, 1), at(a, 2) - at(b, 2));
}
