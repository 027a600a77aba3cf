/** A raw sample: CSS pixels on the element, seconds since the stroke began, pressure 0 to 1. */
export interface PenSample {
  readonly x: number;
  readonly y: number;
  readonly t: number;
  readonly p: number;
}

export interface PenListener {
  /** Whether a stroke may begin here. */
  begin(sample: PenSample, event: PointerEvent): boolean;
  /** `at` is when the pen was there, on the clock of `performance.now()`. */
  move(samples: readonly PenSample[], at: number): void;
  end(cancelled: boolean): void;
}

/** How much a hand-held point may lag behind the pen to be smooth: of the way, each sample at 120 a second. */
const FOLLOW = 0.55;

/**
 * Strokes of a pen, mouse or finger on an element. Samples between two events are taken where the browser has them (they
 * need a secure context). Fingers beside a pen are the palm and do not draw.
 */
export function listenToPen(element: HTMLElement, listener: PenListener): void {
  let active: { id: number; finger: boolean; begin: number; last: PenSample; x: number; y: number } | null = null;
  let penSeen = false;

  element.addEventListener('pointerdown', (event) => {
    if (event.pointerType === 'pen') penSeen = true;
    // A second finger means to move the paper, and a finger that was there before the pen is the palm: it drew no stroke.
    if (active?.finger && event.pointerId !== active.id && event.pointerType !== 'mouse') {
      active = null;
      listener.end(true);
      if (event.pointerType === 'touch') return;
    }
    const drawing = event.pointerType === 'touch' ? !penSeen && event.isPrimary : event.button === 0;
    if (active || !drawing || event.ctrlKey || event.metaKey) return;
    const sample = read(element, event, event.timeStamp, null);
    if (!listener.begin(sample, event)) return;
    element.setPointerCapture(event.pointerId);
    active = { id: event.pointerId, finger: event.pointerType === 'touch', begin: event.timeStamp, last: sample, x: sample.x, y: sample.y };
    event.preventDefault();
  });

  // Where a browser tells of every sample at once, none waits for the next picture; elsewhere they come with it.
  const moves = 'onpointerrawupdate' in element ? 'pointerrawupdate' : 'pointermove';
  element.addEventListener(moves, (event) => {
    if (!(event instanceof PointerEvent)) return;
    if (!active || event.pointerId !== active.id) return;
    const samples: PenSample[] = [];
    for (const part of coalesced(event)) {
      const raw = read(element, part, active.begin, active.last);
      if (raw.t < active.last.t) continue;
      active.last = raw;
      const keep = Math.pow(1 - FOLLOW, Math.min(Math.max((raw.t - (samples.at(-1)?.t ?? raw.t - 1 / 120)) * 120, 0.25), 2));
      active.x = raw.x + (active.x - raw.x) * keep;
      active.y = raw.y + (active.y - raw.y) * keep;
      samples.push({ ...raw, x: active.x, y: active.y });
    }
    if (samples.length > 0) listener.move(samples, event.timeStamp);
    event.preventDefault();
  });

  const end = (event: PointerEvent, cancelled: boolean) => {
    if (!active || event.pointerId !== active.id) return;
    if (!cancelled) listener.move([active.last], event.timeStamp);
    active = null;
    listener.end(cancelled);
  };
  element.addEventListener('pointerup', (event) => end(event, false));
  element.addEventListener('pointercancel', (event) => end(event, true));
}

function coalesced(event: PointerEvent): PointerEvent[] {
  const parts = typeof event.getCoalescedEvents === 'function' ? event.getCoalescedEvents() : [];
  return parts.length > 0 ? parts : [event];
}

function read(element: HTMLElement, event: PointerEvent, begin: number, before: PenSample | null): PenSample {
  const box = element.getBoundingClientRect();
  const [x, y] = [event.clientX - box.left, event.clientY - box.top];
  const t = Math.max(0, (event.timeStamp - begin) / 1000);
  return { x, y, t, p: pressure(event, x, y, t, before) };
}

/** A mouse has no pressure: quick strokes are thinner, as those of a brush are. */
function pressure(event: PointerEvent, x: number, y: number, t: number, before: PenSample | null): number {
  if (event.pointerType === 'pen' && event.pressure > 0) return event.pressure;
  if (!before) return 0.5;
  const speed = Math.hypot(x - before.x, y - before.y) / Math.max(t - before.t, 1 / 240);
  const wanted = Math.min(Math.max(0.75 - speed / 4000, 0.25), 0.75);
  return before.p + 0.2 * (wanted - before.p);
}
