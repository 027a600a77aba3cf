type Attributes = Record<string, string | number | boolean | EventListener | undefined>;

/** An element with attributes (`onclick` and the like are listeners) and children. */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: (Node | string | null)[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === undefined || value === false) continue;
    if (typeof value === 'function') element.addEventListener(name.slice(2), value);
    else element.setAttribute(name, value === true ? '' : String(value));
  }
  element.append(...children.filter((child) => child !== null));
  return element;
}

/** The element of the page with that id. */
export function byId(id: string): HTMLElement {
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page has no #${id}`);
  return element;
}

/** Between two pictures of what is beside a pen that draws, milliseconds. */
const CALM = 200;

let processorDraws = false;

/** Without a graphics card, canvases are quicker when they never pretend to have one. To be said before any is drawn. */
export function drawByProcessor(): void {
  processorDraws = true;
}

/** Fits a canvas to its place on the page; what is drawn counts in CSS pixels. */
export function fit(canvas: HTMLCanvasElement): { context: CanvasRenderingContext2D; width: number; height: number } {
  const density = Math.min(window.devicePixelRatio || 1, 2);
  const [width, height] = [Math.max(canvas.clientWidth, 1), Math.max(canvas.clientHeight, 1)];
  const [w, hh] = [Math.round(width * density), Math.round(height * density)];
  if (canvas.width !== w) canvas.width = w;
  if (canvas.height !== hh) canvas.height = hh;
  const context = canvas.getContext('2d', { willReadFrequently: processorDraws });
  if (!context) throw new Error('this browser draws no canvas');
  context.setTransform(density, 0, 0, density, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height };
}

/** Runs `draw` once before the next picture, however often it is asked for; not while `seen` is hidden. */
export function painter(draw: () => void, seen: HTMLElement | null = null): () => void {
  let asked = false;
  return () => {
    if (asked || (seen && seen.offsetParent === null)) return;
    asked = true;
    requestAnimationFrame(() => {
      asked = false;
      draw();
    });
  };
}

/** Runs `draw` at once, but while `busy` at most every `CALM` milliseconds: what moves then comes first. */
export function calm(busy: () => boolean, draw: () => void): () => void {
  let waiting = 0;
  return () => {
    if (!busy()) draw();
    else if (waiting === 0) waiting = window.setTimeout(() => ((waiting = 0), draw()), CALM);
  };
}

/** Whether somebody asked their system for less motion: then nothing plays by itself. */
export function wantsCalm(): boolean {
  return matchMedia('(prefers-reduced-motion: reduce)').matches;
}

/** Calls `resized` whenever an element gets another size. */
export function onResize(element: Element, resized: () => void): void {
  new ResizeObserver(resized).observe(element);
}

export function download(blob: Blob, name: string): void {
  const link = h('a', { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
