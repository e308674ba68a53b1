// The cost of paths among circles and convex polygons, and their repair: the port of
// swarm_gym/problem/analytic. It has the same operations in the same order, so its bits are the same.
// A path is an array (C + 1): a zero for the start, the offsets of the waypoints, and zeros from the target on.

const FEASIBLE = 1e-9; // largest degree of collision of a feasible path, in map units

// The order of eight-lane sums: ((0 + 4) + (2 + 6)) + ((1 + 5) + (3 + 7)).
function total(lanes) {
  return lanes[0] + lanes[4] + (lanes[2] + lanes[6]) + (lanes[1] + lanes[5] + (lanes[3] + lanes[7]));
}

class Problem {
  // `data` is what experiments/playground/exported.py says of a problem.
  constructor(data) {
    Object.assign(this, data);
    for (const name of ["lower", "upper", "initialLower", "initialUpper", "squaredSpacing"])
      this[name] = Float64Array.from(data[name]);
    this.columns = this.lower.length;
    // Obstacles over segment s: numbers firstOf[s] to firstOf[s + 1] - 1. An obstacle has a place in `numbers`
    // and a count of corners, 0 for a circle.
    const obstacles = data.segments.flat();
    this.firstOf = Int32Array.from([0, ...data.segments.map(({ length }) => length)]);
    for (let s = 0; s < data.segments.length; s++) this.firstOf[s + 1] += this.firstOf[s];
    this.corners = Int32Array.from(obstacles, ({ corners }) => corners);
    this.numbers = Float64Array.from(obstacles.flatMap(({ numbers }) => numbers));
    this.places = new Int32Array(obstacles.length);
    for (let k = 1; k < obstacles.length; k++)
      this.places[k] = this.places[k - 1] + obstacles[k - 1].numbers.length;
    this.up = 0.0;
    this.down = 0.0;
    this.lengths = new Float64Array(LANES);
    this.cleared = new Float64Array(LANES);
    this.contact = new Uint8Array(LANES);
    this.collision = 0.0;
  }

  // Writes into `up` and `down` the shifts along y' by which a segment clears an obstacle over it.
  shiftsOf(obstacle, left, rise, length) {
    const corners = this.corners[obstacle], at = this.places[obstacle];
    if (corners > 0) this.polygonShifts(at, corners, left, rise);
    else this.circleShifts(at, left, rise, length);
  }

  // The nine numbers of a circle are the rows of a tile, in the order of problem/analytic/table.py.
  circleShifts(at, left, rise, length) {
    const n = this.numbers;
    const fromCentre = left - n[at];
    const beginChord = n[at + 1], endChord = n[at + 4];
    const begin = fromCentre + rise * n[at + 2];
    const end = fromCentre + rise * n[at + 3];
    const middle = fromCentre + rise * n[at + 5];
    const tangent = length * n[at + 6];
    const lowest = length * n[at + 7], highest = length * n[at + 8];
    const fall = 0.0 - rise;
    this.up = rise > lowest && rise < highest
      ? tangent - middle
      : larger(beginChord - begin, endChord - end);
    this.down = fall > lowest && fall < highest
      ? tangent + middle
      : larger(beginChord + begin, endChord + end);
  }

  // A corner has three numbers: its share of the segment, and the top and the bottom of the polygon there.
  polygonShifts(at, corners, left, rise) {
    const n = this.numbers;
    let height = left + rise * n[at];
    let up = n[at + 1] - height, down = height - n[at + 2];
    for (let k = at + 3; k < at + 3 * corners; k += 3) {
      height = left + rise * n[k];
      up = larger(up, n[k + 1] - height);
      down = larger(down, height - n[k + 2]);
    }
    this.up = up;
    this.down = down;
  }

  // The sum of the smaller shifts of a segment over all obstacles in contact.
  smallerShifts(segment, left, rise, length) {
    let shifts = 0.0;
    for (let k = this.firstOf[segment]; k < this.firstOf[segment + 1]; k++) {
      this.shiftsOf(k, left, rise, length);
      const smaller = this.up < this.down ? this.up : this.down;
      if (smaller > 0.0) shifts += smaller;
    }
    return shifts;
  }

  // Returns the fitness of a path, and writes its degree of collision into `collision`; both in map units.
  evaluate(path) {
    const { lengths, cleared, squaredSpacing } = this;
    lengths.fill(0.0);
    cleared.fill(0.0);
    for (let segment = 0; segment < squaredSpacing.length; segment++) {
      const left = path[segment], rise = path[segment + 1] - left;
      const length = Math.sqrt(squaredSpacing[segment] + rise * rise);
      lengths[segment % LANES] += length;
      cleared[segment % LANES] += this.smallerShifts(segment, left, rise, length) / length;
    }
    this.collision = total(cleared) * this.spacing;
    return this.lengthWeight * total(lengths) + (1.0 - this.lengthWeight) * this.collision;
  }

  // Pushes colliding segments out of obstacles by the degree phi, from the start on, in place.
  repair(path, degree) {
    const { contact, squaredSpacing } = this;
    for (let first = 0; first < squaredSpacing.length; first += LANES) {
      for (let lane = 0; lane < LANES; lane++) {
        const segment = first + lane, left = path[segment], rise = path[segment + 1] - left;
        const length = Math.sqrt(squaredSpacing[segment] + rise * rise);
        contact[lane] = this.smallerShifts(segment, left, rise, length) > 0.0 ? 1 : 0;
      }
      // What was computed for a segment holds as long as the segment before it stays.
      let moved = false;
      for (let lane = 0; lane < LANES; lane++)
        if (moved || contact[lane]) moved = this.repairSegment(first + lane, path, degree);
    }
  }

  // Returns whether the right end of the segment moved.
  repairSegment(segment, path, degree) {
    const { lower, upper } = this;
    const before = path[segment + 1];
    let left = path[segment], right = before;
    for (let k = this.firstOf[segment]; k < this.firstOf[segment + 1]; k++) {
      const rise = right - left;
      this.shiftsOf(k, left, rise, Math.sqrt(this.squaredSpacing[segment] + rise * rise));
      if (!(this.up > 0.0 && this.down > 0.0)) continue;
      const shift = degree * (this.up <= this.down ? this.up : -this.down);
      if (segment > 0) left = within(left + shift, lower[segment - 1], upper[segment - 1]);
      right = within(right + shift, lower[segment], upper[segment]);
    }
    path[segment] = left;
    path[segment + 1] = right;
    return right !== before;
  }

  // The points [x, y] of a position on the map.
  points(position) {
    const [dx, dy] = this.across;
    return this.line.map(([x, y], k) => {
      const offset = k > 0 && k + 1 < this.line.length ? position[k - 1] : 0.0;
      return [x + offset * dx, y + offset * dy];
    });
  }
}

function larger(one, other) {
  return one > other ? one : other;
}

function within(value, lower, upper) {
  const raised = lower > value ? lower : value;
  return upper < raised ? upper : raised;
}
