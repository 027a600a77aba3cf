import { address } from './http';
import type { FromPage, StrokeMode, ToPage } from './types';

export type LivePoint = [number, number, number, number] | [number, number];

export interface LiveListener {
  said(message: ToPage): void;
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
    this.#send({ type: 'begin', stroke: this.#stroke, mode, timing: timing ?? null });
    return this.#stroke;
  }

  points(stroke: number, points: readonly LivePoint[]): void {
    if (points.length > 0) this.#send({ type: 'points', stroke, points: [...points] });
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

  #send(message: FromPage): void {
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
      if (typeof data === 'string') this.#listener.said(JSON.parse(data) as ToPage);
      else {
        this.#send({ type: 'seen' });
        this.#listener.poses(data);
      }
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
