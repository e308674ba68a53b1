// A learned policy: its observations, the open loop that it corrects, and its network; the port of
// swarm_gym/controllers/learned, open_loop.py, action.py and features.py. Networks have numbers of 32 bits.

const RECENT = 5; // iterations over which recent progress is measured

const gapOf = (swarm, fitness) =>
  Math.max(fitness - swarm.problem.lowerBound, 1e-9 * swarm.problem.lowerBound);

// The features by the names that policies state; one that is not here cannot be observed in a browser.
const FEATURES = {
  "log(1 + E(P)) / 8": ({ now }) => Math.log1p(now.populationCollision) / 8.0,
  "log(1 + mean collision) / 8": ({ now }) => Math.log1p(now.meanCollision) / 8.0,
  "log(1 + standard deviation of the collision) / 8": ({ now }) => Math.log1p(now.collisionDeviation) / 8.0,
  "share of the iterations done": ({ iteration, settings }) => iteration / settings.iterations,
  "log population size, relative to that of the largest": ({ now }, { largest }) =>
    Math.log1p(now.size) / Math.log1p(largest),
  "feasible share": ({ now }) => now.feasibleShare,
  "log(best fitness / lower bound)": ({ now, problem }) => Math.log(now.bestFitness / problem.lowerBound),
  "log(E(P) / first E(P)) / 8": ({ now, history }) =>
    Math.log((1.0 + now.populationCollision) / (1.0 + history[0].populationCollision)) / 8.0,
  "evaluations / reference evaluations, as x / (1 + x)": ({ now, settings }) =>
    now.evaluations / (now.evaluations + settings.referenceEvaluations),
  "log(1 + iteration), relative to that of the last": ({ iteration, settings }) =>
    Math.log1p(iteration) / Math.log1p(settings.iterations),
  [`log(gap ${RECENT} iterations ago / gap)`]: (swarm) => {
    const before = swarm.history[Math.max(swarm.iteration - RECENT, 0)];
    return Math.log(gapOf(swarm, before.bestFitness) / gapOf(swarm, swarm.now.bestFitness));
  },
  "log(1 + diversity) / 8": ({ now }) => Math.log1p(now.diversity) / 8.0,
  "share of the evaluation budget spent": () => 0.0,
  "log10(price / 0.1) / 3": (_, { price }) => Math.log10(Math.max(price, 1e-4) / 0.1) / 3.0,
};

class Policy {
  // `data` is what experiments/playground/exported.py says of a policy.
  constructor(data) {
    Object.assign(this, data);
    this.layers = data.layers.map(({ weight, bias }) => ({ weight: floatsOf(weight), bias: floatsOf(bias) }));
    const unknown = this.features.filter((name) => !(name in FEATURES));
    if (unknown.length) throw new Error(`policy ${this.name}: features that are not ported: ${unknown}`);
  }

  // Returns the next population size and phi.
  decide(swarm) {
    const proposed = this.propose(swarm.iteration);
    const correctable = swarm.iteration >= this.correctedFrom;
    const corrections = this.corrections(swarm, proposed);
    const [size, degree] = proposed.map((number, k) =>
      unit(Math.fround(number + (correctable ? unit(corrections[k]) : 0.0))));
    const natural = this.smallest * (this.largest / this.smallest) ** ((size + 1.0) / 2.0);
    return {
      size: Math.floor(Math.min(Math.max(natural, this.smallest), this.largest) + 0.5),
      degree: Math.min(Math.max((degree + 1.0) / 2.0, 0.0), 1.0),
    };
  }

  // The decisions of the open loop, scaled to [-1, 1].
  propose(iteration) {
    const [size, degree] = this.openLoop[Math.min(iteration, this.openLoop.length - 1)];
    const spread = Math.log(this.largest) - Math.log(this.smallest);
    const scaled = (2.0 * (Math.log(size) - Math.log(this.smallest))) / spread - 1.0;
    return [scaled, 2.0 * degree - 1.0].map((number) => Math.fround(unit(number)));
  }

  // The outputs of the network.
  corrections(swarm, proposed) {
    let values = Float32Array.from([...this.observe(swarm), ...proposed]);
    this.layers.forEach(({ weight, bias }, number) => {
      values = affine(values, weight, bias);
      if (number + 1 < this.layers.length) values = values.map(Math.tanh);
    });
    return values;
  }

  observe(swarm) {
    return this.features.map((name, k) => {
      const [low, high] = swarm.problem.bounds[k];
      return Math.min(Math.max(FEATURES[name](swarm, this), low), high);
    });
  }
}

// A matrix (outputs, inputs) times a vector, plus a bias: products of 32 bits, sums of 64.
function affine(values, weight, bias) {
  return bias.map((constant, output) => {
    let sum = 0.0;
    for (let k = 0; k < values.length; k++) sum += Math.fround(weight[output * values.length + k] * values[k]);
    return Math.fround(sum) + constant;
  });
}

const unit = (number) => Math.min(Math.max(number, -1.0), 1.0);

// The numbers of 32 bits in a text in base 64, the lowest byte first.
function floatsOf(text) {
  const view = new DataView(Uint8Array.from(atob(text), (character) => character.charCodeAt(0)).buffer);
  return Float32Array.from({ length: view.byteLength / 4 }, (_, k) => view.getFloat32(4 * k, true));
}
