export type Vec2 = readonly [number, number];
export type Vec3 = readonly [number, number, number];

export function clamp(value: number, low: number, high: number): number {
  return Math.min(Math.max(value, low), high);
}

export function mix(from: number, to: number, part: number): number {
  return from + (to - from) * part;
}

/** Index of the first entry of a rising list that is not below `value`; the length when all are. */
export function lowerBound(rising: ArrayLike<number>, value: number): number {
  let [low, high] = [0, rising.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((rising[middle] ?? 0) < value) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** Round values from 0 to `total`, about `count` of them. */
export function ticks(total: number, count: number): number[] {
  if (!(total > 0)) return [0];
  const rough = total / Math.max(count, 1);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5, 10].find((factor) => factor * power >= rough * 0.999) ?? 10);
  return Array.from({ length: Math.floor(total / step + 1e-6) + 1 }, (_, i) => Number((i * step).toPrecision(6)));
}

/** `0:07.25`, and `1:02:03.00` beyond an hour. */
export function clock(seconds: number): string {
  const whole = Math.max(0, seconds);
  const minutes = Math.floor(whole / 60);
  return `${minutes}:${(whole % 60).toFixed(2).padStart(5, '0')}`;
}
