import { clamp, mix } from './maths';

export type Rgb = readonly [number, number, number];

export function css(rgb: Rgb, alpha = 1): string {
  return `rgb(${Math.round(rgb[0])} ${Math.round(rgb[1])} ${Math.round(rgb[2])} / ${alpha})`;
}

export function hex(rgb: Rgb): number {
  return (Math.round(rgb[0]) << 16) | (Math.round(rgb[1]) << 8) | Math.round(rgb[2]);
}

export function fromHex(text: string): Rgb {
  const number = Number.parseInt(text.trim().slice(1), 16);
  return [(number >> 16) & 255, (number >> 8) & 255, number & 255];
}

/** Black or white, whichever is easier to read on a colour (WCAG 2.2, relative luminance). */
export function textOn([r, g, b]: Rgb): string {
  const [lr, lg, lb] = [r, g, b].map((value) => (value <= 10.3 ? value / 3294.6 : ((value / 255 + 0.055) / 1.055) ** 2.4)) as [number, number, number];
  return 0.2126 * lr + 0.7152 * lg + 0.0722 * lb > 0.179 ? '#0f1012' : '#ffffff';
}

export function blend(from: Rgb, to: Rgb, part: number): Rgb {
  return [mix(from[0], to[0], part), mix(from[1], to[1], part), mix(from[2], to[2], part)];
}

/**
 * The colours over a part (0 to 1) of the clip, in 256 steps. Hue runs from violet over blue, green and gold to red in
 * OKLCH, where equal steps look equal; lightness rises too, so that the order is seen without hues.
 */
export function rampTable(dark: boolean): Rgb[] {
  return Array.from({ length: 256 }, (_, i) => {
    const part = i / 255;
    const lightness = (dark ? 0.64 : 0.5) + 0.2 * part;
    return oklch(lightness, dark ? 0.13 : 0.145, ((295 - 250 * part) * Math.PI) / 180);
  });
}

export function rampAt(table: readonly Rgb[], part: number): Rgb {
  return table[Math.round(clamp(Number.isFinite(part) ? part : 0, 0, 1) * 255)] ?? [0, 0, 0];
}

/** OKLCH to sRGB (0 to 255), chroma lowered until it fits (Ottosson 2020). */
function oklch(lightness: number, chroma: number, hue: number): Rgb {
  for (let c = chroma; c > 0; c -= 0.01) {
    const rgb = oklab(lightness, c * Math.cos(hue), c * Math.sin(hue));
    if (rgb.every((value) => value >= 0 && value <= 1)) return toBytes(rgb);
  }
  return toBytes(oklab(lightness, 0, 0));
}

function toBytes([r, g, b]: Rgb): Rgb {
  return [255 * gamma(clamp(r, 0, 1)), 255 * gamma(clamp(g, 0, 1)), 255 * gamma(clamp(b, 0, 1))];
}

function oklab(lightness: number, a: number, b: number): Rgb {
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  return [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ];
}

function gamma(value: number): number {
  return value <= 0.0031308 ? 12.92 * value : 1.055 * value ** (1 / 2.4) - 0.055;
}
