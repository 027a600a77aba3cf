import { css, blend } from '../base/colour';
import { fit } from '../base/dom';
import type { Theme } from '../base/theme';
import { facing, type Body } from './motion';

/** Draws one pose (joints x 3) into a small canvas, seen a little from the side; red when it is a key. */
export function drawPose(canvas: HTMLCanvasElement, body: Body, pose: Float32Array, theme: Theme, red = false): void {
  const { context, width, height } = fit(canvas);
  // Hidden: it is drawn when it comes to be seen.
  if (width < 12 || height < 12) return;
  const yaw = facing(body, pose) + 0.6;
  const [c, s] = [Math.cos(yaw), Math.sin(yaw)];
  const places = body.names.map((_, joint) => {
    const [x, y, z] = [pose[3 * joint] ?? 0, pose[3 * joint + 1] ?? 0, pose[3 * joint + 2] ?? 0];
    return { x: c * x - s * z, y, depth: s * x + c * z };
  });
  const used = [...new Set(body.limbs.flatMap((limb) => [limb.from, limb.to]))].map((joint) => places[joint]).filter((p) => p !== undefined);
  const [left, right] = [Math.min(...used.map((p) => p.x)), Math.max(...used.map((p) => p.x))];
  const [low, high] = [Math.min(...used.map((p) => p.y)), Math.max(...used.map((p) => p.y))];
  const margin = 0.06 * body.size;
  const scale = Math.min((height - 6) / (high - low + 2 * margin), (width - 6) / (right - left + 2 * margin), (height - 6) / (0.75 * body.size));
  const x = (value: number) => width / 2 + scale * (value - (left + right) / 2);
  const y = (value: number) => height - 3 - scale * (value - low + margin);
  const shade = { left: theme.left, right: theme.right, middle: theme.middle };
  const limbs = [...body.limbs].sort((a, b) => depthOf(places, a) - depthOf(places, b));
  for (const limb of limbs) {
    const [a, b] = [places[limb.from], places[limb.to]];
    if (!a || !b) continue;
    const tone = red ? theme.key : shade[limb.side];
    capsule(context, x(a.x), y(a.y), scale * limb.fromRadius + 0.6, x(b.x), y(b.y), scale * limb.toRadius + 0.6);
    context.fillStyle = css(tone);
    context.fill();
    context.strokeStyle = css(blend(tone, theme.panel, 0.75));
    context.lineWidth = 0.7;
    context.stroke();
  }
}

function depthOf(places: readonly { depth: number }[], limb: { from: number; to: number }): number {
  return (places[limb.from]?.depth ?? 0) + (places[limb.to]?.depth ?? 0);
}

function capsule(context: CanvasRenderingContext2D, ax: number, ay: number, ar: number, bx: number, by: number, br: number): void {
  const length = Math.hypot(bx - ax, by - ay);
  context.beginPath();
  if (length <= Math.abs(ar - br) + 1e-3) {
    context.arc(ar > br ? ax : bx, ar > br ? ay : by, Math.max(ar, br), 0, 2 * Math.PI);
    return;
  }
  const along = Math.atan2(by - ay, bx - ax);
  const touch = Math.acos(Math.min(Math.max((ar - br) / length, -1), 1));
  context.arc(ax, ay, ar, along + touch, along - touch + 2 * Math.PI);
  context.arc(bx, by, br, along - touch, along + touch);
  context.closePath();
}
