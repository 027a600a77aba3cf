import { get, post, Refused } from '../api/http';
import type { Applied, Command, Document, HistoryLabels, ProjectState } from '../api/types';
import { Signal } from '../base/signal';
import { apply } from './apply';

export type Saved = 'saved' | 'saving' | 'offline';

interface Edit {
  readonly label: string;
  commands: readonly Command[];
  readonly gesture: string | null;
}

/**
 * The project as the server keeps it. Edits show at once and go to the server in order; where it disagrees, its word
 * counts. Undo and redo are the server's, so that they outlive the page.
 */
export class Store {
  readonly document: Signal<Document>;
  readonly history = new Signal<HistoryLabels>({ undo: [], redo: [] });
  readonly saved = new Signal<Saved>('saved');
  readonly failed = new Signal<Refused | null>(null);
  #revision: number;
  #queue: Edit[] = [];
  #running: Promise<void> | null = null;

  constructor(state: ProjectState) {
    this.document = new Signal(state.document);
    this.#revision = state.revision;
    this.history.value = state.history;
  }

  get revision(): number {
    return this.#revision;
  }

  /** One step of undo. Edits with the same `gesture` (a drag) are one step together. */
  edit(label: string, commands: readonly Command[], gesture: string | null = null): void {
    this.document.value = commands.reduce(apply, this.document.value);
    const last = this.#queue.at(-1);
    // Of a drag only the newest place matters, once the one before is on its way.
    if (gesture !== null && last?.gesture === gesture && last.commands.length === 1 && commands.length === 1 && last.commands[0]?.type === commands[0]?.type) {
      last.commands = commands;
    } else this.#queue.push({ label, commands, gesture });
    this.#run();
  }

  async undo(): Promise<void> {
    await this.#move('undo');
  }

  async redo(): Promise<void> {
    await this.#move('redo');
  }

  /** What the server said of a change that did not come from `edit`: an upload, a stroke, another tab. */
  async follow(applied: Applied, known: Partial<Document> | null): Promise<void> {
    if (applied.revision <= this.#revision) return;
    if (known && applied.revision === this.#revision + 1 && this.#queue.length === 0 && !this.#running) {
      this.#revision = applied.revision;
      this.history.value = applied.history;
      this.document.value = { ...this.document.value, ...known };
    } else if (!this.#running) await this.reload();
  }

  async reload(): Promise<void> {
    const state = await get<ProjectState>('project');
    this.#take(state);
  }

  /** Waits until all edits are with the server. */
  async settled(): Promise<void> {
    while (this.#running) await this.#running;
  }

  #take(state: ProjectState): void {
    this.#revision = state.revision;
    this.history.value = state.history;
    this.document.value = state.document;
    this.saved.value = 'saved';
  }

  async #move(way: 'undo' | 'redo'): Promise<void> {
    await this.settled();
    try {
      this.#take(await post<ProjectState>(`project/${way}`, {}));
    } catch (error) {
      if (!(error instanceof Refused) || error.code !== `nothing_to_${way}`) this.#fail(error);
    }
  }

  #run(): void {
    this.#running ??= this.#drain().finally(() => {
      this.#running = null;
      if (this.#queue.length > 0) this.#run();
    });
  }

  async #drain(): Promise<void> {
    this.saved.value = 'saving';
    for (let edit = this.#queue.shift(); edit; edit = this.#queue.shift()) {
      const { label, commands, gesture } = edit;
      try {
        const body = gesture === null ? { label, commands } : { label, commands, gesture };
        const applied = await post<Applied>('project/commands', body);
        this.#revision = applied.revision;
        this.history.value = applied.history;
      } catch (error) {
        this.#queue = [];
        this.#fail(error);
        await this.reload().catch(() => undefined);
        return;
      }
    }
    this.saved.value = 'saved';
  }

  #fail(error: unknown): void {
    const refused = error instanceof Refused ? error : new Refused('page', String(error), null);
    this.saved.value = refused.code === 'unreachable' ? 'offline' : 'saved';
    this.failed.value = refused;
  }
}
