import { Object3D, Vector2 } from 'three';
import { Line2 } from 'three/examples/jsm/lines/Line2.js';
import { LineGeometry } from 'three/examples/jsm/lines/LineGeometry.js';
import { LineMaterial } from 'three/examples/jsm/lines/LineMaterial.js';

import type { MadeFrame } from '../api/types';
import type { Theme } from '../base/theme';
import type { Detail } from './capsule';
import { colour, Figure } from './figure';
import { poseAt, type Motion } from './motion';

/** Most poses that are shown: more would hide each other. */
const MOST = 24;

/** What was drawn on a storyboard, in space: key poses in red, the ways of joints in green. */
export class Drawn {
  readonly object = new Object3D();
  readonly #material = new LineMaterial({ linewidth: 3, transparent: true, opacity: 0.9, fog: true });
  #figures: Figure[] = [];
  #lines: Line2[] = [];

  /** Of an animation; null for nothing. What is drawn on the `chosen` frame stands out. */
  show(motion: Motion | null, frames: readonly MadeFrame[], chosen: MadeFrame | null, theme: Theme, detail: Detail): void {
    for (const figure of this.#figures) figure.dispose();
    for (const line of this.#lines) {
      line.removeFromParent();
      line.geometry.dispose();
    }
    [this.#figures, this.#lines] = [[], []];
    if (!motion) return;
    this.#material.color.copy(colour(theme.trail));
    const places = new Map(motion.body.names.map((name, joint) => [name, joint]));
    for (const part of frames) {
      const { begins, keyFrame, pose, ways } = part;
      const strong = part === chosen || frames.length === 1;
      if (begins === null) continue;
      if (keyFrame !== null && pose.length > 0 && this.#figures.length < MOST) {
        const figure = new Figure(motion, { left: theme.key, right: theme.key, middle: theme.key }, { opacity: strong ? 0.42 : 0.14, order: 8 + this.#figures.length, detail });
        const at = poseAt(motion, (begins + keyFrame) / motion.rate, new Float32Array(3 * motion.body.names.length));
        for (const { name, at: place } of pose) {
          const joint = places.get(name);
          if (joint !== undefined) at.set(place, 3 * joint);
        }
        figure.pose(at);
        this.#figures.push(figure);
      }
      for (const { points } of ways) {
        if (points.length < 2) continue;
        const geometry = new LineGeometry();
        geometry.setPositions(points.flat());
        const line = new Line2(geometry, this.#material);
        line.frustumCulled = false;
        line.renderOrder = 7;
        this.#lines.push(line);
      }
    }
    for (const one of [...this.#figures.map((figure) => figure.object), ...this.#lines]) this.object.add(one);
  }

  resize(width: number, height: number): void {
    this.#material.resolution.copy(new Vector2(width, height));
  }
}
