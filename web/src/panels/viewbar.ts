import type { IconName } from '../base/icons';
import type { Stage, View } from '../viewport/stage';
import { pressed, tool } from './controls';

const SWITCHES: readonly { name: keyof View; icon: IconName; label: string; key: string }[] = [
  { name: 'follow', icon: 'follow', label: 'Camera follows', key: 'C' },
  { name: 'ground', icon: 'ground', label: 'Ground', key: 'G' },
  { name: 'ghosts', icon: 'ghosts', label: 'Ghosts before and after', key: 'O' },
  { name: 'trails', icon: 'trails', label: 'Trails of hands and feet', key: 'T' },
  { name: 'drawn', icon: 'poses', label: 'Drawn poses and ways', key: 'P' },
  { name: 'compare', icon: 'compare', label: 'The clip beside it', key: 'B' },
];

/** What is seen in the viewport. `media` adds what may stand beside it. */
export function viewbar(place: HTMLElement, stage: Stage, extra: readonly HTMLElement[]): void {
  const buttons = SWITCHES.map(({ name, icon, label, key }) => {
    const button = tool(icon, label, () => toggleView(stage, name), key);
    button.dataset['view'] = name;
    return button;
  });
  place.append(...buttons, ...extra, tool('frame', 'Put the camera back', () => stage.frame(), 'Shift+F'));
  const tell = () => {
    for (const button of buttons) {
      pressed(button, stage.view[button.dataset['view'] as keyof View]);
      if (button.dataset['view'] === 'drawn') button.hidden = stage.board.frames.length === 0;
    }
  };
  tell();
  place.addEventListener('viewchange', tell);
}

export function toggleView(stage: Stage, name: keyof View): void {
  stage.view = { ...stage.view, [name]: !stage.view[name] };
  if (name === 'compare') stage.frame();
  tellView();
}

/** What there is to be seen has changed. */
export function tellView(): void {
  document.getElementById('view')?.dispatchEvent(new Event('viewchange'));
}
