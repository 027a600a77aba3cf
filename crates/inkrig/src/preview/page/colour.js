// Colours: those of the page's style, and the ramp over the time of the clip.

/** The style's colours, read again when the theme changes. */
function readTheme() {
  const style = getComputedStyle(document.documentElement);
  const theme = { dark: matchMedia("(prefers-color-scheme: dark)").matches };
  for (const name of ["panel", "ink", "soft", "line", "grid", "accent", "left", "right", "middle", "shadow", "key", "drawn"]) {
    theme[name] = fromHex(style.getPropertyValue(`--${name}`).trim());
  }
  return theme;
}

function fromHex(hex) {
  const number = Number.parseInt(hex.slice(1), 16);
  return [(number >> 16) & 255, (number >> 8) & 255, number & 255];
}

function css(rgb, alpha = 1) {
  return `rgb(${Math.round(rgb[0])} ${Math.round(rgb[1])} ${Math.round(rgb[2])} / ${alpha})`;
}

function mix(from, to, part) {
  return from.map((value, i) => value + (to[i] - value) * part);
}

/**
 * The colour of a part (0 to 1) of the clip. Hue runs from violet over blue, green and gold to red, in OKLCH, where
 * equal steps look equal; lightness rises too, so that the order is seen without hues.
 */
function rampColour(part, theme) {
  const lightness = theme.dark ? 0.62 + 0.2 * part : 0.5 + 0.2 * part;
  const hue = ((295 - 250 * part) * Math.PI) / 180;
  return fromOklch(lightness, theme.dark ? 0.135 : 0.145, hue);
}

/** OKLCH to sRGB (0 to 255), chroma lowered until it fits (Ottosson 2020). */
function fromOklch(lightness, chroma, hue) {
  for (let c = chroma; c > 0; c -= 0.01) {
    const rgb = fromOklab(lightness, c * Math.cos(hue), c * Math.sin(hue));
    if (rgb.every((value) => value >= 0 && value <= 1)) return rgb.map((value) => 255 * gamma(value));
  }
  return fromOklab(lightness, 0, 0).map((value) => 255 * gamma(clamp(value, 0, 1)));
}

function fromOklab(lightness, a, b) {
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  return [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ];
}

function gamma(value) {
  return value <= 0.0031308 ? 12.92 * value : 1.055 * value ** (1 / 2.4) - 0.055;
}

/** The ramp in 256 steps. */
function rampTable(theme) {
  return Array.from({ length: 256 }, (_, i) => rampColour(i / 255, theme));
}

function rampAt(table, part) {
  return table[Math.round(clamp(part, 0, 1) * 255)];
}

