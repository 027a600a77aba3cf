import { address } from './http';
import type { Control, HistoryLabels } from './types';

export type StrokeMode = 'draw' | 'add' | 'redraw' | 'wave';
export type LivePoint = [number, number, number, number] | [number, number];

type Said =
  | { type: 'hello'; revision: number }
  | { type: 'committed'; stroke: number; revision: number; history: HistoryLabels; control: Control }
  | { type: 'drawing'; stroke: number; control: Control }
  | { type: 'waiting'; stroke: number; message: string }
  | { type: 'problem'; message: string; hint: string | null };

export interface LiveListener {
  said(message: Said): void;
  poses(bytes: ArrayBuffer): void;
  connected(is: boolean): void;
}

/** The line over which strokes go out and poses come back while the pen is down. Opens itself again when it breaks. */
export class Live {
  readonly #listener: LiveListener;
  #socket: WebSocket | null = null;
  #wait = 250;
  #stroke = 0;
  #active = 0;
  #closed = false;

  constructor(listener: LiveListener) {
    this.#listener = listener;
    this.#open();
  }

  get connected(): boolean {
    return this.#socket?.readyState === WebSocket.OPEN;
  }

  /** The stroke that is being drawn; 0 when none is. */
  get active(): number {
    return this.#active;
  }

  /** Begins a stroke and returns its number. */
  begin(mode: StrokeMode, timing?: 'pen' | 'even'): number {
    this.#stroke += 1;
    this.#active = this.#stroke;
    this.#send({ type: 'begin', stroke: this.#stroke, mode, timing });
    return this.#stroke;
  }

  points(stroke: number, points: readonly LivePoint[]): void {
    if (points.length > 0) this.#send({ type: 'points', stroke, points });
  }

  end(stroke: number): void {
    this.#active = 0;
    this.#send({ type: 'end', stroke });
  }

  cancel(stroke: number): void {
    this.#active = 0;
    this.#send({ type: 'cancel', stroke });
  }

  close(): void {
    this.#closed = true;
    this.#socket?.close();
  }

  #send(message: unknown): void {
    if (this.#socket?.readyState === WebSocket.OPEN) this.#socket.send(JSON.stringify(message));
  }

  #open(): void {
    const url = address('live');
    url.protocol = url.protocol === 'https:' ? 'wss:' : 'ws:';
    const socket = new WebSocket(url);
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => {
      this.#wait = 250;
      this.#listener.connected(true);
    };
    socket.onmessage = ({ data }: MessageEvent<string | ArrayBuffer>) => {
      if (typeof data === 'string') this.#listener.said(JSON.parse(data) as Said);
      else this.#listener.poses(data);
    };
    socket.onclose = () => {
      if (this.#closed) return;
      this.#listener.connected(false);
      setTimeout(() => this.#open(), this.#wait);
      this.#wait = Math.min(this.#wait * 2, 4000);
    };
    this.#socket = socket;
  }
}
