import { clamp } from '../base/maths';

/** A tapered capsule between two joints; a ball when both are the same. Radii in metres. */
export interface Limb {
  readonly from: number;
  readonly to: number;
  readonly fromRadius: number;
  readonly toRadius: number;
  readonly side: 'left' | 'right' | 'middle';
}

/** What is drawn of a character. */
export interface Body {
  readonly names: readonly string[];
  readonly limbs: readonly Limb[];
  /** A left and a right joint on one parent, by which the body faces somewhere. */
  readonly pair: readonly [number, number] | null;
  /** The joint that the camera follows. */
  readonly travel: number;
  /** The character's size, metres. */
  readonly size: number;
}

/** Places of a body's joints over time: frames x joints x (x, y, z), metres in the world, y up. */
export interface Motion {
  readonly body: Body;
  readonly rate: number;
  readonly frames: number;
  readonly positions: Float32Array;
}

export function duration(motion: Motion): number {
  return Math.max(motion.frames - 1, 0) / motion.rate;
}

/** Writes the pose at a time into `pose` (joints x 3) and returns it. */
export function poseAt(motion: Motion, seconds: number, pose: Float32Array): Float32Array {
  const width = 3 * motion.body.names.length;
  const at = clamp(seconds * motion.rate, 0, Math.max(motion.frames - 1, 0));
  const low = Math.floor(at);
  const part = at - low;
  const a = low * width;
  const b = Math.min(low + 1, motion.frames - 1) * width;
  const { positions } = motion;
  for (let i = 0; i < width; i += 1) {
    const from = positions[a + i] ?? 0;
    pose[i] = from + part * ((positions[b + i] ?? from) - from);
  }
  return pose;
}

/** The direction that the body faces on the ground, as an angle about y; 0 when names do not tell. */
export function facing(body: Body, pose: Float32Array): number {
  if (!body.pair) return 0;
  const [left, right] = body.pair;
  const x = (pose[3 * left] ?? 0) - (pose[3 * right] ?? 0);
  const z = (pose[3 * left + 2] ?? 0) - (pose[3 * right + 2] ?? 0);
  return Math.hypot(x, z) > 0 ? Math.atan2(-z, x) : 0;
}

/** How tall the figure mostly is and how far it reaches sideways from the travelling joint, metres. */
export function outline(motion: Motion): { tall: number; reach: number } {
  const width = motion.body.names.length;
  const used = new Set(motion.body.limbs.flatMap((limb) => [limb.from, limb.to]));
  let [tall, reach] = [0, 0];
  const step = Math.max(1, Math.floor(motion.frames / 60));
  for (let frame = 0; frame < motion.frames; frame += step) {
    const base = 3 * frame * width;
    const [ox, oz] = [motion.positions[base + 3 * motion.body.travel] ?? 0, motion.positions[base + 3 * motion.body.travel + 2] ?? 0];
    for (const joint of used) {
      const at = base + 3 * joint;
      tall = Math.max(tall, motion.positions[at + 1] ?? 0);
      reach = Math.max(reach, Math.hypot((motion.positions[at] ?? 0) - ox, (motion.positions[at + 2] ?? 0) - oz));
    }
  }
  const least = 0.2 * motion.body.size;
  return { tall: Math.max(tall, least), reach: Math.max(reach, least) };
}
