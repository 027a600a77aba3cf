import type { Gauge } from '../api/types';
import { calm, h } from '../base/dom';
import type { Session } from '../document/session';
import type { Ui } from '../document/ui';

const NAMES: Readonly<Record<string, string>> = {
  structure: 'Structure',
  nearness: 'Nearness',
  coverage: 'Coverage',
  freeze: 'Stillness',
  jumps: 'Jumps',
  slide: 'Foot slide',
  speed: 'Speed',
  jerk: 'Jerk',
  seam: 'Seam',
};

/** The gauges that fit in the status line. */
const SHORT = ['structure', 'nearness', 'freeze', 'jumps', 'slide'];

export function gaugeName(gauge: Gauge): string {
  return NAMES[gauge.name] ?? gauge.name;
}

/** The bottom line: how good the result is, what is being computed, how quickly the pen is answered. */
export function status(line: HTMLElement, session: Session, ui: Ui): void {
  const gauges = h('div', { class: 'row', style: 'gap:16px' });
  const said = h('span', { class: 'said' });
  const work = h('span', {});
  const speed = h('span', { title: 'From the move of the pen to the new pose on the screen; in brackets the part of the program' });
  const saved = h('span', {});
  line.append(gauges, said, h('span', { class: 'spring' }), work, speed, saved);
  session.result.watch((result) => {
    gauges.replaceChildren(
      ...(result?.gauges ?? [])
        .filter((gauge) => SHORT.includes(gauge.name))
        .map((gauge) => h('span', { class: `chip ${gauge.verdict}`, title: gauge.text }, gaugeName(gauge), h('i', { style: `--done:${100 * fill(gauge)}%` }), h('b', {}, number(gauge.value)))),
    );
  });
  const working = () => {
    const job = session.job.value;
    const running = job?.state === 'running';
    work.textContent = running ? `Solving, level ${job.level} of ${job.levels}` : session.stale.value && session.result.value ? 'Preview' : '';
  };
  session.job.watch(working);
  session.stale.subscribe(working);
  const tell = calm(() => session.live.active !== 0, () => {
    const latency = session.latency.value;
    speed.textContent = latency ? `pen to pose ${latency.whole.toFixed(0)} ms (${latency.solve.toFixed(0)})` : '';
  });
  session.latency.watch(tell);
  const keep = () => {
    const state = session.connected.value ? session.store.saved.value : 'offline';
    saved.textContent = state === 'saved' ? 'Saved' : state === 'saving' ? 'Saving' : 'Not connected';
  };
  session.store.saved.watch(keep);
  session.connected.subscribe(keep);
  ui.said.watch((text) => (said.textContent = text));
}

/** How full a gauge is: 1 is as good as can be. */
export function fill(gauge: Gauge): number {
  const higher = ['structure', 'coverage'].includes(gauge.name);
  const part = higher ? gauge.value : gauge.good > 0 ? gauge.value / (2 * gauge.good) : gauge.value;
  return Math.min(Math.max(part, 0.02), 1);
}

export function number(value: number): string {
  if (!Number.isFinite(value)) return '–';
  return Math.abs(value) < 10 ? value.toFixed(2) : value.toFixed(0);
}
