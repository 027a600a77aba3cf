/** x to the right, y up, then seconds and pressure where there are some. */
export type Row = readonly number[];
export type Line = readonly Row[];
export type Ink = 'body' | 'trajectory' | 'speed' | 'scene';
export type Exactness = 'off' | 'soft' | 'pin';

/** A frame of the storyboard's file; whatever else a file says of a frame stays as it is. */
export interface BoardFrame {
  readonly word?: string;
  readonly body?: readonly Line[];
  readonly trajectories?: readonly Way[];
  readonly speed_lines?: readonly Line[];
  readonly scene?: readonly Line[];
  readonly pins?: readonly Pin[];
  readonly edits?: readonly Edit[] | undefined;
  readonly constraints?: readonly Constraint[] | undefined;
  readonly lock_ends?: boolean;
  readonly camera?: BoardCamera;
  readonly seconds?: number | undefined;
  /** Which of the ranked motions is taken, from 0. */
  readonly take?: number | undefined;
  /** What motions are sampled with; without it the frame's place, from 1. */
  readonly number?: number | undefined;
  /** Whose way over the ground is gone: on from the frame before, or that of a place in the story, from 1. */
  readonly path?: 'continue' | number | undefined;
}

export interface Way {
  readonly points: Line;
  readonly joint?: string;
  readonly figure?: 'start' | 'end';
}

/** Where a joint of the figure is, said by hand. */
export interface Pin {
  readonly joint: string;
  readonly at: readonly [number, number];
}

/** Where a joint of the motion is at one of its frames, metres in the clip's own space. */
export interface Edit {
  readonly joint: string;
  readonly frame: number;
  readonly at: readonly [number, number, number];
}

/** What holds in space; whatever else it says stays as it is. */
export interface Constraint {
  /** Which stroke of the scene it is set from. */
  readonly scene?: number;
  readonly frames?: readonly [number, number];
}

export interface BoardCamera {
  readonly pitch_degrees?: number;
  readonly yaw_degrees?: number;
}

export interface BoardFile {
  readonly inkrig_storyboard: 1;
  readonly title?: string;
  readonly frames: readonly BoardFrame[];
}

/** Frames of the motion in a second. */
const RATE = 20;
/** The three-quarter view of frames that do not say one. */
export const CAMERA = { pitch_degrees: 20, yaw_degrees: 30 } as const;

/** The lines of a frame, with what they are. */
export function linesOf(frame: BoardFrame): { ink: Ink; at: number; line: Line }[] {
  const all = (ink: Ink, lines: readonly Line[] | undefined) => (lines ?? []).map((line, at) => ({ ink, at, line }));
  return [...all('scene', frame.scene), ...all('body', frame.body), ...all('speed', frame.speed_lines), ...all('trajectory', frame.trajectories?.map(({ points }) => points))];
}

/** The frame without one of its lines. */
export function without(frame: BoardFrame, ink: Ink, at: number): Partial<BoardFrame> {
  const rest = <T>(list: readonly T[] | undefined) => (list ?? []).filter((_, i) => i !== at);
  if (ink === 'trajectory') return { trajectories: rest(frame.trajectories) };
  if (ink === 'speed') return { speed_lines: rest(frame.speed_lines) };
  if (ink !== 'scene' || !frame.constraints) return { [ink]: rest(frame[ink]) };
  const constraints = frame.constraints.filter(({ scene }) => scene !== at).map((one) => (one.scene !== undefined && one.scene > at ? { ...one, scene: one.scene - 1 } : one));
  return { scene: rest(frame.scene), constraints };
}

/** The frame so long, without what lies behind its end. */
export function lasting(frame: BoardFrame, seconds: number | undefined): Partial<BoardFrame> {
  if (seconds === undefined) return { seconds };
  const count = Math.max(Math.round(seconds * RATE), 2);
  const edits = frame.edits?.filter((edit) => edit.frame < count);
  const constraints = frame.constraints?.filter(({ frames }) => !frames || frames[0] < count).map((one): Constraint => (one.frames && one.frames[1] >= count ? { ...one, frames: [one.frames[0], count - 1] } : one));
  return { seconds, ...(edits ? { edits } : {}), ...(constraints ? { constraints } : {}) };
}

/**
 * Frames in another order. Motions are sampled with a frame's place as the seed unless it says a number, so one that is
 * moved says where it was, and a new one takes a number that no other has.
 */
export function numbered(before: readonly BoardFrame[], after: readonly BoardFrame[]): BoardFrame[] {
  const old = after.map((frame) => {
    const place = before.indexOf(frame);
    return frame.number ?? (place < 0 ? undefined : place + 1);
  });
  const taken = new Set(old);
  return after.map((frame, i) => {
    let number = old[i];
    if (number === undefined) {
      number = i + 1;
      while (taken.has(number)) number += 1;
      taken.add(number);
    }
    const path = leading(before, after, frame.path);
    return number === (frame.number ?? i + 1) && path === frame.path ? frame : { ...frame, number, path };
  });
}

/** Where the frame is now whose way is gone; nothing where it is no more. */
function leading(before: readonly BoardFrame[], after: readonly BoardFrame[], path: BoardFrame['path']): BoardFrame['path'] {
  if (typeof path !== 'number') return path;
  const leader = before[path - 1];
  const at = leader ? after.indexOf(leader) : -1;
  return at < 0 ? undefined : at + 1;
}
