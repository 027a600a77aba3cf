import { clamp } from '../base/maths';

/** Room for the names of the lanes. */
export const GUTTER = 76;
const MARGIN = 14;

/** Seconds to pixels of the timeline. */
export class Scale {
  width = 1;
  seconds = 1;

  get inner(): number {
    return Math.max(this.width - GUTTER - MARGIN, 1);
  }

  x(seconds: number): number {
    return GUTTER + (this.seconds > 0 ? seconds / this.seconds : 0) * this.inner;
  }

  time(x: number): number {
    return clamp((x - GUTTER) / this.inner, 0, 1) * this.seconds;
  }
}

/** Lanes from top to bottom: heights in pixels. The plan takes what is left. */
export interface Lanes {
  readonly ruler: Lane;
  readonly control: Lane;
  readonly keys: Lane;
  readonly plan: Lane;
}

export interface Lane {
  readonly top: number;
  readonly height: number;
}

export function lanes(height: number, control: boolean): Lanes {
  const ruler = { top: 0, height: 22 };
  const band = { top: ruler.height, height: control ? 34 : 0 };
  const keys = { top: band.top + band.height, height: 24 };
  const top = keys.top + keys.height;
  return { ruler, control: band, keys, plan: { top, height: Math.max(height - top - 10, 10) } };
}

export function within(lane: Lane, y: number): boolean {
  return y >= lane.top && y < lane.top + lane.height;
}
