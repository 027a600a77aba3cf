import type { Key, KeyKind, Place } from '../api/types';

export const KEY_KINDS = ['soft', 'hard', 'avoid', 'never'] as const satisfies readonly KeyKind[];

export const KEY_NAMES: Readonly<Record<KeyKind, string>> = {
  soft: 'Soft',
  hard: 'Exact',
  avoid: 'Avoid',
  never: 'Never',
  fixed: 'Kept',
};

export const KEY_HELP: Readonly<Record<KeyKind, string>> = {
  soft: 'Near this place the motion is near the pose. Stands anywhere on the canvas.',
  hard: 'At this time the pose is exactly this one. Sits on the curve.',
  avoid: 'The motion keeps its distance from the pose.',
  never: 'The pose, and all nearer than the radius, is not used at all.',
  fixed: 'This part of an earlier result stays as it is.',
};

let made = 0;

/** A key with a new id and the usual strength of its kind. */
export function newKey(kind: Exclude<KeyKind, 'fixed'>, pose: { clip: string; frame: number }, place: Place | null): Key {
  made += 1;
  return {
    id: `k${Date.now().toString(36)}${made}`,
    enabled: true,
    kind,
    place: kind === 'soft' || kind === 'hard' ? place : null,
    pose,
    weight: kind === 'soft' ? 0.5 : kind === 'avoid' ? 1 : null,
    distance: kind === 'avoid' ? 1 : null,
    radius: kind === 'never' ? 0.25 : null,
    fixed: null,
  };
}

/** Where on the canvas a key stands; null when it has no place there of its own. */
export function pointOf(key: Key): readonly [number, number] | null {
  return key.place?.kind === 'point' ? key.place.point : null;
}

export function timeOf(key: Key): number | null {
  return key.place?.kind === 'time' ? key.place.seconds : null;
}
