import { Signal } from '../base/signal';
import type { KeyKind } from '../api/types';

export type Tool = 'draw' | 'add' | 'redraw' | 'select' | 'hand';

/** A pose on its way to the canvas or the timeline. */
export interface Carried {
  readonly clip: string;
  readonly frame: number;
  readonly x: number;
  readonly y: number;
}

/** What is chosen and pointed at; not part of the project. */
export class Ui {
  readonly tool = new Signal<Tool>('draw');
  readonly selected = new Signal<string | null>(null);
  /** Kind of the next key that is placed. */
  readonly keyKind = new Signal<Exclude<KeyKind, 'fixed'>>('soft');
  /** Time that is pointed at, seconds; null when nothing is. */
  readonly hover = new Signal<number | null>(null);
  /** Source frame (counted through all clips) that is pointed at, shown in red beside the character. */
  readonly pointed = new Signal<number | null>(null);
  /** Whether the map of the clip lies under the drawing. */
  readonly underlay = new Signal(false);
  /** The clip that stands beside the result instead of the one it is made of. */
  readonly beside = new Signal<string | null>(null);
  readonly carried = new Signal<Carried | null>(null);
  /** A sentence for the status line and for screen readers. */
  readonly said = new Signal('');
}
