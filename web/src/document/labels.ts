import type { LabelSegment } from '../api/types';
import { fromHex, textOn } from '../base/colour';

/** The segment's own colour, else one that its name always has. */
export function labelColour(all: readonly LabelSegment[], label: LabelSegment, dark: boolean): string {
  const own = ownColour(label);
  if (own) return own;
  const names = [...new Set(all.map((other) => other.name))];
  const hue = (names.indexOf(label.name) * 137.5 + 255) % 360;
  return `oklch(${dark ? 0.74 : 0.5} 0.12 ${hue.toFixed(0)})`;
}

/** Of a name that stands on the segment's colour. */
export function labelText(label: LabelSegment, dark: boolean): string {
  const own = ownColour(label);
  return own ? textOn(fromHex(own)) : dark ? '#0f1012' : '#ffffff';
}

/** Moves the border behind a segment by some seconds; the neighbour gives or takes them. */
export function moveBorder(labels: readonly LabelSegment[], index: number, seconds: number): LabelSegment[] {
  const [a, b] = [labels[index], labels[index + 1]];
  if (!a) return [...labels];
  const least = 0.1;
  const by = Math.max(least - a.seconds, b ? Math.min(seconds, b.seconds - least) : seconds);
  const round = (value: number) => Number(value.toFixed(2));
  return labels.map((label, i) => {
    if (i === index) return { ...label, seconds: round(a.seconds + by) };
    if (b && i === index + 1) return { ...label, seconds: round(b.seconds - by) };
    return label;
  });
}

function ownColour({ colour }: LabelSegment): string | null {
  return colour && /^#[0-9a-f]{6}$/i.test(colour) ? colour : null;
}
