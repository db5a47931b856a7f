/** Plans as SVG: floors by room type, furniture with its symbols, walls, doors and windows. A plainer logic/drawing/plan.py.
 *
 * Each part is a group with data-part, named as `explain --why` names it.
 */

/** As logic/drawing/palettes.json has it: of the drawing that is being made. */
let palette = {};
/** Where a name may stand in a room, from its middle (0, 0) to its walls (1), the middle first. */
const STEPS = [-1, -0.75, -0.5, -0.25, 0, 0.25, 0.5, 0.75, 1];
const SPOTS = STEPS.flatMap((u) => STEPS.map((v) => [u, v])).sort(([a, b], [c, d]) => Math.hypot(a, b) - Math.hypot(c, d));
/** How wide a letter is, as a share of its size. */
const WIDE = 0.62;
const SIDE = 360, MARGIN = 14, FOOT = 24;

/** The plan of a house of today's format, as the text of an SVG file. `looks`: as logic/house/looks.py has them; `inks`: the colours
 * of the parts, and as `new` those of types that have none in `looks`.
 */
export function planSvg(house, looks, inks) {
  palette = inks;
  const boxes = house.rooms.map(box);
  const west = Math.min(...boxes.map(([x]) => x)), north = Math.min(...boxes.map(([, y]) => y));
  const wide = Math.max(...boxes.map(([, , x]) => x)) - west, tall = Math.max(...boxes.map(([, , , y]) => y)) - north;
  const scale = (SIDE - 2 * MARGIN) / Math.max(wide, tall);
  const at = (x, y) => [MARGIN + (x - west) * scale + ((SIDE - 2 * MARGIN) - wide * scale) / 2, MARGIN + (y - north) * scale];
  const height = 2 * MARGIN + tall * scale + FOOT;
  const colours = coloursOf(house.rooms, looks, palette.new);
  const pen = new Pen(at, scale, looks, colours);
  const wall = Math.min(4, Math.max(1.5, 0.09 * scale));
  const isStar = house.topology === "star";
  const counted = isStar ? house.rooms.filter(({ name }) => name !== house.hub) : house.rooms;
  const hub = isStar ? house.rooms.find(({ name }) => name === house.hub) : null;

  const shapes = hub ? [part(hub.name, pen.rect(hub, palette.paper, palette.wall, wall))] : [];
  shapes.push(...counted.map((room) => part(room.name, pen.rect(room, colours.get(room.type)))));
  for (const room of counted)
    for (const [name, piece] of named(room.children)) shapes.push(part(`${room.name}.${name}`, pen.piece(piece)));
  shapes.push(...counted.map((room) => pen.rect(room, "none", palette.wall, wall)));
  for (const [name, door] of doorsByName(house)) shapes.push(part(name, pen.door(door, house, wall)));
  for (const [name, window] of windowsByName(house)) shapes.push(part(name, pen.rect(window, palette.wood, palette.wall, wall / 3, wall / 2)));
  shapes.push(...counted.map((room) => pen.name(room, room.type)));
  if (hub) shapes.push(pen.hubName(hub, counted));
  const floor = house.rooms.reduce((sum, room) => sum + room.width * room.height, 0);
  const count = `${counted.length} room${counted.length === 1 ? "" : "s"} · ${floor.toFixed(0)} m²`;
  shapes.push(text(MARGIN, height - 11, count, 11, palette.ink, "start"), pen.metre(SIDE - MARGIN, height - 11));
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${SIDE} ${round(height)}" font-family="sans-serif">${shapes.join("")}</svg>`;
}

/** Draws in the house's metres. */
class Pen {
  constructor(at, scale, looks, colours) {
    Object.assign(this, { at, scale, looks, colours });
  }

  rect(rect, fill, stroke = "none", width = 0, grow = 0) {
    const [x0, y0] = this.at(rect.x, rect.y), [x1, y1] = this.at(rect.x + rect.width, rect.y + rect.height);
    const [dx, dy] = rect.width > rect.height ? [0, grow] : [grow, 0];
    return block([x0 - dx, y0 - dy, x1 + dx, y1 + dy], fill, stroke, width);
  }

  /** A piece with its symbol and the mark of its front, or with its name where it has no symbol. */
  piece(piece) {
    const corners = [...this.at(piece.x, piece.y), ...this.at(piece.x + piece.width, piece.y + piece.height)];
    const place = (across, forth) => inFrame(corners, piece.orientation, across, forth);
    const shapes = [block(corners, palette.wood, palette.edge, 0.8, 0.05 * this.scale)];
    const forms = this.looks.symbols[this.looks.pieces[piece.type]];
    for (const [form, numbers] of forms ?? []) shapes.push(symbol(form, numbers, corners, place));
    const size = Math.min(10, (1.6 * (corners[2] - corners[0])) / piece.type.length, corners[3] - corners[1]);
    if (!forms && size >= 6) shapes.push(text((corners[0] + corners[2]) / 2, (corners[1] + corners[3]) / 2, piece.type, size, palette.edge));
    if (piece.orientation) {
      const half = Math.min(0.3, 0.3 / (/[NS]/.test(piece.orientation) ? piece.width : piece.height));
      shapes.push(line([...place(0.5 - half, 1), ...place(0.5 + half, 1)], palette.mark, 2));
    }
    return shapes.join("");
  }

  /** Paper over the wall; of an entrance with an arrow inwards. */
  door(door, house, wall) {
    const paper = this.rect(door, palette.paper, "none", 0, 0.75 * wall);
    if (!door.between.includes("outside")) return paper;
    const room = house.rooms.find(({ name }) => door.between.includes(name));
    const [x, y] = [door.x + door.width / 2, door.y + door.height / 2];
    const along = door.width > door.height;
    const [u, v] = along ? [0, 0.4 * Math.sign(room.y + room.height / 2 - y)] : [0.4 * Math.sign(room.x + room.width / 2 - x), 0];
    const points = [[x + u / 8, y + v / 8], [x + u, y + v], [x + u / 2 - v / 2, y + v / 2 - u / 2], [x + u, y + v], [x + u / 2 + v / 2, y + v / 2 + u / 2]];
    const path = points.map(([a, b]) => this.at(a, b).map(round).join(",")).join(" ");
    return `${paper}<polyline points="${path}" fill="none" stroke="${palette.mark}" stroke-width="2"/>`;
  }

  /** A room's name, as large and as near to its middle as it hides no furniture. */
  name(room, words) {
    const largest = Math.min(12, (0.87 * room.width * this.scale) / (WIDE * words.length));
    if (largest < 6) return "";
    const pieces = room.children.flatMap((piece) => [piece, ...piece.children]);
    let best = null;
    for (const size of [largest, Math.max(6, 0.8 * largest), 6]) {
      const half = (WIDE * size * words.length) / 2 / this.scale, high = (0.6 * size) / this.scale;
      const [wide, tall] = [room.width / 2 - half, room.height / 2 - high].map((each) => Math.max(0, each - 0.1));
      for (const [u, v] of SPOTS) {
        const [x, y] = [room.x + room.width / 2 + u * wide, room.y + room.height / 2 + v * tall];
        const hidden = pieces.reduce((sum, piece) => sum
          + Math.max(0, Math.min(x + half, piece.x + piece.width) - Math.max(x - half, piece.x))
          * Math.max(0, Math.min(y + high, piece.y + piece.height) - Math.max(y - high, piece.y)), 0);
        if (!best || hidden < best.hidden - 1e-6) best = { x, y, size, hidden };
      }
      if (best.hidden < 1e-6) break;
    }
    return text(...this.at(best.x, best.y), words, best.size, palette.ink, "middle", this.colours.get(room.type));
  }

  /** The word for the main room, where the rooms around it leave most free. */
  hubName(hub, rooms) {
    const free = (y) => rooms.every((room) => y < room.y - 0.4 || y > room.y + room.height + 0.4);
    const place = [0.5, 0.4, 0.6, 0.3, 0.7].map((share) => hub.y + share * hub.height).find(free) ?? hub.y + hub.height / 2;
    return text(...this.at(hub.x + hub.width / 2, place), "main room", 11, palette.faint, "middle", palette.paper);
  }

  metre(right, y) {
    const metres = [1, 2, 5, 10].find((each) => each * this.scale >= 18) ?? 20;
    const left = right - metres * this.scale;
    return line([left, y, right, y], palette.ink, 1.4) + text(left - 6, y, `${metres} m`, 10, palette.ink, "end");
  }
}

/** A form of a symbol (logic/house/looks.py), `place` by place. */
function symbol(form, numbers, corners, place) {
  const points = Array.from({ length: numbers.length >> 1 }, (_, index) => place(numbers[2 * index], numbers[2 * index + 1]).map(round));
  const [[x0, y0], [x1, y1] = []] = points;
  const around = [Math.min(x0, x1), Math.min(y0, y1), Math.max(x0, x1), Math.max(y0, y1)];
  if (form === "box") return block(around, "none", palette.faint, 0.8);
  if (form === "oval") return oval(around);
  if (form === "ring") {
    const radius = numbers[2] * Math.min(corners[2] - corners[0], corners[3] - corners[1]);
    return oval([x0 - radius, y0 - radius, x0 + radius, y0 + radius]);
  }
  return `<path d="M${points[0]}${form === "curve" ? "C" : "L"}${points.slice(1).join(" ")}" fill="none"${stroked(palette.faint, 0.8)}/>`;
}

/** A point of a piece's own frame: across, and from its back to its front. */
function inFrame([left, top, right, bottom], front, across, forth) {
  const turns = { N: [1 - across, 1 - forth], E: [forth, 1 - across], W: [1 - forth, across] };
  const [u, v] = turns[front] ?? [across, forth];
  return [left + u * (right - left), top + v * (bottom - top)];
}

/** Pieces with their children, each by its type, and from the second on with its number. */
function named(children) {
  const family = (piece) => [piece, ...piece.children.flatMap(family)];
  const pieces = children.flatMap(family);
  return numbered(pieces.map(({ type }) => type)).map((name, place) => [name, pieces[place]]);
}

const numbered = (names) => names.map((name, place) => {
  const before = names.slice(0, place).filter((other) => other === name).length;
  return name + (before ? before + 1 : "");
});

/** The doors of a house with their names. */
function doorsByName({ doors, hub, topology }) {
  const names = doors.map(({ between }) => {
    if (topology === "star") return `${between.find((name) => name !== hub)}.door`;
    return between.includes("outside") ? "entrance" : between.join("-");
  });
  return numbered(names).map((name, place) => [name, doors[place]]);
}

/** The windows of a house with their names. */
function windowsByName({ windows = [] }) {
  return numbered(windows.map(({ room }) => `${room}.window`)).map((name, place) => [name, windows[place]]);
}

/** The colours of floors by type; a type that has none takes one that no other type here has, from a place by its name. */
function coloursOf(rooms, looks, fresh) {
  const types = [...new Set(rooms.map(({ type }) => type))].sort();
  const chosen = new Map(types.filter((type) => looks.rooms[type]).map((type) => [type, looks.rooms[type]]));
  for (const type of types.filter((each) => !looks.rooms[each])) {
    const place = [...type].reduce((sum, letter) => (sum * 31 + letter.codePointAt(0)) % fresh.length, 0);
    const order = [...fresh.slice(place), ...fresh.slice(0, place)];
    const taken = [...chosen.values()];
    chosen.set(type, order.find((colour) => taken.every((other) => differ(colour, other))) ?? order[0]);
  }
  return chosen;
}

/** Whether two colours are told apart: by the sum of their red, green and blue. */
function differ(one, other) {
  const parts = (colour) => [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
  const others = parts(other);
  return parts(one).reduce((sum, value, at) => sum + Math.abs(value - others[at]), 0) > 24;
}

const box = ({ x, y, width, height }) => [x, y, x + width, y + height];
const round = (value) => Math.round(100 * value) / 100;
const escaped = (words) => words.replace(/[&<"]/g, (letter) => `&#${letter.charCodeAt(0)};`);
const part = (name, shapes) => `<g data-part="${escaped(name)}">${shapes}</g>`;
const stroked = (stroke, width) => (stroke === "none" ? "" : ` stroke="${stroke}" stroke-width="${round(width)}"`);
const block = ([x0, y0, x1, y1], fill, stroke = "none", width = 0, radius = 0) =>
  `<rect x="${round(x0)}" y="${round(y0)}" width="${round(x1 - x0)}" height="${round(y1 - y0)}" rx="${round(radius)}" fill="${fill}"${stroked(stroke, width)}/>`;
const oval = ([x0, y0, x1, y1]) =>
  `<ellipse cx="${round((x0 + x1) / 2)}" cy="${round((y0 + y1) / 2)}" rx="${round((x1 - x0) / 2)}" ry="${round((y1 - y0) / 2)}" fill="none"${stroked(palette.faint, 0.8)}/>`;
const line = ([x0, y0, x1, y1], stroke, width) =>
  `<line x1="${round(x0)}" y1="${round(y0)}" x2="${round(x1)}" y2="${round(y1)}"${stroked(stroke, width)}/>`;
const text = (x, y, words, size, fill, anchor = "middle", halo = "") =>
  `<text x="${round(x)}" y="${round(y)}" font-size="${round(size)}" fill="${fill}" text-anchor="${anchor}" dominant-baseline="central" pointer-events="none"${
    halo && ` stroke="${halo}" stroke-width="3" paint-order="stroke"`}>${escaped(words)}</text>`;
