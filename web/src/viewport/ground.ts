import { BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments } from 'three';

import type { Rgb } from '../base/colour';
import { colour } from './figure';

const CELLS = 16;
/** Cells that one piece of a line crosses. */
const PIECE = 2;

/** Lines on y = 0 that fade with distance by the scene's fog and go along with the character. */
export class Ground {
  readonly object: LineSegments;
  readonly #cell: number;

  constructor(tall: number, line: Rgb) {
    this.#cell = roundStep(0.55 * tall);
    const points: number[] = [];
    // Short pieces: some drivers drop lines that pass behind the camera.
    for (let i = -CELLS; i <= CELLS; i += 1) {
      for (let j = -CELLS; j < CELLS; j += PIECE) {
        const [at, from, to] = [i * this.#cell, j * this.#cell, (j + PIECE) * this.#cell];
        points.push(from, 0, at, to, 0, at, at, 0, from, at, 0, to);
      }
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(new Float32Array(points), 3));
    this.object = new LineSegments(geometry, new LineBasicMaterial({ color: colour(line), depthWrite: false }));
    this.object.renderOrder = -2;
    this.object.frustumCulled = false;
  }

  /** Metres between two lines. */
  get cell(): number {
    return this.#cell;
  }

  follow(x: number, z: number): void {
    this.object.position.set(Math.round(x / this.#cell) * this.#cell, 0, Math.round(z / this.#cell) * this.#cell);
  }

  dispose(): void {
    this.object.removeFromParent();
    this.object.geometry.dispose();
    const material = this.object.material;
    if (!Array.isArray(material)) material.dispose();
  }
}

/** 1, 2 or 5 times a power of ten, at most `value`. */
function roundStep(value: number): number {
  const power = 10 ** Math.floor(Math.log10(Math.max(value, 1e-6)));
  return power * ([5, 2, 1].find((factor) => factor * power <= value * 1.001) ?? 1);
}
