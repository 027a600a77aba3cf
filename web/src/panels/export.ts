import { get, post, postFor, Refused } from '../api/http';
import type { Bake, Certificate, CommandLine, ExportAsked, RetargetAsked, RetargetDone } from '../api/types';
import { download, h } from '../base/dom';
import { extension, type Files } from '../document/files';
import type { Session } from '../document/session';
import { button, row, section } from './controls';
import { openDialog } from './dialog';

/** Formats that are only written for a character that came as one of these: into its file, or by its human bones. */
const ONLY_FROM: Readonly<Record<string, readonly string[]>> = { gltf: ['gltf'], vrm: ['vrm'], vrma: ['vrm', 'vrma'] };

/** Takes the result home: a file of any format, on another character if wanted, and the command that makes it again. */
export function showExport(session: Session, files: Files): void {
  const result = session.result.value;
  const format = h('select', {});
  const name = h('input', { type: 'text', value: fileName(session.store.document.value.name), spellcheck: 'false' });
  const fps = h('input', { type: 'number', min: 1, max: 240, placeholder: 'own' });
  const bake = h('select', {}, h('option', { value: 'dense' }, 'One a frame'), h('option', { value: 'sparse' }, 'Few, with tangents'), h('option', { value: 'stepped' }, 'Held, on twos'));
  const source = session.store.document.value.source.clips[0];
  const onto = h('select', {});
  const offer = () => {
    const others = session.store.document.value.clips.filter((clip) => clip.role === 'motion' && clip.id !== source);
    onto.replaceChildren(h('option', { value: '' }, 'The clip’s own'), ...others.map((clip) => h('option', { value: clip.id }, clip.name)));
  };
  offer();
  /** What can be written for the character. */
  const choose = () => {
    const own = session.store.document.value.clips.find((clip) => clip.id === (onto.value || source));
    const fits = session.info.formats.filter(({ write, extension: kind }) => write && (ONLY_FROM[kind]?.includes(extension(own?.file ?? '')) ?? true));
    const before = format.value;
    format.replaceChildren(...fits.map(({ extension: kind, name: text }) => h('option', { value: kind }, `${text} (.${kind})`)));
    if (fits.some((fit) => fit.extension === before)) format.value = before;
  };
  choose();
  const certificate = h('div', {});
  const problem = h('p', { class: 'note bad', hidden: true, role: 'alert' });
  let carried: string | null = null;

  onto.addEventListener('change', () => void retarget());
  const retarget = async () => {
    carried = null;
    choose();
    certificate.replaceChildren();
    const of = result?.id ?? source;
    if (onto.value === '' || !of) return;
    certificate.replaceChildren(h('p', { class: 'help' }, 'Putting it on the other character…'));
    await attempt(async () => {
      const done = await post<RetargetDone>('retarget', { of, onto: onto.value } satisfies RetargetAsked);
      carried = done.result;
      certificate.replaceChildren(show(done.certificate));
    });
  };
  files.oncharacter = (clip) => {
    offer();
    onto.value = clip.id;
    void retarget();
  };
  const attempt = async (work: () => Promise<void>) => {
    problem.hidden = true;
    try {
      await work();
    } catch (error) {
      problem.hidden = false;
      problem.textContent = error instanceof Refused ? [error.message, error.hint].filter(Boolean).join(' ') : String(error);
    }
  };
  const save = button('Save file', () => void attempt(async () => {
    const of = carried ?? result?.id ?? source;
    if (!of) return;
    const answer = await postFor('export', { of, format: format.value, fps: fps.value === '' ? null : Number(fps.value), name: name.value || null, bake: bakeOf(bake.value) } satisfies ExportAsked);
    download(await answer.blob(), `${name.value || 'motion'}.${format.value}`);
  }), 'primary');
  save.disabled = !result && !source;

  const code = h('code', { tabindex: 0, 'aria-label': 'The command line' });
  const copy = button('Copy', () => void copyText(code.textContent ?? '', copy));
  const drawn = h('div', { class: 'row' });
  const command = section('The same on the command line', h('div', { class: 'command' }, code, copy), drawn);
  command.hidden = true;
  if (result) {
    void get<CommandLine>('command-line')
      .then(({ text, files: named }) => {
        // Lines break between options, never within their names.
        code.replaceChildren(...text.split(/ (?=-)/).flatMap((option, i) => [i > 0 ? ' ' : '', h('span', {}, option)]));
        const where = named.length > 0 ? 'Runs in the project’s folder, with what was drawn beside it.' : 'Runs in the project’s folder.';
        drawn.replaceChildren(h('span', { class: 'help' }, where), ...named.map((file) => button(`Save ${file.name}`, () => download(new Blob([file.text], { type: 'text/csv' }), file.name))));
        command.hidden = false;
      })
      .catch(() => undefined);
  }
  const content = h(
    'div',
    {},
    result ? null : h('p', { class: 'note' }, 'Nothing was drawn yet: this saves the clip itself.'),
    section('File', row('Format', format), row('Name', name), row('Frames a second', fps), row('Keys', bake)),
    section('Character', row('Goes onto', onto), h('p', { class: 'help' }, 'Drop a character’s file here to put the motion onto it.'), certificate),
    command,
    problem,
  );
  openDialog('Export', content, [save]).addEventListener('close', () => (files.oncharacter = null));
}

/** The certificate: what was measured, beside its limits. */
function show({ verdict, broken, pairs, unmapped, rows }: Certificate): HTMLElement {
  const cells = rows.map(({ name, unit, mean, p95, max, limit }) => {
    const over = limit !== null && p95 > limit;
    const figures = [mean, p95, max, limit].map((value) => h('td', {}, value === null ? '' : value < 10 ? value.toFixed(1) : value.toFixed(0)));
    return h('tr', { class: over ? 'over' : '' }, h('th', { scope: 'row' }, `${name}, ${unit === 'degrees' ? '°' : unit}`), ...figures);
  });
  const head = h('tr', {}, ...['', 'mean', '95 %', 'most', 'limit'].map((text) => (text === '' ? h('td', {}) : h('th', { scope: 'col' }, text))));
  const joints = `${pairs.length} joints follow${unmapped.length > 0 ? `, ${unmapped.length} keep their rest` : ''}.`;
  return h(
    'div',
    { style: 'margin-top:8px' },
    h('p', { class: `note ${broken.length > 0 ? 'warn' : ''}` }, `${verdict.charAt(0).toUpperCase()}${verdict.slice(1)}. ${joints}`),
    h('table', {}, h('caption', { class: 'hidden' }, 'Certificate'), h('thead', {}, head), h('tbody', {}, ...cells)),
  );
}

function bakeOf(kind: string): Bake {
  if (kind === 'sparse') return { kind, millimetres: 1, degrees: 0.5 };
  return kind === 'stepped' ? { kind, frames: 2 } : { kind: 'dense' };
}

function fileName(name: string): string {
  return name.trim().replace(/[^\p{L}\p{N}._-]+/gu, '-').replace(/^-+|-+$/g, '') || 'motion';
}

/** Over plain http to another machine there is no clipboard: then the text is only marked, to be copied by hand. */
async function copyText(text: string, from: HTMLButtonElement): Promise<void> {
  try {
    await navigator.clipboard.writeText(text);
    from.textContent = 'Copied';
  } catch {
    const code = from.parentElement?.querySelector('code');
    if (code) window.getSelection()?.selectAllChildren(code);
    from.textContent = 'Marked';
  }
}
