// Puts the page together.

const element = (id) => document.getElementById(id);
const data = readData();
const views = {
  curve: data.board.length > 0 ? new BoardView(element("curve"), data) : new CurveView(element("curve"), data),
  stage: new StageView(element("stage"), data),
  plan: new PlanView(element("plan"), data),
  map: new MapView(element("map"), data),
};
views.guide = new GuideView(data, views.map, showPicked);
const player = new Player(data.seconds, Math.min(data.resultRate, data.result.track.rate), requestDraw);
let drawPending = false;

fillTexts();
listenToButtons();
listenToPointer();
document.addEventListener("keydown", onKey);
new ResizeObserver(resize).observe(document.querySelector("main"));
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", resize);
resize();
if (!matchMedia("(prefers-reduced-motion: reduce)").matches) player.play();

function fillTexts() {
  document.title = `${data.title} · inkrig`;
  element("title").textContent = data.title;
  const rate = Number(data.resultRate.toFixed(2));
  const frames = data.resultFrames === 1 ? "1 frame" : `${data.resultFrames} frames`;
  element("summary").textContent = `${frames} at ${rate} per second, ${data.result.names.length} joints`;
  element("length").textContent = ` / ${formatSeconds(data.seconds)}`;
  element("time").max = Math.max(data.seconds, 1e-6);
  for (const id of ["time", "play", "back", "next"]) element(id).disabled = !(data.seconds > 0);
  element("ghost").hidden = !views.stage.hasGhost;
  if (data.board.length > 0) nameBoard();
  else if (data.control.kind === "way") nameWay();
  for (const key of document.querySelectorAll(".key.left, .key.right")) key.hidden = !data.result.pair;
  document.querySelector(".plan").classList.toggle("empty", data.heatMap.values.length === 0);
  element("ramp").parentElement.hidden = data.bestSource.length === 0;
  element("unsure").hidden = data.confidence.length === 0;
  element("clip").hidden = views.map.spots.length === 0;
  document.querySelector("main").classList.toggle("guided", views.map.spots.length > 0);
  showMapText(null);
  fillReport();
}

/** Nothing was drawn: a motion was carried over to another character. */
function nameWay() {
  element("curve-heading").textContent = "Way over the ground";
  element("curve").setAttribute("aria-label", "The way over the ground, from above. Its colours tell the time.");
  element("ghost").textContent = "Motion";
  element("ghost").title = "Show the motion that was carried over, in the result's size, beside it (G)";
  element("plan-heading").textContent = "Time";
}

/** Frames were drawn: there is no clip, and no plan of it. */
function nameBoard() {
  element("curve-heading").textContent = "Storyboard";
  element("curve").setAttribute("aria-label", "The frame of the storyboard that is played now, with the joints that were read.");
  element("plan-heading").textContent = "Time";
  document.querySelector(".key.pose").hidden = data.board.every((frame) => frame.key === null);
  document.querySelector(".key.way").hidden = data.board.every((frame) => frame.ways.length === 0);
}

function fillReport() {
  for (const note of data.notes) element("notes").append(withText("li", note));
  for (const [name, value, note] of data.figures) {
    const row = document.createElement("tr");
    const heading = withText("th", name);
    heading.scope = "row";
    const meaning = withText("td", note);
    meaning.className = "soft";
    row.append(heading, withText("td", value), meaning);
    element("figures").append(row);
  }
  const notes = data.notes.length;
  const link = element("notes-link");
  link.hidden = notes === 0;
  link.textContent = notes === 1 ? "1 note" : `${notes} notes`;
  link.addEventListener("click", () => { element("report").open = true; });
  const counts = [];
  if (data.figures.length > 0) counts.push(data.figures.length === 1 ? "1 figure" : `${data.figures.length} figures`);
  if (notes > 0) counts.push(link.textContent);
  element("report-count").textContent = counts.join(", ");
}

function withText(tag, text) {
  const made = document.createElement(tag);
  made.textContent = text;
  return made;
}

function resize() {
  const theme = readTheme();
  const table = rampTable(theme);
  for (const view of Object.values(views)) view.resize(theme, table);
  const stops = [0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1].map((part) => css(rampAt(table, part)));
  element("ramp").style.background = `linear-gradient(to right, ${stops.join(", ")})`;
  draw();
}

function requestDraw() {
  if (drawPending) return;
  drawPending = true;
  requestAnimationFrame(draw);
}

function draw() {
  drawPending = false;
  const { now, playing } = player;
  for (const view of Object.values(views)) view.draw(now);
  const range = element("time");
  range.value = now;
  range.style.setProperty("--done", `${data.seconds > 0 ? (100 * now) / data.seconds : 0}%`);
  range.setAttribute("aria-valuetext", `${formatSeconds(now)} of ${formatSeconds(data.seconds)}`);
  element("clock").textContent = formatSeconds(now);
  const play = element("play");
  play.setAttribute("aria-label", playing ? "Pause" : "Play");
  play.title = playing ? "Pause (space)" : "Play (space)";
  element("play-shape").setAttribute("d", playing ? "M5 3.5h3.5v13H5zM11.5 3.5H15v13h-3.5z" : "M6 3.5v13L16.5 10z");
  drawNow(now);
}

/** Which part of the clip is used now, and how sure that is. */
function drawNow(now) {
  const moment = data.control.kind === "way" ? null : sourceAt(data, now);
  if (moment === null) return;
  element("swatch").style.background = css(rampAt(views.plan.table, sourcePart(data, moment)));
  const confidence = confidenceAt(data, now);
  const sure = confidence === null ? "" : `, confidence ${Math.round(100 * confidence)} %`;
  const frame = frameAt(data, now);
  const which = frame === null ? "" : `, frame ${frame}${clipName(data, moment)}`;
  element("now").textContent = `from clip time ${formatSeconds(moment)}${which}${sure}`;
}

/** Shows the picked moment's pose beside the result. */
function showPicked() {
  views.stage.peek = views.guide.picked?.seconds ?? null;
  requestDraw();
}

function showMapText(spot) {
  const stress = data.guide === null ? 0 : data.guide.stress;
  element("map-text").textContent = spot === null
    ? `near is alike (stress ${stress.toFixed(2)})`
    : views.guide.describe(spot);
}

/** What the drawing means under the pointer. */
function showTip(event) {
  const tip = element("tip");
  const { curve } = views;
  const seconds = event.buttons === 0 ? curve.timeUnder(event.offsetX, event.offsetY) : null;
  const moment = seconds === null ? null : sourceAt(data, seconds);
  tip.hidden = moment === null;
  views.map.hovered = moment;
  requestDraw();
  if (moment === null) return;
  const frame = frameAt(data, seconds);
  const confidence = confidenceAt(data, seconds);
  const words = [`${formatSeconds(seconds)}: clip ${formatSeconds(moment)}`];
  if (frame !== null) words.push(`frame ${frame}${clipName(data, moment)}`);
  if (confidence !== null) words.push(`${Math.round(100 * confidence)} % sure`);
  tip.textContent = words.join(", ");
  const { width } = curve.surface;
  tip.style.left = `${clamp(event.offsetX + 14, 8, Math.max(width - tip.offsetWidth - 8, 8))}px`;
  tip.style.top = `${Math.max(event.offsetY - tip.offsetHeight - 10, 8)}px`;
}

function listenToButtons() {
  element("play").addEventListener("click", () => player.toggle());
  element("back").addEventListener("click", () => player.step(-1));
  element("next").addEventListener("click", () => player.step(1));
  element("loop").addEventListener("click", toggleLoop);
  element("ghost").addEventListener("click", toggleGhost);
  element("home").addEventListener("click", resetView);
  element("speeds").addEventListener("change", (event) => { player.speed = Number(event.target.value); });
  element("copy").addEventListener("click", () => views.guide.copy());
  element("time").addEventListener("input", (event) => player.seek(Number(event.target.value)));
}

function toggleLoop() {
  player.loop = !player.loop;
  element("loop").setAttribute("aria-pressed", player.loop);
}

function toggleGhost() {
  views.stage.ghost = !views.stage.ghost;
  element("ghost").setAttribute("aria-pressed", views.stage.ghost);
  requestDraw();
}

function resetView() {
  views.stage.camera.reset();
  requestDraw();
}

function listenToPointer() {
  const { stage, curve, plan } = views;
  onDrag(curve.canvas, (event) => player.seek(curve.timeAt(event.offsetX, event.offsetY, player.now)));
  curve.canvas.addEventListener("pointermove", showTip);
  curve.canvas.addEventListener("pointerleave", () => {
    element("tip").hidden = true;
    views.map.hovered = null;
    requestDraw();
  });
  const { map, guide } = views;
  map.canvas.addEventListener("pointermove", (event) => showMapText(map.spotAt(event.offsetX, event.offsetY)));
  map.canvas.addEventListener("pointerleave", () => showMapText(null));
  map.canvas.addEventListener("click", (event) => guide.pick(map.spotAt(event.offsetX, event.offsetY)));
  onDrag(plan.canvas, (event) => player.seek(plan.timeAt(event.offsetX)));
  onDrag(stage.canvas, (event, first) => {
    if (!first) stage.camera.orbit(event.movementX * 0.008, event.movementY * 0.006);
    requestDraw();
  });
  stage.canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    stage.camera.zoom(Math.exp(clamp(event.deltaY, -200, 200) * 0.0012));
    requestDraw();
  }, { passive: false });
  stage.canvas.addEventListener("pointermove", (event) => {
    element("joint").textContent = event.buttons === 0 ? stage.jointAt(event.offsetX, event.offsetY) : "";
  });
}

/** Calls back when the pointer goes down and while it is drawn along. */
function onDrag(canvas, moved) {
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    moved(event, true);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (canvas.hasPointerCapture(event.pointerId)) moved(event, false);
  });
}

function onKey(event) {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  // Whoever works with the keyboard presses the button that has the focus.
  const onButton = event.target.matches("button:focus-visible, summary:focus-visible, a:focus-visible");
  const onSpeed = event.target.matches("input[type=radio]:focus-visible");
  const many = event.shiftKey ? 10 : 1;
  const { camera } = views.stage;
  const actions = {
    " ": onButton ? null : () => player.toggle(),
    ArrowLeft: onSpeed ? null : () => player.step(-many),
    ArrowRight: onSpeed ? null : () => player.step(many),
    Home: () => player.seek(0),
    End: () => player.seek(data.seconds),
    l: toggleLoop,
    g: toggleGhost,
    r: resetView,
    Escape: () => views.guide.pick(null),
    q: () => camera.orbit(-0.15, 0),
    e: () => camera.orbit(0.15, 0),
    "+": () => camera.zoom(1 / 1.12),
    "=": () => camera.zoom(1 / 1.12),
    "-": () => camera.zoom(1.12),
  };
  const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
  if (!action) return;
  event.preventDefault();
  action();
  requestDraw();
}
