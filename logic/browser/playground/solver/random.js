/** Random numbers as NumPy's `default_rng(seed)` draws them: PCG64 over a SeedSequence.
 *
 * O'Neill 2014 (PCG, XSL-RR 128/64); Marsaglia and Tsang 2000 (ziggurat); Lemire 2019 (bounded integers). A test
 * compares them with NumPy.
 */

const MASK32 = 0xffffffffn, MASK64 = (1n << 64n) - 1n, MASK128 = (1n << 128n) - 1n;
const MULTIPLIER = 0x2360ed051fc65da44385df649fccf645n;

/** 32 bits of a product. */
const times = (a, b) => Math.imul(a, b) >>> 0;

/** The 64-bit words that a SeedSequence with this entropy, whole numbers, gives. */
function seedWords(entropy, number) {
  const words = entropy.flatMap((value) => {
    const parts = [];
    for (let left = BigInt(value); left > 0n || !parts.length; left >>= 32n) parts.push(Number(left & MASK32));
    return parts;
  });
  let constant = 0x43b0d7e5;
  const hashed = (value) => {
    const mixed = (value ^ constant) >>> 0;
    constant = times(constant, 0x931e8875);
    const product = times(mixed, constant);
    return (product ^ (product >>> 16)) >>> 0;
  };
  const mixed = (x, y) => {
    const difference = (times(0xca01f9dd, x) - times(0x4973f715, y)) >>> 0;
    return (difference ^ (difference >>> 16)) >>> 0;
  };
  const pool = [0, 1, 2, 3].map((place) => hashed(words[place] ?? 0));
  for (let from = 0; from < 4; from++)
    for (let to = 0; to < 4; to++) if (from !== to) pool[to] = mixed(pool[to], hashed(pool[from]));
  for (const word of words.slice(4)) for (let to = 0; to < 4; to++) pool[to] = mixed(pool[to], hashed(word));

  constant = 0x8b51f9dd;
  const state = [];
  for (let place = 0; place < 2 * number; place++) {
    const value = (pool[place % 4] ^ constant) >>> 0;
    constant = times(constant, 0x58f38ded);
    const product = times(value, constant);
    state.push(BigInt((product ^ (product >>> 16)) >>> 0));
  }
  return Array.from({ length: number }, (_, place) => (state[2 * place + 1] << 32n) | state[2 * place]);
}

/** The ziggurat of the exponential law: 256 layers, the last of which begins at END. */
const END = 7.69711747013104972, VOLUME = 3.9496598225815571993e-3, SCALE = 2 ** 53;
const ziggurat = (() => {
  const bounds = new Array(256), widths = new Array(256), heights = new Array(256);
  let at = END, before = END;
  const base = VOLUME / Math.exp(-END);
  bounds[0] = (END / base) * SCALE;
  bounds[1] = 0;
  widths[0] = base / SCALE;
  widths[255] = END / SCALE;
  heights[0] = 1;
  heights[255] = Math.exp(-END);
  for (let layer = 254; layer >= 1; layer--) {
    at = -Math.log(VOLUME / at + Math.exp(-at));
    bounds[layer + 1] = (at / before) * SCALE;
    before = at;
    heights[layer] = Math.exp(-at);
    widths[layer] = at / SCALE;
  }
  return { bounds, widths, heights };
})();

export class Generator {
  /** As `numpy.random.default_rng(entropy)` for a list of whole numbers. */
  constructor(entropy) {
    const [high, low, sequenceHigh, sequenceLow] = seedWords(entropy, 4);
    this.increment = ((((sequenceHigh << 64n) | sequenceLow) << 1n) | 1n) & MASK128;
    this.state = this.increment;
    this.state = (this.state + ((high << 64n) | low)) & MASK128;
    this.step();
    this.half = null; // The other half of a 64-bit word of which one is used.
  }

  step() {
    this.state = (this.state * MULTIPLIER + this.increment) & MASK128;
  }

  /** 64 bits, a BigInt. */
  word() {
    this.step();
    const turn = this.state >> 122n;
    const value = (this.state >> 64n) ^ (this.state & MASK64);
    return ((value >> turn) | (value << (64n - turn))) & MASK64;
  }

  /** 32 bits, a number. */
  halfWord() {
    if (this.half !== null) {
      const value = this.half;
      this.half = null;
      return value;
    }
    const word = this.word();
    this.half = Number(word >> 32n);
    return Number(word & MASK32);
  }

  /** Uniform in [0, 1). */
  uniform() {
    return Number(this.word() >> 11n) / SCALE;
  }

  /** As `exponential(size=number)`. */
  exponentials(number) {
    return Array.from({ length: number }, () => this.exponential());
  }

  exponential() {
    for (;;) {
      const word = this.word() >> 3n;
      const layer = Number(word & 0xffn), along = Number(word >> 8n);
      const value = along * ziggurat.widths[layer];
      if (along < Math.floor(ziggurat.bounds[layer])) return value;
      if (layer === 0) return END - Math.log1p(-this.uniform());
      const [above, below] = [ziggurat.heights[layer - 1], ziggurat.heights[layer]];
      if ((above - below) * this.uniform() + below < Math.exp(-value)) return value;
    }
  }

  /** A whole number from 0 to most: the bits that most has, drawn again where they are more. */
  upTo(most) {
    const mask = 2 ** (32 - Math.clz32(most)) - 1;
    for (;;) {
      const value = (this.halfWord() & mask) >>> 0;
      if (value <= most) return value;
    }
  }

  /** As `permutation(number)`. */
  permutation(number) {
    const places = Array.from({ length: number }, (_, place) => place);
    for (let last = number - 1; last > 0; last--) {
      const other = this.upTo(last);
      [places[last], places[other]] = [places[other], places[last]];
    }
    return places;
  }

  /** As `integers(2**63)`: a BigInt. */
  seed() {
    return this.word() >> 1n;
  }
}
