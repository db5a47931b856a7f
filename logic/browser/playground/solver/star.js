/** Houses whose rooms stand around a main room: both stages, and what goes between them. As logic/generation/builder.py. */

import { granted, requirements, toFurnish, wrong } from "./grammar.js";
import { LimitReached, Unsatisfiable } from "./answers.js";
import { atom, compound, list, parseTerm, prologText } from "./terms.js";

/** A conflict of stage 2 as a nogood: [atom, holds] in pairs. */
export const nogood = (reasons) => reasons.filter(([kind]) => kind !== "clause").map(([kind, text]) => [text, kind === "holds"]);

export const terms = (atoms) => list(atoms.map((text) => prologText(parseTerm(text))));

/** How often rooms may not leave the main room the area that it must have, though others might. */
const MOST_MISFITS = 200, MOST_AREAS = 300;
const NO_AREA = "the sampled rooms left the main room an area outside house_area/2, but others might fit";

/** Reasons why no star of this layout has the area that is stated, where the clauses `without` are left out; null where some may. */
export function areaConflict(grammar, layout, without) {
  if (!grammar.walls.length) return null;
  const named = (name) => new Map(layout.map(parseTerm).filter((term) => term.name === name).map(({ args: [number, value] }) => [number, value.name]));
  const sides = named("side");
  const rooms = [...named("room")].sort(([a], [b]) => a - b).map(([number, type]) => compound("room", number, atom(type), atom(sides.get(number))));
  const corners = terms(layout.filter((text) => text.startsWith("corner(")));
  return grammar.prolog.ask("layout_area_conflict", list(rooms), corners, list(grammar.types.map(atom)), without);
}

/** A star, { floor, rooms }, metres, as in a house file. */
export function star(grammar, request, rng, inferences) {
  const nogoods = new Map();
  const of = (program) => nogoods.get(program) ?? nogoods.set(program, []).get(program);
  const unfurnishable = new Set();
  let count = 0, misfits = 0;

  const furnish = (rooms, numbers) => {
    const furnished = [...rooms];
    for (const number of numbers) {
      const { type } = rooms[number];
      const program = grammar.room(type, request);
      const furniture = program.sample(rng, grammar.requiredIn(type, request).map(granted), [], of(program));
      if (!furniture) {
        unfurnishable.add(type);
        return null;
      }
      furnished[number] = { ...rooms[number], furniture, seed: rng.seed() };
    }
    return furnished;
  };

  const layout = () => {
    for (;;) {
      const unfurnished = sampleRooms(grammar, request, rng, unfurnishable, of(grammar.rooms(request)));
      const rooms = furnish(unfurnished.rooms, unfurnished.rooms.keys());
      if (rooms) return { ...unfurnished, rooms };
    }
  };

  let found = layout();
  for (;;) {
    const rooms = found.rooms.map(({ number, type, side, furniture, seed }) =>
      compound("room", number, atom(type), atom(side), terms(furniture), seed));
    const corners = terms(found.corners);
    const term = compound("layout", rooms, corners, rng.seed(), count > 1 ? "minimal" : "quick");
    const answer = grammar.prolog.ask("placed", term, inferences);
    if (answer.wrong) throw wrong(answer.wrong);
    if (answer.limit) throw new LimitReached("the Prolog inferences for a house ran out");
    if ("misfit" in answer) {
      if (++misfits === MOST_MISFITS) throw new LimitReached(`${MOST_MISFITS} times ${NO_AREA}`);
      found = layout();
      continue;
    }
    if (!answer.infeasible) return { floor: answer.floor, rooms: answer.rooms };
    inferences -= answer.inferences;
    if (inferences <= 0) throw new LimitReached("the Prolog inferences for a house ran out");
    for (const [number, reasons] of answer.infeasible) {
      of(grammar.room(found.rooms[number].type, request)).push(nogood(reasons));
      count++;
    }
    const rooms_ = furnish(found.rooms, answer.infeasible.map(([number]) => number));
    found = rooms_ ? { ...found, rooms: rooms_ } : layout();
  }
}

/** Types, sides and corners, without the types of room that cannot have any furniture. What is impossible is added to the nogoods. */
function sampleRooms(grammar, request, rng, unfurnishable, nogoods) {
  const holds = requirements(request).map(granted);
  const fails = [...unfurnishable].sort().flatMap((type) => toFurnish(type, request.rooms));
  const sampled = () => {
    for (;;) {
      const layout = grammar.rooms(request).sample(rng, holds, fails, nogoods);
      if (!layout) throw new Unsatisfiable([...unfurnishable].sort());
      const reasons = areaConflict(grammar, layout, list([]));
      if (!reasons) return layout;
      nogoods.push(nogood(reasons));
      if (nogoods.length > MOST_AREAS) throw new LimitReached(`${MOST_AREAS} times ${NO_AREA}`);
    }
  };
  const layout = sampled();
  const named = (name) => layout.map(parseTerm).filter((term) => term.name === name);
  const sides = new Map(named("side").map(({ args: [number, side] }) => [number, side.name]));
  const rooms = named("room")
    .map(({ args: [number, type] }) => ({ number, type: type.name, side: sides.get(number) }))
    .sort((a, b) => a.number - b.number);
  return { rooms, corners: layout.filter((text) => text.startsWith("corner(")) };
}
