import type { Control } from '../api/types';
import { Signal } from '../base/signal';
import type { Store } from './store';

export type ControlKind = 'curve' | 'wave' | 'labels' | 'sound' | 'motion';

const NAMES: Readonly<Record<ControlKind, string>> = { curve: 'drawing', wave: 'wave', labels: 'labels', sound: 'sound', motion: 'motion' };

/** Which kind of control is edited. What was made of the other kinds is kept for when one comes back. */
export class Controls {
  readonly kind: Signal<ControlKind>;
  readonly #kept = new Map<ControlKind, Control>();
  readonly #store: Store;

  constructor(store: Store) {
    this.#store = store;
    this.kind = new Signal(kindOf(store.document.value.control) ?? 'curve');
    store.document.watch(({ control }) => {
      const kind = kindOf(control);
      if (!control || !kind) return;
      this.#kept.set(kind, control);
      this.kind.value = kind;
    });
  }

  /** Edits another kind; takes up what there was of it, else a beginning that can be seen. */
  choose(kind: ControlKind): void {
    if (kind === this.kind.value) return;
    this.kind.value = kind;
    const control = this.#kept.get(kind) ?? this.#beginning(kind);
    if (control) this.set(control, `Follow a ${NAMES[kind]}`);
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
        return { kind: 'labels', segments: [{ name: 'A', seconds: 3 }, { name: 'B', seconds: 2 }, { name: 'A', seconds: 3 }] };
      case 'sound':
        return sounds[0] ? { kind: 'sound', sound: sounds[0].id, smooth: null, outline: false } : null;
      case 'motion': {
        const other = clips.find((clip) => clip.role === 'motion' && !source.clips.includes(clip.id));
        return other ? { kind: 'motion', clip: other.id } : null;
      }
      case 'curve':
        return null;
    }
  }
}

function kindOf(control: Control | null): ControlKind | null {
  if (!control) return null;
  return control.kind === 'drawnWave' ? 'wave' : control.kind;
}
