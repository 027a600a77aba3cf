import './style/tokens.css';
import './style/layout.css';
import './style/controls.css';
import './style/storyboard.css';

import { Refused } from './api/http';
import { byId, calm, h } from './base/dom';
import { css, rampAt } from './base/colour';
import { scheme, setScheme, startScheme, theme } from './base/theme';
import { Board } from './canvas/board';
import { LabelBoard } from './canvas/labelboard';
import { MotionBoard } from './canvas/motionboard';
import { SoundBoard } from './canvas/soundboard';
import { WaveBoard } from './canvas/waveboard';
import { Controls } from './document/controls';
import { Files } from './document/files';
import { timeOf } from './document/keys';
import { Session } from './document/session';
import { linesOf } from './document/storyboardfile';
import { Ui } from './document/ui';
import { Carry } from './panels/carry';
import { acceptDrops, pickFiles } from './panels/drop';
import { showExport } from './panels/export';
import { filesPanel } from './panels/files';
import { guide } from './panels/guide';
import { mapPanel } from './panels/map';
import { keyHere, posesPanel } from './panels/poses';
import { rail } from './panels/rail';
import { Reference } from './panels/reference';
import { reportPanel } from './panels/report';
import { listenToKeys, showShortcuts } from './panels/shortcuts';
import { side } from './panels/side';
import { status } from './panels/status';
import { StoryboardPanel } from './panels/storyboard';
import { toastFailures } from './panels/toast';
import { toolbar } from './panels/toolbar';
import { transport } from './panels/transport';
import { tunePanel } from './panels/tune';
import { tellView, toggleView, viewbar } from './panels/viewbar';
import { Timeline } from './timeline/timeline';
import { Character } from './viewport/character';
import { Grab } from './viewport/grab';
import { duration, type Motion } from './viewport/motion';
import { Stage } from './viewport/stage';

/** Joints that can be dragged in space: those that stand for a limb. */
const JOINTS = ['pelvis', 'left_knee', 'right_knee', 'left_ankle', 'right_ankle', 'left_foot', 'right_foot', 'neck', 'head', 'left_elbow', 'right_elbow', 'left_wrist', 'right_wrist'];

startScheme();
try {
  start(await Session.open());
} catch (error) {
  const text = error instanceof Refused ? [error.message, error.hint].filter(Boolean).join(' ') : String(error);
  byId('app').replaceChildren(h('p', { class: 'nothing', role: 'alert' }, h('b', {}, 'The studio did not open'), text));
}

function start(session: Session): void {
  const ui = new Ui();
  const controls = new Controls(session.store, () => session.player.duration.value);
  const files = new Files(session, controls, (text) => (ui.said.value = text));
  const stage = new Stage(byId('stage') as HTMLCanvasElement);
  const board = new Board(session, ui, byId('ink') as HTMLCanvasElement, byId('pen') as HTMLCanvasElement);
  const character = new Character(session, stage);
  const timeline = new Timeline(session, ui, byId('lanes') as HTMLCanvasElement, byId('head') as HTMLCanvasElement);
  const carry = new Carry(session, ui);
  carry.targets.push(board, timeline);
  const pick = () => pickFiles(files);
  const storyboard = new StoryboardPanel(session.storyboard, (text) => (ui.said.value = text));

  const acts = {
    export: () => showExport(session, files),
    help: showShortcuts,
    guide: () => guide(session, ui, true),
    side: () => byId('app').classList.toggle('wide'),
  };
  toolbar(byId('bar'), session, controls, acts);
  rail(byId('tools'), byId('pen'), session, ui, board, controls);
  viewbar(byId('view'), stage, []);
  transport(byId('transport'), byId('timeline'), session);
  status(byId('status'), session, ui);
  toastFailures(byId('over'), session);
  acceptDrops(files);
  const reference = new Reference(session);
  byId('watching').append(reference.element);
  files.onvideo = (file) => reference.show(file);
  side(byId('side'), [
    { name: 'poses', text: 'Poses', panel: posesPanel(session, ui, carry) },
    { name: 'map', text: 'Map', panel: mapPanel(session, ui, carry) },
    { name: 'tune', text: 'Adjust', panel: tunePanel(session, controls) },
    { name: 'report', text: 'Report', panel: reportPanel(session) },
    { name: 'files', text: 'Files', panel: filesPanel(session, files, { pick, character: character.chosen, beside: ui.beside }) },
  ]);
  boards();
  if (!session.store.document.value.control && session.storyboard.file.value.frames.some((frame) => linesOf(frame).length > 0)) controls.choose('storyboard');
  watch();
  story();
  keys();
  ui.said.subscribe((text) => (byId('said').textContent = text));
  guide(session, ui, false);

  function boards(): void {
    const wave = new WaveBoard(session, ui, controls);
    const sound = new SoundBoard(session, controls, pick);
    const others = { wave, labels: new LabelBoard(session, controls), sound, motion: new MotionBoard(session, controls, pick), storyboard };
    byId('boards').append(...Object.values(others).map((other) => other.element));
    wave.values.onchange = (values) => controls.kind.value === 'wave' && (timeline.wave = values);
    sound.values.onchange = (values) => controls.kind.value === 'sound' && (timeline.wave = values);
    controls.kind.watch((kind) => {
      byId('board').hidden = kind !== 'curve';
      byId('tools').hidden = kind !== 'curve';
      byId('drawing-foot').hidden = kind !== 'curve';
      for (const [name, other] of Object.entries(others)) other.element.hidden = name !== kind;
    });
    const invite = byId('invite');
    const show = () => {
      const { control, source } = session.store.document.value;
      invite.hidden = control?.kind === 'curve' || session.drawing.value !== null;
      invite.replaceChildren(h('b', {}, source.clips.length === 0 ? 'Drop a motion of your character' : 'Draw a line'), source.clips.length === 0 ? 'BVH, FBX or GLB, or take a sample under Files' : 'The character follows while the pen is down');
    };
    session.store.document.watch(show);
    session.drawing.subscribe(show);
    const ramp = h('span', { class: 'ramp', 'aria-hidden': 'true' });
    byId('drawing-foot').append(h('span', {}, 'clip start'), ramp, h('span', {}, 'end'));
    theme.watch(({ ramp: table }) => (ramp.style.background = `linear-gradient(to right, ${[0, 0.2, 0.4, 0.6, 0.8, 1].map((part) => css(rampAt(table, part))).join(', ')})`));
    session.used.watch((used) => (byId('drawing-foot').style.visibility = used && session.store.document.value.control ? 'visible' : 'hidden'));
  }

  /** What the viewport shows follows from the result, the time, and what is pointed at. */
  function watch(): void {
    let beside: Motion | null = null;
    const sourceFrame = () => {
      const used = session.used.value;
      if (!used || used.frames.length === 0) return 0;
      return used.frames[Math.min(Math.round(session.player.seconds.value * used.rate), used.frames.length - 1)] ?? 0;
    };
    const seek = () => {
      const found = session.source.value.find(sourceFrame());
      const whole = beside ? duration(beside) : 0;
      stage.seek(session.player.seconds.value, whole > 0 ? session.player.seconds.value % whole : found ? found.frame / found.part.motion.rate : 0);
      say();
    };
    const say = calm(() => session.live.active !== 0, () => {
      const text = session.used.value ? `clip ${session.source.value.describe(sourceFrame())}` : session.motion.value ? 'the clip as it is' : '';
      if (byId('caption').textContent !== text) byId('caption').textContent = text;
    });
    session.motion.watch((motion) => {
      if (motion) stage.show(motion);
      seek();
    });
    const compare = () => {
      stage.showSource(beside ?? session.source.value.parts[0]?.motion ?? null);
      seek();
    };
    let skeleton = '';
    session.source.watch(({ parts }) => {
      compare();
      const before = skeleton;
      skeleton = parts[0]?.motion.body.names.join(' ') ?? '';
      // Whoever turned the camera keeps it while frames are made anew.
      if (controls.kind.value !== 'storyboard' || skeleton !== before) stage.frame();
    });
    ui.beside.subscribe(async (id) => {
      const motion = id ? (await session.clip(id)).motion : null;
      if (id !== ui.beside.value) return;
      beside = motion;
      compare();
      if (beside && !stage.view.compare) toggleView(stage, 'compare');
      else stage.frame();
    });
    session.store.document.subscribe(({ clips }) => {
      if (ui.beside.value && !clips.some((clip) => clip.id === ui.beside.value)) ui.beside.value = null;
    });
    session.player.seconds.watch(seek);
    session.used.subscribe(seek);
    session.store.document.watch(({ keys: all }) => {
      stage.keyTimes = all.filter((key) => key.kind === 'hard' && key.enabled).flatMap((key) => timeOf(key) ?? []);
    });
    const point = () => {
      const found = ui.pointed.value === null ? null : session.source.value.find(ui.pointed.value);
      stage.keyPose = found ? session.source.value.pose(found.part.clip.id, found.frame) : null;
    };
    ui.pointed.subscribe(point);
    session.player.playing.subscribe((is) => {
      stage.moving = is;
      stage.draw();
      if (is) ui.selected.value = null;
    });
  }

  /** Of an animation of the storyboard, viewport and timeline show what was drawn. */
  function story(): void {
    const { storyboard: board, store, player } = session;
    const RATE = 20;
    const told = () => {
      const { source, control } = store.document.value;
      const made = board.made.value;
      const shown = made && control === null && source.clips.length === 1 && source.clips[0] === made.clip ? made : null;
      return { parts: shown?.frames.filter(({ begins }) => begins !== null) ?? [], transitions: shown?.transitions ?? [] };
    };
    const show = () => {
      const { parts, transitions } = told();
      const blocks = parts.map((part) => {
        const place = board.placeOf(part);
        const from = (part.begins ?? 0) / RATE;
        return { from, to: from + part.frames / RATE, text: `${place < 0 ? '' : `${place + 1} `}${part.word}`, chosen: place >= 0 && place === board.chosen.value };
      });
      timeline.story = parts.length > 0 ? { parts: blocks, transitions: transitions.map(({ begins, frames }) => ({ from: begins / RATE, to: (begins + frames) / RATE })) } : null;
    };
    const drawn = () => {
      const { parts } = told();
      stage.board = { frames: parts, chosen: parts.find((part) => board.placeOf(part) === board.chosen.value) ?? null };
      tellView();
      show();
      hold();
    };
    const between = 'Between two frames nothing can be moved: take another moment';
    // A joint that is dragged in space is moved there in its clip's own space, before that was turned and placed.
    const grab = new Grab(stage, () => player.pause(), (joint, [x, y, z]) => {
      const now = Math.round(player.seconds.value * RATE);
      const part = told().parts.find(({ begins, frames }) => now >= (begins ?? 0) && now < (begins ?? 0) + frames);
      const place = part ? board.placeOf(part) : -1;
      if (!part || place < 0 || board.running) {
        ui.said.value = board.running ? 'The animation is being made' : between;
        return false;
      }
      const frame = board.file.value.frames[place];
      if (frame && !board.told(frame)) {
        ui.said.value = 'The frame was drawn anew: generate it first';
        return false;
      }
      const [dx, dy, dz] = [x - part.shift[0], y - part.shift[1], z - part.shift[2]];
      const [c, s] = [Math.cos(part.turn), Math.sin(part.turn)];
      const at = [c * dx - s * dz, dy, s * dx + c * dz].map((value) => Number(value.toFixed(4)));
      board.choose(place);
      board.moveJoint({ joint, frame: now - (part.begins ?? 0), at: [at[0] ?? 0, at[1] ?? 0, at[2] ?? 0] });
      return true;
    }, (text) => (ui.said.value = text));
    const hold = () => {
      const { parts } = told();
      grab.joints = new Set(controls.kind.value === 'storyboard' && board.available && parts.length > 0 ? JOINTS : []);
    };
    controls.kind.subscribe(hold);
    for (const signal of [board.made, session.source]) signal.watch(drawn);
    store.document.subscribe(drawn);
    board.file.subscribe(show);
    timeline.onpart = (index) => {
      const part = told().parts[index];
      if (part) board.choose(board.placeOf(part));
    };
    // Whoever looks at another frame sees what became of it.
    board.chosen.subscribe((at) => {
      drawn();
      const part = told().parts.find((one) => board.placeOf(one) === at);
      if (part?.begins == null || player.playing.value) return;
      const [from, to] = [part.begins / RATE, (part.begins + part.frames) / RATE];
      if (player.seconds.value < from || player.seconds.value >= to) player.seek(from + (part.keyFrame ?? 0) / RATE);
    });
  }

  function keys(): void {
    const { player, store } = session;
    const kind = (name: Parameters<Controls['choose']>[0]) => () => controls.choose(name);
    const all: Record<string, () => void> = {
      ' ': () => player.toggle(),
      ',': () => player.step(-1),
      '.': () => player.step(1),
      ArrowLeft: () => player.step(-1),
      ArrowRight: () => player.step(1),
      Home: () => player.seek(0),
      End: () => player.seek(player.duration.value),
      L: () => (player.looping.value = !player.looping.value),
      K: () => keyHere(session, ui),
      D: () => (ui.tool.value = 'draw'),
      R: () => (ui.tool.value = 'redraw'),
      A: () => (ui.tool.value = 'add'),
      V: () => (ui.tool.value = 'select'),
      H: () => (ui.tool.value = 'hand'),
      F: () => board.frame(),
      'Shift+F': () => stage.frame(),
      'Shift+D': () => setScheme(scheme() === 'dark' ? 'light' : 'dark'),
      C: () => toggleView(stage, 'follow'),
      G: () => toggleView(stage, 'ground'),
      O: () => toggleView(stage, 'ghosts'),
      T: () => toggleView(stage, 'trails'),
      P: () => toggleView(stage, 'drawn'),
      B: () => toggleView(stage, 'compare'),
      '1': kind('curve'),
      '2': kind('wave'),
      '3': kind('labels'),
      '4': kind('sound'),
      '5': kind('motion'),
      '6': kind('storyboard'),
      '\\': acts.side,
      '?': showShortcuts,
      'Ctrl+Z': () => void store.undo(),
      'Ctrl+Shift+Z': () => void store.redo(),
      'Ctrl+Y': () => void store.redo(),
      'Ctrl+E': acts.export,
      'Ctrl+O': pick,
      Delete: removeKey,
      Backspace: removeKey,
      Escape: () => (ui.selected.value = null),
    };
    // While frames are drawn, their keys come first.
    for (const [key, act] of Object.entries(storyboard.keys)) {
      const other = all[key];
      all[key] = () => (controls.kind.value === 'storyboard' ? act() : other?.());
    }
    listenToKeys(all);
    function removeKey(): void {
      const id = ui.selected.value;
      if (!id) return;
      ui.selected.value = null;
      store.edit('Remove key', [{ type: 'removeKey', id }]);
    }
  }
}
