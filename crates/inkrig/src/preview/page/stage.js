// The moving skeleton: ground, shadow, and limbs as shaded capsules from the far to the near.

class StageView {
  constructor(canvas, data) {
    this.canvas = canvas;
    this.data = data;
    this.camera = new Camera(data.result);
    this.ghost = true;
    /** A moment of the clip to show instead of the one that is used now, seconds; or null. */
    this.peek = null;
    this.hasGhost = data.bestSource.length > 0;
    this.spots = [];
  }

  resize(theme, table) {
    this.surface = fitCanvas(this.canvas);
    this.theme = theme;
    this.table = table;
  }

  draw(seconds) {
    const { context, width, height } = this.surface;
    const { result, source } = this.data;
    const ghost = this.hasGhost && (this.ghost || this.peek !== null);
    const gap = ghost ? this.camera.gap() : 0;
    this.camera.aim(seconds, gap, width, height);
    context.clearRect(0, 0, width, height);
    this.drawGround(context);
    this.drawTrail(context);
    const origin = originAt(result.track, seconds);
    const pose = poseAt(result.track, seconds, origin);
    const figures = [{ character: result, at: origin, pose, tone: (limb) => this.theme[limb.side] }];
    const moment = this.peek ?? sourceAt(this.data, seconds);
    if (ghost && moment !== null) figures.push(this.ghostFigure(source, moment, gap, figures[0]));
    for (const figure of figures) this.drawShadow(context, figure);
    this.drawBoard(context, seconds);
    this.drawLimbs(context, figures);
    if (figures.length > 1) this.drawLabel(context, figures[1], `clip ${formatSeconds(moment)}`);
    this.spots = this.project(figures[0]);
  }

  /** The clip's own pose, standing beside the result and turned the same way, in the colour of its time. */
  ghostFigure(source, moment, gap, beside) {
    const right = this.camera.right();
    const place = [beside.at[0] + gap * right[0], originAt(source.track, moment)[1], beside.at[2] + gap * right[2]];
    const pose = poseAt(source.track, moment, place);
    if (source.pair && beside.character.pair) {
      turn(pose, place, facing(beside.character, beside.pose) - facing(source, pose));
    }
    const colour = mix(rampAt(this.table, sourcePart(this.data, moment)), this.theme.panel, 0.42);
    return { character: source, pose, tone: () => colour };
  }

  /** Of a storyboard: the drawn pose of the frame that is played, in red where it is taken, and drawn ways in green. */
  drawBoard(context, seconds) {
    const { board, result } = this.data;
    if (board.length === 0) return;
    const now = boardFrameAt(this.data, seconds);
    board.forEach((frame, i) => {
      for (const { begins, rate, points } of frame.ways) {
        context.lineWidth = i === now ? 3 : 1.5;
        context.strokeStyle = css(this.theme.drawn, i === now ? 1 : 0.35);
        context.beginPath();
        for (const point of points) {
          const spot = this.camera.project(...point);
          if (spot) context.lineTo(spot.x, spot.y);
        }
        context.stroke();
        const at = points[Math.round((seconds - begins) * rate)];
        const spot = i === now && at ? this.camera.project(...at) : null;
        context.fillStyle = css(this.theme.drawn);
        if (spot) disc(context, [spot.x, spot.y], 5);
      }
    });
    const { key } = board[now];
    if (key === null) return;
    const pose = poseAt(result.track, key, originAt(result.track, key));
    context.globalAlpha = Math.abs(seconds - key) < 0.06 ? 1 : 0.4;
    this.drawLimbs(context, [{ character: result, pose, tone: () => this.theme.key }]);
    context.globalAlpha = 1;
  }

  project({ character, pose }) {
    const spots = [];
    for (let joint = 0; joint < character.track.joints; joint += 1) {
      spots.push(this.camera.project(pose[3 * joint], pose[3 * joint + 1], pose[3 * joint + 2]));
    }
    return spots;
  }

  drawGround(context) {
    const { camera, theme } = this;
    const { size } = this.data.result;
    const step = roundStep(0.45 * Math.max(size, camera.distance / 5));
    const count = 9;
    const middle = [Math.round(camera.target[0] / step), Math.round(camera.target[2] / step)];
    context.lineWidth = 1;
    for (let line = -count; line <= count; line += 1) {
      for (let piece = -count; piece < count; piece += 1) {
        for (const alongX of [true, false]) {
          const at = (i) => (alongX ? [middle[0] + i, middle[1] + line] : [middle[0] + line, middle[1] + i]);
          const [from, to] = [at(piece), at(piece + 1)].map(([x, z]) => camera.project(x * step, 0, z * step));
          const away = Math.hypot(line, piece + 0.5) / count;
          if (!from || !to || away >= 1) continue;
          context.strokeStyle = css(theme.grid, 0.75 * (1 - away) ** 1.3);
          context.beginPath();
          context.moveTo(from.x, from.y);
          context.lineTo(to.x, to.y);
          context.stroke();
        }
      }
    }
  }

  /** The way over the ground, in the colours of the clip's time. */
  drawTrail(context) {
    const { track } = this.data.result;
    const stride = Math.max(Math.ceil(track.frames / 500), 1);
    context.lineWidth = 2.5;
    context.lineCap = "round";
    const reach = 8 * this.data.result.size + this.camera.distance;
    let before = null;
    for (let frame = 0; frame < track.frames; frame += stride) {
      const spot = this.camera.project(track.origins[3 * frame], 0, track.origins[3 * frame + 2]);
      const moment = sourceAt(this.data, frame / track.rate);
      const colour = moment === null ? this.theme.accent : rampAt(this.table, sourcePart(this.data, moment));
      if (before && spot) {
        // Opaque, since overlapping ends would show; paler in the distance.
        const away = clamp((spot.depth - 0.5 * this.camera.distance) / reach, 0, 1);
        context.strokeStyle = css(mix(colour, this.theme.panel, 0.4 + 0.5 * away));
        context.beginPath();
        context.moveTo(before.x, before.y);
        context.lineTo(spot.x, spot.y);
        context.stroke();
      }
      before = spot;
    }
  }

  /** All limbs' shadows as one shape, so that overlaps are not darker. */
  drawShadow(context, { character, pose }) {
    const cast = (joint) => {
      const y = Math.max(pose[3 * joint + 1], 0);
      return this.camera.project(pose[3 * joint] + 0.22 * y, 0, pose[3 * joint + 2] - 0.12 * y);
    };
    for (const [grow, alpha] of [[1.5, 0.45], [0.8, 0.6]]) {
      context.beginPath();
      for (const limb of character.limbs) {
        const [from, to] = [cast(limb.from), cast(limb.to)];
        if (from && to) {
          addCapsule(context, from, grow * limb.from_radius * from.scale, to, grow * limb.to_radius * to.scale);
        }
      }
      context.fillStyle = css(this.theme.shadow, alpha);
      context.fill();
    }
  }

  drawLimbs(context, figures) {
    const drawn = [];
    for (const figure of figures) {
      const spots = this.project(figure);
      for (const limb of figure.character.limbs) {
        const [from, to] = [spots[limb.from], spots[limb.to]];
        if (from && to) drawn.push({ limb, from, to, depth: from.depth + to.depth, colour: figure.tone(limb) });
      }
    }
    drawn.sort((a, b) => b.depth - a.depth);
    for (const each of drawn) this.drawLimb(context, each);
  }

  /** A capsule lit from the upper left, with a rim that keeps crossing limbs apart. */
  drawLimb(context, { limb, from, to, depth, colour }) {
    const radii = [limb.from_radius * from.scale, limb.to_radius * to.scale].map((radius) => Math.max(radius, 0.8));
    const haze = clamp(0.25 + (0.5 * depth - this.camera.distance) / this.data.result.size, 0, 1) * 0.3;
    const tone = mix(colour, this.theme.panel, haze);
    const [dx, dy] = [to.x - from.x, to.y - from.y];
    const length = Math.hypot(dx, dy);
    let [nx, ny] = length > 1e-3 ? [-dy / length, dx / length] : [-0.5, -0.86];
    if (nx * -0.5 + ny * -0.86 < 0) [nx, ny] = [-nx, -ny];
    const radius = Math.max(...radii);
    context.beginPath();
    // The links of a dense chain (a tail, a snake) are one body: their rims are at the sides only.
    // Thinner where the figure is small.
    const rim = Math.min(1.2, 0.3 * radius);
    if (length > 1.5 * radius) addCapsule(context, from, radii[0] + rim, to, radii[1] + rim);
    else addBand(context, from, radii[0] + rim, to, radii[1] + rim, [nx, ny]);
    context.fillStyle = css(this.theme.panel, 0.8);
    context.fill();
    const [x, y] = [(from.x + to.x) / 2, (from.y + to.y) / 2];
    const shade = context.createLinearGradient(x + nx * radius, y + ny * radius, x - nx * radius, y - ny * radius);
    shade.addColorStop(0, css(mix(tone, [255, 255, 255], 0.3)));
    shade.addColorStop(0.5, css(tone));
    shade.addColorStop(1, css(mix(tone, [0, 0, 0], 0.24)));
    context.beginPath();
    addCapsule(context, from, radii[0], to, radii[1]);
    context.fillStyle = shade;
    context.fill();
  }

  drawLabel(context, { character, pose }, text) {
    let low = null;
    for (let joint = 0; joint < character.track.joints; joint += 1) {
      const spot = this.camera.project(pose[3 * joint], 0, pose[3 * joint + 2]);
      if (spot && (low === null || spot.y > low.y)) low = spot;
    }
    if (low === null) return;
    context.font = "12px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "top";
    context.fillStyle = css(this.theme.soft);
    context.fillText(text, low.x, Math.min(low.y + 16, this.surface.height - 40));
  }

  /** The name of the result's joint near a place on the picture, or nothing. */
  jointAt(x, y) {
    let [name, least] = ["", 13];
    this.spots.forEach((spot, joint) => {
      const apart = spot ? Math.hypot(spot.x - x, spot.y - y) : Infinity;
      if (apart < least) [name, least] = [this.data.result.names[joint], apart];
    });
    return name;
  }
}

/** Turns a pose about the vertical through a place. */
function turn(pose, place, angle) {
  const [sine, cosine] = [Math.sin(angle), Math.cos(angle)];
  for (let i = 0; i < pose.length; i += 3) {
    const [x, z] = [pose[i] - place[0], pose[i + 2] - place[2]];
    pose[i] = place[0] + cosine * x + sine * z;
    pose[i + 2] = place[2] + cosine * z - sine * x;
  }
}

/** 1, 2 or 5 times a power of ten. */
function roundStep(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return power * [1, 2, 5].findLast((factor) => factor * power <= value * 1.001);
}

/** A capsule without its round ends. */
function addBand(context, from, fromRadius, to, toRadius, [nx, ny]) {
  context.moveTo(from.x + nx * fromRadius, from.y + ny * fromRadius);
  context.lineTo(to.x + nx * toRadius, to.y + ny * toRadius);
  context.lineTo(to.x - nx * toRadius, to.y - ny * toRadius);
  context.lineTo(from.x - nx * fromRadius, from.y - ny * fromRadius);
  context.closePath();
}

/** The hull of two circles, always wound the same way. */
function addCapsule(context, from, fromRadius, to, toRadius) {
  const length = Math.hypot(to.x - from.x, to.y - from.y);
  if (length <= Math.abs(fromRadius - toRadius) + 1e-3) {
    const [spot, radius] = fromRadius > toRadius ? [from, fromRadius] : [to, toRadius];
    context.moveTo(spot.x + radius, spot.y);
    context.arc(spot.x, spot.y, radius, 0, 2 * Math.PI);
    return;
  }
  const along = Math.atan2(to.y - from.y, to.x - from.x);
  const touch = Math.acos(clamp((fromRadius - toRadius) / length, -1, 1));
  const begin = along + touch;
  context.moveTo(from.x + fromRadius * Math.cos(begin), from.y + fromRadius * Math.sin(begin));
  context.arc(from.x, from.y, fromRadius, begin, along - touch + 2 * Math.PI);
  context.arc(to.x, to.y, toRadius, along - touch, along + touch);
  context.closePath();
}

