// The data block: reading it, and looking things up by time.

function readData() {
  const data = JSON.parse(document.getElementById("data").textContent);
  data.result.track = readTrack(data.result.track);
  data.source.track = readTrack(data.source.track);
  data.heatMap.values = bytes(data.heatMap.values);
  return data;
}

function bytes(base64) {
  const text = atob(base64);
  const out = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i += 1) out[i] = text.charCodeAt(i);
  return out;
}

function readTrack(track) {
  return {
    ...track,
    origins: new Float32Array(bytes(track.origins).buffer),
    offsets: new Int16Array(bytes(track.offsets).buffer),
  };
}

function clamp(value, low, high) {
  return Math.min(Math.max(value, low), high);
}

/** The frames around a time, and how far it is between them. */
function around(seconds, rate, frames) {
  const place = clamp(seconds * rate, 0, frames - 1);
  const low = Math.floor(place);
  return [low, Math.min(low + 1, frames - 1), place - low];
}

/** Where the character is at a time, metres. */
function originAt(track, seconds) {
  const [low, high, part] = around(seconds, track.rate, track.frames);
  return [0, 1, 2].map((axis) => {
    const from = track.origins[3 * low + axis];
    return from + (track.origins[3 * high + axis] - from) * part;
  });
}

/** Where all joints are at a time, from the given origin: x, y, z of each joint in turn. */
function poseAt(track, seconds, origin) {
  const [low, high, part] = around(seconds, track.rate, track.frames);
  const width = 3 * track.joints;
  const out = new Float64Array(width);
  for (let i = 0; i < width; i += 1) {
    const from = track.offsets[low * width + i];
    const to = track.offsets[high * width + i];
    out[i] = origin[i % 3] + track.scale * (from + (to - from) * part);
  }
  return out;
}

/** The moment of the clip that is used most at a time of the drawing, or null when it is not known. */
function sourceAt(data, seconds) {
  const best = data.bestSource;
  if (best.length === 0) return null;
  const [low, high, part] = around(seconds, data.sampleRate, best.length);
  // A cut is a cut: only what flows on is interpolated.
  const flows = Math.abs(best[high] - best[low]) < 4 / data.sampleRate;
  return flows ? best[low] + (best[high] - best[low]) * part : best[part < 0.5 ? low : high];
}

/** The frame of the source that is used most at a time of the drawing, or null. */
function frameAt(data, seconds) {
  if (data.guide === null || data.guide.frames.length === 0) return null;
  const [low, high, part] = around(seconds, data.sampleRate, data.guide.frames.length);
  return data.guide.frames[part < 0.5 ? low : high];
}

function confidenceAt(data, seconds) {
  if (data.confidence.length === 0) return null;
  const [low, high, part] = around(seconds, data.sampleRate, data.confidence.length);
  return data.confidence[low] + (data.confidence[high] - data.confidence[low]) * part;
}

/** A moment of the clip as a part of it, 0 to 1. */
function sourcePart(data, seconds) {
  return data.sourceSeconds > 0 ? clamp(seconds / data.sourceSeconds, 0, 1) : 0;
}

function formatSeconds(seconds) {
  return `${seconds.toFixed(2)} s`;
}

