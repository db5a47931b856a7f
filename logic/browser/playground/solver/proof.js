/** Why there is no house: a minimal set of the user's own statements and choices in conflict. As logic/layout/relaxed.py, proof.py.
 *
 * Every rule of the user's files gets one more condition, stated(N), which is free to hold and is assumed; so do the
 * lengths of the .pl files. A minimal conflict of stage 1 is then found by leaving statements out one by one. What stage 1
 * takes for possible is tried in stage 2, and what that refutes is a nogood of the next round.
 */

import { LimitReached } from "./answers.js";
import { MOST, granted, requirements, toFurnish } from "./grammar.js";
import { Program } from "./program.js";
import { areaConflict, nogood, terms } from "./star.js";
import { atomOf, rule, statements } from "./statements.js";
import { atom, list, parseTerm, prologText, termText } from "./terms.js";

const LEFT_OUT = "why/left_out.lp";
const MOST_ROUNDS = 400;

const written = ({ head, body }, ...more) => `${head} :- ${[body, ...more].filter(Boolean).join("; ")}.`;

/** The same length with nothing known of it: its numbers are least and greatest ones in turn. */
function unbound(fact, far) {
  const term = parseTerm(fact);
  let place = 0;
  return termText({ ...term, args: term.args.map((each) => (typeof each === "number" ? (place++ % 2 ? far : 0) : each)) });
}

/** A program in which each statement of the user's can be left out. */
class Relaxed {
  /** `lengths`: [fact, clauses] in pairs. */
  constructor(grammar, constants, parts, lengths, differences = false) {
    this.grammar = grammar;
    this.statements = [];
    this.nogoods = [];
    this.first = new Map();
    const files = grammar.own.map((file) => ({ name: file.name, text: this.conditional(file) }));
    const shared = grammar.asp.filter(({ name }) => !grammar.own.some((file) => file.name === name));
    const left = { name: LEFT_OUT, text: grammar.bundle.rules[LEFT_OUT] };
    const facts = this.conditionalLengths(lengths);
    const free = this.statements.map((_, number) => `{ stated(${number}) }. #heuristic stated(${number}). [1@1,true]`);
    this.program = new Program(grammar.clingo, [...shared, left, ...files, { name: "conditions", text: [...facts, ...free].join("\n") }], constants, parts, differences);
    for (const fact of grammar.absent(this.program, parts)) this.absent(fact);
  }

  /** That a fact is not stated; it reads at the first of its kind that is. */
  absent(atom) {
    const fact = termText(parseTerm(atom).args[0]);
    const { file, line, column } = this.first.get(parseTerm(fact).name) ?? {};
    this.statements.push({ reason: { text: fact + this.grammar.bundle.says.absent, file, line, column }, literals: [[atom, false]] });
  }

  stated(reason, clause) {
    const condition = `stated(${this.statements.length})`;
    this.statements.push({ reason, clause, literals: [[condition, true]] });
    return condition;
  }

  conditional(file) {
    const lines = [];
    for (const { text, ...place } of statements(file)) {
      const parts = rule(text);
      if (!parts) {
        lines.push(text);
        continue;
      }
      const condition = this.stated({ text, ...place });
      lines.push(written(parts, condition));
      const { name, signature } = atomOf(parts.head) ?? {};
      if (!this.grammar.bundle.leftOut.includes(signature)) continue;
      if (!this.first.has(name)) this.first.set(name, place);
      lines.push(written({ ...parts, head: `listed'(${parts.head})` }), written({ ...parts, head: `without'(${parts.head})` }, `not ${condition}`));
    }
    return lines.join("\n");
  }

  conditionalLengths(lengths) {
    const clauses = [...new Set(lengths.flatMap(([, each]) => each))];
    const origins = this.grammar.prolog.ask("grammar_origins", list(clauses.map((text) => prologText(parseTerm(text)))));
    const conditions = new Map();
    for (const [clause, path, line] of origins) {
      const file = path.slice(path.lastIndexOf("/") + 1);
      conditions.set(clause, this.stated({ text: this.clauseAt(file, line), file, line, column: 1 }, clause));
    }
    return lengths.flatMap(([fact, each]) => {
      const given = each.flatMap((clause) => conditions.get(clause) ?? []);
      const free = unbound(fact, this.grammar.bundle.far);
      const without = free === fact ? [] : given.map((condition) => `${free} :- not ${condition}.`);
      return [`${fact}${given.length ? ` :- ${given.join(", ")}` : ""}.`, ...without];
    });
  }

  /** The clause at a line of a .pl file, up to its full stop. */
  clauseAt(file, line) {
    let text = "";
    for (const part of this.grammar.files[file].split("\n").slice(line - 1)) {
      text += ` ${part.replace(/%.*/, "").trim()}`;
      if (text.endsWith(".")) break;
    }
    return text.replace(/\s+/g, " ").trim();
  }

  /** A choice of the request's. */
  choice(reason, literals) {
    this.statements.push({ reason, literals });
  }

  /** { layout } under these statements, or { conflict }: a minimal set of them, only proved to be there with `once`.
   * `refuted(layout, without)`: reasons of stage 2; null where it has
   * no part in it, and then there are as few statements as can be. */
  solve(refuted, some = this.statements, once = false) {
    for (let round = 0; round < MOST_ROUNDS; round++) {
      const lines = this.program.run({ what: refuted || once ? "conflict" : "fewest", mostLayouts: this.grammar.bundle.mostLayouts, differences: this.program.differences, once, nogoods: this.nogoods, statements: some.map(({ literals }) => literals) });
      const layouts = [];
      let conflict = [];
      for (const [tag, ...fields] of lines)
        if (tag === "keeps") layouts.push({ kept: new Set(fields.map((number) => some[number - 1])), atoms: [] });
        else if (tag === "atom") layouts.at(-1).atoms.push(fields[0]);
        else if (tag === "conflict") conflict = fields.map((number) => some[number - 1]);
      const learnt = layouts.map((layout) => refuted && this.refute(layout, refuted)).filter(Boolean);
      this.nogoods.push(...learnt);
      const whole = layouts.find(({ kept }) => kept.size === some.length);
      if (whole && !learnt.length) return { layout: whole.atoms };
      if (!learnt.length) return { conflict };
    }
    throw new LimitReached("the proof takes too long in the browser: use vitruvius explain");
  }

  /** A layout as a nogood, with the clauses that must be stated for it, if stage 2 refutes it. */
  refute({ kept, atoms }, refuted) {
    const without = this.statements.filter((each) => each.clause && !kept.has(each)).map(({ clause }) => clause);
    const reasons = refuted(atoms, list(without.map((text) => prologText(parseTerm(text)))));
    if (!reasons) return null;
    const clauses = new Set(reasons.filter(([kind]) => kind === "clause").map(([, text]) => text));
    const conditions = this.statements.filter((each) => clauses.has(each.clause)).flatMap(({ literals }) => literals);
    return [...conditions, ...nogood(reasons)];
  }
}

/** The rooms of a request, without rooms of the types that cannot be furnished; and how stage 2 refutes a layout. */
function rooms(grammar, request, unfurnishable) {
  const required = requirements(request);
  const relaxed = new Relaxed(grammar, { rooms: request.rooms }, ["house", "typical", ...required], grammar.walls, grammar.differences);
  for (const [number, type] of Object.keys(request.types).sort().entries())
    relaxed.choice({ text: `${type}: ${inWords(request.types[type])}` }, [[granted(required[number]), true]]);
  for (const type of unfurnishable)
    relaxed.choice({ unfurnished: type }, toFurnish(type, request.rooms).map((text) => [text, false]));
  const refuted = grammar.sharesWalls
    ? (layout, without) => grammar.prolog.ask("plan_conflict", terms(layout), without)
    : grammar.walls.length ? (layout, without) => areaConflict(grammar, layout, without) : null;
  return [relaxed, refuted];
}

/** The furniture of a room of a type, of any size, with what a request counts. */
function furniture(grammar, type, request) {
  const size = `size(${type})`;
  const lengths = grammar.lengths[type].map(([fact, clause]) => [fact, fact.startsWith("extent(") ? [clause, size] : [clause]]);
  const asked = grammar.counted(type, request);
  const required = asked.map(([, piece, [least, most]]) => `has(${piece},${least},${most ?? MOST})`);
  const more = asked.flatMap(([, piece, [least]]) => (least ? `more(${piece},${Math.min(least, grammar.bundle.more)})` : []));
  const relaxed = new Relaxed(grammar, { this_room: type }, ["room", "capacity", ...required, ...more], lengths);
  for (const [place, [name, , counts]] of asked.entries())
    relaxed.choice({ text: `${name}: ${inWords(counts)}` }, [[granted(required[place]), true]]);
  return [relaxed, (layout, without) => grammar.prolog.ask("room_conflict", atom(type), terms(layout), without)];
}

/** Whether a room of this type can be furnished at some size. */
export function isFurnishable(grammar, type, request) {
  const key = JSON.stringify([type, grammar.requiredIn(type, request)]);
  if (!grammar.furnishable.has(key)) {
    const [relaxed, refuted] = furniture(grammar, type, request);
    grammar.furnishable.set(key, Boolean(relaxed.solve(refuted, relaxed.statements, true).layout));
  }
  return grammar.furnishable.get(key);
}

/** Whether a request has a house: rooms, each of which can be furnished. */
function hasHouse(grammar, request) {
  const unfurnishable = new Set();
  for (;;) {
    const [relaxed, refuted] = rooms(grammar, request, unfurnishable);
    const { layout } = relaxed.solve(refuted, relaxed.statements, true);
    if (!layout) return false;
    const types = new Set(layout.map(parseTerm).filter(({ name }) => name === "room").map(({ args: [, type] }) => type.name));
    const without = [...types].filter((type) => !isFurnishable(grammar, type, request));
    if (!without.length) return true;
    without.forEach((type) => unfurnishable.add(type));
  }
}

const key = (reason) => JSON.stringify(reason);

/** Why a request has no house: `reasons`, { text, file, line, column } each, a choice of the request's without a place, and
 * the types of room that are `unfurnishable`; then, which takes longer, the same with `advice`. */
export function* proofs(grammar, request, unfurnishable) {
  const [relaxed, refuted] = rooms(grammar, request, unfurnishable);
  const { conflict } = relaxed.solve(refuted);
  if (!conflict) throw new Error("the request was proved infeasible, and has a layout");
  const needed = new Set(conflict.map(({ reason }) => key(reason)));
  const unfurnished = conflict.flatMap(({ reason }) => reason.unfurnished ?? []);
  const others = numbersWithout(needed, grammar, request, unfurnishable);
  const first = others.next().value;
  const stated = conflict.filter(({ reason }) => !reason.unfurnished).map(({ reason }) => reason);
  const inRooms = unfurnished.flatMap((type) => {
    const [room, test] = furniture(grammar, type, request);
    return room.solve(test).conflict.map(({ reason }) => reason);
  });
  const named = first ? [{ text: `rooms: ${request.rooms}` }] : [];
  const reasons = [...new Map([...named, ...stated, ...inRooms].map((reason) => [key(reason), reason])).values()];
  yield { reasons, unfurnishable: unfurnished };

  let number = first;
  while (number && !hasHouse(grammar, { ...request, rooms: number })) number = others.next().value;
  const ways = number ? [`with ${number} rooms`] : [];
  for (const [text, fewer] of withoutEach(request))
    if (reasons.some((reason) => reason.text === text) && hasHouse(grammar, fewer)) ways.push(`without ${text}`);
  const isThere = grammar.walls.length && !grammar.sharesWalls ? "may be" : "is"; // the area of a furnished star was not tried
  if (ways.length) yield { reasons, unfurnishable: unfurnished, advice: `There ${isThere} a house ${ways.join(", or ")}.` };
}

/** Other numbers of rooms that end a conflict of these reasons. */
function* numbersWithout(needed, grammar, request, unfurnishable) {
  for (const number of otherNumbers(grammar, request)) {
    const [relaxed, refuted] = rooms(grammar, { ...request, rooms: number }, unfurnishable);
    const some = relaxed.statements.filter(({ reason }) => needed.has(key(reason)));
    if (relaxed.solve(refuted, some, true).layout) yield number;
  }
}

/** Other numbers of rooms, the nearest first: near this one and near the sum of types; where rooms do not share walls, powers of
 * two as well. */
function* otherNumbers(grammar, { rooms: number, types }) {
  const wanted = Object.values(types).reduce((sum, [least]) => sum + least, 0);
  const { star, plans } = grammar.bundle.near, near = grammar.sharesWalls ? plans : star;
  const some = new Set(grammar.sharesWalls ? [] : [0, 1, 2, 3, 4, 5, 6, 7].map((power) => 2 ** power));
  for (let each = 1; each < near; each++) some.add(each);
  for (const middle of [number, wanted]) for (let each = middle - near; each <= middle + near; each++) some.add(each);
  const others = [...some].filter((other) => other >= 1 && other <= grammar.mostRooms && other !== number);
  yield* others.sort((one, other) => Math.abs(one - number) - Math.abs(other - number) || one - other);
}

/** Each choice of the request's in words, and the request without it. */
function* withoutEach(request) {
  for (const kind of ["types", "furniture"])
    for (const [name, counts] of Object.entries(request[kind])) {
      const { [name]: _, ...fewer } = request[kind];
      yield [`${name}: ${inWords(counts)}`, { ...request, [kind]: fewer }];
    }
}

/** A count in words: 2, 1 to 3, at least 1. */
export const inWords = ([least, most]) => (least === most ? `${least}` : most === null ? `at least ${least}` : `${least} to ${most}`);
