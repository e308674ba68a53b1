// The player: two replays of the same scenario and seed side by side, with one clock.
"use strict";

const SVG = "http://www.w3.org/2000/svg";
const WIDTH = 1000; // of a map, in units of its picture
// From the lowest to the highest.
const LAYERS = ["best", "removed", "new", "colliding", "feasible", "trajectory", "removed-marks", "new-marks"];
const MARK = 9; // half the width of crosses, in the same units
// Courses beside the map: column of the trace, name, decimals, and scale of the vertical axis.
const COURSES = [
  ["population_collision", "E(P):", 3, Math.sqrt],
  ["population_size", "members:", 0, Number],
  ["repair_degree", "φ:", 2, Number],
];
const CHART = { width: 200, height: 90, margin: 6 };

function element(name, attributes = {}, parent = null) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (parent) parent.append(made);
  return made;
}

const formatted = (value, digits) =>
  value === undefined || Number.isNaN(value) ? "–" : value.toLocaleString("en", { maximumFractionDigits: digits });

// A map as a picture that is WIDTH units wide, and the positions of map coordinates on it.
class MapPicture {
  constructor(svg) {
    this.svg = svg;
    this.ground = element("g", {}, svg);
    this.layers = {};
    for (const name of LAYERS)
      this.layers[name] = element("path", { class: name }, svg);
    this.ends = element("g", {}, svg);
  }

  show(map) {
    if (this.map === map) return;
    this.map = map;
    const [left, low, right, high] = map.extent;
    this.height = (WIDTH * (high - low)) / (right - left);
    this.svg.setAttribute("viewBox", `0 0 ${WIDTH} ${this.height}`);
    this.ground.replaceChildren();
    this.ends.replaceChildren();
    if (map.picture) {
      const size = { width: WIDTH, height: this.height, preserveAspectRatio: "none" };
      const image = element("image", { href: map.picture, ...size }, this.ground);
      image.style.imageRendering = "pixelated";
    }
    const scale = WIDTH / (right - left);
    for (const [x, y, radius] of map.circles ?? []) {
      const [cx, cy] = this.place(x, y);
      element("circle", { class: "obstacle", cx, cy, r: radius * scale }, this.ground);
    }
    for (const polygon of map.polygons ?? []) {
      const points = polygon.map(([x, y]) => this.place(x, y).join()).join(" ");
      element("polygon", { class: "obstacle", points }, this.ground);
    }
    if (map.shortest) {
      const points = map.shortest.map(([x, y]) => this.place(x, y).join()).join(" ");
      element("polyline", { class: "shortest", points }, this.ground);
    }
    for (const [letter, point] of [["S", map.start], ["T", map.target]]) {
      if (!point) continue;
      const [x, y] = this.place(...point);
      element("circle", { class: "end", cx: x, cy: y, r: 8 }, this.ends);
      const side = y > 50 ? -16 : 34;
      element("text", { x, y: y + side, "text-anchor": "middle" }, this.ends).textContent = letter;
    }
  }

  place(x, y) {
    const [left, low, right, high] = this.map.extent;
    const down = this.map.yUp ? (high - y) / (high - low) : (y - low) / (high - low);
    return [((x - left) / (right - left)) * WIDTH, down * this.height];
  }

  // Points [x, y] of the picture, from quantised coordinates.
  points(values, bits) {
    const steps = 2 ** bits - 1;
    const found = [];
    for (let k = 0; k + 1 < values.length; k += 2) {
      const x = (values[k] / steps) * WIDTH;
      const up = (values[k + 1] / steps) * this.height;
      found.push([x.toFixed(1), (this.map.yUp ? this.height - up : up).toFixed(1)]);
    }
    return found;
  }
}

const lineOf = (points) => `M${points.join("L")}`;
const middleOf = (points) => points[points.length >> 1].map(Number);
const dot = ([x, y], radius) =>
  `M${x - radius} ${y}a${radius} ${radius} 0 1 0 ${2 * radius} 0a${radius} ${radius} 0 1 0 ${-2 * radius} 0`;
const plus = ([x, y]) => `M${x - MARK} ${y}h${2 * MARK}M${x} ${y - MARK}v${2 * MARK}`;
const cross = ([x, y]) =>
  `M${x - MARK} ${y - MARK}l${2 * MARK} ${2 * MARK}m0 ${-2 * MARK}l${-2 * MARK} ${2 * MARK}`;

// A course over the iterations with a cursor.
class Chart {
  constructor(parent, name, digits, scale) {
    Object.assign(this, { name, digits, scale });
    const figure = document.createElement("figure");
    this.caption = document.createElement("figcaption");
    const { width, height } = CHART;
    this.svg = element("svg", { viewBox: `0 0 ${width} ${height}`, "aria-hidden": "true" });
    element("path", { class: "frame", d: `M0.5 0V${height - 0.5}H${width}` }, this.svg);
    this.events = element("path", { class: "event" }, this.svg);
    this.line = element("path", { class: "course" }, this.svg);
    this.cursor = element("line", { class: "cursor", y1: 0, y2: height }, this.svg);
    this.at = element("circle", { class: "at", r: 3 }, this.svg);
    figure.append(this.caption, this.svg);
    parent.append(figure);
  }

  // `events` are the iterations from which the map is another one.
  show(values, iterations, events) {
    const { width, height, margin } = CHART;
    const top = this.scale(Math.max(...values)) || 1;
    this.values = values;
    this.x = (iteration) => (iteration / Math.max(iterations, 1)) * (width - margin);
    this.y = (value) => height - (this.scale(value) / top) * (height - margin);
    const points = values.map((value, iteration) => `${this.x(iteration).toFixed(1)} ${this.y(value).toFixed(1)}`);
    this.line.setAttribute("d", lineOf(points));
    this.events.setAttribute("d", events.map((event) => `M${this.x(event).toFixed(1)} 0V${height}`).join(""));
  }

  seek(iteration) {
    const at = Math.min(iteration, this.values.length - 1);
    const x = this.x(at);
    for (const [name, value] of [["x1", x], ["x2", x]]) this.cursor.setAttribute(name, value);
    this.at.setAttribute("cx", x);
    this.at.setAttribute("cy", this.y(this.values[at]));
    this.caption.textContent = `${this.name} ${formatted(this.values[at], this.digits)}`;
  }
}

// One of the two replays: its map, its state in words, and its courses.
class Pane {
  constructor(root) {
    this.root = root;
    this.select = root.querySelector("select");
    this.svg = root.querySelector(".map");
    this.picture = new MapPicture(this.svg);
    this.state = root.querySelector(".state");
    const courses = root.querySelector(".courses");
    this.charts = COURSES.map(([key, ...course]) => [key, new Chart(courses, ...course)]);
  }

  async show(group, packed, iterations) {
    this.group = group;
    const replay = (packed.unpacked ??= await Replay.unpack(packed));
    this.replay = replay;
    const events = group.maps.slice(1).map(({ from }) => from);
    for (const [key, chart] of this.charts) chart.show(replay.courses[key], iterations, events);
  }

  seek(iteration) {
    const { replay, picture } = this;
    const frame = replay.frameAt(iteration);
    const map = this.group.maps.findLast(({ from }) => from <= replay.frames[frame]);
    picture.show(map);
    picture.svg.classList.toggle("points", replay.points);
    const drawn = Object.fromEntries(LAYERS.map((name) => [name, []]));
    const shape = (points) => (replay.points ? dot(points[0].map(Number), 5) : lineOf(points));
    const coordinates = (k, member) => picture.points(replay.member(k, member), replay.bits);
    replay.flags[frame].forEach((flags, member) => {
      const points = coordinates(frame, member);
      drawn[flags & FEASIBLE ? "feasible" : "colliding"].push(shape(points));
      if (!(flags & NEW)) return;
      if (!replay.points) drawn.new.push(lineOf(points));
      drawn["new-marks"].push(plus(middleOf(points)));
    });
    if (frame > 0)
      replay.flags[frame - 1].forEach((flags, member) => {
        if (!(flags & REMOVED)) return;
        const points = coordinates(frame - 1, member);
        if (!replay.points) drawn.removed.push(lineOf(points));
        drawn["removed-marks"].push(cross(middleOf(points)));
      });
    const best = picture.points(replay.best[frame], replay.bits);
    drawn.best.push(replay.points && best.length === 1 ? dot(best[0].map(Number), 8) : lineOf(best));
    const been = (replay.robots ?? []).slice(0, frame + 1).filter((robot) => robot);
    if (been.length) {
      const trajectory = picture.points(been.flat(), replay.bits);
      drawn.trajectory.push(lineOf(trajectory), dot(trajectory.at(-1).map(Number), 10));
    }
    for (const [name, parts] of Object.entries(drawn)) picture.layers[name].setAttribute("d", parts.join(""));
    for (const [, chart] of this.charts) chart.seek(replay.frames[frame]);
    this.tell(frame);
  }

  tell(frame) {
    const { replay } = this;
    const iteration = replay.frames[frame];
    const members = replay.members[frame], feasible = replay.feasible[frame];
    const shown = replay.every > 1 ? ` (1 of ${replay.every} drawn)` : "";
    const best = formatted(replay.courses.best_fitness[iteration], 2);
    const collides = replay.bestFlags[frame] & FEASIBLE ? "" : ", which collides";
    this.state.textContent =
      `Iteration ${iteration}: ${members} members${shown}, ${feasible} feasible, ${members - feasible} colliding; ` +
      `${replay.added[frame]} new, ${replay.removed[frame]} removed in this step. ` +
      `Best so far ${best}${collides}, after ${formatted(replay.courses.evaluations[iteration], 0)} evaluations.`;
    this.svg.setAttribute("aria-label", `${replay.label}, ${this.state.textContent}`);
  }
}

class Player {
  constructor(root, groups) {
    this.root = root;
    this.groups = groups;
    this.panes = [...root.querySelectorAll(".pane")].map((pane) => new Pane(pane));
    this.task = root.querySelector(".task");
    this.slider = root.querySelector("input[type=range]");
    this.output = root.querySelector(".now");
    this.speed = root.querySelector(".speed");
    this.playButton = root.querySelector(".play");
    this.news = root.querySelector(".news");
    this.task.append(...groups.map(({ scenario, seed }, k) => new Option(`${scenario}, seed ${seed}`, k)));
    this.task.addEventListener("change", () => this.choose());
    for (const pane of this.panes) pane.select.addEventListener("change", () => this.load());
    this.slider.addEventListener("input", () => { this.pause(); this.seek(Number(this.slider.value)); });
    this.playButton.addEventListener("click", () => (this.timer ? this.pause() : this.play()));
    this.speed.addEventListener("change", () => { if (this.timer) { this.pause(); this.play(); } });
    for (const [name, step] of [[".back", -1], [".forward", 1]])
      root.querySelector(name).addEventListener("click", () => { this.pause(); this.seek(this.iteration + step); });
  }

  async choose() {
    const { replays } = this.groups[this.task.value];
    this.panes.forEach((pane, k) => {
      pane.root.hidden = k > 0 && replays.length < 2;
      pane.select.replaceChildren(...replays.map(({ label }, place) => new Option(label, place)));
      pane.select.value = Math.min(k, replays.length - 1);
    });
    await this.load();
  }

  async load() {
    this.pause();
    const group = this.groups[this.task.value];
    const panes = this.panes.filter((pane) => !pane.root.hidden);
    const chosen = panes.map((pane) => group.replays[pane.select.value]);
    this.last = Math.max(...chosen.map(({ frames }) => frames.at(-1)));
    this.slider.max = this.last;
    await Promise.all(panes.map((pane, k) => pane.show(group, chosen[k], this.last)));
    this.root.classList.toggle("points", chosen.some(({ points }) => points));
    this.seek(Math.min(this.iteration ?? 0, this.last));
    this.root.dataset.ready = "";
  }

  seek(iteration) {
    this.iteration = Math.min(Math.max(iteration, 0), this.last);
    this.slider.value = this.iteration;
    this.slider.setAttribute("aria-valuetext", `iteration ${this.iteration} of ${this.last}`);
    this.output.textContent = `${this.iteration} of ${this.last}`;
    const panes = this.panes.filter((pane) => !pane.root.hidden);
    for (const pane of panes) pane.seek(this.iteration);
    // A screen reader could not follow while it plays.
    if (!this.timer)
      this.news.textContent = panes.map(({ replay, state }) => `${replay.label}: ${state.textContent}`).join(" ");
  }

  play() {
    if (this.iteration >= this.last) this.iteration = -1;
    this.timer = setInterval(() => {
      this.seek(this.iteration + 1);
      if (this.iteration >= this.last) this.pause();
    }, 1000 / Number(this.speed.value));
    this.label("Pause");
  }

  pause() {
    clearInterval(this.timer);
    const played = this.timer;
    this.timer = null;
    this.label("Play");
    if (played) this.seek(this.iteration);
  }

  label(text) {
    this.playButton.textContent = text;
  }
}

const replayData = document.getElementById("replay-data");
if (replayData) {
  const player = new Player(document.querySelector(".player"), JSON.parse(replayData.textContent));
  player.choose();
}
