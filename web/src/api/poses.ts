import type { Body, Motion } from '../viewport/motion';
import type { ClipDetail, SkeletonInfo } from './types';

/** A skeleton as the page needs it: what is drawn, and what poses are computed with. */
export interface Rig {
  readonly body: Body;
  readonly parents: Int32Array;
  /** joints x 3, metres. */
  readonly offsets: Float32Array;
}

/** Motion as it came, with where its frames are from. */
export interface Poses {
  readonly motion: Motion;
  readonly kind: 'clip' | 'live' | 'result';
  readonly revision: number;
  readonly stroke: number;
  readonly message: number;
  readonly level: number;
  readonly levels: number;
  readonly final: boolean;
  readonly loop: boolean;
  readonly full: boolean;
  readonly milliseconds: number;
  /** Source frame of every control sample, counted through all source clips. */
  readonly used: Uint32Array;
  readonly sampleRate: number;
}

const MAGIC = 0x31504b49;
const HEADER = 64;
const KINDS = ['clip', 'live', 'result'] as const;

export function rigOf(clip: Pick<ClipDetail, 'limbs'> & { skeleton: SkeletonInfo }): Rig {
  const { joints, travelJoint, height } = clip.skeleton;
  const offsets = new Float32Array(joints.flatMap((joint) => joint.offset));
  const body = { names: joints.map((joint) => joint.name), limbs: clip.limbs, pair: pairOf(clip), travel: travelJoint, size: height };
  return { body, parents: Int32Array.from(joints, (joint) => joint.parent), offsets };
}

/**
 * Reads the server's poses and puts the joints where they are in the world.
 *
 * Throws when the bytes are not poses of that rig.
 */
export function readPoses(buffer: ArrayBuffer, rig: Rig): Poses {
  const view = new DataView(buffer);
  if (buffer.byteLength < HEADER || view.getUint32(0, true) !== MAGIC) throw new Error('these bytes are no poses');
  const [frames, joints, tracks] = [view.getUint32(20, true), view.getUint32(24, true), view.getUint32(28, true)];
  if (joints !== rig.parents.length) throw new Error(`poses of ${joints} joints for a skeleton of ${rig.parents.length}`);
  const samples = view.getUint32(48, true);
  const trackJoints = new Uint16Array(buffer, HEADER, tracks);
  const translationsAt = HEADER + Math.ceil((2 * tracks) / 4) * 4;
  const translations = new Float32Array(buffer, translationsAt, 3 * frames * tracks);
  const rotationsAt = translationsAt + translations.byteLength;
  const rotations = new Int16Array(buffer, rotationsAt, 4 * frames * joints);
  const used = new Uint32Array(buffer, rotationsAt + Math.ceil(rotations.byteLength / 4) * 4, samples);
  const flags = view.getUint32(40, true);
  const positions = inWorld(rig, frames, trackJoints, translations, rotations);
  return {
    motion: { body: rig.body, rate: view.getFloat32(32, true), frames, positions },
    kind: KINDS[view.getUint32(4, true)] ?? 'clip',
    revision: view.getUint32(8, true),
    stroke: view.getUint32(12, true),
    message: view.getUint32(16, true),
    level: view.getUint16(36, true),
    levels: view.getUint16(38, true),
    final: (flags & 1) !== 0,
    loop: (flags & 2) !== 0,
    full: (flags & 8) !== 0,
    milliseconds: view.getFloat32(44, true),
    used: used.slice(),
    sampleRate: view.getFloat32(52, true),
  };
}

function inWorld(rig: Rig, frames: number, trackJoints: Uint16Array, translations: Float32Array, rotations: Int16Array): Float32Array {
  const joints = rig.parents.length;
  const out = new Float32Array(3 * frames * joints);
  const turns = new Float32Array(4 * joints);
  const local = rig.offsets.slice();
  for (let frame = 0; frame < frames; frame += 1) {
    trackJoints.forEach((joint, track) => {
      const at = 3 * (frame * trackJoints.length + track);
      local.set(translations.subarray(at, at + 3), 3 * joint);
    });
    for (let joint = 0; joint < joints; joint += 1) place(joint, rig.parents[joint] ?? -1, frame * joints, local, rotations, turns, out);
  }
  return out;
}

/** position = parent's + parent's rotation x local; rotation = parent's x local. */
function place(joint: number, parent: number, row: number, local: Float32Array, rotations: Int16Array, turns: Float32Array, out: Float32Array): void {
  const r = 4 * (row + joint);
  const [x, y, z, w] = [rotations[r] ?? 0, rotations[r + 1] ?? 0, rotations[r + 2] ?? 0, rotations[r + 3] ?? 0];
  const n = 1 / (Math.sqrt(x * x + y * y + z * z + w * w) || 1);
  const [bx, by, bz, bw] = [x * n, y * n, z * n, w * n];
  const [lx, ly, lz] = [local[3 * joint] ?? 0, local[3 * joint + 1] ?? 0, local[3 * joint + 2] ?? 0];
  const [o, t] = [3 * (row + joint), 4 * joint];
  if (parent < 0) {
    out[o] = lx;
    out[o + 1] = ly;
    out[o + 2] = lz;
    turns[t] = bx;
    turns[t + 1] = by;
    turns[t + 2] = bz;
    turns[t + 3] = bw;
    return;
  }
  const p = 4 * parent;
  const [ax, ay, az, aw] = [turns[p] ?? 0, turns[p + 1] ?? 0, turns[p + 2] ?? 0, turns[p + 3] ?? 1];
  const [cx, cy, cz] = [2 * (ay * lz - az * ly), 2 * (az * lx - ax * lz), 2 * (ax * ly - ay * lx)];
  const q = 3 * (row + parent);
  out[o] = (out[q] ?? 0) + lx + aw * cx + ay * cz - az * cy;
  out[o + 1] = (out[q + 1] ?? 0) + ly + aw * cy + az * cx - ax * cz;
  out[o + 2] = (out[q + 2] ?? 0) + lz + aw * cz + ax * cy - ay * cx;
  turns[t] = aw * bx + ax * bw + ay * bz - az * by;
  turns[t + 1] = aw * by - ax * bz + ay * bw + az * bx;
  turns[t + 2] = aw * bz + ax * by - ay * bx + az * bw;
  turns[t + 3] = aw * bw - ax * bx - ay * by - az * bz;
}

/** The first joints of the two sides that hang on one parent and lie apart: hips or shoulders. */
function pairOf(clip: Pick<ClipDetail, 'limbs'> & { skeleton: SkeletonInfo }): readonly [number, number] | null {
  const sides = new Map(clip.limbs.map((limb) => [limb.to, limb.side]));
  const first = new Map<number, { left?: number; right?: number }>();
  for (const limb of clip.limbs) {
    const side = sides.get(limb.to);
    if (side !== 'left' && side !== 'right') continue;
    const pair = first.get(limb.from) ?? {};
    pair[side] ??= limb.to;
    first.set(limb.from, pair);
  }
  for (const { left, right } of first.values()) {
    if (left === undefined || right === undefined) continue;
    const [a, b] = [clip.skeleton.joints[left]?.offset, clip.skeleton.joints[right]?.offset];
    if (a && b && Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) > 0.01 * clip.skeleton.height) return [left, right];
  }
  return null;
}
