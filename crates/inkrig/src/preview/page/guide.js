// Poses worth a keyframe: small pictures, and the text that asks for the one that was picked.

/** One pose of the clip, standing still, seen half from the front. */
class PoseView extends StageView {
  constructor(canvas, data, seconds) {
    super(canvas, data);
    this.camera = new Camera(data.source);
    this.camera.closeness = 0.92;
    this.seconds = seconds;
  }

  draw() {
    const { context, width, height } = this.surface;
    const { source } = this.data;
    context.clearRect(0, 0, width, height);
    const origin = [0, originAt(source.track, this.seconds)[1], 0];
    const pose = poseAt(source.track, this.seconds, origin);
    this.camera.yaw = facing(source, pose) + 0.55;
    this.camera.aim(this.seconds, 0, width, height);
    // Over the middle of the figure, wherever its origin is.
    const middle = [0, 2].map((axis) => {
      const places = source.framed.map((joint) => pose[3 * joint + axis]);
      return places.length > 0 ? (Math.min(...places) + Math.max(...places)) / 2 : 0;
    });
    [this.camera.target[0], this.camera.target[2]] = middle;
    const figure = { character: source, at: origin, pose, tone: (limb) => this.theme[limb.side] };
    this.drawShadow(context, figure);
    this.drawLimbs(context, [figure]);
  }
}

class GuideView {
  /** `changed` is called when another moment is picked: by pictures, by the map. */
  constructor(data, map, changed) {
    this.data = data;
    this.map = map;
    this.changed = changed;
    this.picked = null;
    this.poses = map.candidates.map((candidate) => this.addButton(candidate));
  }

  addButton(candidate) {
    const button = document.createElement("button");
    button.type = "button";
    button.className = "pose";
    const canvas = document.createElement("canvas");
    const share = `${Math.max(Math.round(100 * candidate.share), 1)} %`;
    const name = document.createElement("span");
    name.append(withText("b", String(candidate.number)), ` ${share}`);
    button.append(canvas, name);
    button.title = `${this.describe(candidate)}; stands for ${share} of the clip`;
    button.setAttribute("aria-label", `Pose ${candidate.number}: ${button.title}`);
    button.setAttribute("aria-pressed", "false");
    button.addEventListener("click", () => this.pick(this.picked === candidate ? null : candidate));
    element("poses").append(button);
    return { button, candidate, view: new PoseView(canvas, this.data, candidate.seconds) };
  }

  /** Where a moment is, in words. */
  describe({ seconds, frame }) {
    return `clip ${formatSeconds(seconds)}, frame ${frame}${clipName(this.data, seconds)}`;
  }

  resize(theme, table) {
    for (const { view } of this.poses) {
      view.resize(theme, table);
      view.draw();
    }
  }

  pick(spot) {
    this.picked = spot;
    this.map.marked = spot;
    for (const { button, candidate } of this.poses) button.setAttribute("aria-pressed", candidate === spot);
    this.changed();
  }

  draw(now) {
    const { picked } = this;
    element("key-line").classList.toggle("idle", picked === null);
    element("copy").disabled = picked === null;
    element("key-text").textContent = picked === null
      ? "Pick a pose to see how to ask for it"
      : `--key ${Number(now.toFixed(2))}s~frame:${picked.frame}`;
    element("key-what").textContent = picked === null ? "" : this.describe(picked);
  }

  async copy() {
    const text = element("key-text").textContent;
    try {
      await navigator.clipboard.writeText(text);
      element("copy").textContent = "Copied";
    } catch {
      // Without leave, or in a file: select it, so that a key press copies it.
      getSelection().selectAllChildren(element("key-text"));
      element("copy").textContent = "Selected";
    }
    setTimeout(() => { element("copy").textContent = "Copy"; }, 1500);
  }
}

/** ` of NAME` where the source is of several clips. */
function clipName(data, seconds) {
  if (data.guide === null || data.guide.clips.length < 2) return "";
  const name = data.guide.clips.findLast(([, start]) => start <= seconds + 1e-6)?.[0];
  return name === undefined ? "" : ` of ${name}`;
}

