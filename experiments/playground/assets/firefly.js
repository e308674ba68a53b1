// A swarm of fireflies: the port of swarm_gym/optimizers/firefly.py and swarm_gym/population.py, with uniform
// new members and no evaluation budget. Source: SPSFA paper, Algorithm 1 and eq. 7 and 12-15.

class Swarm {
  // `settings` has the parameters of the optimizer, `meanWeight` of E(P) and the number of `iterations`.
  constructor(problem, settings, seed) {
    Object.assign(this, { problem, settings });
    this.stream = Stream.ofSeed(seed);
    this.columns = problem.columns;
    this.path = new Float64Array(this.columns + 1);
    this.noise = new Float64Array(this.columns);
    this.squares = new Float64Array(LANES);
    this.positions = []; // of the members, an array (C,) each
    this.fitness = [];
    this.collision = [];
    this.best = { fitness: Infinity, collision: Infinity, position: new Float64Array(this.columns) };
    this.evaluations = 0;
    this.iteration = 0;
    this.history = []; // after the first population and each iteration
  }

  get size() {
    return this.positions.length;
  }

  get ended() {
    return this.iteration >= this.settings.iterations;
  }

  // Draws the first population.
  begin(size) {
    this.addMembers(size, this.problem.initialLower, this.problem.initialUpper);
    this.record(0.0);
  }

  // Carries out one iteration in parts: yields after each member, so that a page can answer in between.
  *step(size, degree) {
    if (size > this.size) this.addMembers(size - this.size, ...this.span());
    else if (size < this.size) this.shrink(size);
    yield* this.iterate(degree);
    this.iteration++;
    this.record(degree);
  }

  // Every firefly looks at every other one in turn, and moves at once towards each one that is brighter now.
  *iterate(degree) {
    const { path, noise, fitness, collision, positions, problem } = this;
    for (let i = 0; i < positions.length; i++) {
      path.set(positions[i], 1);
      for (let j = 0; j < positions.length; j++) {
        if (!(fitness[j] < fitness[i])) continue;
        this.stream.fill(noise);
        this.moveTowards(positions[j]);
        if (degree > 0.0) problem.repair(path, degree);
        fitness[i] = this.evaluate();
        collision[i] = problem.collision;
      }
      positions[i].set(path.subarray(1));
      yield;
    }
  }

  moveTowards(brighter) {
    const { path, noise, problem, settings } = this;
    const { lower, upper } = problem;
    const decay = Math.exp(-settings.absorption * this.squaredDistance(brighter));
    const attraction = settings.attractiveness * decay; // eq. 13, 14
    for (let k = 0; k < brighter.length; k++) {
      const here = path[k + 1];
      const moved = here + attraction * (brighter[k] - here) + settings.noise * (noise[k] - 0.5); // eq. 15
      const raised = moved > lower[k] ? moved : lower[k];
      path[k + 1] = raised < upper[k] ? raised : upper[k];
    }
  }

  squaredDistance(position) {
    const { path, squares } = this;
    squares.fill(0.0);
    for (let k = 0; k < position.length; k++) {
      const difference = position[k] - path[k + 1];
      squares[k % LANES] += difference * difference;
    }
    return total(squares);
  }

  // Returns the fitness of `path`; counts the evaluation and updates the best so far.
  evaluate() {
    const fitness = this.problem.evaluate(this.path);
    this.evaluations++;
    if (fitness < this.best.fitness) {
      this.best.fitness = fitness;
      this.best.collision = this.problem.collision;
      this.best.position.set(this.path.subarray(1));
    }
    return fitness;
  }

  addMembers(count, lower, upper) {
    for (let added = 0; added < count; added++) {
      this.stream.fill(this.noise);
      for (let k = 0; k < this.columns; k++)
        this.path[k + 1] = lower[k] + (upper[k] - lower[k]) * this.noise[k]; // eq. 12
      this.fitness.push(this.evaluate());
      this.collision.push(this.problem.collision);
      this.positions.push(this.path.slice(1));
    }
  }

  // The corners of the box of all members; where it has no extent, the bounds of the workspace.
  span() {
    const lower = new Float64Array(this.columns), upper = new Float64Array(this.columns);
    for (let k = 0; k < this.columns; k++) {
      lower[k] = Math.min(...this.positions.map((position) => position[k]));
      upper[k] = Math.max(...this.positions.map((position) => position[k]));
      if (lower[k] >= upper[k]) [lower[k], upper[k]] = [this.problem.lower[k], this.problem.upper[k]];
    }
    return [lower, upper];
  }

  // Deletes infeasible members, worst collision first, then feasible ones, worst fitness first.
  shrink(size) {
    const doomed = new Uint8Array(this.size);
    for (let left = this.size; left > size; left--) {
      let worst = -1;
      for (let i = 0; i < doomed.length; i++)
        if (!doomed[i] && (worst < 0 || !this.outlives(i, worst))) worst = i;
      doomed[worst] = 1;
    }
    for (const name of ["positions", "fitness", "collision"])
      this[name] = this[name].filter((_, i) => !doomed[i]);
  }

  outlives(i, j) {
    const { fitness, collision } = this;
    const feasible = collision[i] <= FEASIBLE;
    if (feasible !== (collision[j] <= FEASIBLE)) return feasible;
    if (feasible || collision[i] === collision[j]) return fitness[i] < fitness[j];
    return collision[i] < collision[j];
  }

  // Records what controllers observe and charts show.
  record(degree) {
    const { size, collision, settings } = this;
    const mean = collision.reduce((sum, value) => sum + value, 0.0) / size;
    const squares = collision.reduce((sum, value) => sum + (value - mean) * (value - mean), 0.0);
    const deviation = size > 1 ? Math.sqrt(squares / (size - 1)) : 0.0;
    const feasible = collision.filter((value) => value <= FEASIBLE).length;
    this.history.push({
      populationCollision: settings.meanWeight * mean + (1.0 - settings.meanWeight) * deviation, // eq. 7
      meanCollision: mean,
      collisionDeviation: deviation,
      feasible,
      feasibleShare: feasible / size,
      diversity: this.diversity(),
      size,
      repairDegree: degree,
      bestFitness: this.best.fitness,
      evaluations: this.evaluations,
    });
  }

  // The root mean square of the members' distances from their mean, in map units.
  diversity() {
    let squares = 0.0;
    for (let k = 0; k < this.columns; k++) {
      let mean = 0.0;
      for (const position of this.positions) mean += position[k];
      mean /= this.size;
      for (const position of this.positions) squares += (position[k] - mean) * (position[k] - mean);
    }
    return Math.sqrt(squares / this.size);
  }

  get now() {
    return this.history[this.iteration];
  }
}
