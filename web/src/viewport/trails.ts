import { Object3D, Vector2 } from 'three';
import { Line2 } from 'three/examples/jsm/lines/Line2.js';
import { LineGeometry } from 'three/examples/jsm/lines/LineGeometry.js';
import { LineMaterial } from 'three/examples/jsm/lines/LineMaterial.js';

import type { Rgb } from '../base/colour';
import { colour } from './figure';
import type { Motion } from './motion';

/** The ways of some joints through the world, as lines of two pixels. */
export class Trails {
  readonly object = new Object3D();
  readonly #material = new LineMaterial({ linewidth: 2, transparent: true, opacity: 0.85, fog: true });

  constructor() {
    this.object.renderOrder = 1;
  }

  show(motion: Motion | null, joints: readonly number[], shade: Rgb): void {
    this.clear();
    if (!motion || motion.frames < 2) return;
    this.#material.color.copy(colour(shade));
    const width = motion.body.names.length;
    const step = Math.max(1, Math.floor(motion.frames / 2000));
    for (const joint of joints) {
      const points: number[] = [];
      for (let frame = 0; frame < motion.frames; frame += step) {
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
