import { h } from '../base/dom';
import type { Session } from '../document/session';
import { button, section } from './controls';
import { fill, gaugeName, number } from './status';

/** What the result is worth, in numbers that cannot all be good at once. */
export function reportPanel(session: Session): HTMLElement {
  const place = h('div', {});
  session.result.watch((result) => {
    if (!result) {
      place.replaceChildren(h('p', { class: 'help' }, 'Draw something: the report comes with the first full result.'));
      return;
    }
    const gauges = result.gauges.map((gauge) => {
      const meter = h('span', { class: 'meter' }, h('i', { style: `width:${100 * fill(gauge)}%` }));
      if (gauge.baseline !== null) meter.append(h('u', { style: `left:${100 * fill({ ...gauge, value: gauge.baseline })}%`, title: `Without inkrig: ${number(gauge.baseline)}` }));
      return h('div', { class: `gauge ${gauge.verdict}`, title: gauge.text }, h('span', {}, gaugeName(gauge)), meter, h('b', {}, number(gauge.value)));
    });
    const bad = Object.entries(result.badFrames).filter(([, frames]) => frames.length > 0);
    const jumps = bad.map(([kind, frames]) =>
      h('div', { class: 'row' }, h('span', { class: 'text' }, `${BAD[kind] ?? kind}: ${frames.length} ${frames.length === 1 ? 'frame' : 'frames'}`), button('Show', () => session.player.seek((frames[0] ?? 0) / result.frameRate))),
    );
    const notes = result.notes.map((note) => h('p', { class: 'note warn' }, note));
    place.replaceChildren(
      section('Quality', ...gauges, h('p', { class: 'help' }, 'Bars fill with the value; the thin mark is the clip merely stretched to the length.')),
      ...(jumps.length > 0 ? [section('Red on the timeline', ...jumps)] : []),
      ...(notes.length > 0 ? [section('Notes', ...notes)] : []),
      section(
        'Result',
        h('p', { class: 'soft' }, `${result.frames} frames at ${number(result.frameRate)} a second, ${result.seconds.toFixed(2)} s`),
        h('p', { class: 'soft' }, `Mirror image of itself: ${Math.round(100 * result.mirrorSymmetry)} %${result.ambiguous ? ', ambiguous' : ''}`),
      ),
    );
  });
  return place;
}

const BAD: Readonly<Record<string, string>> = { jump: 'Jumps', slide: 'Feet slide', freeze: 'Stands still' };
