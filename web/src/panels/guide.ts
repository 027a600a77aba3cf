import { h } from '../base/dom';
import type { Session } from '../document/session';
import type { Ui } from '../document/ui';
import { button } from './controls';

interface Lesson {
  readonly at: string;
  readonly title: string;
  readonly text: string;
  /** Goes on by itself when that happens. */
  readonly until?: (next: () => void, session: Session, ui: Ui) => () => void;
}

const LESSONS: readonly Lesson[] = [
  {
    at: '#drawing',
    title: 'Draw a line',
    text: 'Draw a few loops on the paper, some small, some large. The character follows while you draw: large movements where the line is large.',
    until: (next, session) => session.store.document.subscribe(({ control }) => control?.kind === 'curve' && next()),
  },
  {
    at: '#watching',
    title: 'Watch',
    text: 'Space plays. Drag to look around. The dot on the line is where the character is now; its colour says which part of the clip it uses.',
    until: (next, session) => session.player.playing.subscribe((is) => is && setTimeout(next, 2500)),
  },
  {
    at: '#side',
    title: 'Ask for a pose',
    text: 'These poses stand for most of the clip. Drag one onto the line: there the motion will be like it. “Never” keeps one away for good.',
    until: (next, session) => session.store.document.subscribe(({ keys }) => keys.length > 0 && next()),
  },
  {
    at: '#timeline',
    title: 'See why',
    text: 'Over time to the right: which moment of the clip is used, from its first below to its last above. Pull the line at any time to another moment to make a key of it.',
  },
  {
    at: '#bar',
    title: 'Take it home',
    text: 'Everything can be undone, and is saved as you go. Export writes BVH, FBX, GLB and more, also onto your own character.',
  },
];

const STORED = 'inkrig.guided';

/** The first run: five short steps beside what they are about. */
export function guide(session: Session, ui: Ui, always: boolean): void {
  try {
    if (!always && localStorage.getItem(STORED)) return;
    localStorage.setItem(STORED, '1');
  } catch {
    if (!always) return;
  }
  document.querySelector('.coach')?.remove();
  show(0, session, ui);
}

function show(index: number, session: Session, ui: Ui): void {
  const lesson = LESSONS[index];
  document.querySelector('.coach')?.remove();
  if (!lesson) return;
  let stop: (() => void) | undefined;
  const leave = () => {
    stop?.();
    card.remove();
  };
  const next = () => {
    if (!card.isConnected) return;
    stop?.();
    show(index + 1, session, ui);
  };
  const last = index === LESSONS.length - 1;
  const card = h(
    'section',
    { class: 'coach', 'aria-label': 'Guided tour' },
    h('h2', {}, lesson.title),
    h('p', {}, lesson.text),
    h('div', { class: 'row' }, h('span', { class: 'text soft' }, `${index + 1} of ${LESSONS.length}`), last ? null : button('Leave', leave, ''), button(last ? 'Done' : 'Next', last ? leave : next, 'quiet')),
  );
  document.getElementById('over')?.append(card);
  place(card, lesson.at);
  stop = lesson.until?.(next, session, ui);
}

/** Beside the middle of what it is about, inside of the window. */
function place(card: HTMLElement, at: string): void {
  const box = document.querySelector(at)?.getBoundingClientRect();
  if (!box) return;
  const [w, hh] = [card.offsetWidth, card.offsetHeight];
  const narrow = box.width < 400 && box.left > w + 20;
  const left = narrow ? box.left - w - 14 : Math.min(Math.max(box.left + box.width - w - 16, 12), window.innerWidth - w - 12);
  const top = box.height < 60 ? box.bottom + 10 : at === '#timeline' ? box.top - hh - 50 : narrow ? box.top + 60 : box.bottom - hh - 40;
  card.style.left = `${left}px`;
  card.style.top = `${Math.min(Math.max(top, 10), window.innerHeight - hh - 10)}px`;
}
