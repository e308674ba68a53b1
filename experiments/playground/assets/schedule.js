// The schedule SPSFA-TIP: the port of swarm_gym/controllers/schedules.py.
// Source: SPSFA paper, section III, eq. 8-11 and 17.

class Schedule {
  // `settings` has the parameters of the schedule and the limits of sizes.
  constructor(settings) {
    this.settings = settings;
    this.firstSize = settings.firstSize;
  }

  // Returns the next population size and phi; it is asked once after each iteration, from 0 on.
  decide(swarm) {
    const { settings } = this;
    const { populationCollision: current, collisionDeviation: deviation } = swarm.now;
    if (swarm.iteration === 0) {
      this.firstCollision = current; // E_init
      this.size = this.largest = this.firstSize; // PS, PS_max
      return { size: this.size, degree: 0.0 };
    }
    this.size = this.nextSize(current);
    this.largest = Math.max(this.largest, this.size);
    if (deviation > settings.lowDeviation) return { size: this.size, degree: 0.0 };
    const degree = (settings.repairFactor * 2.0 * this.largest) / (this.size * this.size); // eq. 17
    return { size: this.size, degree: Math.min(Math.max(degree, 0.0), 1.0) };
  }

  nextSize(current) {
    const { growth, decay, smallest, largest } = this.settings;
    let size = this.size;
    if (current > this.firstCollision) size += growth / size; // eq. 9
    else if (this.firstCollision > 0.0) size = this.largest * (current / this.firstCollision) ** decay; // eq. 10, 11
    return Math.min(Math.max(Math.floor(size + 0.5), smallest), largest);
  }
}
