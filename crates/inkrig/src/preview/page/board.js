// The frame of a storyboard that is played now.

/** Between two frames of a storyboard the next one is shown. */
function boardFrameAt(data, seconds) {
  const next = data.board.findIndex((frame) => seconds < frame.seconds[1]);
  return next < 0 ? data.board.length - 1 : next;
}

class BoardView {
  constructor(canvas, data) {
    this.canvas = canvas;
    this.data = data;
  }

  resize(theme) {
    this.surface = fitCanvas(this.canvas);
    this.theme = theme;
    this.still = null;
  }

  draw(seconds) {
    const { context, width, height } = this.surface;
    const index = boardFrameAt(this.data, seconds);
    const { key } = this.data.board[index];
    const keyed = key !== null && Math.abs(seconds - key) < 0.06;
    const name = `${index} ${keyed}`;
    // Lines of a pen have many points: a drawing is made once for as long as it is shown.
    if (this.still?.name !== name) {
      this.still = { name, layer: stillLayer(this.surface, (layer) => this.drawStill(layer, this.data.board[index], keyed)) };
    }
    context.clearRect(0, 0, width, height);
    context.drawImage(this.still.layer, 0, 0, width, height);
    this.drawStrip(index, seconds);
  }

  drawStill(context, frame, keyed) {
    const { width, height } = this.surface;
    const [left, top, right, bottom] = [36, 64, 36, 56];
    const room = [Math.max(width - left - right, 1), Math.max(height - top - bottom, 1)];
    const scale = Math.min(room[0] / Math.max(frame.size[0], 1e-6), room[1] / Math.max(frame.size[1], 1e-6));
    const [x, y] = [left + (room[0] - scale * frame.size[0]) / 2, top + (room[1] + scale * frame.size[1]) / 2];
    const place = (point) => [x + scale * point[0], y - scale * point[1]];
    const { theme } = this;
    const inks = {
      scene: [theme.line, 2], body: [keyed ? theme.key : theme.ink, 2.6], way: [theme.drawn, 2.6],
      speed: [theme.soft, 1.4], word: [theme.soft, 1.4],
    };
    context.lineCap = context.lineJoin = "round";
    for (const [ink, points] of frame.strokes) {
      [context.strokeStyle, context.lineWidth] = [css(inks[ink][0]), inks[ink][1]];
      context.beginPath();
      for (const point of points) context.lineTo(...place(point));
      context.stroke();
    }
    context.fillStyle = css(theme.accent, 0.8);
    for (const joint of frame.joints) disc(context, place(joint), 3);
  }

  /** Which of the frames it is, and how much of each is over. */
  drawStrip(index, seconds) {
    const { context, width, height } = this.surface;
    const { theme } = this;
    const { board } = this.data;
    context.fillStyle = css(theme.ink);
    context.font = "600 15px system-ui, sans-serif";
    context.textAlign = "left";
    context.textBaseline = "alphabetic";
    context.fillText(board[index].word || "no word", 18, 58, width - 36);
    const [left, gap] = [18, 4];
    const part = (width - 2 * left + gap) / board.length;
    board.forEach(({ seconds: [from, to] }, i) => {
      const [x, length] = [left + i * part, Math.max(part - gap, 1)];
      context.fillStyle = css(theme.line);
      context.fillRect(x, height - 46, length, 3);
      context.fillStyle = css(theme.accent);
      context.fillRect(x, height - 46, length * clamp((seconds - from) / Math.max(to - from, 1e-6), 0, 1), 3);
    });
  }

  /** Frames lie side by side: where the pointer is says when. */
  timeAt(x) {
    const { board } = this.data;
    const place = clamp((x - 18) / Math.max(this.surface.width - 36, 1), 0, 0.999999) * board.length;
    const [from, to] = board[Math.floor(place)].seconds;
    return from + (place % 1) * (to - from);
  }

  timeUnder() {
    return null;
  }
}
