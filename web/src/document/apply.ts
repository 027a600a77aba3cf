import type { Command, Document } from '../api/types';

/** The document after a command, as the server will have it. */
export function apply(document: Document, command: Command): Document {
  switch (command.type) {
    case 'setName':
      return { ...document, name: command.name };
    case 'setSource':
      return { ...document, source: command.source };
    case 'setControl':
      return { ...document, control: command.control };
    case 'setSettings':
      return { ...document, settings: command.settings };
    case 'setPage':
      return { ...document, page: command.page };
    case 'setKeys':
      return { ...document, keys: command.keys };
    case 'putKey': {
      const there = document.keys.some((key) => key.id === command.key.id);
      const keys = there
        ? document.keys.map((key) => (key.id === command.key.id ? command.key : key))
        : [...document.keys, command.key];
      return { ...document, keys };
    }
    case 'removeKey':
      return { ...document, keys: document.keys.filter((key) => key.id !== command.id) };
    case 'renameClip': {
      const clips = document.clips.map((clip) => (clip.id === command.id ? { ...clip, name: command.name } : clip));
      return { ...document, clips };
    }
    case 'removeClip':
      return { ...document, clips: document.clips.filter((clip) => clip.id !== command.id) };
    case 'removeSound':
      return { ...document, sounds: document.sounds.filter((sound) => sound.id !== command.id) };
    case 'clear':
      return { ...document, control: null, keys: [] };
  }
}
