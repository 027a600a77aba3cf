import { calm, h } from '../base/dom';
import { icon } from '../base/icons';
import { clock } from '../base/maths';
import { SPEEDS } from '../document/player';
import type { Session } from '../document/session';
import { pressed, Segments, tool } from './controls';

/** Play, step, loop, speed, and the clock. */
export function transport(place: HTMLElement, timeline: HTMLElement, session: Session): void {
  const { player } = session;
  const play = tool('play', 'Play', () => player.toggle(), 'Space');
  play.classList.add('play');
  const loop = tool('loop', 'Loop', () => (player.looping.value = !player.looping.value), 'L');
  const [now, whole] = [document.createTextNode(''), h('small', {})];
  const time = h('span', { class: 'clock' }, now, whole);
  const speeds = new Segments(
    'Speed',
    SPEEDS.map((speed) => ({ value: String(speed), text: speed === 0.25 ? '¼' : speed === 0.5 ? '½' : `${speed}×` })),
    (speed) => (player.speed.value = Number(speed)),
  );
  const frame = h('span', { class: 'soft' });
  place.append(
    h('div', { class: 'group' }, tool('back', 'To the start', () => player.seek(0), 'Home'), tool('stepBack', 'One frame back', () => player.step(-1), ','), play, tool('stepOn', 'One frame on', () => player.step(1), '.'), loop),
    time,
    frame,
    h('div', { class: 'spring' }),
    speeds.element,
  );
  // A slider of the keyboard and of screen readers for what the timeline is for the pointer.
  const scrub = h('input', { type: 'range', class: 'scrubber', min: 0, step: 'any', 'aria-label': 'Time' });
  scrub.addEventListener('input', () => {
    player.pause();
    player.seek(Number(scrub.value));
  });
  timeline.append(scrub);
  player.playing.watch((is) => {
    play.replaceChildren(icon(is ? 'pause' : 'play'));
    play.setAttribute('aria-label', is ? 'Pause' : 'Play');
    play.title = is ? 'Pause (Space)' : 'Play (Space)';
  });
  player.looping.watch((is) => pressed(loop, is));
  player.speed.watch((speed) => (speeds.value = String(speed)));
  const tell = calm(() => session.live.active !== 0, () => {
    now.data = clock(player.seconds.value);
    whole.textContent = ` / ${clock(player.duration.value)}`;
    frame.textContent = `frame ${Math.round(player.seconds.value * player.rate)}`;
    scrub.max = String(player.duration.value);
    scrub.value = String(player.seconds.value);
    scrub.setAttribute('aria-valuetext', `${player.seconds.value.toFixed(2)} seconds`);
  });
  player.seconds.subscribe(tell);
  player.duration.watch(tell);
}
