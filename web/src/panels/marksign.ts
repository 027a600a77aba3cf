import type { KeyKind } from '../api/types';

/** The sign of a kind of key as SVG, the same as `drawMark` draws. */
export function markSign(kind: KeyKind): SVGSVGElement {
  const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  svg.setAttribute('viewBox', '0 0 18 18');
  svg.setAttribute('class', 'mark');
  svg.setAttribute('aria-hidden', 'true');
  svg.innerHTML = SIGNS[kind];
  return svg;
}

const LINE = 'fill="none" stroke="currentColor" stroke-width="1.8" stroke-linejoin="round" stroke-linecap="round"';
const SIGNS: Readonly<Record<KeyKind, string>> = {
  soft: `<circle cx="9" cy="9" r="5.5" ${LINE}/><circle cx="9" cy="9" r="1.9" fill="currentColor"/>`,
  hard: `<path d="M9 2.500L15.500 9 9 15.500 2.500 9z" fill="currentColor"/>`,
  avoid: `<circle cx="9" cy="9" r="5.500" ${LINE}/><path d="M6.500 9h5" ${LINE}/>`,
  never: `<rect x="3.800" y="3.800" width="10.400" height="10.400" ${LINE}/><path d="M6.700 6.700l4.600 4.600M11.300 6.700l-4.600 4.600" ${LINE}/>`,
  fixed: `<rect x="2.500" y="6.500" width="13" height="5" fill="currentColor"/>`,
};
