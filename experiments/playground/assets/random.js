// Random numbers, word for word as swarm_gym draws them: from the seed of an environment to the numbers of
// a swarm. Sources: M. O'Neill, "Developing a seed_seq alternative" and "PCG" (2014); C. Doty-Humphrey,
// PractRand, "sfc64"; in the form of NumPy's SeedSequence, PCG64 and SFC64.

const LANES = 8; // generators of a stream, and the order of sums: see `total` in problem.js
const TWO_32 = 2 ** 32;
const DISCARDED = 12; // numbers of a lane that are not used when it is seeded

// NumPy's SeedSequence: words of 32 bits that depend on all words of the entropy.
class SeedSequence {
  // `entropy` and `key` are arrays of words of 32 bits; the key tells the children of a sequence apart.
  constructor(entropy, key = []) {
    this.entropy = entropy;
    const padding = key.length ? Math.max(4 - entropy.length, 0) : 0;
    const words = [...entropy, ...Array(padding).fill(0), ...key];
    let constant = 0x43b0d7e5;
    const hashed = (word) => {
      const value = word ^ constant;
      constant = Math.imul(constant, 0x931e8875);
      const product = Math.imul(value, constant);
      return product ^ (product >>> 16);
    };
    const mixed = (one, other) => {
      const value = Math.imul(0xca01f9dd, one) - Math.imul(0x4973f715, other) | 0;
      return value ^ (value >>> 16);
    };
    const pool = [0, 1, 2, 3].map((k) => hashed(words[k] ?? 0));
    for (let from = 0; from < 4; from++)
      for (let to = 0; to < 4; to++)
        if (from !== to) pool[to] = mixed(pool[to], hashed(pool[from]));
    for (const word of words.slice(4))
      for (let to = 0; to < 4; to++) pool[to] = mixed(pool[to], hashed(word));
    this.pool = pool;
  }

  child(number) {
    return new SeedSequence(this.entropy, [number]);
  }

  // The first words of 32 bits, not negative; two of them, the lower one first, are a word of 64 bits.
  words(count) {
    let constant = 0x8b51f9dd;
    return Array.from({ length: count }, (_, k) => {
      const value = this.pool[k % 4] ^ constant;
      constant = Math.imul(constant, 0x58f38ded);
      const product = Math.imul(value, constant);
      return (product ^ (product >>> 16)) >>> 0;
    });
  }
}

// The words of 32 bits that NumPy's PCG64 draws. It runs once for a seed, so 128-bit integers may be slow.
class Pcg64 {
  constructor(sequence) {
    const words = sequence.words(8).map(BigInt);
    const wide = (k) => (words[k + 1] << 96n) | (words[k] << 64n) | (words[k + 3] << 32n) | words[k + 2];
    this.increment = BigInt.asUintN(128, (wide(4) << 1n) | 1n);
    this.state = 0n;
    this.step();
    this.state += wide(0);
    this.step();
    this.kept = [];
  }

  step() {
    const multiplier = (2549297995355413924n << 64n) | 4865540595714422341n;
    this.state = BigInt.asUintN(128, this.state * multiplier + this.increment);
  }

  word() {
    if (this.kept.length === 0) {
      this.step();
      const folded = BigInt.asUintN(64, (this.state >> 64n) ^ this.state);
      const turn = this.state >> 122n;
      const drawn = BigInt.asUintN(64, (folded >> turn) | (folded << (64n - turn)));
      this.kept = [Number(drawn & 0xffffffffn), Number(drawn >> 32n)];
    }
    return this.kept.shift();
  }
}

// Eight SFC64 side by side. Words of 64 bits are pairs of 32 bits, since BigInt is slow.
class Stream {
  constructor(sequence) {
    const words = sequence.words(6 * LANES);
    this.low = [0, 1, 2].map((row) => Uint32Array.from({ length: LANES }, (_, k) => words[6 * k + 2 * row]));
    this.high = [0, 1, 2].map((row) => Uint32Array.from({ length: LANES }, (_, k) => words[6 * k + 2 * row + 1]));
    this.counter = 1;
    this.fill(new Float64Array(DISCARDED * LANES));
  }

  // The stream of the first episode of an environment that is reset with this seed, a natural number.
  static ofSeed(seed) {
    const words = seed < TWO_32 ? [seed] : [seed % TWO_32, Math.floor(seed / TWO_32)];
    const generator = new Pcg64(new SeedSequence(words));
    const episode = new SeedSequence(Array.from({ length: LANES }, () => generator.word()));
    return new Stream(episode.child(1)); // child 0 draws the scenario
  }

  // Fills an array, whose length is a multiple of eight, with numbers uniform in [0, 1).
  fill(numbers) {
    const [aLow, bLow, cLow] = this.low;
    const [aHigh, bHigh, cHigh] = this.high;
    for (let first = 0; first < numbers.length; first += LANES) {
      const counterLow = this.counter >>> 0, counterHigh = Math.floor(this.counter / TWO_32);
      this.counter++;
      for (let k = 0; k < LANES; k++) {
        const bl = bLow[k], bh = bHigh[k], cl = cLow[k], ch = cHigh[k];
        const sum = aLow[k] + bl + counterLow;
        const low = sum >>> 0;
        const high = (aHigh[k] + bh + counterHigh + Math.floor(sum / TWO_32)) >>> 0;
        aLow[k] = bl ^ ((bl >>> 11) | (bh << 21));
        aHigh[k] = bh ^ (bh >>> 11);
        const shifted = cl + ((cl << 3) >>> 0);
        bLow[k] = shifted;
        bHigh[k] = ch + ((ch << 3) | (cl >>> 29)) + (shifted >= TWO_32 ? 1 : 0);
        const turned = ((cl << 24) | (ch >>> 8)) >>> 0;
        const next = turned + low;
        cLow[k] = next;
        cHigh[k] = ((ch << 24) | (cl >>> 8)) + high + (next >= TWO_32 ? 1 : 0);
        numbers[first + k] = (high * 2 ** 21 + (low >>> 11)) * 2 ** -53;
      }
    }
  }
}
