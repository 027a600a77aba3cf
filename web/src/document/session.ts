import { listen } from '../api/events';
import { bytes, get, Refused } from '../api/http';
import { Live } from '../api/live';
import { readPlan, type Plan } from '../api/plan';
import { readPoses, rigOf, type Poses, type Rig } from '../api/poses';
import type { ClipDetail, Control, Document, Figure, Info, JobState, ProjectState, Result, Suggestions } from '../api/types';
import { Signal } from '../base/signal';
import { duration, type Motion } from '../viewport/motion';
import { Player } from './player';
import { SourceClips } from './source';
import { Store } from './store';
import { Storyboard } from './storyboard';

/** Which source frame (counted through all clips) every control sample is made of. */
export interface Used {
  readonly rate: number;
  readonly frames: ArrayLike<number>;
  readonly confidence: readonly number[] | null;
}

/** From the pen's move to its pose on the screen, milliseconds. */
export interface Latency {
  readonly solve: number;
  readonly whole: number;
}

/** All that the rooms of the page share: the project, what was made of it, and where one is. */
export class Session {
  readonly store: Store;
  readonly player = new Player();
  readonly live: Live;
  readonly source = new Signal<SourceClips>(new SourceClips([]));
  readonly clips = new Signal<ReadonlyMap<string, ClipDetail>>(new Map());
  readonly motion = new Signal<Motion | null>(null);
  readonly used = new Signal<Used | null>(null);
  readonly result = new Signal<Result | null>(null);
  readonly plan = new Signal<Plan | null>(null);
  readonly suggestions = new Signal<Suggestions | null>(null);
  readonly job = new Signal<JobState | null>(null);
  readonly problem = new Signal<{ message: string; hint: string | null } | null>(null);
  readonly connected = new Signal(false);
  readonly latency = new Signal<Latency | null>(null);
  /** The drawing while it is being drawn or replaced; null at rest. */
  readonly drawing = new Signal<Control | null>(null);
  /** Whether what is shown is not yet the full result of the document. */
  readonly stale = new Signal(false);
  readonly #rigs = new Map<string, { clip: ClipDetail; rig: Rig; motion: Motion }>();
  #sent = new Map<string, number>();
  #sources = '';
  #rig: Rig | null = null;
  #loading = 0;
  /** What of the document the result that is shown was made of. */
  #solved = '';
  /** The revision of a result that came before the page knew of that revision. */
  #awaited: number | null = null;

  constructor(
    readonly info: Info,
    state: ProjectState,
    readonly storyboard: Storyboard,
  ) {
    this.store = new Store(state);
    this.live = new Live({
      connected: (is) => {
        if (is && !this.connected.value && this.motion.value) void this.store.reload().catch(() => undefined);
        this.connected.value = is;
        if (!is) this.store.saved.value = 'offline';
      },
      poses: (buffer) => this.#poses(buffer),
      said: (message) => {
        if (message.type === 'committed') {
          this.drawing.value = null;
          void this.store.follow(message, { control: message.control });
        } else if (message.type === 'drawing') this.drawing.value = message.control;
        else if (message.type === 'problem') this.problem.value = message;
      },
    });
    listen({
      project: (event) => void this.store.follow(event, null),
      job: (job) => (job.kind === 'storyboard' ? void this.storyboard.follow(job) : (this.job.value = job)),
      result: ({ id }) => void this.#load(id),
      problem: (problem) => (this.problem.value = problem),
    });
    this.store.document.watch(() => void this.#sourceChanged());
    this.store.document.subscribe((document) => this.#forget(document));
    this.store.document.subscribe(({ control }) => {
      // The drawing was cleared, or undone.
      if (control === null && this.result.value) this.#showClip();
    });
    for (const signal of [this.store.document, this.store.history]) signal.subscribe(() => this.#judge());
    this.job.value = state.job;
  }

  static async open(): Promise<Session> {
    const [info, state, storyboard] = await Promise.all([get<Info>('info'), get<ProjectState>('project'), Storyboard.open()]);
    const session = new Session(info, state, storyboard);
    await session.#sourceChanged();
    if (state.result) await session.#load(state.result);
    return session;
  }

  /** A clip with its skeleton and poses, fetched once. */
  async clip(id: string): Promise<{ clip: ClipDetail; rig: Rig; motion: Motion }> {
    const known = this.#rigs.get(id);
    if (known) return known;
    const [clip, poses] = await Promise.all([get<ClipDetail>(`clips/${id}`), bytes(`clips/${id}/poses`)]);
    const rig = rigOf(clip);
    const loaded = { clip, rig, motion: readPoses(poses, rig).motion };
    this.#rigs.set(id, loaded);
    this.clips.value = new Map(this.clips.value).set(id, clip);
    return loaded;
  }

  /** Clips that the document no longer has. */
  #forget({ clips, source }: Document): void {
    const had = new Set([...clips.map(({ id }) => id), ...source.clips]);
    for (const id of [...this.#rigs.keys()]) if (!had.has(id)) this.#rigs.delete(id);
    if ([...this.clips.value.keys()].some((id) => !had.has(id))) this.clips.value = new Map([...this.clips.value].filter(([id]) => had.has(id)));
  }

  /** Remembers when the pen was where a message says, to tell how long its poses took. */
  sent(stroke: number, message: number, at: number): void {
    this.#sent.set(`${stroke}/${message}`, at);
    if (this.#sent.size > 400) this.#sent = new Map([...this.#sent].slice(-200));
  }

  /** A stroke was taken back before it was done. */
  abandon(): void {
    this.drawing.value = null;
    // Where nothing else was drawn no result comes in its place.
    if (!this.store.document.value.control) this.#showClip();
  }

  async #sourceChanged(): Promise<void> {
    const { clips } = this.store.document.value.source;
    const name = clips.join(' ');
    if (name === this.#sources) return;
    this.#sources = name;
    try {
      const loaded = await Promise.all(clips.map((id) => this.clip(id)));
      if (name !== this.#sources) return;
      this.#rig = loaded[0]?.rig ?? null;
      this.source.value = new SourceClips(loaded);
      this.#showClip();
      this.suggestions.value = null;
      if (clips.length > 0) this.suggestions.value = await get<Suggestions>('suggestions?count=8');
    } catch (error) {
      this.#failed(error);
    }
  }

  /** The clip as it is: nothing is followed. */
  #showClip(): void {
    this.result.value = null;
    this.plan.value = null;
    const first = this.source.value.parts[0];
    this.motion.value = first?.motion ?? null;
    this.used.value = null;
    this.player.rate = first?.clip.frameRate ?? 30;
    this.player.setDuration(first ? duration(first.motion) : 0);
  }

  #poses(buffer: ArrayBuffer): void {
    // A preview that was overtaken by the full result, or of a stroke that was taken back.
    const { control } = this.store.document.value;
    const whole = control === null || (this.result.value !== null && !this.stale.value);
    const done = whole && this.drawing.value === null && this.live.active === 0;
    if (!this.#rig || done) return;
    let poses: Poses;
    try {
      poses = readPoses(buffer, this.#rig);
    } catch {
      // Poses of a character that was just exchanged: newer ones follow.
      return;
    }
    this.#show(poses);
    this.problem.value = null;
    const begin = this.#sent.get(`${poses.stroke}/${poses.message}`);
    if (begin === undefined) return;
    this.#sent.delete(`${poses.stroke}/${poses.message}`);
    // The picture with this pose is drawn in the next frame and done when the one after it begins.
    requestAnimationFrame(() =>
      requestAnimationFrame(() => {
        this.latency.value = { solve: poses.milliseconds, whole: performance.now() - begin };
        if (performance.getEntriesByName('pen to pose').length > 2000) performance.clearMeasures('pen to pose');
        performance.measure('pen to pose', { start: begin, end: performance.now() });
      }),
    );
  }

  #show(poses: Poses): void {
    this.motion.value = poses.motion;
    this.used.value = { rate: poses.sampleRate, frames: poses.used, confidence: null };
    this.player.rate = poses.motion.rate;
    this.player.setDuration(duration(poses.motion));
  }

  async #load(id: string): Promise<void> {
    const turn = (this.#loading += 1);
    try {
      const [result, poses, plan] = await Promise.all([
        get<Result>(`results/${id}`),
        bytes(`results/${id}/poses`),
        bytes(`results/${id}/plan?width=600&height=160`),
      ]);
      // A result of clips that are no longer the ones to arrange, or of a drawing that was cleared.
      const { source, control } = this.store.document.value;
      if (result.clipForSkeleton !== source.clips[0] || control === null) return;
      const rig = await this.#rigOf(result);
      // A newer one came, or a stroke goes on.
      if (turn !== this.#loading || this.drawing.value) return;
      this.#show(readPoses(poses, rig));
      this.#rig = rig;
      this.result.value = result;
      this.plan.value = readPlan(plan);
      const used = this.used.value;
      if (used) this.used.value = { ...used, confidence: result.used.confidence };
      this.problem.value = null;
      this.#awaited = result.revision;
      this.#judge();
    } catch (error) {
      if (turn === this.#loading) this.#failed(error);
    }
  }

  /** Says whether the result that is shown is that of the document. */
  #judge(): void {
    const now = solved(this.store.document.value);
    if (this.#awaited !== null && this.#awaited <= this.store.revision) [this.#solved, this.#awaited] = [now, null];
    this.stale.value = now !== this.#solved;
  }

  /** The skeleton of the result: the clip's, unless a root bone was put in. */
  async #rigOf(result: Result): Promise<Rig> {
    const { rig } = await this.clip(result.clipForSkeleton);
    const { root } = this.store.document.value.settings;
    if (result.kind === 'align' && root !== 'bone' && root !== 'hips') return rig;
    return rigOf(await get<Figure>(`results/${result.id}/skeleton`));
  }

  #failed(error: unknown): void {
    const refused = error instanceof Refused ? error : new Refused('page', String(error), null);
    // Without a connection the status line says so already.
    if (refused.code !== 'unreachable') this.store.failed.value = refused;
  }
}

/** Of a document, what a result depends on. */
function solved({ source, control, keys, settings }: Document): string {
  return JSON.stringify([source, control, keys, settings]);
}
