import { get, post, put, Refused, remove } from '../api/http';
import type { BoardMade, BoardState, JobState, MadeFrame } from '../api/types';
import { Signal } from '../base/signal';
import { numbered, type BoardFile, type BoardFrame, type Edit, type Exactness, type Ink, type Line } from './storyboardfile';

/** How long nothing has to be drawn before the storyboard is kept, milliseconds. */
const REST = 300;
const MOST_STEPS = 200;
const EMPTY: BoardFile = { inkrig_storyboard: 1, frames: [{}] };

/** What is known of a frame. */
export interface Told {
  readonly made: MadeFrame;
  /** Whether the frame is drawn as it was then. */
  readonly still: boolean;
}

/** The storyboard that is drawn: kept with the project, with an undo of its own, and what was made of it. */
export class Storyboard {
  readonly file = new Signal<BoardFile>(EMPTY);
  readonly chosen = new Signal(0);
  readonly job = new Signal<JobState | null>(null);
  /** The newest animation. */
  readonly made = new Signal<BoardMade | null>(null);
  readonly problem = new Signal<string | null>(null);
  readonly saved = new Signal(true);
  readonly words: readonly string[];
  readonly available: boolean;
  exact: Exactness = 'soft';
  /** By the frame as it was drawn: undo finds it again. */
  readonly #told = new WeakMap<BoardFrame, Told>();
  /** What a frame is, however it is changed or moved; and of which one a part of the animation is. */
  readonly #selves = new WeakMap<BoardFrame, object>();
  readonly #madeOf = new WeakMap<MadeFrame, object>();
  #past: BoardFile[] = [];
  #future: BoardFile[] = [];
  #timer = 0;
  /** What is being kept, and whether a job is asked for and not answered yet. */
  #keeping: Promise<void> = Promise.resolve();
  #sending = false;
  /** The frames that the running job is made of. */
  #asked: readonly BoardFrame[] = [];

  constructor(state: BoardState, problem: string | null) {
    this.available = state.available;
    this.words = state.words;
    this.problem.value = problem;
    if (state.board) this.file.value = state.board as unknown as BoardFile;
    this.job.value = state.job;
    if (state.job) this.#asked = this.file.value.frames;
    state.made?.frames.forEach((made, i) => this.#tell(this.file.value.frames[state.of[i] ?? -1], made, state.still[i]));
    this.made.value = state.made;
  }

  static async open(): Promise<Storyboard> {
    try {
      return new Storyboard(await get<BoardState>('storyboard'), null);
    } catch (error) {
      return new Storyboard({ available: false, words: [], board: null, job: null, made: null, of: [], still: [] }, said(error));
    }
  }

  get frame(): BoardFrame {
    return this.file.value.frames[this.chosen.value] ?? {};
  }

  get running(): boolean {
    return this.#sending || this.job.value?.state === 'running';
  }

  /** What is known of a frame: of one that was changed since, what held before. */
  told(frame = this.frame): Told | null {
    return this.#told.get(frame) ?? null;
  }

  /** Which frame, from 0, a part of the animation is of; -1 where it is gone. */
  placeOf(made: MadeFrame): number {
    const self = this.#madeOf.get(made);
    return self ? this.file.value.frames.findIndex((frame) => this.#selves.get(frame) === self) : -1;
  }

  /** One step of undo. */
  edit(frames: readonly BoardFrame[], chosen = this.chosen.value): void {
    this.#past = [...this.#past.slice(1 - MOST_STEPS), this.file.value];
    this.#future = [];
    this.#show({ ...this.file.value, frames: frames.length > 0 ? frames : [{}] }, chosen);
  }

  change(what: Partial<BoardFrame>): void {
    const before = this.frame;
    // Of another figure come other motions.
    const after = { ...before, ...('body' in what ? { take: undefined } : {}), ...what };
    this.#selves.set(after, this.#self(before));
    const told = this.#told.get(before);
    // Of another figure nothing is known.
    if (told && !('body' in what)) this.#told.set(after, { ...told, still: false });
    this.edit(this.file.value.frames.map((frame, i) => (i === this.chosen.value ? after : frame)));
  }

  draw(ink: Ink, line: Line): void {
    const { frame } = this;
    if (ink === 'trajectory') this.change({ trajectories: [...(frame.trajectories ?? []), { points: line }] });
    else if (ink === 'speed') this.change({ speed_lines: [...(frame.speed_lines ?? []), line] });
    else this.change({ [ink]: [...(frame[ink] ?? []), line] });
  }

  /** Says where a joint of the figure is. */
  pin(joint: string, at: readonly [number, number]): void {
    this.change({ pins: [...(this.frame.pins ?? []).filter((pin) => pin.joint !== joint), { joint, at }] });
  }

  unpin(joint: string): void {
    const pins = this.frame.pins ?? [];
    if (pins.some((pin) => pin.joint === joint)) this.change({ pins: pins.filter((pin) => pin.joint !== joint) });
  }

  add(copy: boolean): void {
    const { frames } = this.file.value;
    const at = this.chosen.value;
    // A copy gets motions of its own: nothing was chosen or moved of these.
    const fresh: BoardFrame = copy ? { ...this.frame, number: undefined, take: undefined, edits: undefined } : {};
    const told = this.told();
    if (copy && told) this.#told.set(fresh, { made: { ...told.made, begins: null, pose: [], takes: [] }, still: false });
    this.#arrange([...frames.slice(0, at + 1), fresh, ...frames.slice(at + 1)], at + 1);
  }

  remove(): void {
    const at = this.chosen.value;
    this.#arrange(this.file.value.frames.filter((_, i) => i !== at), at);
  }

  /** Puts the chosen frame a place on or back. */
  move(by: -1 | 1): void {
    const frames = [...this.file.value.frames];
    const [from, to] = [this.chosen.value, this.chosen.value + by];
    const [here, there] = [frames[from], frames[to]];
    if (!here || !there) return;
    [frames[from], frames[to]] = [there, here];
    this.#arrange(frames, to);
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

  /** Makes the animation of all frames, or of the chosen one, with the others where these need not be made again. */
  async make(only = false): Promise<void> {
    if (this.running) return;
    clearTimeout(this.#timer);
    this.problem.value = null;
    const file = this.file.value;
    const query = `exact=${this.exact}${only ? `&frame=${this.chosen.value + 1}` : ''}`;
    this.#asked = file.frames;
    this.#sending = true;
    try {
      await this.#keeping;
      const job = await post<JobState>(`storyboard?${query}`, file);
      this.#sending = false;
      // The stream of news may have been quicker.
      if (this.job.value?.id !== job.id) this.job.value = job;
      if (this.file.value === file) this.saved.value = true;
    } catch (error) {
      this.#sending = false;
      this.problem.value = said(error);
    }
  }

  /** Takes another motion for the chosen frame, and shows it. */
  take(number: number): void {
    // What was moved was moved of the other one.
    if (number !== (this.frame.take ?? 0)) this.#apply({ take: number, edits: undefined });
  }

  /** Moves a joint of the chosen frame's motion, and shows that. */
  moveJoint(edit: Edit): void {
    const others = (this.frame.edits ?? []).filter((one) => one.joint !== edit.joint || one.frame !== edit.frame);
    this.#apply({ edits: [...others, edit] });
  }

  /** Changes what no motion is sampled for: it is shown at once, with the whole where nothing else waits to be made. */
  #apply(what: Partial<BoardFrame>): void {
    if (this.running) return;
    const others = this.file.value.frames.every((frame, i) => i === this.chosen.value || this.told(frame)?.still);
    this.change(what);
    void this.make(!others);
  }

  /** As {@link moveJoint}, of the whole frame: nothing is moved any more, or its ends stay. */
  moved(what: { edits: readonly Edit[] } | { lock_ends: boolean }): void {
    this.#apply(what);
  }

  async cancel(): Promise<void> {
    const job = this.job.value;
    if (job?.state !== 'running') return;
    try {
      // It may have been done before it could be stopped.
      await this.follow(await remove<JobState>(`jobs/${job.id}`));
    } catch (error) {
      this.problem.value = said(error);
    }
  }

  /** News of a job, from the stream. */
  async follow(job: JobState): Promise<void> {
    const before = this.job.value;
    // What was stopped here stays stopped, whatever is still on its way.
    if (before?.id === job.id && before.state !== 'running') return;
    if (before?.id !== job.id) this.#sending = false;
    this.job.value = job;
    if (job.state === 'failed') this.problem.value = job.error;
    if (job.state !== 'done') return;
    const { made } = await get<BoardState>('storyboard');
    if (made?.job !== job.id) return;
    for (const frame of made.frames) this.#tell(this.#asked[frame.number - 1], frame);
    this.made.value = made;
  }

  #tell(frame: BoardFrame | undefined, made: MadeFrame, still = true): void {
    if (!frame) return;
    this.#told.set(frame, { made, still });
    this.#madeOf.set(made, this.#self(frame));
  }

  #self(frame: BoardFrame): object {
    const self = this.#selves.get(frame) ?? {};
    this.#selves.set(frame, self);
    return self;
  }

  /** Frames in another order, each with the motions that it had. */
  #arrange(frames: readonly BoardFrame[], chosen: number): void {
    const fresh = numbered(this.file.value.frames, frames);
    fresh.forEach((frame, i) => {
      const before = frames[i];
      if (!before) return;
      this.#selves.set(frame, this.#self(before));
      const told = this.#told.get(before);
      if (told) this.#told.set(frame, told);
    });
    this.edit(fresh, chosen);
  }

  #show(file: BoardFile, chosen: number): void {
    const at = Math.min(Math.max(chosen, 0), file.frames.length - 1);
    this.file.value = file;
    this.chosen.value = at;
    this.saved.value = false;
    clearTimeout(this.#timer);
    this.#timer = window.setTimeout(() => (this.#keeping = this.#keep(file)), REST);
  }

  async #keep(file: BoardFile): Promise<void> {
    try {
      await put('storyboard', file);
      this.problem.value = null;
      if (this.file.value === file) this.saved.value = true;
    } catch (error) {
      this.problem.value = said(error);
    }
  }
}

function said(error: unknown): string {
  return error instanceof Refused ? [error.message, error.hint].filter(Boolean).join(' ') : String(error);
}
