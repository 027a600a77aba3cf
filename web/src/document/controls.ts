import type { Command, Control, Key } from '../api/types';
import { Signal } from '../base/signal';
import { lineOf, nearestPart } from './curve';
import type { Store } from './store';

export type ControlKind = 'curve' | 'wave' | 'labels' | 'sound' | 'motion' | 'storyboard';

const NAMES: Readonly<Record<ControlKind, string>> = { curve: 'drawing', wave: 'wave', labels: 'labels', sound: 'sound', motion: 'motion', storyboard: 'storyboard' };

/** Which kind of control is edited. What was made of the other kinds is kept for when one comes back. */
export class Controls {
  readonly kind: Signal<ControlKind>;
  readonly #kept = new Map<ControlKind, Control>();
  readonly #store: Store;
  readonly #seconds: () => number;

  /** `seconds` is the length of the result as it is. */
  constructor(store: Store, seconds: () => number) {
    this.#store = store;
    this.#seconds = seconds;
    this.kind = new Signal(kindOf(store.document.value.control) ?? 'curve');
    let before: ControlKind | null = null;
    store.document.watch(({ control }) => {
      const kind = kindOf(control);
      if (control && kind) this.#kept.set(kind, control);
      // Another kind may have been chosen already that has nothing to follow yet.
      if (kind && kind !== before) this.kind.value = kind;
      before = kind;
    });
  }

  /** Edits another kind; takes up what there was of it, else a beginning that can be seen. */
  choose(kind: ControlKind): void {
    if (kind === this.kind.value) return;
    this.kind.value = kind;
    const control = this.#kept.get(kind) ?? this.#beginning(kind);
    if (!control) return;
    const commands: Command[] = [{ type: 'setControl', control }];
    const { keys } = this.#store.document.value;
    const fitting = keys.map((key) => this.#timed(key));
    if (fitting.some((key, i) => key !== keys[i])) commands.push({ type: 'setKeys', keys: fitting });
    this.#store.edit(`Follow a ${NAMES[kind]}`, commands);
  }

  /** A place on the paper, on a wave or in a label means nothing to another control: the time there does. */
  #timed(key: Key): Key {
    if (!key.place || key.place.kind === 'time') return key;
    const line = lineOf(this.#store.document.value.control);
    const part = key.place.kind === 'point' ? nearestPart(line, key.place.point)?.part : undefined;
    return { ...key, place: { kind: 'time', seconds: Number(((part ?? 0.5) * this.#seconds()).toFixed(3)) } };
  }

  set(control: Control | null, label: string, gesture: string | null = null): void {
    this.#store.edit(label, [{ type: 'setControl', control }], gesture);
  }

  #beginning(kind: ControlKind): Control | null {
    const { sounds, clips, source } = this.#store.document.value;
    switch (kind) {
      case 'wave':
        return { kind: 'wave', expression: 'sine(0.5Hz..2Hz) for 10s' };
      case 'labels':
        return { kind: 'labels', segments: [{ name: 'A', seconds: 3, colour: null }, { name: 'B', seconds: 2, colour: null }, { name: 'A', seconds: 3, colour: null }] };
      case 'sound':
        return sounds[0] ? { kind: 'sound', sound: sounds[0].id, smooth: null, outline: false } : null;
      case 'motion': {
        const other = clips.find((clip) => clip.role === 'motion' && !source.clips.includes(clip.id));
        return other ? { kind: 'motion', clip: other.id } : null;
      }
      case 'curve':
      // A storyboard makes its own motion: nothing is followed by it.
      case 'storyboard':
        return null;
    }
  }
}

function kindOf(control: Control | null): ControlKind | null {
  if (!control) return null;
  return control.kind === 'drawnWave' ? 'wave' : control.kind;
}
