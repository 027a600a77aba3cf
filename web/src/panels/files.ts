import type { ClipEntry } from '../api/types';
import { h, painter } from '../base/dom';
import type { Signal } from '../base/signal';
import type { Files } from '../document/files';
import type { Session } from '../document/session';
import { button, pressed, section, tool } from './controls';

export interface FilesActs {
  pick(): void;
  /** The clip whose own mesh is shown. */
  readonly character: Signal<string | null>;
  /** The clip that stands beside the result. */
  readonly beside: Signal<string | null>;
}

/** The clips that are arranged, sounds, the character's own skin, and what comes with the program. */
export function filesPanel(session: Session, files: Files, acts: FilesActs): HTMLElement {
  const clips = h('div', { class: 'list' });
  const sounds = h('div', { class: 'list' });
  const soundSection = section('Sounds', sounds);
  const draw = painter(() => {
    const document = session.store.document.value;
    clips.replaceChildren(...document.clips.filter((clip) => clip.role === 'motion').map((clip) => clipRow(clip, session, acts)));
    soundSection.hidden = document.sounds.length === 0;
    sounds.replaceChildren(
      ...document.sounds.map((sound) => {
        const gone = tool('close', `Remove ${sound.name}`, () => session.store.edit('Remove sound', [{ type: 'removeSound', id: sound.id }]));
        gone.classList.add('small');
        return h('div', { class: 'row' }, h('span', { class: 'text' }, sound.name), gone);
      }),
    );
  });
  session.store.document.subscribe(draw);
  session.clips.subscribe(draw);
  acts.character.subscribe(draw);
  acts.beside.subscribe(draw);
  draw();
  const samples = session.info.samples.map((sample) => {
    const load = button(sample.name, () => void files.sample(sample));
    load.title = sample.description;
    return { sample, load };
  });
  const wrap = (kind: 'motion' | 'curve') => h('div', { style: 'display:flex;flex-wrap:wrap;gap:4px' }, ...samples.filter(({ sample }) => sample.kind === kind).map(({ load }) => load));
  return h(
    'div',
    {},
    section('Clips', clips, h('p', { class: 'help' }, 'Ticked clips are arranged, in this order.'), h('div', { style: 'margin-top:8px' }, button('Open motion, drawing or sound', acts.pick, 'quiet wide'))),
    soundSection,
    section('Sample characters', wrap('motion')),
    section('Sample drawings', wrap('curve')),
  );
}

function clipRow(clip: ClipEntry, session: Session, acts: FilesActs): HTMLElement {
  const { store } = session;
  const { source } = store.document.value;
  const detail = session.clips.value.get(clip.id);
  const on = h('input', { type: 'checkbox', 'aria-label': `Arrange ${clip.name}` });
  on.checked = source.clips.includes(clip.id);
  on.addEventListener('change', () => {
    const now = store.document.value.source;
    const next = on.checked ? [...now.clips, clip.id] : now.clips.filter((id) => id !== clip.id);
    store.edit(on.checked ? `Arrange ${clip.name}` : `Leave out ${clip.name}`, [{ type: 'setSource', source: { ...now, clips: next } }]);
  });
  const name = h('input', { type: 'text', value: clip.name, style: 'flex:1;min-width:0;border-color:transparent;background:none', 'aria-label': `Name of ${clip.name}` });
  name.addEventListener('change', () => store.edit('Rename clip', [{ type: 'renameClip', id: clip.id, name: name.value.trim() || clip.name }]));
  const about = h('span', { class: 'soft' }, detail ? `${detail.seconds.toFixed(1)} s` : '');
  const gone = tool('close', `Remove ${clip.name}`, () => store.edit(`Remove ${clip.name}`, [{ type: 'removeClip', id: clip.id }]));
  gone.classList.add('small');
  const row = h('div', { class: 'row' }, on, name, about);
  if (detail?.hasSkin) {
    const shown = acts.character.value === clip.id;
    const skin = tool('skin', source.clips.includes(clip.id) ? `Show ${clip.name} with its own skin` : `Show the motion on ${clip.name}`, () => (acts.character.value = shown ? null : clip.id));
    skin.classList.add('small');
    pressed(skin, shown);
    row.append(skin);
  }
  const stands = acts.beside.value === clip.id;
  const beside = tool('compare', `Show ${clip.name} beside the result`, () => (acts.beside.value = stands ? null : clip.id));
  beside.classList.add('small');
  pressed(beside, stands);
  row.append(beside, gone);
  return row;
}
