import { get, post, put, Refused, remove } from '../api/http';
import type { BoardState, JobState, MadeFrame } from '../api/types';
import { Signal } from '../base/signal';

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
  readonly seconds?: number;
}

export interface Way {
  readonly points: Line;
  readonly joint?: string;
  readonly figure?: 'start' | 'end';
}

export interface BoardFile {
  readonly inkrig_storyboard: 1;
  readonly title?: string;
  readonly frames: readonly BoardFrame[];
}

/** How long nothing has to be drawn before the storyboard is kept, milliseconds. */
const REST = 300;
const MOST_STEPS = 200;
const EMPTY: BoardFile = { inkrig_storyboard: 1, frames: [{}] };

/** The storyboard that is drawn: kept with the project, with an undo of its own, and what was made of it. */
export class Storyboard {
  readonly file = new Signal<BoardFile>(EMPTY);
  readonly chosen = new Signal(0);
  readonly job = new Signal<JobState | null>(null);
  /** What was read of the frames, as they were then. */
  readonly read = new Signal<ReadonlyMap<BoardFrame, MadeFrame>>(new Map());
  readonly problem = new Signal<string | null>(null);
  readonly saved = new Signal(true);
  readonly words: readonly string[];
  readonly available: boolean;
  exact: Exactness = 'soft';
  #past: BoardFile[] = [];
  #future: BoardFile[] = [];
  #timer = 0;
  /** The frames that the running job is made of. */
  #asked: readonly BoardFrame[] = [];

  constructor(state: BoardState, problem: string | null) {
    this.available = state.available;
    this.words = state.words;
    this.problem.value = problem;
    if (state.board) this.file.value = state.board as unknown as BoardFile;
    this.job.value = state.job;
    if (state.job) this.#asked = this.file.value.frames;
    if (state.made) this.#take(this.file.value.frames, state.made.frames);
  }

  static async open(): Promise<Storyboard> {
    try {
      return new Storyboard(await get<BoardState>('storyboard'), null);
    } catch (error) {
      return new Storyboard({ available: false, words: [], board: null, job: null, made: null }, said(error));
    }
  }

  get frame(): BoardFrame {
    return this.file.value.frames[this.chosen.value] ?? {};
  }

  get running(): boolean {
    return this.job.value?.state === 'running';
  }

  /** One step of undo. */
  edit(frames: readonly BoardFrame[], chosen = this.chosen.value): void {
    this.#past = [...this.#past.slice(1 - MOST_STEPS), this.file.value];
    this.#future = [];
    this.#show({ ...this.file.value, frames: frames.length > 0 ? frames : [{}] }, chosen);
  }

  change(what: Partial<BoardFrame>): void {
    this.edit(this.file.value.frames.map((frame, i) => (i === this.chosen.value ? { ...frame, ...what } : frame)));
  }

  draw(ink: Ink, line: Line): void {
    const { frame } = this;
    if (ink === 'trajectory') this.change({ trajectories: [...(frame.trajectories ?? []), { points: line }] });
    else if (ink === 'speed') this.change({ speed_lines: [...(frame.speed_lines ?? []), line] });
    else this.change({ [ink]: [...(frame[ink] ?? []), line] });
  }

  add(copy: boolean): void {
    const { frames } = this.file.value;
    const at = this.chosen.value;
    const fresh: BoardFrame = copy ? { ...this.frame } : {};
    this.edit([...frames.slice(0, at + 1), fresh, ...frames.slice(at + 1)], at + 1);
  }

  remove(): void {
    const at = this.chosen.value;
    this.edit(this.file.value.frames.filter((_, i) => i !== at), at);
  }

  /** Puts the chosen frame a place on or back. */
  move(by: -1 | 1): void {
    const frames = [...this.file.value.frames];
    const [from, to] = [this.chosen.value, this.chosen.value + by];
    const [here, there] = [frames[from], frames[to]];
    if (!here || !there) return;
    [frames[from], frames[to]] = [there, here];
    this.edit(frames, to);
  }

  choose(at: number): void {
    if (at >= 0 && at < this.file.value.frames.length) this.chosen.value = at;
  }

  undo(): void {
    const before = this.#past.pop();
    if (!before) return;
    this.#future.push(this.file.value);
    this.#show(before, this.chosen.value);
  }

  redo(): void {
    const after = this.#future.pop();
    if (!after) return;
    this.#past.push(this.file.value);
    this.#show(after, this.chosen.value);
  }

  async make(): Promise<void> {
    if (this.running) return;
    clearTimeout(this.#timer);
    this.problem.value = null;
    const { file } = this;
    this.#asked = file.value.frames;
    try {
      const job = await post<JobState>(`storyboard?exact=${this.exact}`, file.value);
      // The stream of news may have been quicker.
      if (this.job.value?.id !== job.id) this.job.value = job;
      this.saved.value = true;
    } catch (error) {
      this.problem.value = said(error);
    }
  }

  async cancel(): Promise<void> {
    const id = this.job.value?.id;
    if (id && this.running) await remove(`jobs/${id}`).catch((error: unknown) => (this.problem.value = said(error)));
    const job = this.job.value;
    if (job && job.id === id && job.state === 'running') this.job.value = { ...job, state: 'cancelled' };
  }

  /** News of a job, from the stream. */
  async follow(job: JobState): Promise<void> {
    const before = this.job.value;
    // What was stopped here stays stopped, whatever is still on its way.
    if (before?.id === job.id && before.state !== 'running') return;
    this.job.value = job;
    if (job.state === 'failed') this.problem.value = job.error;
    if (job.state !== 'done') return;
    const { made } = await get<BoardState>('storyboard');
    if (made?.job === job.id) this.#take(this.#asked, made.frames);
  }

  #take(frames: readonly BoardFrame[], made: readonly MadeFrame[]): void {
    this.read.value = new Map(frames.flatMap((frame, i) => (made[i] ? [[frame, made[i]] as const] : [])));
  }

  #show(file: BoardFile, chosen: number): void {
    const at = Math.min(Math.max(chosen, 0), file.frames.length - 1);
    this.file.value = file;
    this.chosen.value = at;
    this.saved.value = false;
    clearTimeout(this.#timer);
    this.#timer = window.setTimeout(() => void this.#keep(file), REST);
  }

  async #keep(file: BoardFile): Promise<void> {
    try {
      await put('storyboard', file);
      if (this.file.value === file) this.saved.value = true;
    } catch (error) {
      this.problem.value = said(error);
    }
  }
}

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
  return { [ink]: rest(frame[ink]) };
}

function said(error: unknown): string {
  return error instanceof Refused ? [error.message, error.hint].filter(Boolean).join(' ') : String(error);
}
