import { post, Refused, upload } from '../api/http';
import type { Added, ClipInfo, DrawingRead, Info, SoundAdded } from '../api/types';
import type { Controls } from './controls';
import type { Session } from './session';

const SOUNDS = ['wav', 'mp3', 'flac', 'ogg', 'oga'];
const DRAWINGS = ['svg', 'csv', 'json'];
const BESIDE = ['asf', 'bin'];
const VIDEOS = ['mp4', 'webm', 'mov', 'm4v'];

/** Files from the user's machine: each goes where its kind belongs. */
export class Files {
  onvideo: (file: File) => void = () => undefined;
  /** While somebody waits for a character, motions that come are that and are not arranged. */
  oncharacter: ((clip: ClipInfo) => void) | null = null;

  constructor(
    readonly session: Session,
    readonly controls: Controls,
    readonly say: (text: string) => void,
  ) {}

  async take(files: readonly File[]): Promise<void> {
    const beside: string[] = [];
    // What others lie beside of goes first.
    for (const file of files.filter((candidate) => BESIDE.includes(extension(candidate.name)))) {
      const { id } = await upload<{ id: string }>(`uploads?name=${encodeURIComponent(file.name)}`, file);
      beside.push(id);
    }
    for (const file of files.filter((candidate) => !BESIDE.includes(extension(candidate.name)))) {
      try {
        await this.#one(file, beside);
      } catch (error) {
        const refused = error instanceof Refused ? error : new Refused('page', String(error), null);
        this.session.store.failed.value = new Refused(refused.code, `${file.name}: ${refused.message}`, refused.hint);
      }
    }
  }

  /** A clip or drawing that comes with the program. */
  async sample(sample: Info['samples'][number]): Promise<void> {
    if (sample.kind === 'curve') {
      const { control } = await post<Added>(`samples/${sample.name}`, {});
      this.controls.set(control, `Drawing ${sample.name}`);
      return;
    }
    const added = await post<Added>(`samples/${sample.name}`, {});
    await this.#added(added, this.controls.kind.value !== 'motion');
  }

  async #one(file: File, beside: readonly string[]): Promise<void> {
    const kind = extension(file.name);
    const name = encodeURIComponent(file.name);
    if (VIDEOS.includes(kind)) {
      this.onvideo(file);
    } else if (SOUNDS.includes(kind)) {
      const added = await upload<SoundAdded>(`sounds?name=${name}`, file);
      await this.session.store.follow(added, null);
      this.controls.set({ kind: 'sound', sound: added.sound.id, smooth: null, outline: false }, `Sound ${added.sound.name}`);
      this.controls.kind.value = 'sound';
    } else if (DRAWINGS.includes(kind)) {
      const { control, note } = await upload<DrawingRead>(`drawings?name=${name}`, file);
      this.controls.set(control, `Drawing ${file.name}`);
      if (note) this.say(note);
    } else {
      const added = await upload<Added>(`clips?name=${name}${beside.length > 0 ? `&beside=${beside.join(',')}` : ''}`, file);
      await this.#added(added, this.controls.kind.value !== 'motion');
    }
  }

  /** A motion that was dropped is the one to arrange, or the one that steers while such a one is asked for. */
  async #added(added: Added, arrange: boolean): Promise<void> {
    await this.session.store.follow(added, null);
    const [clip] = added.clips;
    if (!clip) return;
    await this.session.clip(clip.id);
    if (this.oncharacter) {
      this.oncharacter(clip);
      return;
    }
    // A mesh that does not move has nothing to arrange: the motion goes onto it.
    if (clip.hasSkin && clip.frames <= 1) {
      this.say(`${clip.name} is a character without motion: Export puts the motion onto it.`);
      return;
    }
    const { source } = this.session.store.document.value;
    if (!arrange && !source.clips.includes(clip.id)) this.controls.set({ kind: 'motion', clip: clip.id }, `Follow ${clip.name}`);
    else if (!source.clips.includes(clip.id)) {
      // Poses of another character mean nothing to this one.
      const keys = this.session.store.document.value.keys.filter((key) => key.pose === null || key.pose.clip === clip.id);
      this.session.store.edit(`Arrange ${clip.name}`, [{ type: 'setSource', source: { ...source, clips: [clip.id], range: null } }, { type: 'setKeys', keys }]);
    }
    this.say(added.warnings[0] ?? `${clip.name}: ${clip.frames} frames, ${clip.joints} joints`);
  }
}

export function extension(name: string): string {
  return /\.([^.]+)$/.exec(name)?.[1]?.toLowerCase() ?? '';
}
