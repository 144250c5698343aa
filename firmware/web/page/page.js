// What the daemon has told, and how it is looked at. Lengths in metres, map frame.
const view = { x_m: 0, y_m: 0, px_per_m: 40, follow: true };
const tiles = new Map(); // "column row" to {column, row, levels, picture, known_cells}
let map = null; // {run, number, side_cells, cell_size_m}
let pose = null;
let path_m = []; // x, y, x, y, ...
let scan_m = [];
let status = null;
let placed_m = null; // from where to where is dragged to set the pose; null: no setting, empty: not begun
let measured_m = null; // points that were touched to measure; null: no measuring

const $ = id => document.getElementById(id);
const canvas = $("map");
const UNKNOWN = 16;

// ---- What is told

// Runs of levels: a letter each, and behind it how often it stands there.
function levelsOf(runs, count) {
  const levels = new Uint8Array(count).fill(UNKNOWN);
  let at = 0;
  for (const [, letter, times] of runs.matchAll(/([a-q])(\d*)/g)) {
    const end = at + (times === "" ? 1 : Number(times));
    levels.fill(letter.charCodeAt(0) - 97, at, end);
    at = end;
  }
  return levels;
}

// Unknown is transparent; from free, white, to occupied, black. The first row is the lowest.
function pictureOf(levels, side) {
  const picture = document.createElement("canvas");
  picture.width = picture.height = side;
  const image = new ImageData(side, side);
  for (let i = 0; i < levels.length; ++i) {
    const to = 4 * ((side - 1 - Math.floor(i / side)) * side + i % side);
    image.data.fill(255 - 17 * Math.min(levels[i], 15), to, to + 3);
    image.data[to + 3] = levels[i] === UNKNOWN ? 0 : 255;
  }
  picture.getContext("2d").putImageData(image, 0, 0);
  return picture;
}

// The part of a tile that is known, in cells from the map's origin: left, low, right, high; null where nothing is.
function knownCells(levels, column, row) {
  const side = map.side_cells;
  let box = null;
  levels.forEach((level, i) => {
    if (level === UNKNOWN) return;
    const x = column * side + i % side, y = row * side + Math.floor(i / side);
    box = box ? [Math.min(box[0], x), Math.min(box[1], y), Math.max(box[2], x + 1), Math.max(box[3], y + 1)] : [x, y, x + 1, y + 1];
  });
  return box;
}

const hear = {
  map(told) {
    if (map?.run !== told.run) findControl();
    if (!map || map.run !== told.run || map.number !== told.number) {
      tiles.clear();
      path_m = [];
      scan_m = [];
      pose = null;
      text("pose", "none yet");
      text("deviation", "");
    }
    map = told;
  },
  state(told) {
    status = told;
    showStatus();
  },
  pose(told) {
    pose = told;
    showPose();
  },
  path(told) {
    path_m.length = 2 * told.from;
    path_m.push(...told.points_cm.map(cm => cm / 100));
  },
  scan(told) {
    scan_m = told.points_cm.map(cm => cm / 100);
  },
};

function hearTile(text) {
  const [column, row, runs] = text.split(" ");
  const levels = levelsOf(runs, map.side_cells ** 2);
  tiles.set(`${column} ${row}`, { column: Number(column), row: Number(row), levels, picture: pictureOf(levels, map.side_cells),
    known_cells: knownCells(levels, Number(column), Number(row)) });
}

// ---- The connection: one that has ended, or is silent, is made anew.

let events = null;
let heard_ms = 0;

function connect() {
  events?.close();
  heard_ms = performance.now();
  events = new EventSource("events");
  for (const [kind, take] of Object.entries(hear)) {
    events.addEventListener(kind, event => heardNow(() => take(JSON.parse(event.data))));
  }
  events.addEventListener("tile", event => heardNow(() => hearTile(event.data)));
  events.onerror = () => showNoConnection();
}

function heardNow(take) {
  heard_ms = performance.now();
  take();
  draw();
}

setInterval(() => {
  const silent_ms = performance.now() - heard_ms;
  if (silent_ms > 2500) {
    showNoConnection();
    connect();
  }
}, 500);

// ---- Words and figures

function text(id, words) {
  if ($(id).textContent !== words) $(id).textContent = words;
}

function showNoConnection() {
  status = null;
  document.body.dataset.state = "NONE";
  text("state", "no connection");
  text("reasons", "to the daemon; tried again and again");
  text("probability", "");
}

function showStatus() {
  document.body.dataset.state = status.state;
  text("state", status.state);
  text("reasons", status.reasons.join(", "));
  text("probability", `pose right: ${(100 * status.pose_probability).toFixed(0)} %`);
  const { rates, scans, map: size, stages } = status;
  text("scans", `${rates.scans_hz.toFixed(1)} Hz, poses ${rates.poses_hz.toFixed(1)} Hz, ${scans.dropped} dropped, ${scans.rejected} refused`);
  text("size", `${size.width_m.toFixed(0)} m by ${size.height_m.toFixed(0)} m, ${(100 * size.memory_used).toFixed(0)} % of its memory`);
  text("cpu", `matcher ${stages.matcher.p50_ms.toFixed(1)} ms, filter ${stages.filter.p50_ms.toFixed(1)} ms (median)`);
}

function showPose() {
  const deg = 180 / Math.PI;
  const [xx, , yy] = pose.covariance_m2;
  text("pose", `x ${pose.x_m.toFixed(2)} m, y ${pose.y_m.toFixed(2)} m, yaw ${(pose.yaw_rad * deg).toFixed(1)}\u00b0`);
  text("deviation", `${Math.sqrt(xx + yy).toFixed(3)} m, ${(pose.sd_yaw_rad * deg).toFixed(2)}\u00b0`);
}

// ---- The picture

const toX = x_m => canvas.width / 2 + (x_m - view.x_m) * scale();
const toY = y_m => canvas.height / 2 - (y_m - view.y_m) * scale();
const scale = () => view.px_per_m * devicePixelRatio;

let is_asked = false;

function draw() {
  if (!is_asked) {
    is_asked = true;
    requestAnimationFrame(paint);
  }
}

function paint() {
  is_asked = false;
  canvas.width = canvas.clientWidth * devicePixelRatio;
  canvas.height = canvas.clientHeight * devicePixelRatio;
  if (view.follow && pose) {
    view.x_m = pose.x_m;
    view.y_m = pose.y_m;
  }
  const pen = canvas.getContext("2d");
  pen.lineWidth = 2 * devicePixelRatio;
  paintMap(pen);
  paintPath(pen);
  paintScan(pen);
  if (pose) paintPose(pen);
  if (measured_m) paintLine(pen, measured_m);
  if (placed_m) paintLine(pen, placed_m);
  paintScale();
}

function paintMap(pen) {
  const side_m = map ? map.side_cells * map.cell_size_m : 0;
  pen.imageSmoothingEnabled = scale() * (map?.cell_size_m ?? 1) < 1;
  for (const { column, row, picture } of tiles.values()) {
    // Whole pixels, the same for neighbours, so that there is no seam.
    const left = Math.round(toX(column * side_m)), right = Math.round(toX((column + 1) * side_m));
    const top = Math.round(toY((row + 1) * side_m)), bottom = Math.round(toY(row * side_m));
    pen.drawImage(picture, left, top, right - left, bottom - top);
  }
}

function paintPath(pen) {
  pen.strokeStyle = "#dc3220";
  pen.beginPath();
  for (let i = 0; i < path_m.length; i += 2) pen.lineTo(toX(path_m[i]), toY(path_m[i + 1]));
  if (pose) pen.lineTo(toX(pose.x_m), toY(pose.y_m));
  pen.stroke();
}

function paintScan(pen) {
  const dot = 3 * devicePixelRatio;
  pen.fillStyle = "#005ab5";
  for (let i = 0; i < scan_m.length; i += 2) pen.fillRect(toX(scan_m[i]) - dot / 2, toY(scan_m[i + 1]) - dot / 2, dot, dot);
}

// The robot as an arrow, around it where it may be: the ellipse of three standard deviations, and the same of its heading.
function paintPose(pen) {
  const [xx, xy, yy] = pose.covariance_m2;
  const mean = (xx + yy) / 2, spread = Math.hypot((xx - yy) / 2, xy);
  const sd_m = [Math.sqrt(mean + spread), Math.sqrt(Math.max(mean - spread, 0))];
  const size = 9 * devicePixelRatio, far = 3 * size;
  pen.save();
  pen.translate(toX(pose.x_m), toY(pose.y_m));
  pen.scale(1, -1);
  pen.fillStyle = "#7c3aed55";
  pen.beginPath();
  pen.ellipse(0, 0, 3 * sd_m[0] * scale(), 3 * sd_m[1] * scale(), Math.atan2(2 * xy, xx - yy) / 2, 0, 2 * Math.PI);
  pen.fill();
  pen.rotate(pose.yaw_rad);
  pen.beginPath();
  pen.moveTo(0, 0);
  pen.arc(0, 0, far, -3 * pose.sd_yaw_rad, 3 * pose.sd_yaw_rad);
  pen.fill();
  pen.fillStyle = "#7c3aed";
  pen.beginPath();
  pen.moveTo(size * 1.5, 0);
  pen.lineTo(-size, size);
  pen.lineTo(-size / 2, 0);
  pen.lineTo(-size, -size);
  pen.fill();
  pen.restore();
}

function paintLine(pen, points_m) {
  pen.strokeStyle = pen.fillStyle = "#b45309";
  pen.beginPath();
  for (const [x_m, y_m] of points_m) {
    pen.lineTo(toX(x_m), toY(y_m));
    pen.fillRect(toX(x_m) - 4, toY(y_m) - 4, 8, 8);
  }
  pen.stroke();
}

function paintScale() {
  const steps_m = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100];
  const length_m = steps_m.find(step_m => step_m * view.px_per_m >= 50) ?? 200;
  $("scale").style.width = `${length_m * view.px_per_m}px`;
  text("scale_text", `${length_m} m`);
}

// ---- Hands

function press(id, is_pressed) {
  $(id).setAttribute("aria-pressed", String(is_pressed));
}

function follow(is_followed) {
  view.follow = is_followed;
  press("follow", is_followed);
  draw();
}

// The point under (x, y), in the canvas's CSS pixels.
function pointAt(x, y) {
  return [view.x_m + (x - canvas.clientWidth / 2) / view.px_per_m, view.y_m - (y - canvas.clientHeight / 2) / view.px_per_m];
}

function zoom(factor, x = canvas.clientWidth / 2, y = canvas.clientHeight / 2) {
  const before = pointAt(x, y);
  view.px_per_m = Math.min(Math.max(view.px_per_m * factor, 1), 2000);
  const after = pointAt(x, y);
  move(before[0] - after[0], before[1] - after[1]);
}

function move(dx_m, dy_m) {
  view.x_m += dx_m;
  view.y_m += dy_m;
  draw();
}

function showAll() {
  const boxes = [...tiles.values()].map(tile => tile.known_cells).filter(box => box);
  if (boxes.length === 0) return;
  const edge_m = (side, most) => most(...boxes.map(box => box[side])) * map.cell_size_m;
  const left_m = edge_m(0, Math.min), low_m = edge_m(1, Math.min), right_m = edge_m(2, Math.max), high_m = edge_m(3, Math.max);
  follow(false);
  view.x_m = (left_m + right_m) / 2;
  view.y_m = (low_m + high_m) / 2;
  view.px_per_m = 0.94 * Math.min(canvas.clientWidth / (right_m - left_m), canvas.clientHeight / (high_m - low_m));
}

function measureAt(x, y) {
  measured_m = [...(measured_m.length === 2 ? [] : measured_m), pointAt(x, y)];
  const [from, to] = measured_m;
  text("measured", to ? `${Math.hypot(to[0] - from[0], to[1] - from[1]).toFixed(2)} m` : "touch a second point");
  draw();
}

const fingers = new Map(); // those that are down, by their number

canvas.addEventListener("pointerdown", event => {
  canvas.setPointerCapture(event.pointerId);
  fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
  if (measured_m && fingers.size === 1) measureAt(event.offsetX, event.offsetY);
  if (placed_m && fingers.size === 1) placed_m = [pointAt(event.offsetX, event.offsetY)];
});

// One finger moves the map; two also zoom it.
canvas.addEventListener("pointermove", event => {
  const from = fingers.get(event.pointerId);
  if (!from || measured_m) return;
  const to = [event.offsetX, event.offsetY];
  if (placed_m) {
    placed_m = [placed_m[0] ?? pointAt(...to), pointAt(...to)];
    draw();
    return;
  }
  const other = [...fingers].find(([id]) => id !== event.pointerId)?.[1];
  if (view.follow && Math.hypot(to[0] - from[0], to[1] - from[1]) > 3) follow(false);
  if (view.follow) return;
  if (other) {
    const distance = point => Math.hypot(point[0] - other[0], point[1] - other[1]);
    zoom(distance(to) / Math.max(distance(from), 1), other[0], other[1]);
  } else {
    move((from[0] - to[0]) / view.px_per_m, (to[1] - from[1]) / view.px_per_m);
  }
  fingers.set(event.pointerId, to);
});

canvas.addEventListener("pointerup", () => {
  if (placed_m?.length !== 2) return;
  const [[x_m, y_m], [to_x_m, to_y_m]] = placed_m;
  const yaw_deg = Math.atan2(to_y_m - y_m, to_x_m - x_m) * 180 / Math.PI;
  ask(`pose ${x_m.toFixed(3)} ${y_m.toFixed(3)} ${yaw_deg.toFixed(2)}`);
  place(false);
});

for (const kind of ["pointerup", "pointercancel"]) canvas.addEventListener(kind, event => fingers.delete(event.pointerId));

canvas.addEventListener("wheel", event => {
  event.preventDefault();
  zoom(Math.exp(-event.deltaY / 400), event.offsetX, event.offsetY);
}, { passive: false });

$("in").onclick = () => zoom(1.5);
$("out").onclick = () => zoom(1 / 1.5);
$("all").onclick = showAll;
$("follow").onclick = () => follow(!view.follow);
$("measure").onclick = () => {
  measured_m = measured_m ? null : [];
  press("measure", measured_m !== null);
  text("measured", measured_m ? "touch two points" : "");
  draw();
};
addEventListener("resize", draw);

// ---- Commands, for who knows the token, which this tab keeps

$("token").value = sessionStorage.getItem("token") ?? "";
$("token").onchange = () => sessionStorage.setItem("token", $("token").value);

async function ask(command) {
  text("answer", "...");
  try {
    const answer = await fetch("command", { method: "POST", body: command, headers: { Authorization: `Bearer ${$("token").value}` } });
    text("answer", answer.ok ? `${command}: ${(await answer.text()).trim()}` : answer.status === 401 ? "the token is wrong" : `refused (${answer.status})`);
  } catch {
    text("answer", "no connection");
  }
}

function place(is_placing) {
  if (is_placing) follow(false); // what is pointed at must not move
  placed_m = is_placing ? [] : null;
  press("place", is_placing);
  draw();
}

function showControls(is_shown) {
  $("controls").hidden = !is_shown;
  press("control", is_shown);
  if (!is_shown) place(false);
}

$("control").onclick = () => showControls($("controls").hidden);
for (const command of ["pause", "resume", "save"]) $(command).onclick = () => ask(command);
$("place").onclick = () => place(placed_m === null);

async function findControl() {
  const is_there = await fetch("control").then(answer => answer.text(), () => "no") === "yes";
  $("control").hidden = !is_there;
  if (!is_there) showControls(false);
}

// For tests and for the curious: what is shown, as figures.
window.odoless = {
  get tiles() { return tiles.size; },
  get run() { return map?.run; },
  get pose() { return pose; },
  get path_points() { return path_m.length / 2; },
  get view() { return { ...view }; },
  // From 0, free, to 15, occupied; 16: nothing is known.
  levelAt(x_m, y_m) {
    if (!map) return UNKNOWN;
    const column = Math.floor(x_m / map.cell_size_m), row = Math.floor(y_m / map.cell_size_m);
    const tile = tiles.get(`${Math.floor(column / map.side_cells)} ${Math.floor(row / map.side_cells)}`);
    const within = at => (at % map.side_cells + map.side_cells) % map.side_cells;
    return tile ? tile.levels[within(row) * map.side_cells + within(column)] : UNKNOWN;
  },
};

connect();
