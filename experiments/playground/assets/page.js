// The playground itself: three swarms from the same seed, one of which a reader steers.

const SLICE = 12; // milliseconds of work after which the page can answer
const PACE = 80; // least milliseconds of an iteration while it runs
const CALM = 1000; // milliseconds between two pictures for those who ask for reduced motion

const COURSES = [
  {
    title: "Gap to the optimum in percent", across: "evaluations", scale: "logarithmic",
    x: ({ evaluations }) => evaluations, y: ({ bestFitness }, { optimum }) => 100 * (bestFitness / optimum - 1),
  },
  {
    title: "Population collision E(P), on a square-root scale", across: "iterations", scale: "root",
    x: (_, __, iteration) => iteration, y: ({ populationCollision }) => populationCollision,
  },
  {
    title: "Population size", across: "iterations", scale: "linear",
    x: (_, __, iteration) => iteration, y: ({ size }) => size,
  },
];

const counted = (value) => value.toLocaleString("en");
const percent = (gap) => `${(100 * gap).toFixed(2)} %`;
const gapIn = (record, problem) => record.bestFitness / problem.optimum - 1;
const listed = (parts) => (parts.length < 2 ? parts.join() : `${parts.slice(0, -1).join(", ")} and ${parts.at(-1)}`);

// A swarm with whoever decides for it, and its part of the page.
class Entrant {
  constructor(pane, name, makeController) {
    Object.assign(this, { name, makeController });
    this.picture = new MapPicture(pane.querySelector(".field"));
    this.state = pane.querySelector(".facts");
    this.title = pane.querySelector("h3").textContent;
  }

  begin(problem, settings, seed) {
    this.controller = this.makeController();
    this.swarm = new Swarm(problem, settings, seed);
    this.swarm.begin(this.controller.firstSize);
    this.picture.showMap(problem.map);
  }

  step() {
    const { size, degree } = this.controller.decide(this.swarm);
    return this.swarm.step(size, degree);
  }

  show() {
    const { now, problem, best } = this.swarm;
    this.picture.showSwarm(this.swarm);
    const collides = best.collision <= FEASIBLE ? "" : ", by a path that collides";
    this.state.textContent =
      `${now.size} members, ${now.feasible} feasible; φ ${now.repairDegree.toFixed(2)}; ` +
      `E(P) ${now.populationCollision.toFixed(1)}. Gap ${percent(gapIn(now, problem))}${collides}, ` +
      `after ${counted(now.evaluations)} evaluations.`;
    this.picture.svg.setAttribute("aria-label", `${this.title}: ${this.state.textContent}`);
  }
}

class Playground {
  constructor(root, data) {
    Object.assign(this, { root, data });
    const find = (selector) => root.querySelector(selector);
    this.controls = Object.fromEntries(
      ["case", "seed", "size", "degree", "step", "run", "reset", "fault", "told", "count"].map((name) =>
        [name, find(`[data-part=${name}]`)]));
    const panes = Object.fromEntries([...root.querySelectorAll(".swarm")].map((pane) => [pane.dataset.of, pane]));
    const { size, degree } = this.controls;
    const hand = () => ({
      firstSize: Number(size.value),
      decide: () => ({ size: Number(size.value), degree: Number(degree.value) }),
    });
    this.entrants = [
      new Entrant(panes.hand, "you", hand),
      new Entrant(panes.schedule, data.schedule.label, () => new Schedule(data.schedule)),
      new Entrant(panes.policy, "learned policy", () => new Policy(data.policy)),
    ];
    const figures = root.querySelectorAll(".curves figure");
    this.charts = COURSES.map((course, k) => new Chart(figures[k], course, ["hand", "schedule", "policy"]));
    this.problems = data.cases.map((one) => new Problem(one));
    this.calm = matchMedia("(prefers-reduced-motion: reduce)");
    this.work = Promise.resolve();
    this.running = null; // the run under way
    this.listen();
    this.reset();
  }

  listen() {
    const { controls } = this;
    for (const slider of [controls.size, controls.degree]) {
      const show = () => (slider.nextElementSibling.textContent = slider.value);
      slider.addEventListener("input", show);
      show();
    }
    for (const field of [controls.case, controls.seed]) field.addEventListener("change", () => this.reset());
    controls.reset.addEventListener("click", () => this.reset());
    controls.step.addEventListener("click", () => { this.pause(); this.step(); });
    controls.run.addEventListener("click", () => (this.running ? this.pause() : this.run()));
  }

  // Begins anew with the case and seed in the fields; a faulty seed changes nothing but a message.
  reset() {
    const { controls, data } = this;
    const text = controls.seed.value.trim();
    const seed = /^\d+$/.test(text) ? Number(text) : NaN;
    const valid = Number.isSafeInteger(seed);
    controls.seed.setAttribute("aria-invalid", String(!valid));
    controls.fault.textContent = valid
      ? ""
      : `The seed must be a whole number from 0 to ${Number.MAX_SAFE_INTEGER}, got “${text}”.`;
    if (!valid) return;
    this.pause();
    this.episode = Symbol("episode"); // work on an earlier one stops
    const problem = this.problems[controls.case.value];
    for (const entrant of this.entrants) entrant.begin(problem, data.settings, seed);
    this.show();
  }

  get ended() {
    return this.entrants[0].swarm.ended;
  }

  // Carries out one iteration of all swarms, after those that were asked for before.
  step() {
    const { episode } = this;
    this.work = this.work.then(() => this.advance(episode));
    return this.work;
  }

  async advance(episode) {
    let began = performance.now();
    for (const entrant of this.entrants) {
      if (episode !== this.episode || entrant.swarm.ended) return;
      for (const _ of entrant.step()) {
        if (performance.now() - began < SLICE) continue;
        await new Promise((resolve) => setTimeout(resolve));
        if (episode !== this.episode) return;
        began = performance.now();
      }
    }
    const pictureIsDue = !this.running || !this.calm.matches || performance.now() - this.shown >= CALM;
    if (pictureIsDue || this.ended) this.show();
  }

  async run() {
    const run = (this.running = Symbol("run"));
    this.controls.run.textContent = "Pause";
    while (this.running === run && !this.ended) {
      const paced = new Promise((resolve) => setTimeout(resolve, PACE));
      await this.step();
      await paced;
    }
    if (this.running === run) this.pause();
  }

  pause() {
    if (!this.running) return;
    this.running = null;
    this.controls.run.textContent = "Run";
    this.show();
  }

  show() {
    const { controls, entrants, data } = this;
    for (const entrant of entrants) entrant.show();
    const { problem, iteration } = entrants[0].swarm;
    this.charts.forEach((chart, k) => {
      const { x, y } = COURSES[k];
      chart.show(entrants.map(({ swarm }) =>
        swarm.history.map((record, number) => [x(record, problem, number), y(record, problem)])));
    });
    controls.count.textContent = `Iteration ${iteration} of ${data.settings.iterations}`;
    controls.step.disabled = controls.run.disabled = this.ended;
    // A screen reader could not follow while it runs.
    controls.told.setAttribute("aria-live", this.running && !this.ended ? "off" : "polite");
    controls.told.textContent = `${controls.count.textContent}. ${this.standings()}`;
    this.root.dataset.iteration = iteration;
    this.shown = performance.now();
  }

  // Who is ahead, in numbers: now, and with the evaluations that all have spent.
  standings() {
    const swarms = this.entrants.map(({ swarm }) => swarm);
    const spent = Math.min(...swarms.map(({ now }) => now.evaluations));
    const each = (gaps, more) => listed(this.entrants.map(({ name }, k) => `${name} ${percent(gaps[k])}${more(k)}`));
    const now = swarms.map((swarm) => gapIn(swarm.now, swarm.problem));
    const after = (k) => ` after ${counted(swarms[k].now.evaluations)} evaluations`;
    const told = `Smallest gap now: ${this.leaders(now)} (${each(now, after)}).`;
    const records = swarms.map(({ history }) => history.findLast(({ evaluations }) => evaluations <= spent));
    if (records.includes(undefined)) return told; // a first population was larger than all that another spent
    const then = records.map((record, k) => gapIn(record, swarms[k].problem));
    return `${told} Smallest gap within ${counted(spent)} evaluations: ${this.leaders(then)} (${each(then, () => "")}).`;
  }

  leaders(gaps) {
    const least = Math.min(...gaps);
    return listed(this.entrants.filter((_, k) => gaps[k] === least).map(({ name }) => name));
  }
}

for (const root of document.querySelectorAll(".playground"))
  root.playground = new Playground(root, JSON.parse(root.querySelector("script").textContent));
