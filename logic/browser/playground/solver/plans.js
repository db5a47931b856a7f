/** Plans: houses whose rooms share walls. From a request to such a house. As logic/generation/shared_walls.py and furnish.py. */

import { LimitReached, Unsatisfiable } from "./answers.js";
import { granted, requirements, toFurnish } from "./grammar.js";
import { nogood, terms } from "./star.js";
import { faults } from "./tiling.js";
import { atom, compound, list, parseTerm, real, termText } from "./terms.js";

const TOLERANCE = 1e-6;

/** A plan, { rooms, doors, windows, hub }, without a hub where there is not just one; metres, as in a house file. `isFurnishable`: whether a room of a type can be. */
export function plan(grammar, request, rng, inferences, isFurnishable) {
  const nogoods = [], unfurnishable = new Set(), { mostTries } = grammar.bundle;
  for (let turn = 0; turn < mostTries; turn++) {
    const unfurnished = unfurnishedPlan(grammar, request, rng, inferences, nogoods, unfurnishable);
    inferences = unfurnished.inferences;
    if (grammar.topology.isOwn) requireTiling(grammar, unfurnished);
    const pieces = furnished(grammar, unfurnished.plan, request, rng, inferences);
    if (pieces.failed === undefined) {
      const [inner, outer] = grammar.prolog.ask("wall_thicknesses");
      return { ...house(unfurnished, pieces), ...(outer && { wall_thickness: { inner, outer } }) };
    }
    const { type } = unfurnished.plan.rooms[pieces.failed];
    if (!isFurnishable(type)) unfurnishable.add(type);
  }
  throw new LimitReached(`after ${mostTries} attempts, some room could not be furnished at its sampled size: try another seed, or larger rooms`);
}

/** Walls, doors and windows, and the layout that they have. What is found infeasible is added to the nogoods. */
function unfurnishedPlan(grammar, request, rng, inferences, nogoods, unfurnishable) {
  const holds = requirements(request).map(granted);
  const fails = [...unfurnishable].sort().flatMap((type) => toFurnish(type, request.rooms));
  for (;;) {
    const layout = grammar.rooms(request).sample(rng, holds, fails, nogoods);
    if (!layout) throw new Unsatisfiable([...unfurnishable].sort());
    const answer = grammar.prolog.ask("plan_placed", compound("plan", terms(layout), [], rng.seed(), "minimal"), inferences);
    if (answer.limit) throw new LimitReached("the Prolog inferences for a house ran out");
    inferences -= answer.inferences;
    if (!answer.infeasible) return { plan: answer, layout, inferences };
    nogoods.push(nogood(answer.infeasible));
    if (inferences <= 0) throw new LimitReached("the Prolog inferences for a house ran out");
  }
}

/** Refuse a topology of the user's own whose rooms are no plan. */
function requireTiling(grammar, unfurnished) {
  const made = house(unfurnished, unfurnished.plan.rooms.map(() => []));
  for (const fault of faults(made, grammar.bundle.passage)) {
    const named = made.rooms.map(({ name }) => name).filter((name) => new RegExp(`\\b${name}\\b`).test(fault));
    const all = unfurnished.layout.map(parseTerm).filter(({ name }) => name === "edge");
    const theirs = all.filter(({ args: [room] }) => named.includes(`R${room}`));
    const edges = theirs.length ? theirs : all, some = apart(edges, named.length);
    const why = grammar.bundle.says.noPlan.replace("{rooms}", made.rooms.length).replace("{fault}", fault);
    throw grammar.topologyError(why, some.length ? some : edges);
  }
}

/** Edges that can bring rooms where they must not be: not those of the outline, nor of several rooms on one side of a line. */
function apart(edges, rooms) {
  const side = ({ args: [, side, line] }) => `${termText(side)} ${termText(line)}`;
  const alike = (edge) => edges.filter((other) => side(other) === side(edge)).length;
  return edges.filter((edge) => edge.args[2].name !== "outline" && !(rooms > 1 && alike(edge) === rooms));
}

function house({ plan: { rooms, doors, windows }, layout }, pieces) {
  const atoms = layout.map(parseTerm);
  const hubs = atoms.filter(({ name }) => name === "hub").map(({ args: [number] }) => `R${number}`);
  const wholes = new Map(atoms.filter(({ name }) => name === "part_of").map(({ args: [part, whole] }) => [part, whole]));
  const name = (each) => (typeof each === "number" ? `R${each}` : each);
  return {
    rooms: rooms.map((room, number) => ({ ...sides(room), name: name(number), type: room.type, children: pieces[number], storey: 0, ...(wholes.has(number) && { part_of: name(wholes.get(number)) }) })),
    doors: doors.map((door) => ({ ...sides(door), between: door.between.map(name), ...(door.opening && { opening: true }) })),
    windows: windows.map((window) => ({ ...sides(window), room: name(window.room) })),
    ...(hubs.length === 1 ? { hub: hubs[0] } : {}),
  };
}

const sides = ({ x, y, width, height }) => ({ x, y, width, height });

/** The pieces of each room of a unfurnished plan; { failed: number } of a room that can have none. */
function furnished(grammar, unfurnished, request, rng, inferences) {
  const frames = unfurnished.rooms.map((room, number) => new Frame(unfurnished, number, grammar.bundle));
  const pieces = unfurnished.rooms.map(() => []), nogoods = unfurnished.rooms.map(() => []);
  let waiting = [...unfurnished.rooms.keys()].filter((number) => grammar.hasFurniture(unfurnished.rooms[number].type));
  const required = unfurnished.rooms.map(({ type }) => grammar.requiredIn(type, request).map(granted));
  const isLate = (number) => !grammar.first.has(unfurnished.rooms[number].type) && !required[number].length;
  if (grammar.first.size) waiting.sort((one, other) => isLate(one) - isLate(other));
  const kinds = unfurnished.rooms.map(() => []);
  while (waiting.length) {
    const asked = [];
    for (const [place, number] of waiting.entries()) {
      const { type } = unfurnished.rooms[number], frame = frames[number];
      const { holds, fails } = frame.given();
      const elsewhere = kinds.flatMap((own, other) => (other === number ? [] : own));
      for (const [group, some] of grammar.groups)
        (elsewhere.some((kind) => some.has(kind)) ? holds : fails).push(`taken(${group})`);
      const program = grammar.givenRoom(type, frame.doorways(), request);
      const furniture = program.sample(rng, [...holds, ...required[number]], fails, nogoods[number]);
      if (!furniture) return { failed: number };
      kinds[number] = furniture.map(parseTerm).filter(({ name }) => name === "on").map(({ args: [piece] }) => piece.name);
      asked.push(frame.term(place, type, furniture, rng.seed()));
    }
    const again = waiting.some((number) => nogoods[number].length);
    const answer = grammar.prolog.ask("rooms_furnished", list(asked), again ? "minimal" : "quick", inferences);
    if (answer.limit || (inferences -= answer.inferences) <= 0)
      throw new LimitReached("the Prolog inferences for a house ran out");
    const conflicts = new Map(answer.infeasible);
    for (const [place, number] of waiting.entries())
      if (conflicts.has(place)) nogoods[number].push(nogood(conflicts.get(place)));
      else pieces[number] = answer.rooms[place];
    waiting = waiting.filter((_, place) => conflicts.has(place));
  }
  return pieces;
}

/** A room as seen from its entrance: x to the right along the front wall, y inwards. */
class Frame {
  constructor(unfurnished, number, { walls, short }) {
    Object.assign(this, { walls, short });
    const room = unfurnished.rooms[number], area = ({ width, height }) => width * height;
    this.isLargest = unfurnished.rooms.find(({ type, ...each }, other) => other !== number && type === room.type
      && (area(each) > area(room) || (area(each) === area(room) && other < number))) === undefined;
    const doors = unfurnished.doors.filter(({ between }) => between.includes(number))
      .sort((a, b) => (a.between[0] !== number) - (b.between[0] !== number));
    const windows = unfurnished.windows.filter((window) => window.room === number);
    const [west, north, east, south] = box(room), entrance = box(doors[0]);
    const lines = { north: [1, south], east: [0, west], south: [1, north], west: [0, east] };
    this.side = Object.keys(lines).find((side) => {
      const [axis, line] = lines[side];
      return Math.max(Math.abs(entrance[axis] - line), Math.abs(entrance[axis + 2] - line)) < TOLERANCE;
    });
    [this.x, this.y] = { north: [west, south], east: [west, north], south: [east, north], west: [east, south] }[this.side];
    const across = this.side === "north" || this.side === "south";
    this.width = across ? room.width : room.height;
    this.depth = across ? room.height : room.width;
    this.doors = this.byWall(doors);
    this.windows = this.byWall(windows);
  }

  byWall(segments) {
    const found = Object.fromEntries(Object.keys(this.walls).map((wall) => [wall, []]));
    for (const segment of segments) {
      const [left, front, right, back] = this.own(box(segment));
      const across = right - left > back - front;
      const walls = across ? { front, back: this.depth - back } : { left, right: this.width - right };
      const [one, other] = Object.keys(walls);
      found[Math.abs(walls[other]) < Math.abs(walls[one]) ? other : one].push(across ? [left, right] : [front, back]);
    }
    for (const spans of Object.values(found)) spans.sort((a, b) => a[0] - b[0] || a[1] - b[1]);
    return found;
  }

  /** A box of the house, in the room's frame. */
  own([west, north, east, south]) {
    const { x, y } = this;
    if (this.side === "north") return [west - x, y - south, east - x, y - north];
    if (this.side === "east") return [north - y, west - x, south - y, east - x];
    if (this.side === "south") return [x - east, north - y, x - west, south - y];
    return [y - south, x - east, y - north, x - west];
  }

  /** All doors but the entrance, as facts. */
  doorways() {
    return Object.entries(this.doors)
      .flatMap(([wall, spans]) => spans.map((_, place) => `doorway(${wall},${place + 1})`))
      .filter((fact) => fact !== "doorway(front,1)");
  }

  /** The room across and inwards, and each stretch of wall as far as its doors (m). */
  *lengths() {
    yield ["across", this.width];
    yield ["inwards", this.depth];
    for (const [wall, [first, last]] of Object.entries(this.walls)) {
      const size = wall === "front" || wall === "back" ? this.width : this.depth;
      const spans = this.doors[wall];
      if (!spans.length) {
        yield [wall, size];
        continue;
      }
      yield [first, spans[0][0]];
      for (let place = 1; place < spans.length; place++)
        yield [`between(${wall},${place})`, spans[place][0] - spans[place - 1][1]];
      yield [last, size - spans.at(-1)[1]];
    }
  }

  /** What rules/room/doors.lp is to assume of the room. */
  given() {
    const holds = [], fails = [], { step, bits } = this.short;
    (this.isLargest ? holds : fails).push("largest");
    for (const [what, length] of this.lengths()) {
      const short = Math.max(0, Math.trunc(2 ** bits - 1 - length / step));
      for (let bit = 0; bit < bits; bit++) ((short >> bit) & 1 ? holds : fails).push(`short(${what},${bit})`);
    }
    for (const [wall, spans] of Object.entries(this.windows)) {
      (spans.length ? holds : fails).push(`window(${wall})`);
      fails.push(`loose(${wall})`);
    }
    return { holds, fails };
  }

  /** The room for rules/room/given_rooms.pl. */
  term(number, type, furniture, seed) {
    const pair = (a, b) => `${real(a)}-${real(b)}`;
    const doors = Object.values(this.doors).map((spans) => spans.map(([start, end]) => pair(start, end - start)));
    const frame = compound("frame", this.side, real(this.x), real(this.y));
    return compound("room", number, atom(type), terms(furniture), seed, `(${pair(this.width, this.depth)})`, compound("doors", ...doors), frame);
  }
}

const box = ({ x, y, width, height }) => [x, y, x + width, y + height];
