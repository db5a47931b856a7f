/** Words on a plan: its title, names of rooms, and below it the scale, marks and a key. As logic/drawing/labels.py. */

import { block, line, text } from "./canvas.js";

/** No name is written smaller. */
export const LEAST = 6.5;
/** How wide a colour is in the key, and a row high. */
export const SWATCH = 14;
const EIGHTHS = Array.from({ length: 17 }, (_, k) => (k - 8) / 8);
const SPOTS = EIGHTHS.flatMap((u) => EIGHTHS.map((v) => [u, v])).sort(([a, b], [c, d]) => Math.hypot(a, b) - Math.hypot(c, d));

export const spaced = (name) => name.replace(/([a-z0-9])(?=[A-Z])/g, "$1 ").replaceAll("_", " ").toLowerCase();

/** For each type the shortest beginning that no other has. */
export function abbreviations(types) {
  const all = [...new Set(types)].sort();
  const short = (name) => {
    for (let n = 1; n < name.length; n++)
      if (!all.some((other) => other !== name && other.startsWith(name.slice(0, n)))) return name.slice(0, n);
    return name;
  };
  return new Map(all.map((name) => [name, short(name)]));
}

/** A room's name in the best place, [words, shapes]: see logic/drawing/labels.py. `pieces` and `swings`: boxes. */
export function roomName(wide, words, short, area, room, pieces, swings, scale, ink, floor) {
  const size = Math.min(Math.max(0.3 * scale, 8.5, LEAST), 15), both = [...pieces, ...swings];
  const rounded = (value) => Math.round(10 * value) / 10;
  if (0.8 * size >= LEAST) {
    const place = spot(Math.max(wide(words, size), wide(area, 0.8 * size)), 1.15 * size, room, both, size);
    if (place && !place.hidden) {
      const { at: [x, y] } = place;
      return [words, text([x, y - 0.5 * size], words, rounded(size), ink) + text([x, y + 0.62 * size], area, rounded(0.8 * size), ink)];
    }
  }
  let found = null;
  for (const said of short ? [words, short] : [words]) for (const boxes of [both, pieces]) {
    for (const letter of [size, Math.max(LEAST, 0.85 * size), Math.max(LEAST, 0.7 * size), LEAST]) {
      const place = spot(wide(said, letter), 0.75 * letter, room, boxes, letter);
      if (!place) continue;
      const halo = boxes === both && !place.hidden ? "" : floor;
      const shape = text(place.at, said, rounded(letter), ink, "middle", halo);
      if (!place.hidden) return [said, shape];
      if (boxes === pieces && said === short && (!found || place.hidden < found.hidden)) found = { hidden: place.hidden, shape };
    }
  }
  return found ? [short, found.shape] : ["", ""];
}

/** Where words are as near to the middle of a room as they hide least, and how much; null where they do not fit. */
function spot(width, tall, [left, top, right, bottom], taken, letter) {
  const half = width / 2 + 0.3 * letter;
  const wide = (right - left) / 2 - half - 1.5, high = (bottom - top) / 2 - tall - 1.5;
  if (wide < 0 || high < 0) return null;
  let best = null;
  for (const [u, v] of SPOTS) {
    const x = (left + right) / 2 + u * wide, y = (top + bottom) / 2 + v * high;
    const hidden = taken.reduce((sum, box) => sum + Math.max(0, Math.min(
      Math.min(x + half, box[2]) - Math.max(x - half, box[0]), Math.min(y + tall, box[3]) - Math.max(y - tall, box[1]))), 0);
    if (!best || hidden < best.hidden) best = { at: [x, y], hidden };
    if (!hidden) break;
  }
  return best;
}

/** The bar of the scale, and what the marks mean. */
export function legend(wide, scale, left, y, inks, marks) {
  const metres = [1, 2, 5, 10, 20].find((each) => each * scale >= 18) ?? 50, right = left + metres * scale;
  const ends = [left, right].map((x) => line([[x, y - 3], [x, y + 3]], inks.ink, 1.2));
  const shapes = [line([[left, y], [right, y]], inks.ink, 1.2), ...ends, text([right + 6, y], `${metres} m`, 10, inks.ink, "start")];
  let start = right + 6 + wide(`${metres} m`, 10) + 16;
  for (const meaning of marks) {
    const end = start + (meaning === "entrance" ? 8 : SWATCH);
    shapes.push(meaning === "entrance" ? line([[start, y - 5], [end, y], [start, y + 5]], inks.mark, 1.8) : line([[start, y], [end, y]], inks.mark, 2.4));
    shapes.push(text([end + 5, y], meaning, 10, inks.ink, "start"));
    start = end + 5 + wide(meaning, 10) + 16;
  }
  return shapes;
}

const entryWidth = (wide, { words }) => SWATCH + 14 + wide(words, 10);

/** Entries { words, short, fill } in rows that fit a width. */
export function keyRows(wide, entries, width) {
  const rows = [[]];
  for (const entry of entries) {
    const taken = [...rows.at(-1), entry].reduce((sum, each) => sum + entryWidth(wide, each), 0);
    if (rows.at(-1).length && taken > width) rows.push([]);
    rows.at(-1).push(entry);
  }
  return rows.filter((row) => row.length);
}

export function key(wide, rows, left, y, inks) {
  return rows.flatMap((row, number) => {
    const middle = y + number * SWATCH;
    let x = left;
    return row.map((entry) => {
      const { words, short, fill } = entry, box = [x, middle - 5.5, x + SWATCH, middle + 5.5];
      const size = Math.min(7.5, (SWATCH - 2) / wide(short, 1));
      const shapes = block(box, fill) + block(box, "", inks.wall, 0.8) + text([x + SWATCH / 2, middle], short, size, inks.ink)
        + text([x + SWATCH + 4, middle], words, 10, inks.ink, "start");
      x += entryWidth(wide, entry);
      return shapes;
    });
  });
}
