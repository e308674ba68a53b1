// Pictures of the playground: a map with a swarm on it, and curves of several swarms.

const SVG = "http://www.w3.org/2000/svg";

function element(name, attributes = {}, parent = null) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (parent) parent.append(made);
  return made;
}

const lineOf = (points) => `M${points.map(([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`).join("L")}`;

// A map and a swarm; pictures have map units, upside down.
class MapPicture {
  constructor(svg) {
    this.svg = svg;
    this.ground = element("g", {}, svg);
    this.layers = {};
    for (const name of ["best", "colliding", "feasible"]) this.layers[name] = element("path", { class: name }, svg);
    this.ends = element("g", {}, svg);
  }

  showMap({ view, circles, polygons, start, target }) {
    const [left, low, right, high] = view;
    this.place = ([x, y]) => [x - left, high - y];
    this.svg.setAttribute("viewBox", `0 0 ${right - left} ${high - low}`);
    this.ground.replaceChildren();
    this.ends.replaceChildren();
    for (const [x, y, radius] of circles) {
      const [cx, cy] = this.place([x, y]);
      element("circle", { class: "obstacle", cx, cy, r: radius }, this.ground);
    }
    for (const polygon of polygons) {
      const points = polygon.map((vertex) => this.place(vertex).join()).join(" ");
      element("polygon", { class: "obstacle", points }, this.ground);
    }
    const size = (right - left) / 40;
    for (const [letter, point] of [["S", start], ["T", target]]) {
      const [x, y] = this.place(point);
      element("circle", { class: "end", cx: x, cy: y, r: size / 3 }, this.ends);
      const label = { x, y: y - size * 0.6, "font-size": size, "text-anchor": "middle" };
      element("text", label, this.ends).textContent = letter;
    }
  }

  showSwarm(swarm) {
    const lines = { feasible: [], colliding: [], best: [] };
    const line = (position) => lineOf(swarm.problem.points(position).map(this.place));
    swarm.positions.forEach((position, i) => {
      lines[swarm.collision[i] <= FEASIBLE ? "feasible" : "colliding"].push(line(position));
    });
    lines.best.push(line(swarm.best.position));
    for (const [name, parts] of Object.entries(lines)) this.layers[name].setAttribute("d", parts.join(""));
  }
}

const PLOT = { width: 360, height: 190, left: 48, right: 10, top: 10, bottom: 34 };

// Scales of a vertical axis: where a value lies between its ends, and the ticks between these.
const SCALES = {
  root: {
    at: (value, [, high]) => Math.sqrt(value / high),
    ends: (values) => [0, niceAbove(Math.max(...values))],
    ticks: ([, high]) => [0, high / 4, high],
  },
  linear: {
    at: (value, [, high]) => value / high,
    ends: (values) => [0, niceAbove(Math.max(...values))],
    ticks: ([, high]) => [0, high / 2, high],
  },
  logarithmic: {
    at: (value, [low, high]) => Math.log(Math.max(value, low) / low) / Math.log(high / low),
    ends: (values) => {
      const positive = values.filter((value) => value > 0);
      const low = Math.floor(Math.log10(Math.min(...positive, 1)));
      const high = Math.ceil(Math.log10(Math.max(...positive, 1)));
      return [10 ** low, 10 ** Math.max(high, low + 1)];
    },
    ticks: ([low, high]) => {
      const count = Math.round(Math.log10(high / low));
      const stride = Math.ceil(count / 5);
      return Array.from({ length: Math.floor(count / stride) + 1 }, (_, k) => low * 10 ** (k * stride));
    },
  },
};

// The least of 1, 2, 5, 10, 20, ... that is no smaller.
function niceAbove(value) {
  if (!(value > 0)) return 1;
  const unitOf = 10 ** Math.floor(Math.log10(value));
  return [1, 2, 5, 10].find((step) => step * unitOf >= value) * unitOf;
}

const shortNumber = (value) =>
  value >= 1e6 ? `${value / 1e6}M` : value >= 1e4 ? `${value / 1e3}k` : String(Number(value.toPrecision(3)));

// A chart with one curve for each swarm.
class Chart {
  // `course` has a title, names of both axes, a scale, and functions `x` and `y` of a record and its problem.
  constructor(figure, course, names) {
    this.course = course;
    this.svg = element("svg", { viewBox: `0 0 ${PLOT.width} ${PLOT.height}`, role: "img" });
    this.frame = element("g", { class: "frame" }, this.svg);
    this.curves = names.map((name) => element("path", { class: `curve ${name}` }, this.svg));
    const caption = document.createElement("figcaption");
    caption.textContent = course.title;
    this.svg.setAttribute("aria-label", course.title);
    figure.append(caption, this.svg);
  }

  // `series` are lists of points [x, y], one for each swarm.
  show(series) {
    const { course, frame } = this;
    const { width, height, left, right, top, bottom } = PLOT;
    const scale = SCALES[course.scale], all = series.flat();
    const ends = scale.ends(all.map(([, y]) => y));
    const most = niceAbove(Math.max(...all.map(([x]) => x)));
    const across = (x) => left + (x / most) * (width - left - right);
    const down = (y) => height - bottom - scale.at(y, ends) * (height - top - bottom);
    frame.replaceChildren();
    const write = (text, attributes) => (element("text", attributes, frame).textContent = text);
    for (const tick of scale.ticks(ends)) {
      element("path", { d: `M${left} ${down(tick).toFixed(1)}H${width - right}` }, frame);
      write(shortNumber(tick), { x: left - 6, y: down(tick) + 4, "text-anchor": "end" });
    }
    for (const [tick, anchor] of [[0, "start"], [most, "end"]])
      write(shortNumber(tick), { x: across(tick), y: height - bottom + 16, "text-anchor": anchor });
    write(course.across, { x: across(most / 2), y: height - bottom + 16, "text-anchor": "middle" });
    series.forEach((points, k) => {
      this.curves[k].setAttribute("d", lineOf(points.map(([x, y]) => [across(x), down(y)])));
    });
  }
}
