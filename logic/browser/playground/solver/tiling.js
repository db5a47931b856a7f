/** What a plan by a topology of the user's own must be in the end, whatever its rules say: see logic/generation/tiling.py. */

const TOLERANCE = 1e-6;

/** What is wrong with a plan, { rooms, doors, windows } as in a house file: texts. `passage`: metres, as wide as the body needs it. */
export function* faults({ rooms, doors, windows }, passage) {
  const named = new Map(rooms.map((room) => [room.name, { ...room, box: box(room), label: `${room.name} (${room.type})` }]));
  const all = [...named.values()];
  for (const [one, other] of pairs(all)) {
    const depth = Math.min(...[0, 1].map((axis) => common(one.box, other.box, axis)));
    if (depth > TOLERANCE) yield `${one.label} overlaps ${other.label} by ${figure(depth)} m`;
  }
  const number = parts(all);
  if (number > 1) yield `house: its rooms lie in ${number} parts that do not touch`;
  const area = gap(all.map(({ box }) => box), passage);
  if (area > 1e-3) yield `house: ${figure(area)} m² between its rooms are no room's`;

  const label = ({ between }) => `door between ${between.map((name) => named.get(name)?.label ?? name).join(" and ")}`;
  for (const door of doors) {
    const joined = door.between.flatMap((name) => named.get(name) ?? []);
    const width = Math.max(door.width, door.height);
    if (width < passage - TOLERANCE) yield `${label(door)}: is ${width.toFixed(3)} m wide (at least ${passage})`;
    if (joined.length > 1 && !isShared(box(door), ...joined)) yield `${label(door)}: is not on a wall that they share`;
    if (joined.length === 1) for (const fault of inside(box(door), joined[0], all)) yield `${label(door)}: ${fault}`;
  }
  for (const [one, other] of pairs(doors)) if (meet(one, other)) yield `${label(one)}: meets the ${label(other)}`;
  for (const [place, window] of windows.entries()) {
    const room = named.get(window.room);
    const name = `${room.label}: its window at (${window.x.toFixed(2)}, ${window.y.toFixed(2)})`;
    for (const fault of inside(box(window), room, all)) yield `${name} ${fault}`;
    if (doors.some((door) => meet(window, door))) yield `${name} meets a door`;
    if (windows.slice(0, place).some((other) => meet(window, other))) yield `${name} meets another window`;
  }
}

/** Why an opening of a room does not lead outside. */
function* inside(opening, room, rooms) {
  if (![0, 1, 2, 3].some((wall) => isOn(opening, room.box, wall))) yield "is not on a wall of the room";
  for (const other of rooms) {
    const along = opening[2] - opening[0] > opening[3] - opening[1] ? 0 : 1;
    const [length, across] = [common(opening, other.box, along), common(opening, other.box, 1 - along)];
    if (other !== room && across >= -TOLERANCE && length > TOLERANCE) yield `leads into ${other.label}, not outside`;
  }
}

/** How many parts the rooms lie in that do not touch. */
function parts(rooms) {
  const left = new Set(rooms);
  let number = 0;
  for (const first of rooms) {
    if (!left.delete(first)) continue;
    number++;
    for (const waiting = [first]; waiting.length;) {
      const { box } = waiting.pop();
      for (const other of left)
        if ([0, 1].every((axis) => common(box, other.box, axis) >= -2 * TOLERANCE) && left.delete(other)) waiting.push(other);
    }
  }
  return number;
}

/** The area (m²) of what squares as wide as a passage close between boxes: courtyards of any size, and slits. */
function gap(boxes, passage) {
  const reach = passage / 2;
  const [xs, ys] = [0, 1].map((axis) => lines(boxes.flatMap((each) => [each[axis], each[axis + 2]]), reach));
  const cells = (holds) => xs.slice(1).map((_, i) => ys.slice(1).map((_, j) => holds(i, j)));
  const middle = (along, place) => (along[place] + along[place + 1]) / 2;
  const floor = cells((i, j) => boxes.some(([west, north, east, south]) => {
    const [x, y] = [middle(xs, i), middle(ys, j)];
    return west < x && x < east && north < y && y < south;
  }));
  const near = (along) => along.slice(1).map((_, i) => along.slice(1).flatMap((_, k) =>
    (along[k] - reach < middle(along, i) && middle(along, i) < along[k + 1] + reach ? [k] : [])));
  const [nearX, nearY] = [near(xs), near(ys)];
  const grown = (some) => {
    const wide = cells((i, j) => nearX[i].some((k) => some[k][j]));
    return cells((i, j) => nearY[j].some((k) => wide[i][k]));
  };
  const not = (some) => some.map((column) => column.map((each) => !each));
  const closed = not(grown(not(grown(not(outside(floor))))));
  let area = 0;
  cells((i, j) => (area += closed[i][j] && !floor[i][j] ? (xs[i + 1] - xs[i]) * (ys[j + 1] - ys[j]) : 0));
  return area;
}

/** The cells that one reaches from the first one and from no floor. */
function outside(floor) {
  const reached = floor.map((column) => column.map(() => false));
  for (const waiting = [[0, 0]]; waiting.length;) {
    const [i, j] = waiting.pop();
    if (floor[i]?.[j] !== false || reached[i][j]) continue;
    reached[i][j] = true;
    waiting.push([i + 1, j], [i - 1, j], [i, j + 1], [i, j - 1]);
  }
  return reached;
}

/** The places of edges, and of what is grown twice from them, in order; what lies within the tolerance is one. */
function lines(edges, reach) {
  const places = edges.flatMap((edge) => [-2, -1, 0, 1, 2].map((times) => edge + times * reach)).sort((a, b) => a - b);
  const found = [];
  for (const place of places) if (!(place - found.at(-1) <= 2 * TOLERANCE)) found.push(place);
  return found;
}

/** Whether a door lies on a wall of one room that is also the facing wall of the other. */
const isShared = (door, one, other) => [0, 1, 2, 3].some((wall) => isOn(door, one.box, wall) && isOn(door, other.box, (wall + 2) % 4));

/** Whether a segment lies on a wall of a box, from end to end. */
function isOn(segment, around, wall) {
  const edge = [...around];
  edge[(wall + 2) % 4] = edge[wall];
  return [0, 1].every((axis) => segment[axis] >= edge[axis] - TOLERANCE && segment[axis + 2] <= edge[axis + 2] + TOLERANCE);
}

/** Whether two openings in one wall touch or overlap. */
function meet(one, other) {
  if ((one.height > one.width) !== (other.height > other.width)) return false;
  return Math.hypot(...[0, 1].map((axis) => Math.max(0, -common(box(one), box(other), axis)))) <= TOLERANCE;
}

/** How much two boxes have in common along an axis; negative where they are apart. */
const common = (one, other, axis) => Math.min(one[axis + 2], other[axis + 2]) - Math.max(one[axis], other[axis]);
const pairs = (all) => all.flatMap((one, place) => all.slice(place + 1).map((other) => [one, other]));
const box = ({ x, y, width, height }) => [x, y, x + width, y + height];

/** A length or an area in the fewest decimals, from two on, in which it is not zero. */
const figure = (value) => [2, 3, 4, 5, 6, 7, 8, 9].map((digits) => value.toFixed(digits)).find(Number) ?? "0";
