import { css } from '../base/colour';
import { fit, h, painter } from '../base/dom';
import { clamp } from '../base/maths';
import { theme } from '../base/theme';
import type { Storyboard } from '../document/storyboard';
import { CAMERA, lasting } from '../document/storyboardfile';

/** Degrees that a drag of a CSS pixel turns. */
const TURN = 1.5;

/** From where a frame is seen, and how long it lasts: a little figure that is turned by dragging, and numbers. */
export function boardCamera(story: Storyboard): HTMLElement {
  const canvas = h('canvas', { class: 'gizmo', title: 'Drag to turn the view that the frame is drawn in; twice puts it back', 'aria-hidden': 'true' });
  const number = (label: string, low: number, high: number, step: number, text: string) => h('input', { type: 'number', min: low, max: high, step, 'aria-label': label, title: label, placeholder: text });
  const pitch = number('Pitch of the camera, degrees: how far it looks down', -90, 90, 5, '');
  const yaw = number('Yaw of the camera, degrees: how far the figure is turned to the right', -180, 180, 5, '');
  const seconds = number('Seconds of the frame; empty for as long as is needed', 0.1, 60, 0.1, 'auto');
  const now = () => ({ ...CAMERA, ...story.frame.camera });
  let dragged: { x: number; y: number; pitch: number; yaw: number; camera: { pitch_degrees: number; yaw_degrees: number } } | null = null;
  const shown = () => dragged?.camera ?? now();
  const draw = painter(() => paint(canvas, shown()), canvas);
  const show = () => {
    const { pitch_degrees, yaw_degrees } = shown();
    const { seconds: lasts } = story.frame;
    for (const [input, value] of [[pitch, pitch_degrees], [yaw, yaw_degrees], [seconds, lasts ?? '']] as const) {
      if (document.activeElement !== input || dragged) input.value = String(value);
    }
    draw();
  };
  const set = (pitch_degrees: number, yaw_degrees: number) => {
    const before = now();
    if (pitch_degrees !== before.pitch_degrees || yaw_degrees !== before.yaw_degrees) story.change({ camera: { pitch_degrees, yaw_degrees } });
  };
  const typed = (input: HTMLInputElement, low: number, high: number, usual: number) => (input.value === '' ? usual : clamp(Number(input.value) || 0, low, high));
  const view = () => {
    set(typed(pitch, -90, 90, CAMERA.pitch_degrees), typed(yaw, -180, 180, CAMERA.yaw_degrees));
    const { pitch_degrees, yaw_degrees } = now();
    [pitch.value, yaw.value] = [String(pitch_degrees), String(yaw_degrees)];
  };
  pitch.addEventListener('change', view);
  yaw.addEventListener('change', view);
  seconds.addEventListener('change', () => {
    const value = seconds.value === '' ? undefined : clamp(Number(seconds.value) || 0, 0.1, 60);
    if (value !== story.frame.seconds) story.change(lasting(story.frame, value));
    seconds.value = String(value ?? '');
  });
  canvas.addEventListener('pointerdown', (event) => {
    if (event.button !== 0) return;
    canvas.setPointerCapture(event.pointerId);
    const { pitch_degrees, yaw_degrees } = now();
    dragged = { x: event.clientX, y: event.clientY, pitch: pitch_degrees, yaw: yaw_degrees, camera: now() };
  });
  canvas.addEventListener('pointermove', (event) => {
    if (!dragged) return;
    const turned = dragged.yaw + TURN * (event.clientX - dragged.x);
    dragged.camera = { pitch_degrees: Math.round(clamp(dragged.pitch + TURN * (event.clientY - dragged.y), -90, 90)), yaw_degrees: Math.round(((((turned + 180) % 360) + 360) % 360) - 180) };
    show();
  });
  const end = (event: PointerEvent) => {
    const camera = dragged?.camera;
    dragged = null;
    if (camera && event.type === 'pointerup') set(camera.pitch_degrees, camera.yaw_degrees);
    show();
  };
  canvas.addEventListener('pointerup', end);
  canvas.addEventListener('pointercancel', end);
  canvas.addEventListener('dblclick', () => set(CAMERA.pitch_degrees, CAMERA.yaw_degrees));
  for (const signal of [story.file, story.chosen]) signal.subscribe(show);
  theme.subscribe(draw);
  show();
  requestAnimationFrame(draw);
  const field = (text: string, input: HTMLElement, unit: string) => h('span', { class: 'field' }, h('span', { 'aria-hidden': 'true' }, text), input, unit);
  return h('div', { class: 'board-camera', role: 'group', 'aria-label': 'Camera and length of the frame' }, canvas, field('Pitch', pitch, '°'), field('Yaw', yaw, '°'), field('Lasts', seconds, 's'));
}

/** A figure with a nose on a disc, as the camera sees it. */
function paint(canvas: HTMLCanvasElement, { pitch_degrees, yaw_degrees }: { pitch_degrees: number; yaw_degrees: number }): void {
  const { context, width, height } = fit(canvas);
  const [pitch, yaw] = [(pitch_degrees * Math.PI) / 180, (yaw_degrees * Math.PI) / 180];
  const { ink, soft, accent, left, right } = theme.value;
  const scale = height / 2.5;
  const seen = (x: number, y: number, z: number): [number, number] => {
    const [u, w] = [x * Math.cos(yaw) + z * Math.sin(yaw), z * Math.cos(yaw) - x * Math.sin(yaw)];
    return [width / 2 + scale * u, height / 2 - scale * ((y - 0.9) * Math.cos(pitch) - w * Math.sin(pitch))];
  };
  const line = (style: string, thick: number, ...places: [number, number, number][]) => {
    context.beginPath();
    for (const place of places) context.lineTo(...seen(...place));
    context.lineWidth = thick;
    context.strokeStyle = style;
    context.stroke();
  };
  context.lineCap = context.lineJoin = 'round';
  line(css(soft, 0.7), 1, ...Array.from({ length: 25 }, (_, i): [number, number, number] => [0.75 * Math.cos((i * Math.PI) / 12), 0, 0.75 * Math.sin((i * Math.PI) / 12)]));
  line(css(accent), 1.5, [0, 0, 0], [0, 0, 0.75]);
  line(css(left), 2, [0, 0.95, 0], [0.18, 0, 0]);
  line(css(right), 2, [0, 0.95, 0], [-0.18, 0, 0]);
  line(css(left), 2, [0, 1.4, 0], [0.42, 0.85, 0]);
  line(css(right), 2, [0, 1.4, 0], [-0.42, 0.85, 0]);
  line(css(ink), 2, [0, 0.95, 0], [0, 1.5, 0]);
  const [x, y] = seen(0, 1.7, 0);
  context.beginPath();
  context.arc(x, y, 0.17 * scale, 0, 2 * Math.PI);
  context.fillStyle = css(ink);
  context.fill();
  line(css(accent), 2, [0, 1.7, 0.16], [0, 1.68, 0.34]);
}
