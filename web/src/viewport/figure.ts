import {
  Bone,
  Color,
  DoubleSide,
  KeepStencilOp,
  Matrix4,
  MeshBasicMaterial,
  MeshLambertMaterial,
  NotEqualStencilFunc,
  Object3D,
  Quaternion,
  ReplaceStencilOp,
  Skeleton,
  SkinnedMesh,
  SRGBColorSpace,
  Vector3,
} from 'three';

import type { Rgb } from '../base/colour';
import { bodyGeometry } from './capsule';
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
  readonly #bones: Bone[];
  readonly #shadowBones: Bone[] = [];
  readonly #lengths: number[];
  readonly #mesh: SkinnedMesh;
  readonly #limbs: Motion['body']['limbs'];
  readonly #shadow: SkinnedMesh | null = null;

  constructor(motion: Motion, tint: Tint, options: { opacity?: number; shadow?: Rgb; order?: number } = {}) {
    this.#limbs = motion.body.limbs;
    this.#lengths = this.#limbs.map((limb) => distance(motion.positions, limb.from, limb.to));
    const colours = this.#limbs.map((limb) => colour(tint[limb.side]));
    const geometry = bodyGeometry(motion.body, this.#lengths, colours);
    const opacity = options.opacity ?? 1;
    const material = new MeshLambertMaterial({ vertexColors: true, transparent: opacity < 1, opacity, depthWrite: true });
    this.#bones = this.#limbs.map(bone);
    this.#mesh = skinned(geometry, material, this.#bones);
    this.#mesh.renderOrder = options.order ?? 0;
    this.object.add(this.#mesh);
    if (opacity < 1) {
      // Depth first, so that limbs do not shine through each other.
      const solid = new SkinnedMesh(geometry, new MeshBasicMaterial({ colorWrite: false, transparent: true }));
      solid.frustumCulled = solid.matrixAutoUpdate = false;
      solid.bind(this.#mesh.skeleton, new Matrix4());
      solid.renderOrder = this.#mesh.renderOrder - 0.5;
      this.object.add(solid);
    }
    if (options.shadow) {
      this.#shadowBones = this.#limbs.map(bone);
      this.#shadow = skinned(geometry, shadowMaterial(options.shadow), this.#shadowBones);
      this.#shadow.renderOrder = -1;
      this.object.add(this.#shadow);
    }
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
      const matrix = this.#bones[place]?.matrixWorld;
      matrix?.compose(from.add(aside), turn, scale);
      const shadow = this.#shadowBones[place]?.matrixWorld;
      if (matrix && shadow) shadow.multiplyMatrices(FLAT, matrix);
    });
  }

  dispose(): void {
    this.object.removeFromParent();
    this.#mesh.geometry.dispose();
    for (const mesh of [this.#mesh, this.#shadow]) {
      mesh?.skeleton.dispose();
      const material = mesh?.material;
      if (material && !Array.isArray(material)) material.dispose();
    }
  }
}

const ZERO = new Vector3();
const [from, to, along, scale, turn] = [new Vector3(), new Vector3(), new Vector3(), new Vector3(), new Quaternion()];
/** Onto the ground along the light, a hair above it. */
const FLAT = new Matrix4().set(1, SHADOW.x, 0, 0, 0, 0, 0, 0.002, 0, SHADOW.z, 1, 0, 0, 0, 0, 1);

export function colour(rgb: Rgb): Color {
  return new Color().setRGB(rgb[0] / 255, rgb[1] / 255, rgb[2] / 255, SRGBColorSpace);
}

function bone(): Bone {
  const bone = new Bone();
  bone.matrixAutoUpdate = false;
  bone.matrixWorldAutoUpdate = false;
  return bone;
}

function skinned(geometry: ReturnType<typeof bodyGeometry>, material: MeshLambertMaterial | MeshBasicMaterial, bones: Bone[]): SkinnedMesh {
  const mesh = new SkinnedMesh(geometry, material);
  mesh.frustumCulled = false;
  mesh.matrixAutoUpdate = false;
  // Bones are given in the world, and stand at the origin when bound.
  mesh.bind(new Skeleton(bones, bones.map(() => new Matrix4())), new Matrix4());
  return mesh;
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
