/** Plans as SVG, as `vitruvius watch` draws them: logic/drawing/draw.py, plan.py and furniture.py, of houses that are no maps.
 *
 * Each part is a group with data-part, named as `explain --why` names it.
 */

import { block, curve, line, oval, part, text, union, widthOf } from "./canvas.js";
import { coloursOf } from "./colours.js";
import { boxOf, doorLeaves, grown, opening, thickness, wallBoxes } from "./openings.js";
import { abbreviations, key, keyRows, legend, roomName, spaced, SWATCH } from "./words.js";

const SIDE = 300, TITLE = 30, FOOT = 22, MARGIN = 12, NORTH = 16;
/** Of a cubic curve for a quarter of a circle: how far its inner points are from its ends, in radii. */
const QUARTER = 0.5523;

/** The plan of a house of today's format, as the text of an SVG file. `looks`: as logic/looks/looks.py has them; `inks`: the colours
 * of the parts, and as `new` those of types that have none in `looks`; `widths`: of letters, in font sizes.
 */
export function planSvg(house, looks, inks, widths) {
  const plan = new Plan(house, looks, inks, widthOf(widths));
  return `<svg xmlns="http://www.w3.org/2000/svg" width="${SIDE}" height="${SIDE}" viewBox="0 0 ${SIDE} ${SIDE}" font-family="DejaVu Sans, Verdana, sans-serif">`
    + `<rect width="${SIDE}" height="${SIDE}" fill="#ffffff"/>${plan.shapes().join("")}</svg>`;
}

class Plan {
  constructor(house, looks, inks, wide) {
    Object.assign(this, { house, looks, inks, wide });
    const half = house.wall_thickness ? house.wall_thickness.inner / 2 : 0;
    this.hub = house.topology === "star" ? house.rooms.find(({ name }) => name === house.hub) : null;
    this.counted = house.rooms.filter((room) => room !== this.hub);
    this.pieces = new Map(house.rooms.map((room) => [room.name, room.children.flatMap(family)]));
    this.leaves = doorLeaves(house, new Map([...this.pieces].map(([name, pieces]) => [name, pieces.map(boxOf)])));
    this.tiles = house.rooms.map((room) => grown(boxOf(room), half));
    this.floors = coloursOf(this.counted.map((room) => this.whole(room).type), looks, inks.new);
    const boxes = house.rooms.map(boxOf), reach = half + thickness(house)[1];
    const [west, north] = [0, 1].map((axis) => Math.min(...boxes.map((box) => box[axis])) - reach);
    const [east, south] = [2, 3].map((axis) => Math.max(...boxes.map((box) => box[axis])) + reach);
    this.extent = [west, north, east, south];
  }

  whole(room) {
    return room.part_of ? this.house.rooms.find(({ name }) => name === room.part_of) : room;
  }

  name(kind) {
    return this.looks.names[kind] || spaced(kind);
  }

  symbol(kind) {
    return this.looks.symbols[this.looks.pieces[kind]];
  }

  /** All shapes; a key takes space, in which a further name may have stood. */
  shapes() {
    const every = abbreviations([...this.floors.keys(), ...Object.keys(this.looks.rooms)]);
    let keyed = [], numbered = [];
    for (;;) {
      const rooms = [...every].filter(([kind]) => keyed.includes(kind)).map(([kind, short]) => ({ words: spaced(kind), short, fill: this.floors.get(kind) }));
      const strange = numbered.map((kind, place) => ({ words: this.name(kind), short: `${place + 1}`, fill: this.inks.wood }));
      const rows = keyRows(this.wide, [...rooms, ...strange], SIDE - 2 * MARGIN);
      this.place(FOOT + SWATCH * rows.length);
      const names = this.names((kind) => (keyed.includes(kind) ? every.get(kind) : ""));
      const unnamed = this.counted.filter((room, place) => !room.part_of && names[place][0] !== spaced(room.type)).map(({ type }) => type);
      const unlabelled = this.unlabelled();
      if (unnamed.every((kind) => keyed.includes(kind)) && unlabelled.every((kind) => numbered.includes(kind))) return this.drawn(names, rows, numbered);
      keyed = [...new Set([...keyed, ...unnamed])];
      numbered = [...new Set([...numbered, ...unlabelled])].sort();
    }
  }

  /** Put the house into the middle of the picture. */
  place(below) {
    const [west, north, east, south] = this.extent, high = SIDE - TITLE - below;
    this.scale = Math.min((SIDE - 2 * MARGIN) / (east - west), (high - MARGIN) / (south - north));
    this.left = (SIDE - this.scale * (east - west)) / 2 - this.scale * west;
    this.top = TITLE + (high - this.scale * (south - north)) / 2 - this.scale * north;
  }

  at([x, y]) {
    return [this.left + this.scale * x, this.top + this.scale * y];
  }

  box([x0, y0, x1, y1]) {
    return [...this.at([x0, y0]), ...this.at([x1, y1])];
  }

  drawn(names, rows, numbered) {
    const { inks, house } = this, foot = SIDE - FOOT / 2 - SWATCH * rows.length, x = SIDE - MARGIN - 5, y = TITLE / 2;
    const marked = house.rooms.some((room) => this.pieces.get(room.name).some((piece) => this.isMarked(piece)));
    const marks = [...marked ? ["front of furniture"] : [], ...house.doors.some(isEntrance) ? ["entrance"] : []];
    const tip = y - NORTH / 2;
    return [
      ...this.structure(numbered),
      ...names.map(([, shapes]) => shapes),
      text([MARGIN, y], this.title(), 11.5, inks.ink, "start"),
      line([[x, y + NORTH / 2], [x, tip], [x - 4, tip + 6], [x, tip], [x + 4, tip + 6]], inks.ink, 1.3),
      text([x - 8, y], "N", 10, inks.ink, "end"),
      ...legend(this.wide, this.scale, MARGIN, foot, inks, marks),
      ...key(this.wide, rows, MARGIN, foot + SWATCH + 2, inks),
    ];
  }

  /** Walls, floors, furniture, doors and windows. */
  structure(numbered) {
    const { house, inks, scale, tiles } = this, beyond = Math.max(thickness(house)[1] * scale, 2);
    const paved = (room) => this.floors.get(this.whole(room).type);
    const shapes = [union(tiles.map((tile) => grown(this.box(tile), beyond)), inks.wall)];
    if (this.hub) shapes.push(part(this.hub.name, [block(this.box(boxOf(this.hub)), inks.paper)]));
    shapes.push(...this.counted.map((room) => part(room.name, [block(this.box(boxOf(room)), paved(room))])));
    for (const room of this.counted) {
      const pieces = this.pieces.get(room.name), names = withNumbers(pieces.map(({ type }) => type));
      shapes.push(...pieces.map((piece, place) => part(`${room.name}.${names[place]}`, this.piece(piece, numbered))));
    }
    if (!house.wall_thickness) shapes.push(union(wallBoxes(house).map((box) => this.box(box)), inks.wall));
    const leaves = this.leaves.values(), doors = withNumbers(house.doors.map((door) => this.doorName(door)));
    house.doors.forEach((door, place) => shapes.push(part(doors[place], this.door(door, door.opening ? null : leaves.next().value))));
    for (const room of this.counted.filter(({ part_of }) => part_of)) {
      const joints = house.doors.filter(({ between }) => between.includes(room.name) && between.includes(room.part_of));
      shapes.push(...joints.map((door) => block(this.box(opening(house, tiles, door)), paved(room))));
    }
    const windows = withNumbers((house.windows ?? []).map(({ room }) => `${room}.window`));
    windows.forEach((name, place) => shapes.push(part(name, this.window(house.windows[place]))));
    return shapes;
  }

  doorName({ between }) {
    if (between.includes("outside")) return "entrance";
    return this.hub ? `${between.find((name) => name !== this.hub.name)}.door` : between.join("-");
  }

  door(door, leaf) {
    const { inks, scale } = this, place = this.box(opening(this.house, this.tiles, door)), shapes = [block(place, inks.paper)];
    if (leaf) {
      const { hinge, tip, jamb } = leaf, bent = (from, to) => from.map((value, axis) => value + QUARTER * (to[axis] - hinge[axis]));
      shapes.push(curve([tip, bent(tip, jamb), bent(jamb, tip), jamb].map((point) => this.at(point)), inks.faint, thin(scale)));
      shapes.push(line([this.at(hinge), this.at(tip)], inks.edge, stroke(0.04 * scale, 1.2, 4)));
    }
    if (isEntrance(door)) {
      const room = this.house.rooms.find(({ name }) => door.between.includes(name));
      shapes.push(this.entrance(place, this.box(boxOf(room)), Math.min(0.3 * scale, 7.5)));
    }
    return shapes;
  }

  /** A tip outside of an entrance that points in. */
  entrance([x0, y0, x1, y1], room, size) {
    let [x, y] = [(x0 + x1) / 2, (y0 + y1) / 2], [u, v] = [0, 0];
    if (x1 - x0 > y1 - y0) {
      v = y < (room[1] + room[3]) / 2 ? size : -size;
      y = v > 0 ? y0 : y1;
    } else {
      u = x < (room[0] + room[2]) / 2 ? size : -size;
      x = u > 0 ? x0 : x1;
    }
    return line([[x - u - v, y - v - u], [x - u / 5, y - v / 5], [x - u + v, y - v + u]], this.inks.mark, size / 4);
  }

  window(window) {
    const place = this.box(opening(this.house, this.tiles, window)), [left, top, right, bottom] = place;
    const width = Math.min(Math.min(right - left, bottom - top) / 8, 1);
    const middle = right - left < bottom - top
      ? [[(left + right) / 2, top], [(left + right) / 2, bottom]] : [[left, (top + bottom) / 2], [right, (top + bottom) / 2]];
    return [block(place, this.inks.wood, this.inks.wall, width), line(middle, this.inks.wall, width)];
  }

  isMarked({ orientation, type }) {
    return Boolean(orientation) && !this.symbol(type);
  }

  /** The types of pieces that have neither a symbol nor room for their names. */
  unlabelled() {
    const pieces = this.counted.flatMap(({ name }) => this.pieces.get(name));
    return [...new Set(pieces.filter((piece) => piece.type && !this.symbol(piece.type) && !this.letters(piece)).map(({ type }) => type))].sort();
  }

  /** The size of letters in which a piece's name fits on it, or 0. */
  letters(piece) {
    const [left, top, right, bottom] = this.box(boxOf(piece));
    const size = Math.min(0.22 * this.scale, 11, (0.9 * (right - left)) / this.wide(this.name(piece.type), 1));
    return size >= 6 && size <= bottom - top ? size : 0;
  }

  piece(piece, numbered) {
    const { inks, scale } = this, box = this.box(boxOf(piece)), [left, top, right, bottom] = box, front = piece.orientation;
    const radius = Math.min(0.05 * scale, (right - left) / 3, (bottom - top) / 3), forms = this.symbol(piece.type);
    const shapes = [block(box, inks.wood, inks.edge, stroke(0.02 * scale, 0.8, 4), radius)];
    for (const [form, numbers] of forms ?? []) shapes.push(this.form(form, numbers, box, front));
    if (!forms && piece.type) {
      const place = numbered.indexOf(piece.type) + 1, middle = [(left + right) / 2, (top + bottom) / 2], size = this.letters(piece);
      const small = Math.max(5, Math.min(8, (0.9 * (right - left)) / this.wide(`${place}`, 1), bottom - top));
      if (size) shapes.push(text(middle, this.name(piece.type), size, inks.edge));
      else if (place) shapes.push(text(middle, `${place}`, small, inks.edge));
    }
    if (this.isMarked(piece)) {
      const edge = /[NS]/.test(front) ? right - left : bottom - top, half = Math.min(0.3, (0.3 * scale) / edge);
      shapes.push(line([inFrame(box, front, 0.5 - half, 1), inFrame(box, front, 0.5 + half, 1)], inks.mark, stroke(0.05 * scale, 1.8, 3)));
    }
    return shapes;
  }

  /** A form of a symbol (logic/looks/looks.py). */
  form(form, numbers, box, front) {
    const { inks, scale } = this, width = thin(scale);
    const points = Array.from({ length: numbers.length >> 1 }, (_, k) => inFrame(box, front, numbers[2 * k], numbers[2 * k + 1]));
    const [[x0, y0], [x1, y1] = []] = points, around = [Math.min(x0, x1), Math.min(y0, y1), Math.max(x0, x1), Math.max(y0, y1)];
    if (form === "box") return block(around, "", inks.faint, width, 0.04 * scale);
    if (form === "oval") return oval(around, inks.faint, width);
    if (form === "line") return line(points, inks.faint, width);
    if (form === "curve") return curve(points, inks.faint, width);
    const radius = numbers[2] * Math.min(box[2] - box[0], box[3] - box[1]);
    return oval([x0 - radius, y0 - radius, x0 + radius, y0 + radius], inks.faint, width);
  }

  /** The name of each room as [words, shapes], then that of the main room. */
  names(short) {
    const { inks, house, scale } = this, swings = this.leaves.map(({ hinge, tip, jamb }) => {
      const [xs, ys] = [0, 1].map((axis) => [hinge, tip, jamb].map((point) => point[axis]));
      return this.box([Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)]);
    });
    const named = (words, abbreviation, area, room, taken, ink, floor) =>
      roomName(this.wide, words, abbreviation, `${rounded(area, 1)} m²`, this.box(boxOf(room)), taken, swings, scale, ink, floor);
    const names = this.counted.map((room) => {
      if (room.part_of) return ["", ""];
      const area = house.rooms.filter((each) => each === room || each.part_of === room.name).reduce((sum, each) => sum + areaOf(each), 0);
      const pieces = this.pieces.get(room.name).map((piece) => this.box(boxOf(piece)));
      return named(spaced(room.type), short(room.type), area, room, pieces, inks.ink, this.floors.get(room.type));
    });
    if (!this.hub) return names;
    const around = this.counted.map(boxOf), main = boxOf(this.hub);
    const free = areaOf(this.hub) - around.reduce((sum, box) => sum + shared(main, box), 0);
    return [...names, named("main room", "", free, this.hub, around.map((box) => this.box(box)), inks.edge, inks.paper)];
  }

  /** Where the house comes from and how large it is; the first words go where there is no room. */
  title() {
    const { provenance, rooms } = this.house, count = this.counted.length;
    let parts = [`${count.toLocaleString("en")} room${count === 1 ? "" : "s"}`, `${rounded(rooms.reduce((sum, room) => sum + areaOf(room), 0), 0)} m²`];
    if (provenance) parts = [provenance.grammar.split("/").at(-1), `seed ${provenance.seed}`, `house ${provenance.index}`, ...parts];
    while (parts.length > 1 && this.wide(parts.join(" · "), 11.5) > SIDE - 2 * MARGIN - 2 * NORTH) parts = parts.slice(1);
    return parts.join(" · ");
  }
}

const family = (piece) => [piece, ...piece.children.flatMap(family)];
const areaOf = ({ width, height }) => width * height;
/** A number with so many digits, halves to the even one: as Python writes it. */
function rounded(value, digits) {
  const scaled = value * 10 ** digits, floor = Math.floor(scaled);
  const isHalf = Number.isInteger(value * 2 ** (digits + 1)) && scaled - floor === 0.5;
  return (isHalf ? (floor + (floor % 2)) / 10 ** digits : value).toFixed(digits);
}
const isEntrance = ({ between }) => between.includes("outside");
const shared = (one, other) => [0, 1].map((axis) => Math.max(0, Math.min(one[axis + 2], other[axis + 2]) - Math.max(one[axis], other[axis]))).reduce((a, b) => a * b);
/** The width of a line: at least so wide, but on small plans at most four times its due. */
const stroke = (width, least, most) => Math.min(Math.max(width, Math.min(4 * width, least)), most);
const thin = (scale) => stroke(0.012 * scale, 0.8, 1.2);

/** A point of a piece's own frame: across, and from its back to its front. */
function inFrame([left, top, right, bottom], front, across, forth) {
  const turns = { N: [1 - across, 1 - forth], E: [forth, 1 - across], W: [1 - forth, across] };
  const [u, v] = turns[front] ?? [across, forth];
  return [left + u * (right - left), top + v * (bottom - top)];
}

const withNumbers = (names) => names.map((name, place) => {
  const before = names.slice(0, place).filter((other) => other === name).length;
  return name + (before ? before + 1 : "");
});
