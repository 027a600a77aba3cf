import { fit, h, onResize, painter } from '../base/dom';
import type { IconName } from '../base/icons';
import { theme } from '../base/theme';
import { StoryboardCanvas, type BoardTool } from '../canvas/storyboard';
import { drawFrame, viewOf } from '../canvas/storyboardview';
import type { Storyboard } from '../document/storyboard';
import type { Exactness } from '../document/storyboardfile';
import { boardCamera } from './boardcamera';
import { boardTakes } from './boardtakes';
import { button, pressed, Segments, Switch, tool } from './controls';
import type { ShortcutActs } from './shortcuts';

const TOOLS: readonly { tool: BoardTool; icon: IconName; label: string; key: string }[] = [
  { tool: 'body', icon: 'poses', label: 'Draw the figure', key: 'D' },
  { tool: 'trajectory', icon: 'trails', label: 'Draw the way of a joint', key: 'R' },
  { tool: 'speed', icon: 'speed', label: 'Draw speed lines beside a way', key: 'Q' },
  { tool: 'scene', icon: 'ground', label: 'Draw what stands around', key: 'S' },
  { tool: 'joints', icon: 'select', label: 'Put joints where they belong', key: 'V' },
  { tool: 'eraser', icon: 'eraser', label: 'Erase lines and pins', key: 'E' },
];

/** Drawn frames that become one animation: the strip of frames, the sheet, the word, and what makes it. */
export class StoryboardPanel {
  readonly element: HTMLElement;
  readonly keys: ShortcutActs;
  readonly #canvas: StoryboardCanvas;
  readonly #strip = h('div', { class: 'frames', role: 'group', 'aria-label': 'Frames' });
  readonly #said = h('p', { class: 'board-said', role: 'status' });
  readonly #word = h('input', { type: 'text', placeholder: 'Word: kick', 'aria-label': 'Word of the frame', list: 'board-words', maxlength: 100, spellcheck: 'false' });
  readonly #thumbs: () => void;

  constructor(
    readonly story: Storyboard,
    say: (text: string) => void,
  ) {
    this.#canvas = new StoryboardCanvas(story, say);
    this.#thumbs = painter(() => this.#paint(), this.#strip);
    onResize(this.#strip, this.#thumbs);
    this.element = h('div', { class: 'board editor storyboard' }, this.#top(), h('div', { class: 'sheet-box' }, this.#tools(), this.#canvas.element, boardTakes(story)), this.#said, this.#foot());
    const make = () => void story.make();
    this.keys = {
      ...Object.fromEntries(TOOLS.map(({ tool: name, key }) => [key, () => (this.#canvas.tool.value = name)])),
      '[': () => story.choose(story.chosen.value - 1),
      ']': () => story.choose(story.chosen.value + 1),
      '{': () => story.move(-1),
      '}': () => story.move(1),
      N: () => story.add(false),
      'Shift+N': () => story.add(true),
      Delete: () => story.remove(),
      Backspace: () => story.remove(),
      'Ctrl+Z': () => story.undo(),
      'Ctrl+Shift+Z': () => story.redo(),
      'Ctrl+Y': () => story.redo(),
      'Ctrl+Enter': make,
      M: () => void story.make(true),
      Escape: () => void story.cancel(),
    };
    story.file.subscribe(() => this.#build());
    story.chosen.subscribe(() => this.#build());
    theme.subscribe(() => this.#thumbs());
    for (const signal of [story.job, story.problem, story.made, story.chosen, story.file]) signal.subscribe(() => this.#tell());
    story.job.subscribe((job) => {
      if (job?.state === 'done') say('The animation is shown, and is a clip under Files');
      else if (job?.state === 'cancelled') say('Stopped');
    });
    this.#build();
    this.#tell();
  }

  #top(): HTMLElement {
    const { story } = this;
    const gone = tool('clear', 'Delete the frame', () => story.remove(), 'Delete');
    const back = tool('undo', 'Undo in the storyboard', () => story.undo(), 'Ctrl+Z');
    const acts = [
      tool('add2', 'Add a frame', () => story.add(false), 'N'),
      tool('copy', 'Copy the frame', () => story.add(true), 'Shift+N'),
      gone,
      tool('stepBack', 'Move the frame back', () => story.move(-1), '{'),
      tool('stepOn', 'Move the frame on', () => story.move(1), '}'),
      back,
    ];
    for (const act of acts) act.classList.add('small');
    return h('div', { class: 'frame-bar' }, this.#strip, h('div', { class: 'group', role: 'toolbar', 'aria-label': 'Frames' }, ...acts));
  }

  #tools(): HTMLElement {
    const buttons = TOOLS.map(({ tool: name, icon, label, key }) => {
      const one = tool(icon, label, () => (this.#canvas.tool.value = name), key);
      one.dataset['ink'] = name;
      return one;
    });
    this.#canvas.tool.watch((now) => buttons.forEach((one) => pressed(one, one.dataset['ink'] === now)));
    return h('div', { class: 'rail', role: 'toolbar', 'aria-label': 'Pens', 'aria-orientation': 'vertical' }, ...buttons);
  }

  #foot(): HTMLElement {
    const { story } = this;
    const words = h('datalist', { id: 'board-words' }, ...story.words.map((value) => h('option', { value })));
    this.#word.addEventListener('change', () => story.change({ word: this.#word.value.trim() }));
    const exact = new Segments<Exactness>(
      'How exactly the drawing is met',
      [
        { value: 'off', text: 'Off', title: 'Only the word counts' },
        { value: 'soft', text: 'Soft', title: 'The motion is drawn to the lines while it is made' },
        { value: 'pin', text: 'Pin', title: 'And then moved until it meets them' },
      ],
      (value) => (story.exact = value),
    );
    exact.value = story.exact;
    const timed = new Switch('Pen’s speed', (on) => (this.#canvas.timed.value = on), 'A way that is drawn twice as fast takes half the time');
    timed.value = true;
    const joints = new Switch('Joints', (on) => (this.#canvas.shows.value = on), 'Show the joints that were read over the ink');
    joints.value = true;
    const one = button('Generate frame', () => void story.make(true));
    one.title = 'Only the frame that is shown (M)';
    one.setAttribute('aria-keyshortcuts', 'M');
    const make = button('Generate all', () => void story.make(), 'primary');
    make.setAttribute('aria-keyshortcuts', 'Control+Enter');
    make.disabled = one.disabled = !story.available;
    const stop = button('Cancel', () => void story.cancel());
    const bar = h('progress', { max: 1, value: 0, 'aria-label': 'Progress' });
    story.job.watch((job) => {
      const running = job?.state === 'running';
      make.hidden = one.hidden = running;
      stop.hidden = bar.hidden = !running;
      bar.value = job && job.total > 0 ? Math.max(job.done / job.total, 0.03) : 0.03;
    });
    return h(
      'div',
      { class: 'board-foot' },
      h('div', { class: 'board-row' }, this.#word, words, boardCamera(story), h('span', { class: 'spring' }), joints.element),
      this.#edits(),
      h('div', { class: 'board-row' }, exact.element, timed.element, h('span', { class: 'spring' }), bar, stop, one, make),
    );
  }

  /** What was moved in space. */
  #edits(): HTMLElement {
    const { story } = this;
    const text = h('span', { class: 'soft' });
    const lock = new Switch('Lock ends', (on) => story.moved({ lock_ends: on }), 'The clip begins and ends as it did, so that no other clip moves');
    const none = button('Undo all moves', () => story.moved({ edits: [] }));
    const row = h('div', { class: 'board-row' }, text, lock.element, h('span', { class: 'spring' }), none);
    const show = () => {
      const { edits = [], lock_ends = false } = story.frame;
      row.hidden = edits.length === 0;
      text.textContent = `${edits.length} ${edits.length === 1 ? 'joint' : 'joints'} moved in 3D`;
      lock.value = lock_ends;
      none.disabled = lock.disabled = story.running;
    };
    for (const signal of [story.file, story.chosen, story.job]) signal.subscribe(show);
    show();
    return row;
  }

  #build(): void {
    const { story } = this;
    const { frames } = story.file.value;
    const had = this.#strip.contains(document.activeElement);
    if (document.activeElement !== this.#word || this.#word.value.trim() !== (story.frame.word ?? '')) this.#word.value = story.frame.word ?? '';
    this.#strip.replaceChildren(
      ...frames.map((frame, i) => {
        const one = h('button', { type: 'button', class: 'frame', title: `Frame ${i + 1} of ${frames.length}`, onclick: () => story.choose(i) }, h('canvas', { 'aria-hidden': 'true' }), h('span', {}, h('i', { class: 'hidden' }, 'Frame '), `${i + 1} ${frame.word ?? ''}`));
        pressed(one, i === story.chosen.value);
        return one;
      }),
    );
    const now = this.#strip.children[story.chosen.value];
    if (now instanceof HTMLElement) {
      now.scrollIntoView({ block: 'nearest', inline: 'nearest' });
      if (had) now.focus();
    }
    this.#thumbs();
  }

  #paint(): void {
    this.story.file.value.frames.forEach((frame, i) => {
      const canvas = this.#strip.children[i]?.querySelector('canvas');
      if (!canvas) return;
      const { context, width, height } = fit(canvas);
      drawFrame(context, viewOf(frame, width, height, 3), frame, 1.4);
    });
  }

  /** What goes on, what is wrong, or what was made of the frame that is shown. */
  #tell(): void {
    const { story } = this;
    const job = story.job.value;
    const told = story.told();
    let text = '';
    if (story.problem.value) text = story.problem.value;
    else if (!story.available) text = 'This inkrig makes no animations of storyboards; drawings are kept.';
    else if (job?.state === 'running') text = job.level > 0 ? `Making frame ${job.level} of ${job.levels}` : job.done > 0 ? 'Joining the frames' : 'Reading the drawings';
    else if (job?.state === 'cancelled') text = 'Stopped. The animation before it is still there.';
    else if (told) {
      const { made, still } = told;
      const whole = story.made.value;
      const now = whole?.frames.includes(made) ?? false;
      const centimetres = (metres: number) => `${(100 * metres).toFixed(1)} cm`;
      const ways = made.ways.length > 0 ? `Way of ${made.ways.map(({ joint }) => joint.replace('_', ' ')).join(', ')}. ` : '';
      text = `${still && now ? '' : 'Changed since it was made. '}${ways}${centimetres(made.meanMiss)} off the drawing, ${centimetres(made.worstMiss)} at most. ${[...made.notes, ...(now ? (whole?.notes ?? []) : [])].join(' ')}`;
    }
    this.#said.classList.toggle('bad', story.problem.value !== null);
    if (this.#said.textContent !== text) this.#said.textContent = text;
    this.#said.hidden = text === '';
  }
}
