import { fromHex, rampTable, type Rgb } from './colour';
import { Signal } from './signal';

const NAMES = [
  'paper', 'stage', 'panel', 'ink', 'soft', 'line', 'grid', 'accent', 'key', 'trail', 'left', 'right', 'middle', 'bad', 'ghost',
] as const;
export type ColourName = (typeof NAMES)[number];

export interface Theme extends Readonly<Record<ColourName, Rgb>> {
  readonly dark: boolean;
  readonly ramp: readonly Rgb[];
}

export type Scheme = 'dark' | 'light';

/** The style sheet's colours for what is drawn on canvases; changes with the scheme. */
export const theme = new Signal<Theme>(read());

const STORED = 'inkrig.scheme';

export function scheme(): Scheme {
  return document.documentElement.dataset['scheme'] === 'light' ? 'light' : 'dark';
}

export function setScheme(scheme: Scheme): void {
  document.documentElement.dataset['scheme'] = scheme;
  remember(scheme);
  theme.value = read();
}

/** What was chosen last, else what the system has. */
export function startScheme(): void {
  const light = matchMedia('(prefers-color-scheme: light)');
  const follow = () => {
    document.documentElement.dataset['scheme'] = light.matches ? 'light' : 'dark';
    theme.value = read();
  };
  const chosen = remembered();
  if (chosen) setScheme(chosen);
  else {
    follow();
    light.addEventListener('change', () => {
      if (!remembered()) follow();
    });
  }
}

// A browser that stores nothing is no error.
function remember(scheme: Scheme): void {
  try {
    localStorage.setItem(STORED, scheme);
  } catch {
    return;
  }
}

function remembered(): Scheme | null {
  try {
    const stored = localStorage.getItem(STORED);
    return stored === 'dark' || stored === 'light' ? stored : null;
  } catch {
    return null;
  }
}

function read(): Theme {
  const style = getComputedStyle(document.documentElement);
  const dark = document.documentElement.dataset['scheme'] !== 'light';
  const colours = Object.fromEntries(NAMES.map((name) => [name, fromHex(style.getPropertyValue(`--${name}`))]));
  return { ...(colours as Record<ColourName, Rgb>), dark, ramp: rampTable(dark) };
}
