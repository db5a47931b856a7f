/** The colours of floors. As logic/drawing/palettes.py has those of the palette `colour`. */

/** How much a new type's colour differs from all others where it can: CIE 1976. */
const APART = 10;

/** The colour of each type: that of its looks, or the first that differs from all others here, from a place that its name gives. */
export function coloursOf(kinds, looks, fresh) {
  const types = [...new Set(kinds)].sort();
  const chosen = new Map(types.filter((type) => looks.rooms[type]).map((type) => [type, looks.rooms[type]]));
  for (const type of types.filter((each) => !looks.rooms[each])) {
    const turn = checksum(type) % fresh.length, taken = [...chosen.values()];
    const apart = (colour) => Math.min(APART, ...taken.map((other) => difference(colour, other)));
    const order = [...fresh.slice(turn), ...fresh.slice(0, turn)];
    chosen.set(type, order.reduce((best, colour) => (apart(colour) > apart(best) ? colour : best)));
  }
  return chosen;
}

/** CRC-32 of a name. */
function checksum(name) {
  let sum = -1;
  for (const byte of new TextEncoder().encode(name)) {
    sum ^= byte;
    for (let bit = 0; bit < 8; bit++) sum = (sum >>> 1) ^ (sum & 1 ? 0xedb88320 : 0);
  }
  return ~sum >>> 0;
}

const difference = (one, other) => {
  const [a, b] = [lab(one), lab(other)];
  return Math.hypot(...a.map((value, place) => value - b[place]));
};

/** CIE L*a*b* of an sRGB colour, in the light of day (D65). */
function lab(colour) {
  const [red, green, blue] = [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16) / 255)
    .map((value) => (value > 0.04045 ? ((value + 0.055) / 1.055) ** 2.4 : value / 12.92));
  const [x, y, z] = [
    (0.4124 * red + 0.3576 * green + 0.1805 * blue) / 0.9505,
    0.2126 * red + 0.7152 * green + 0.0722 * blue,
    (0.0193 * red + 0.1192 * green + 0.9505 * blue) / 1.089,
  ].map((value) => (value > (6 / 29) ** 3 ? Math.cbrt(value) : (value * 841) / 108 + 4 / 29));
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}
