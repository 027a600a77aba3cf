import type { ClipDetail } from '../api/types';
import { poseAt, type Motion } from '../viewport/motion';

/** One clip of those that are arranged. */
export interface SourcePart {
  readonly clip: ClipDetail;
  readonly motion: Motion;
  /** Frame of its beginning, counted through all. */
  readonly first: number;
}

/** The clips that are arranged, one after the other; frames are counted through all of them. */
export class SourceClips {
  readonly parts: readonly SourcePart[];
  readonly frames: number;

  constructor(clips: readonly { clip: ClipDetail; motion: Motion }[]) {
    let first = 0;
    this.parts = clips.map(({ clip, motion }) => {
      const part = { clip, motion, first };
      first += motion.frames;
      return part;
    });
    this.frames = first;
  }

  /** The clip that a frame counted through all is in, and the frame in it. */
  find(frame: number): { part: SourcePart; frame: number } | null {
    for (const part of this.parts) {
      if (frame < part.first + part.motion.frames) return { part, frame: Math.max(frame - part.first, 0) };
    }
    const last = this.parts.at(-1);
    return last ? { part: last, frame: last.motion.frames - 1 } : null;
  }

  /** Counted through all: frame of a clip; null when the clip is not arranged. */
  count(clip: string, frame: number): number | null {
    const part = this.parts.find((candidate) => candidate.clip.id === clip);
    return part ? part.first + frame : null;
  }

  pose(clip: string, frame: number): Float32Array | null {
    const part = this.parts.find((candidate) => candidate.clip.id === clip);
    if (!part) return null;
    return poseAt(part.motion, frame / part.motion.rate, new Float32Array(3 * part.motion.body.names.length));
  }

  /** `Walk 2.13 s, frame 64`, with the clip's name where there are several. */
  describe(frame: number): string {
    const found = this.find(frame);
    if (!found) return '';
    const seconds = (found.frame / found.part.motion.rate).toFixed(2);
    const name = this.parts.length > 1 ? `${found.part.clip.name} ` : '';
    return `${name}${seconds} s, frame ${found.frame}`;
  }
}
