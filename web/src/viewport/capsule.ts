import { BufferAttribute, BufferGeometry, type Color } from 'three';

import type { Body } from './motion';

const AROUND = 12;
const CAP = 4;

/**
 * One geometry for all limbs of a body, each bound to a bone of its own index: a figure is one draw call. Limbs stand on
 * the origin and go up by `lengths`.
 */
export function bodyGeometry(body: Body, lengths: readonly number[], colours: readonly Color[]): BufferGeometry {
  const [position, normal, colour, bone, index]: [number[], number[], number[], number[], number[]] = [[], [], [], [], []];
  body.limbs.forEach((limb, place) => {
    const first = position.length / 3;
    const rings = profile(limb.fromRadius, limb.toRadius, limb.from === limb.to ? 0 : (lengths[place] ?? 0));
    const tint = colours[place];
    for (const ring of rings) {
      for (let i = 0; i <= AROUND; i += 1) {
        const angle = (2 * Math.PI * i) / AROUND;
        const [c, s] = [Math.cos(angle), Math.sin(angle)];
        position.push(ring.radius * c, ring.height, ring.radius * s);
        normal.push(ring.out * c, ring.up, ring.out * s);
        colour.push(tint?.r ?? 1, tint?.g ?? 1, tint?.b ?? 1);
        bone.push(place, 0, 0, 0);
      }
    }
    for (let ring = 0; ring + 1 < rings.length; ring += 1) {
      for (let i = 0; i < AROUND; i += 1) {
        const a = first + ring * (AROUND + 1) + i;
        const b = a + AROUND + 1;
        index.push(a, b, a + 1, a + 1, b, b + 1);
      }
    }
  });
  const weight = new Float32Array(bone.length);
  for (let i = 0; i < weight.length; i += 4) weight[i] = 1;
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(position), 3));
  geometry.setAttribute('normal', new BufferAttribute(new Float32Array(normal), 3));
  geometry.setAttribute('color', new BufferAttribute(new Float32Array(colour), 3));
  geometry.setAttribute('skinIndex', new BufferAttribute(new Uint16Array(bone), 4));
  geometry.setAttribute('skinWeight', new BufferAttribute(weight, 4));
  geometry.setIndex(index);
  return geometry;
}

interface Ring {
  readonly radius: number;
  readonly height: number;
  readonly out: number;
  readonly up: number;
}

/** Rings of the hull of two balls, from the lower pole to the upper one. */
function profile(lower: number, upper: number, length: number): Ring[] {
  const slope = length > Math.abs(lower - upper) ? Math.asin((lower - upper) / length) : 0;
  const rings: Ring[] = [];
  for (let i = 0; i <= CAP; i += 1) rings.push(ring(lower, 0, -Math.PI / 2 + ((Math.PI / 2 + slope) * i) / CAP));
  for (let i = 0; i <= CAP; i += 1) rings.push(ring(upper, length, slope + ((Math.PI / 2 - slope) * i) / CAP));
  return rings;
}

function ring(radius: number, base: number, angle: number): Ring {
  const [out, up] = [Math.cos(angle), Math.sin(angle)];
  return { radius: radius * out, height: base + radius * up, out, up };
}
