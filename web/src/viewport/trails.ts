import { Object3D, Vector2 } from 'three';
import { Line2 } from 'three/examples/jsm/lines/Line2.js';
import { LineGeometry } from 'three/examples/jsm/lines/LineGeometry.js';
import { LineMaterial } from 'three/examples/jsm/lines/LineMaterial.js';

import type { Rgb } from '../base/colour';
import { colour } from './figure';
import type { Motion } from './motion';

/** How far before and after the moment that is seen, seconds. */
const REACH = 1.2;

/** The ways of some joints through the world around a moment, as lines of two pixels. */
export class Trails {
  readonly object = new Object3D();
  readonly #material = new LineMaterial({ linewidth: 2, transparent: true, opacity: 0.85, fog: true });
  #motion: Motion | null = null;
  #joints: readonly number[] = [];

  constructor() {
    this.object.renderOrder = 1;
  }

  show(motion: Motion | null, joints: readonly number[], shade: Rgb): void {
    this.#motion = motion;
    this.#joints = joints;
    this.#material.color.copy(colour(shade));
    if (!motion) this.clear();
  }

  seek(seconds: number): void {
    this.clear();
    const motion = this.#motion;
    if (!motion) return;
    const width = motion.body.names.length;
    const first = Math.max(Math.floor((seconds - REACH) * motion.rate), 0);
    const last = Math.min(Math.ceil((seconds + REACH) * motion.rate), motion.frames - 1);
    const step = Math.max(1, Math.floor((last - first) / 120));
    if (last - first < step) return;
    for (const joint of this.#joints) {
      const points: number[] = [];
      for (let frame = first; frame <= last; frame += step) {
        const at = 3 * (frame * width + joint);
        points.push(motion.positions[at] ?? 0, motion.positions[at + 1] ?? 0, motion.positions[at + 2] ?? 0);
      }
      const geometry = new LineGeometry();
      geometry.setPositions(points);
      const line = new Line2(geometry, this.#material);
      line.frustumCulled = false;
      this.object.add(line);
    }
  }

  resize(width: number, height: number): void {
    this.#material.resolution.copy(new Vector2(width, height));
  }

  clear(): void {
    for (const child of [...this.object.children]) {
      child.removeFromParent();
      if (child instanceof Line2) child.geometry.dispose();
    }
  }
}

/** The ends of the longest chains (hands, feet, head, tail): what animators watch. */
export function endJoints(motion: Motion, most = 5): number[] {
  const { limbs } = motion.body;
  const starts = new Set(limbs.filter((limb) => limb.from !== limb.to).map((limb) => limb.from));
  const parent = new Map(limbs.map((limb) => [limb.to, limb.from]));
  const depth = (joint: number): number => {
    let [steps, at] = [0, joint];
    for (let up = parent.get(at); up !== undefined && up !== at && steps < 512; up = parent.get(at)) {
      steps += 1;
      at = up;
    }
    return steps;
  };
  const ends = [...new Set(limbs.map((limb) => limb.to))].filter((joint) => !starts.has(joint));
  // Of fingers and toes that end one limb, one will do: the first below each branch that is two joints up.
  const seen = new Set<number>();
  return ends
    .sort((a, b) => depth(b) - depth(a) || a - b)
    .filter((joint) => {
      const above = parent.get(parent.get(joint) ?? joint) ?? joint;
      if (seen.has(above)) return false;
      seen.add(above);
      return true;
    })
    .slice(0, most);
}
