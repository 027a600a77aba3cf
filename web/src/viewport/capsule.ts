import { BufferAttribute, BufferGeometry, type Color, DynamicDrawUsage, type Matrix4 } from 'three';

import type { Body } from './motion';

/** Into how many pieces a capsule is cut: around it, and along the quarter of a circle that closes it. */
export interface Detail {
  readonly around: number;
  readonly cap: number;
}

export const FINE: Detail = { around: 12, cap: 4 };
/** Without a graphics card every triangle is felt. */
export const PLAIN: Detail = { around: 8, cap: 3 };
/** Of a shadow only the outline is seen. */
const SHADOW: Detail = { around: 6, cap: 2 };

/** Shadows lie a hair above the ground, metres. */
const ABOVE = 0.002;

/** Capsules of all limbs of a body as they are before they are put in their places: standing on the origin, going up. */
class Limbs {
  readonly positions: Float32Array;
  readonly normals: Float32Array;
  readonly index: number[] = [];
  /** Where limbs end, in vertices. */
  readonly ends: number[] = [];

  constructor(body: Body, lengths: readonly number[], { around, cap }: Detail) {
    const [position, normal]: [number[], number[]] = [[], []];
    body.limbs.forEach((limb, place) => {
      const first = position.length / 3;
      const rings = profile(limb.fromRadius, limb.toRadius, limb.from === limb.to ? 0 : (lengths[place] ?? 0), cap);
      for (const ring of rings) {
        for (let i = 0; i <= around; i += 1) {
          const angle = (2 * Math.PI * i) / around;
          const [c, s] = [Math.cos(angle), Math.sin(angle)];
          position.push(ring.radius * c, ring.height, ring.radius * s);
          normal.push(ring.out * c, ring.up, ring.out * s);
        }
      }
      for (let ring = 0; ring + 1 < rings.length; ring += 1) {
        for (let i = 0; i < around; i += 1) {
          const a = first + ring * (around + 1) + i;
          const b = a + around + 1;
          // At the poles one of the two has no area.
          if (ring + 2 < rings.length) this.index.push(a + 1, b, b + 1);
          if (ring > 0) this.index.push(a, b, a + 1);
        }
      }
      this.ends.push(position.length / 3);
    });
    [this.positions, this.normals] = [new Float32Array(position), new Float32Array(normal)];
  }

  /** Writes where vertices are in their places and, where asked for, which way their normals turn. */
  place(limbs: readonly Matrix4[], placed: Float32Array, turned: Float32Array | null): void {
    let vertex = 0;
    this.ends.forEach((end, limb) => {
      const m = limbs[limb]?.elements;
      if (!m) return;
      for (; vertex < end; vertex += 1) {
        const at = 3 * vertex;
        const [px, py, pz] = [this.positions[at] ?? 0, this.positions[at + 1] ?? 0, this.positions[at + 2] ?? 0];
        placed[at] = m[0] * px + m[4] * py + m[8] * pz + m[12];
        placed[at + 1] = m[1] * px + m[5] * py + m[9] * pz + m[13];
        placed[at + 2] = m[2] * px + m[6] * py + m[10] * pz + m[14];
        if (!turned) continue;
        const [nx, ny, nz] = [this.normals[at] ?? 0, this.normals[at + 1] ?? 0, this.normals[at + 2] ?? 0];
        // Limbs are hardly stretched: no need for the inverse.
        turned[at] = m[0] * nx + m[4] * ny + m[8] * nz;
        turned[at + 1] = m[1] * nx + m[5] * ny + m[9] * nz;
        turned[at + 2] = m[2] * nx + m[6] * ny + m[10] * nz;
      }
    });
  }
}

/**
 * A body and its shadow, each one draw call. Limbs are put in their places here and not by the graphics card: a computer
 * without one would take longer for that than for all else.
 */
export class BodyGeometry {
  readonly body = new BufferGeometry();
  /** The same, flat on the ground; null without. */
  readonly shadow: BufferGeometry | null = null;
  readonly #limbs: Limbs;
  readonly #flat: Limbs | null = null;
  readonly #light: { readonly x: number; readonly z: number };

  /** Limbs are `lengths` long. Shadows fall `light` across the ground for each metre of height; none where null. */
  constructor(body: Body, lengths: readonly number[], colours: readonly Color[], detail: Detail, light: { readonly x: number; readonly z: number } | null) {
    this.#limbs = new Limbs(body, lengths, detail);
    const vertices = this.#limbs.positions.length;
    this.body.setAttribute('position', moving(vertices));
    this.body.setAttribute('normal', moving(vertices));
    this.body.setAttribute('color', new BufferAttribute(coloured(this.#limbs.ends, colours), 3));
    this.body.setIndex(this.#limbs.index);
    this.#light = light ?? { x: 0, z: 0 };
    if (!light) return;
    this.#flat = new Limbs(body, lengths, SHADOW);
    this.shadow = new BufferGeometry().setAttribute('position', moving(this.#flat.positions.length)).setIndex(this.#flat.index);
  }

  /** Puts limbs in their places. */
  place(limbs: readonly Matrix4[]): void {
    this.#limbs.place(limbs, changed(this.body, 'position'), changed(this.body, 'normal'));
    if (!this.#flat || !this.shadow) return;
    const flat = changed(this.shadow, 'position');
    this.#flat.place(limbs, flat, null);
    for (let at = 0; at < flat.length; at += 3) {
      const height = flat[at + 1] ?? 0;
      flat[at] = (flat[at] ?? 0) + this.#light.x * height;
      flat[at + 1] = ABOVE;
      flat[at + 2] = (flat[at + 2] ?? 0) + this.#light.z * height;
    }
  }

  dispose(): void {
    this.body.dispose();
    this.shadow?.dispose();
  }
}

function moving(values: number): BufferAttribute {
  return new BufferAttribute(new Float32Array(values), 3).setUsage(DynamicDrawUsage);
}

/** The values of an attribute that are about to change. */
function changed(geometry: BufferGeometry, name: 'position' | 'normal'): Float32Array {
  const attribute = geometry.getAttribute(name) as BufferAttribute;
  attribute.needsUpdate = true;
  return attribute.array as Float32Array;
}

function coloured(ends: readonly number[], colours: readonly Color[]): Float32Array {
  const values: number[] = [];
  ends.forEach((end, limb) => {
    const { r, g, b } = colours[limb] ?? { r: 1, g: 1, b: 1 };
    while (values.length < 3 * end) values.push(r, g, b);
  });
  return new Float32Array(values);
}

interface Ring {
  readonly radius: number;
  readonly height: number;
  readonly out: number;
  readonly up: number;
}

/** Rings of the hull of two balls, from the lower pole to the upper one. */
function profile(lower: number, upper: number, length: number, cap: number): Ring[] {
  const slope = length > Math.abs(lower - upper) ? Math.asin((lower - upper) / length) : 0;
  const rings: Ring[] = [];
  for (let i = 0; i <= cap; i += 1) rings.push(ring(lower, 0, -Math.PI / 2 + ((Math.PI / 2 + slope) * i) / cap));
  for (let i = 0; i <= cap; i += 1) rings.push(ring(upper, length, slope + ((Math.PI / 2 - slope) * i) / cap));
  return rings;
}

function ring(radius: number, base: number, angle: number): Ring {
  const [out, up] = [Math.cos(angle), Math.sin(angle)];
  return { radius: radius * out, height: base + radius * up, out, up };
}
