// A camera that orbits the character and follows it.

class Camera {
  constructor(character) {
    this.character = character;
    const { path, tall, reach } = outline(character);
    this.path = smooth(path);
    this.tall = Math.max(tall, 0.15 * character.size);
    this.reach = Math.max(reach, 0.15 * character.size);
    this.reset();
  }

  reset() {
    const { track } = this.character;
    this.yaw = facing(this.character, poseAt(track, 0, originAt(track, 0))) + 0.55;
    this.pitch = 0.24;
    this.closeness = 1;
    this.target = [0, 0, 0];
  }

  /** How far a second figure stands aside, metres. */
  gap() {
    return Math.max(2.1 * this.reach, 0.45 * this.tall);
  }

  orbit(dx, dy) {
    this.yaw -= dx;
    this.pitch = clamp(this.pitch + dy, -0.1, 1.5);
  }

  zoom(factor) {
    this.closeness = clamp(this.closeness * factor, 0.2, 12);
  }

  /** Looks at where the character is at a time, and `gap` metres to the right of it, in a picture of that size. */
  aim(seconds, gap, width, height) {
    const at = originAt(this.path, seconds);
    const right = this.right();
    this.target = [at[0] + (gap / 2) * right[0], 0.52 * this.tall, at[2] + (gap / 2) * right[2]];
    const [sy, cy, sp, cp] = [Math.sin(this.yaw), Math.cos(this.yaw), Math.sin(this.pitch), Math.cos(this.pitch)];
    this.up = [-sp * sy, cp, -sp * cy];
    this.back = [cp * sy, sp, cp * cy];
    this.focal = 1.75 * Math.min(height, width);
    this.centre = [width / 2, height * 0.5];
    const room = Math.max((1.42 * this.tall) / height, (2.5 * this.reach + gap) / width);
    this.distance = this.closeness * room * this.focal;
  }

  right() {
    return [Math.cos(this.yaw), 0, -Math.sin(this.yaw)];
  }

  /** Place on the picture, pixels a metre there, and distance from the camera; null behind it. */
  project(x, y, z) {
    const [dx, dy, dz] = [x - this.target[0], y - this.target[1], z - this.target[2]];
    const right = this.right();
    const depth = this.distance - (dx * this.back[0] + dy * this.back[1] + dz * this.back[2]);
    if (!(depth > 0.05 * this.distance)) return null;
    const scale = this.focal / depth;
    const across = dx * right[0] + dz * right[2];
    const above = dx * this.up[0] + dy * this.up[1] + dz * this.up[2];
    return { x: this.centre[0] + scale * across, y: this.centre[1] - scale * above, scale, depth };
  }
}

/** The turn about the vertical that looks the character in the face; 0 when names do not tell. */
function facing({ pair }, pose) {
  if (!pair) return 0;
  const [left, right] = pair;
  const [x, z] = [pose[3 * left] - pose[3 * right], pose[3 * left + 2] - pose[3 * right + 2]];
  return Math.hypot(x, z) > 0 ? Math.atan2(-z, x) : 0;
}

/** The way of the figure's middle, how tall it mostly is, and how far it reaches sideways, metres. */
function outline({ track, framed }) {
  const path = { rate: track.rate, frames: track.frames, origins: new Float64Array(3 * track.frames) };
  const [tops, reaches] = [[], []];
  for (let frame = 0; frame < track.frames; frame += 1) {
    const pose = poseAt(track, frame / track.rate, originAt(track, frame / track.rate));
    const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
    for (const joint of framed) {
      for (let axis = 0; axis < 3; axis += 1) {
        low[axis] = Math.min(low[axis], pose[3 * joint + axis]);
        high[axis] = Math.max(high[axis], pose[3 * joint + axis]);
      }
    }
    const middle = low.map((value, axis) => (framed.length > 0 ? (value + high[axis]) / 2 : 0));
    path.origins.set(middle, 3 * frame);
    tops.push(framed.length > 0 ? high[1] : 0);
    reaches.push(framed.length > 0 ? Math.hypot(high[0] - low[0], high[2] - low[2]) / 2 : 0);
  }
  return { path, tall: mostly(tops), reach: mostly(reaches) };
}

/** The 90th percentile. */
function mostly(values) {
  return values.sort((a, b) => a - b)[Math.floor(0.9 * (values.length - 1))];
}

/** A way without its bounce, so that the camera is calm: a mean over half a second. */
function smooth(path) {
  const reach = Math.max(Math.round(path.rate / 4), 1);
  const origins = new Float64Array(path.origins.length);
  for (let frame = 0; frame < path.frames; frame += 1) {
    const from = Math.max(frame - reach, 0);
    const to = Math.min(frame + reach, path.frames - 1);
    for (let axis = 0; axis < 3; axis += 1) {
      let sum = 0;
      for (let i = from; i <= to; i += 1) sum += path.origins[3 * i + axis];
      origins[3 * frame + axis] = sum / (to - from + 1);
    }
  }
  return { ...path, origins };
}

