/** Walls without a thickness as boxes, doors and windows as deep as their walls, and the leaves of doors; metres. As
 * logic/house/walls.py, logic/drawing/plan.py and frame.py, and logic/drawing/door_leaves.py.
 */

export const OUTER = 0.2, INNER = 0.1;
const TOLERANCE = 1e-6;

export const boxOf = ({ x, y, width, height }) => [x, y, x + width, y + height];
export const grown = ([x0, y0, x1, y1], by) => [x0 - by, y0 - by, x1 + by, y1 + by];
const span = (box, axis) => [box[1 - axis], box[3 - axis]];
const near = (one, other) => Math.abs(one - other) <= TOLERANCE;
const byFirst = ([a, b], [c, d]) => a - c || b - d;

/** What is left of a span when the gaps are cut out of it. */
function remaining([low, high], gaps) {
  const left = [];
  for (const [start, end] of gaps.toSorted(byFirst)) {
    if (start - low > TOLERANCE) left.push([low, Math.min(start, high)]);
    low = Math.max(low, end);
    if (low >= high) break;
  }
  if (high - low > TOLERANCE) left.push([low, high]);
  return left;
}

/** Walls of rooms side by side, as [where, from, to], by axis: each once, with a gap at each door. */
function sharedLines({ rooms, doors }) {
  const open = doors.filter(({ between }) => !between.includes("outside")).map(boxOf);
  return [0, 1].map((axis) => {
    const edges = rooms.map(boxOf).flatMap((box) => [axis, axis + 2].map((end) => [box[end], ...span(box, axis)]));
    const lines = [];
    for (const [at, low, high] of edges.sort((one, other) => one[0] - other[0] || byFirst(one.slice(1), other.slice(1)))) {
      if (!lines.length || at - lines.at(-1)[0] > TOLERANCE) lines.push([at, []]);
      lines.at(-1)[1].push([low, high]);
    }
    return lines.flatMap(([at, spans]) => {
      const gaps = open.filter((door) => door[axis] === door[axis + 2] && near(door[axis], at)).map((door) => span(door, axis));
      return joined(spans).flatMap((one) => remaining(one, gaps)).map((one) => [at, ...one]);
    });
  });
}

/** Spans as those that do not touch. */
function joined(spans) {
  const found = [];
  for (const [low, high] of spans.toSorted(byFirst)) {
    if (found.length && low - found.at(-1)[1] <= TOLERANCE) found.at(-1)[1] = Math.max(found.at(-1)[1], high);
    else found.push([low, high]);
  }
  return found;
}

/** Walls of a star: every room's but for its door, and the main room's where no room covers it. */
function starLines({ rooms, doors, hub }) {
  const floor = boxOf(rooms.find(({ name }) => name === hub)), around = rooms.filter(({ name }) => name !== hub);
  const covered = around.map(boxOf);
  return [0, 1].map((axis) => {
    const own = around.flatMap((room) => {
      const box = boxOf(room), door = boxOf(doors.find(({ between }) => between.includes(room.name)));
      const ends = [box[axis], box[axis + 2]];
      const [nearest] = ends.toSorted((one, other) => Math.abs(one - door[axis]) - Math.abs(other - door[axis]));
      return ends.flatMap((at) => {
        const gaps = door[axis] === door[axis + 2] && at === nearest ? [span(door, axis)] : [];
        return remaining(span(box, axis), gaps).map((one) => [at, ...one]);
      });
    });
    const main = [floor[axis], floor[axis + 2]].flatMap((at) => {
      const covers = covered.filter((box) => box[axis] - TOLERANCE <= at && at <= box[axis + 2] + TOLERANCE);
      return remaining(span(floor, axis), covers.map((box) => span(box, axis))).map((one) => [at, ...one]);
    });
    return [...own, ...main];
  });
}

/** Walls as thick as inner ones, without the doorways between rooms. */
export function wallBoxes(house) {
  const walls = house.topology === "star" ? starLines(house) : sharedLines(house), half = INNER / 2;
  return walls.flatMap((lines, axis) => {
    const meets = (at, end) => walls[1 - axis].some(([place, low, high]) => near(place, end) && low - TOLERANCE <= at && at <= high + TOLERANCE);
    return lines.map(([at, low, high]) => {
      const first = low - (meets(at, low) ? half : 0), last = high + (meets(at, high) ? half : 0);
      return axis ? [first, at - half, last, at + half] : [at - half, first, at + half, last];
    });
  });
}

/** Half of an inner wall, and how far an outer one reaches beyond its middle. */
export function thickness({ wall_thickness: thick }) {
  return thick ? [thick.inner / 2, thick.outer - thick.inner / 2] : [INNER / 2, OUTER - INNER / 2];
}

/** A door or a window as deep as its wall; `tiles`: rooms with half of an inner wall around each. */
export function opening(house, tiles, segment) {
  const across = segment.height === 0, [half, beyond] = thickness(house);
  const middle = [segment.x + segment.width / 2, segment.y + segment.height / 2];
  const [before, behind] = [-0.01, 0.01].map((by) => {
    const [x, y] = across ? [middle[0], middle[1] + by] : [middle[0] + by, middle[1]];
    return tiles.some(([x0, y0, x1, y1]) => x0 < x && x < x1 && y0 < y && y < y1) ? half : beyond;
  });
  const [west, north, east, south] = boxOf(segment);
  return across ? [west, north - before, east, south + behind] : [west - before, north, east + behind, south];
}

/** For each door that is no opening { room, hinge, tip, jamb }, in the order of the doors. */
export function doorLeaves(house, pieces) {
  const away = steps(house), rooms = new Map(house.rooms.map((room) => [room.name, boxOf(room)])), leaves = new Leaves();
  for (const door of house.doors.filter((each) => !each.opening)) {
    const order = (leaf) => [-(away.get(leaf.room) ?? 0), fromCorner(leaf, rooms.get(leaf.room))];
    const all = ways(door, house, rooms).map((leaf) => [order(leaf), leaf]).sort(([one], [other]) => byFirst(one, other)).map(([, leaf]) => leaf);
    leaves.add(all, all.map((leaf) => swept(leaf, rooms.get(leaf.room), pieces.get(leaf.room))));
  }
  return leaves.chosen;
}

/** Bounds: other doors whose leaves move, one out of the way of the next, for the leaf of a door; attempts at that in a house; swings
 * near a leaf whose quarter circles are compared, by points of a unit square. Of more swings, the squares are compared. */
const MAX_MOVED = 3, MAX_SETTLED = 300, MAX_NEAR = 8;
const POINTS = Array.from({ length: 144 }, (_, n) => [((n % 12) + 0.5) / 12, (Math.floor(n / 12) + 0.5) / 12]);

/** Leaves that are chosen so far, one of the possible leaves of each door. */
class Leaves {
  chosen = [];
  free = []; // leaves of each door over no furniture and no walls
  attempts = 0;
  before = []; // changes to undo: a door and its previous leaf

  add(ways, depths) {
    const number = this.chosen.length;
    this.before = [];
    this.free.push(ways.filter((_, way) => depths[way] === 0));
    this.chosen.push(ways[0]);
    if (this.settle(number, MAX_MOVED, [])) return;
    const sum = (leaf) => this.crossed(number, leaf).reduce((total, { area }) => total + area, 0);
    [[, this.chosen[number]]] = ways.map((leaf, way) => [[depths[way], sum(leaf)], leaf]).sort(([one], [other]) => byFirst(one, other));
  }

  /** Choose a leaf of a door that crosses no other, or return false. Doors that are settled stay. */
  settle(number, wanted, others) {
    const mark = this.before.length, settled = [...others, number];
    this.attempts += Number(wanted > 0);
    const moves = this.attempts <= MAX_SETTLED ? wanted : 0;
    for (const most of moves ? [0, moves] : [0])
      for (const leaf of this.free[number]) {
        const crossed = this.crossed(number, leaf).map(({ other }) => other);
        if (crossed.length > most || crossed.some((other) => settled.includes(other))) continue;
        this.before.push([number, this.chosen[number]]);
        this.chosen[number] = leaf;
        if (crossed.every((other) => this.settle(other, moves - crossed.length, settled))) return true;
        while (this.before.length > mark) {
          const [door, last] = this.before.pop();
          this.chosen[door] = last;
        }
      }
    return false;
  }

  /** The doors whose swings a leaf of a door would cross, and the shared areas. */
  crossed(number, leaf) {
    const around = swing(leaf);
    const near = this.chosen.flatMap((each, other) => {
      const [west, north, east, south] = swing(each);
      const start = [Math.max(west, around[0]), Math.max(north, around[1])];
      const sides = [Math.min(east, around[2]) - start[0], Math.min(south, around[3]) - start[1]];
      return other !== number && each.room === leaf.room && Math.min(...sides) > TOLERANCE ? [{ each, other, start, sides }] : [];
    });
    const share = ({ each, start, sides }) => {
      const points = POINTS.map((point) => point.map((part, axis) => start[axis] + part * sides[axis]));
      return points.filter((point) => inReach(leaf, point) && inReach(each, point)).length / POINTS.length;
    };
    return near.map((one) => ({ other: one.other, area: one.sides[0] * one.sides[1] * (near.length <= MAX_NEAR ? share(one) : 1) }))
      .filter(({ area }) => area > 0);
  }
}

const inReach = ({ hinge, tip }, [x, y]) => Math.hypot(x - hinge[0], y - hinge[1]) < Math.hypot(hinge[0] - tip[0], hinge[1] - tip[1]);

/** Through how many doors each room is reached from where bodies start. */
function steps({ rooms, doors, hub }) {
  const entrance = doors.find(({ between }) => between.includes("outside"))?.between.find((name) => name !== "outside");
  let level = [hub ?? entrance ?? rooms[0].name];
  const found = new Map([[level[0], 0]]);
  while (level.length) {
    const next = level.flatMap((here) => doors.filter(({ between }) => between.includes(here)).flatMap(({ between }) => between))
      .filter((name) => name !== "outside" && !found.has(name));
    for (const name of next) found.set(name, found.get(level[0]) + 1);
    level = [...new Set(next)];
  }
  return found;
}

function ways(door, house, rooms) {
  const ends = [[door.x, door.y], [door.x + door.width, door.y + door.height]];
  const main = house.topology === "star" ? house.hub : "";
  const names = door.between.filter((name) => name !== "outside").sort((one, other) => (one === main) - (other === main));
  const box = rooms.get(names[0]), axis = Number(door.height === 0);
  const side = (box[axis] + box[axis + 2]) / 2 > ends[0][axis] ? 1 : -1, length = side * (door.width + door.height);
  return names.flatMap((room, place) => [ends, ends.toReversed()].map(([hinge, jamb]) => {
    const sign = place ? -1 : 1, off = sign * side * (house.wall_thickness ? house.wall_thickness.inner / 2 : 0);
    const moved = (point, by) => point.map((value, each) => (each === axis ? value + by : value));
    return { room, hinge: moved(hinge, off), tip: moved(hinge, sign * length + off), jamb: moved(jamb, off) };
  }));
}

function swing({ hinge, tip, jamb }) {
  const [xs, ys] = [0, 1].map((axis) => [hinge, tip, jamb].map((point) => point[axis]));
  return [Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)];
}

const overlap = (one, other) => Math.min(
  ...[0, 1].map((axis) => Math.min(one[axis + 2], other[axis + 2]) - Math.max(one[axis], other[axis])));

/** The depth to which a leaf reaches into furniture or walls, in metres. */
function swept(leaf, room, pieces) {
  const around = swing(leaf), length = Math.hypot(leaf.hinge[0] - leaf.tip[0], leaf.hinge[1] - leaf.tip[1]);
  const from = ([x, y], box) => Math.hypot(...[Math.max(0, box[0] - x, x - box[2]), Math.max(0, box[1] - y, y - box[3])]);
  const within = (box) => box.map((value, side) => (side < 2 ? Math.max : Math.min)(value, around[side]));
  const hit = pieces.filter((piece) => overlap(around, piece) > TOLERANCE).map((piece) => length - from(leaf.hinge, within(piece)));
  const beyond = Math.max(room[0] - around[0], around[2] - room[2], room[1] - around[1], around[3] - room[3]);
  return Math.max(beyond, ...hit, TOLERANCE) - TOLERANCE;
}

/** How far the hinge is from the nearer corner along the door's wall. */
function fromCorner({ hinge, jamb }, room) {
  const axis = Number(hinge[0] === jamb[0]);
  return Math.min(hinge[axis] - room[axis], room[axis + 2] - hinge[axis]);
}
