import { get, post, Refused } from '../api/http';
import type { Applied, JobState, Result, Settings } from '../api/types';
import { h } from '../base/dom';
import type { Controls } from '../document/controls';
import type { Session } from '../document/session';
import { button, row, section, Segments, Slider, Switch } from './controls';
import { number } from './status';

/** How the clip follows: structure or naturalness, time, ground, loop, mirror, alternatives. */
export function tunePanel(session: Session, controls: Controls): HTMLElement {
  const { store } = session;
  const set = (change: Partial<Settings>, label: string, gesture: string | null = null) =>
    store.edit(label, [{ type: 'setSettings', settings: { ...store.document.value.settings, ...change } }], gesture);

  let gesture = '';
  const structure = new Slider('Structure or naturalness', { low: 0, high: 1, step: 0.01, text: (v) => `${Math.round(100 * v)} percent structure` }, (value) => {
    gesture ||= `structure ${Date.now()}`;
    set({ structure: value }, 'Structure', gesture);
  }, () => (gesture = ''));
  const preset = new Segments<Settings['preset']>('Preset', [{ value: 'natural', text: 'Natural' }, { value: 'follow', text: 'Follow' }], (value) => set({ preset: value, structure: null }, 'Preset'), true);

  const timing = new Segments<'pen' | 'even'>('Timing of the drawing', [{ value: 'pen', text: 'As drawn' }, { value: 'even', text: 'Even' }], (value) => {
    const { control } = store.document.value;
    if (control?.kind === 'curve') controls.set({ ...control, timing: value }, 'Timing');
  }, true);
  const length = h('input', { type: 'number', min: 0.5, max: 600, step: 0.5, placeholder: 'auto' });
  length.addEventListener('change', () => set({ length: length.value === '' ? null : Math.max(0.5, Number(length.value)) }, 'Length'));
  const repeat = h('input', { type: 'number', min: 1, max: 50, step: 1 });
  repeat.addEventListener('change', () => set({ repeat: Math.max(1, Math.round(Number(repeat.value) || 1)) }, 'Repeat'));
  const laps = h('input', { type: 'number', min: 1, max: 20, step: 1 });
  laps.addEventListener('change', () => store.edit('Laps', [{ type: 'setSource', source: { ...store.document.value.source, laps: Math.max(1, Math.round(Number(laps.value) || 1)) } }]));

  const loop = new Switch('Seamless loop', (on) => set({ loop: on }, on ? 'Loop' : 'No loop'));
  const mirror = new Switch('Mirror', (on) => set({ mirror: on }, 'Mirror'), 'What the drawing has on two sides changes places');
  const root = h('select', {}, ...([['travel', 'Travels'], ['inPlace', 'In place'], ['bone', 'Root bone'], ['hips', 'Hips only']] as const).map(([value, text]) => h('option', { value }, text)));
  root.addEventListener('change', () => set({ root: root.value as Settings['root'] }, 'Root motion'));
  const path = h('select', {}, ...([['none', 'As it comes'], ['straight', 'Straight'], ['arc', 'An arc'], ['drawn', 'Along the drawing']] as const).map(([value, text]) => h('option', { value }, text)));
  path.addEventListener('change', () => set({ path: pathOf(path.value, store.document.value.control, degrees.value) }, 'Path'));
  const degrees = h('input', { type: 'number', min: -720, max: 720, step: 15, value: 90 });
  degrees.addEventListener('change', () => set({ path: { kind: 'arc', degrees: Number(degrees.value) || 0 } }, 'Path'));
  const turn = row('Degrees', degrees);
  const seed = h('input', { type: 'number', min: 0, step: 1 });
  seed.addEventListener('change', () => set({ seed: Math.max(0, Math.round(Number(seed.value) || 0)) }, 'Seed'));

  const others = alternatives(session, (solution) => set({ solution }, 'Alternative'));
  const timingSection = section('Timing', timing.element);
  store.document.watch(({ settings, control, source }) => {
    preset.value = settings.preset;
    structure.value = settings.structure ?? (settings.preset === 'follow' ? 0.9 : 0.6);
    timing.value = control?.kind === 'curve' ? control.timing : 'pen';
    timingSection.hidden = control !== null && control.kind !== 'curve';
    show(length, settings.length === null ? '' : String(settings.length));
    show(repeat, String(settings.repeat));
    show(laps, String(source.laps));
    show(seed, String(settings.seed));
    loop.value = settings.loop;
    mirror.value = settings.mirror;
    root.value = settings.root;
    path.value = settings.path === null ? 'none' : settings.path.kind === 'bend' ? 'arc' : settings.path.kind;
    turn.hidden = settings.path?.kind !== 'arc' && settings.path?.kind !== 'bend';
    if (settings.path?.kind === 'arc' || settings.path?.kind === 'bend') show(degrees, String(settings.path.degrees));
  });
  return h(
    'div',
    {},
    section('Follow', preset.element, h('div', { style: 'margin-top:8px' }, structure.element), h('div', { class: 'ends' }, h('span', {}, 'Naturalness'), h('span', {}, 'Structure'))),
    timingSection,
    section('Length', row('Seconds', length), row('Repeat the control', repeat), row('Laps of the clip', laps)),
    section('Motion', loop.element, mirror.element, row('Root', root), row('Path', path), turn),
    section('Alternatives', others, row('Seed', seed)),
    section('Keep a part', keepPart(session)),
  );
}

/** Not while somebody types in it. */
function show(input: HTMLInputElement, value: string): void {
  if (document.activeElement !== input) input.value = value;
}

function pathOf(kind: string, control: ReturnType<() => Session['store']['document']['value']['control']>, degrees: string): Settings['path'] {
  if (kind === 'straight') return { kind };
  if (kind === 'arc') return { kind, degrees: Number(degrees) || 90 };
  if (kind !== 'drawn' || control?.kind !== 'curve') return null;
  const points = control.strokes.flat().map(([x, y]) => [x, y] as [number, number]);
  return { kind, points, closed: false, metresPerUnit: null };
}

/** A stretch of the result that stays as it is while the rest is made anew. */
function keepPart(session: Session): HTMLElement {
  const [from, to] = [0, 1].map(() => h('input', { type: 'number', min: 0, step: 0.1 })) as [HTMLInputElement, HTMLInputElement];
  const keep = button('Keep it', () => void lock(), 'quiet wide');
  const lock = async () => {
    const result = session.result.value;
    if (!result || from.value === '' || !(Number(to.value) > Number(from.value))) {
      session.store.failed.value = new Refused('range', 'A part to keep begins before it ends.', 'Give both times in seconds.');
      return;
    }
    try {
      await session.store.settled();
      await session.store.follow(await post<Applied>('locks', { result: result.id, from: Number(from.value), to: Number(to.value) }), null);
    } catch (error) {
      session.store.failed.value = error instanceof Refused ? error : new Refused('page', String(error), null);
    }
  };
  const here = button('Around the playhead', () => {
    const { seconds, duration } = session.player;
    from.value = Math.max(0, seconds.value - 0.5).toFixed(1);
    to.value = Math.min(duration.value, seconds.value + 0.5).toFixed(1);
  }, 'quiet wide');
  return h('div', {}, row('From, seconds', from), row('To, seconds', to), h('div', { style: 'display:flex;gap:6px' }, here, keep));
}

/** Other results that follow about as well: for drawings that are nearly their own mirror image. */
function alternatives(session: Session, choose: (solution: number) => void): HTMLElement {
  const found = h('div', { class: 'list' });
  const note = h('p', { class: 'help' });
  const look = button('Find alternatives', () => void find(), 'quiet wide');
  const find = async () => {
    look.disabled = true;
    try {
      let job = await post<JobState>('jobs', { kind: 'alternatives', most: 4 });
      while (job.state === 'running') {
        note.textContent = `Looking: level ${job.level} of ${job.levels}`;
        await new Promise((done) => setTimeout(done, 250));
        job = await get<JobState>(`jobs/${job.id}`);
      }
      note.textContent = job.error ?? (job.results.length < 2 ? 'No other follows as well.' : '');
      const results = await Promise.all(job.results.map((id) => get<Result>(`results/${id}`)));
      list(results);
    } catch (error) {
      note.textContent = error instanceof Error ? error.message : String(error);
    }
    look.disabled = false;
  };
  const list = (results: readonly Result[]) => {
    const now = session.store.document.value.settings.solution;
    found.replaceChildren(
      ...results.map((result, i) => {
        const structure = result.gauges.find((gauge) => gauge.name === 'structure')?.value;
        const apart = result.distance === null ? '' : `, ${result.distance.toFixed(1)} apart`;
        const choice = h('button', { type: 'button', class: 'wide', style: 'justify-content:flex-start', 'aria-pressed': String(i === now) }, `Alternative ${i + 1}`, h('span', { class: 'soft' }, `structure ${structure === undefined ? '–' : number(structure)}${apart}`));
        choice.addEventListener('click', () => {
          choose(i);
          found.querySelectorAll('button').forEach((other) => other.setAttribute('aria-pressed', String(other === choice)));
        });
        return choice;
      }),
    );
  };
  // What was found for another drawing is no choice for this one.
  let sought = session.store.document.value.control;
  session.store.document.subscribe(({ control }) => {
    if (control === sought) return;
    sought = control;
    found.replaceChildren();
    note.textContent = '';
  });
  session.result.watch((result) => {
    if (result?.ambiguous && found.childElementCount === 0) note.textContent = 'The drawing is nearly its own mirror image: there is more than one way to follow it.';
  });
  return h('div', {}, look, note, found);
}
