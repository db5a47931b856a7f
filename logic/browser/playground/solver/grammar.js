/** A grammar: its rule files, what they state, and the programs of stage 1 that they make. As logic/grammar.py, loaded.py. */

import { Program, RuleError } from "./program.js";
import { blank, misspeltName, placeOf, refused, unknownPredicate } from "./audit.js";
import { withIncluded } from "./includes.js";
import { unknown } from "./spelling.js";
import { placesOf } from "./places.js";
import { atom, compound, list, parseTerm, termText } from "./terms.js";

const OWN = "/grammar";
const DIFFERENCES = "rules/shared_walls/differences.lp";
const NOTHING = { rooms: 1, types: {}, furniture: {} };
/** clingo's greatest number: no bound. */
export const MOST = 2 ** 31 - 1;

/** clingo-dl's theory, as far as the rules use it. program.lua has what it means. */
const THEORY = {
  name: "theory",
  text: `#theory dl { term { - : 3, unary; - : 1, binary, left; + : 1, binary, left }; &diff/0 : term, {<=}, term, head }.`,
};

/** A core file and what it includes, as [{ name, text }], from all texts by path. */
function withIncludes(rules, path) {
  const folder = path.includes("/") ? path.slice(0, path.lastIndexOf("/") + 1) : "";
  const included = [...rules[path].matchAll(/^#include "(.+?)"\./gm)].flatMap(([, name]) =>
    withIncludes(rules, name.startsWith("../") ? name.slice(3) : folder + name));
  return [...included, { name: `rules/${path}`, text: rules[path].replace(/^#include .*$/gm, "") }];
}

/** The topology that a fact names: its name, the table of it, and the shared files that come with it. */
function topologyOf(own, { rules, topologies, adjacent }) {
  const named = [];
  let isNamed = false; // adjacent, by a rule
  for (const { name, text } of own) {
    const code = blank(text);
    isNamed ||= /\badjacent\s*\(/.test(code);
    for (const found of code.matchAll(/\btopology\s*\(\s*(\w+)\s*\)\s*\./g)) named.push({ topology: found[1], file: name, ...placeOf(code, found.index) });
  }
  if (named.length > 1) {
    const { file, line, column } = named[1];
    throw new RuleError(`a grammar has one topology, and ${named[0].topology} is named already`, file, line, column);
  }
  const [{ topology, file, line, column }] = named.length ? named : [{ topology: "star" }];
  const isOwn = own.some(({ name }) => name === `${topology}.lp`);
  const table = topologies[isOwn ? "own" : topology];
  if (topology === "building") throw new RuleError("the browser does not support houses of units: use the command vitruvius generate", file, line, column);
  const others = Object.keys(topologies).map((each) => (each === "own" ? "building" : each));
  if (!table) throw new RuleError(`${unknown("topology", topology, others)}; one of yours is a file ${topology}.lp beside this one`, file, line, column);
  const files = [...table.files, ...(isNamed && topology !== "star" ? [adjacent] : [])].sort();
  return { name: topology, isOwn, table, files: files.flatMap((path) => withIncludes(rules, path)) };
}

const millimetres = (extremes) => extremes.map((metres, place) => (place % 2 ? Math.ceil : Math.floor)(1000 * metres));

export class Grammar {
  /** `files`: the user's, by name. `bundle`: rules.json. Throws RuleError for the first mistake. */
  constructor(files, bundle, clingo, prolog) {
    const [own, lengths] = [".lp", ".pl"].map((ending) => withIncluded(files, ending, bundle));
    for (const [ending, found] of [[".lp", own], [".pl", lengths]])
      if (!found.length) throw new RuleError(`the grammar has no ${ending} file`);
    /** All rule files by name, as the solvers read them. */
    files = Object.fromEntries([...own, ...lengths].map(({ name, text }) => [name, text]));
    Object.assign(this, { clingo, prolog, bundle, files, own });
    /** The same in the order of a grammar's hash, as they are written. */
    this.written = [...own, ...lengths].map(({ name, written }) => [name, written]);
    this.core = withIncludes(bundle.rules, "core.lp");
    this.topology = topologyOf(this.own, bundle);
    this.sharesWalls = this.topology.name !== "star";
    this.differences = this.topology.files.some(({ name }) => name === DIFFERENCES);
    this.asp = [...(this.differences ? [THEORY] : []), ...this.core, ...this.topology.files, ...this.own];
    this.programs = new Map();
    this.furnishable = new Map(); // by type and what is asked of it: see proof.js
    this.audit();
    this.loadLengths(lengths.map(({ name }) => name));
    this.loadTypes();
    this.loadExtremes();
    this.walls = [...(this.sharesWalls ? this.wallFacts() : []), ...this.areaFacts()];
    this.warnings = this.remarks();
  }

  /** What no grammar may state. */
  audit() {
    const found = refused(this.own, this.topology, this.bundle);
    if (found) throw new RuleError(found.why, found.file, found.line, found.column);
  }

  /** Stage 2 reads the .pl files. */
  loadLengths(names) {
    this.prolog.write(OWN, Object.fromEntries(names.map((name) => [name, this.files[name]])));
    const walls = this.sharesWalls ? "shared" : "apart";
    const problems = this.prolog.ask("grammar_problems", list(names.map((name) => atom(`${OWN}/${name}`))), walls, "0.0");
    if (problems.length) throw wrong(problems[0]);
  }

  /** What the facts state, by the two programs without furniture. */
  loadTypes() {
    const signatures = [["wrong", 2], ["twice", 2], ["type", 1], ["may", 4], ["beside", 4], ["around", 4], ["turns", 2], ["lit", 1], ["may_be_lit", 1], ["outdoor", 1], ["opening", 2], ["part", 2], ["most_rooms", 1], ["one_room", 2]];
    // Of what the core knows clingo is not to say that no rule derives it, as it says that a few times alone.
    const known = { name: "known", text: this.topology.table.known.map((signature) => `#defined ${signature}.`).join("\n") };
    const facts = new Program(this.clingo, [...this.asp, known], { rooms: 1 }, ["house", "typical"]).atoms(...signatures).map(parseTerm);
    const of = (name) => facts.filter((fact) => fact.name === name).map((fact) => fact.args);
    const without = this.withoutRule();
    new Program(this.clingo, [...this.asp, known], {}, ["room"]).atoms();
    this.refuseMistakes(facts, [...without, ...this.withoutRule()]);
    this.types = of("type").map(([type]) => type.name).sort();
    if (!this.types.length) throw new RuleError("no room type: state type/1 in a .lp file", this.own[0].name, 1, 1);
    this.mostRooms = Math.min(this.bundle.mostRooms, ...of("most_rooms").map(([most]) => most));
    this.furniture = Object.fromEntries(this.types.map((type) => [type, []]));
    for (const [type, piece] of of("may")) this.furniture[type.name].push(piece.name);
    /** Pieces of each group of one_room/2, and the types of room that need some of these. */
    this.groups = new Map();
    for (const [group, piece] of of("one_room"))
      this.groups.set(termText(group), (this.groups.get(termText(group)) ?? new Set()).add(piece.name));
    const grouped = new Set([...this.groups.values()].flatMap((pieces) => [...pieces]));
    this.first = new Set(of("may").filter(([, piece, least]) => least && grouped.has(piece.name)).map(([type]) => type.name));
    for (const [piece, companion] of [...of("beside"), ...of("around")])
      for (const pieces of Object.values(this.furniture))
        if (pieces.includes(piece.name) && !pieces.includes(companion.name)) pieces.push(companion.name);
    this.lit = new Set([...of("lit"), ...of("may_be_lit")].map(([type]) => type.name));
    this.outdoor = new Set(of("outdoor").map(([type]) => type.name));
    this.openings = of("opening").map(([type, other]) => compound("opening", atom(type.name), atom(other.name)));
    this.parts = of("part").map(([type, whole]) => compound("part", atom(type.name), atom(whole.name)));
    this.turned = new Set([...of("turns").map(([piece]) => piece.name), ...of("around").map(([, companion]) => companion.name)]);
  }

  /** What is misspelt, and what is wrong with facts, in the order in which one mistake hides another. */
  refuseMistakes(facts, without) {
    const of = (name) => facts.filter((fact) => fact.name === name).map((fact) => fact.args);
    const refuse = (found) => {
      if (found) throw new RuleError(found.why, found.file, found.line, found.column);
    };
    refuse(unknownPredicate(this.own, this.topology, without));
    // A value that is wrong explains a strange name in it, and a misspelt name that something is not there.
    const [values, absent] = [false, true].map((isAbsent) => of("wrong").filter(([, why]) => JSON.parse(why.string).includes(": see ") === isAbsent));
    for (const [fact, why] of values) throw this.at(fact, `${stated(fact)}: ${JSON.parse(why.string)}`);
    for (const twice of of("twice")) throw this.statedTwice(twice);
    const lengths = Object.keys(this.files).filter((name) => name.endsWith(".pl")).map((name) => this.files[name]);
    const misspelt = misspeltName(this.own, lengths, this.topology);
    if (misspelt?.isNear || !absent.length) refuse(misspelt);
    for (const [fact, why] of absent) throw this.at(fact, `${stated(fact)}: ${JSON.parse(why.string)}`);
    const isName = new RegExp(`^${this.bundle.name}$`);
    for (const [kind, place, names] of [["type", 0, ["type"]], ["piece", 1, ["may", "beside", "around"]]])
      for (const { name, args } of facts.filter((fact) => names.includes(fact.name)))
        if (!isName.test(termText(args[place]))) throw this.at({ name, args }, `${termText(args[place])}: ${this.bundle.says.noName[kind]}`);
  }

  /** That two facts contradict each other: at the later one, which is the user's own where the other is a shipped grammar's. */
  statedTwice(facts) {
    const places = facts.map((fact) => this.at(fact, "").findings[0]);
    const number = ({ file }) => this.own.findIndex(({ name }) => name === file);
    const byPlace = (one, other) => number(one) - number(other) || one.line - other.line || one.column - other.column;
    const [one, other] = byPlace(...places) <= 0 ? [0, 1] : [1, 0];
    const { file, line, column } = places[one];
    const why = `${stated(facts[one])} is stated too, at ${file}:${line}:${column}: keep one of them`;
    return this.at(facts[other], `${stated(facts[other])}: ${why}`);
  }

  /** What clingo says of atoms that no rule of the last program derives, in the user's files. */
  withoutRule() {
    return this.clingo.placed.filter(({ text, file }) => this.files[file] && text.startsWith("atom does not occur in any rule head"));
  }

  /** The lengths that stage 1 knows, facts of each type of room, each with the clause that it comes from. */
  loadExtremes() {
    const wanted = Object.entries(this.furniture).map(([type, pieces]) =>
      compound("furniture", atom(type), pieces.map((piece) => compound("piece", atom(piece), this.turned.has(piece)))));
    const report = this.prolog.ask("grammar_lengths", list(wanted), list(this.bundle.lengths.map(atom)));
    const used = (clause, value, fact) => {
      const why = `${clause} has no clause: add one to a .pl file`;
      if (value === null) throw fact ? this.at(parseTerm(fact), why) : new RuleError(why, this.prologFile);
      if (value.wrong) throw wrong(value.wrong);
      return value;
    };
    this.metres = Object.fromEntries(report.lengths);
    const lengths = report.lengths.map(([name, metres]) => [`length(${name},${Math.floor(1000 * used(`${name}/1`, metres))})`, `length(${name})`]);
    this.lengths = {};
    for (const [type, extremes, pieces] of report.types) {
      const reach = [type, ...millimetres(used(`room_size/3 for ${type}`, extremes, `type(${type})`))];
      this.lengths[type] = [...lengths, [`reach(${reach})`, `size(${type})`]];
      for (const [of, side] of report.turning)
        if (of === type) this.lengths[type].push([`turning(${Math.floor(1000 * side)})`, `turning(${type})`]);
      for (const [piece, extent] of pieces) {
        const fact = [piece, ...millimetres(used(`piece_size/4 for ${piece}`, extent, `may(${type},${piece})`))];
        this.lengths[type].push([`extent(${fact})`, `size(${type},${piece})`]);
      }
    }
    const topology = compound("topology", this.sharesWalls ? "shared" : "apart", false, this.bundle.mostRooms);
    const rooms = this.types.map((type) => compound("room", atom(type), this.lit.has(type)));
    const disagreements = this.prolog.ask("grammar_disagreements", topology, list(rooms), list([...this.openings, ...this.parts]));
    if (disagreements.length) throw wrong(disagreements[0]);
  }

  get prologFile() {
    return Object.keys(this.files).filter((name) => name.endsWith(".pl")).at(-1);
  }

  /** What stage 1 knows of walls that rooms share: facts of shared_walls/differences.lp, each with its clauses. */
  wallFacts() {
    const types = list(Object.keys(this.furniture).map(atom));
    const [doorway, contact, openings, extremes, thickness, doors] = this.prolog.ask("plan_lengths", types, list(this.openings));
    const facts = [[`length(doorway,${Math.floor(1000 * doorway)})`, ["length(door_width)", "length(door_margin)"]]];
    facts.push([`length(contact,${Math.floor(1000 * contact)})`, []]);
    for (const [type, other, wall, clauses] of openings) facts.push([`opening_wall(${type},${other},${Math.floor(1000 * wall)})`, clauses]);
    if (thickness) {
      const thick = [Math.floor, Math.ceil].map((bound) => bound(Number((1000 * thickness).toFixed(6))));
      facts.push([`inner_wall(${thick})`, ["length(inner_wall)"]]);
    }
    const only = ["house_size", ...doors];
    for (const [type, reach, uppers, lowers] of extremes) {
      const clauses = [`size(${type})`, `room_area(${type})`];
      facts.push([`reach(${[type, ...millimetres(reach)]})`, clauses]);
      for (const [name, bound, pairs] of [["upper_bound", Math.ceil, uppers], ["lower_bound", Math.floor, lowers]])
        for (const pair of pairs) facts.push([`${name}(${[type, ...pair.map((metres) => bound(1000 * metres))]})`, clauses]);
      only.push(`window_size(${type})`, `whole_area(${type})`);
    }
    return [...facts, ...only.map((clause) => [`sized(${clause})`, [clause]])];
  }

  /** What stage 1 knows of the area of the house, where one is stated: facts of areas.lp, and of star/areas.lp. */
  areaFacts() {
    const [total, rooms] = this.prolog.ask("house_areas", list(this.types.filter((type) => !this.outdoor.has(type)).map(atom)));
    if (!total.length) return [];
    const bounds = (least, most) => [Math.floor(100 * least), Math.ceil(100 * most)];
    const facts = [[`total(${bounds(...total)})`, ["house_area"]]];
    for (const [type, least, most] of rooms)
      facts.push([`floor(${[type, ...bounds(least, most)]})`, [`size(${type})`, `room_area(${type})`]]);
    if (this.sharesWalls) return facts;
    const { room_gap: gap, door_clearance: clear, door_width: door } = this.metres, apart = Math.max(gap, clear);
    const widths = [Math.min(...rooms.map((room) => room[3])), Math.max(...rooms.map((room) => room[4]))];
    const berth = [widths, [apart, apart], [door, door]].map((each) => bounds(...each));
    const clauses = ["room_gap", "door_clearance", "door_width"].map((name) => `length(${name})`);
    return [...facts, [`berth(${berth})`, [...this.types.map((type) => `size(${type})`), ...clauses]]];
  }

  /** A program, grounded once and kept. */
  program(constants, parts, differences = false) {
    const key = JSON.stringify([constants, parts]);
    if (!this.programs.has(key)) this.programs.set(key, new Program(this.clingo, this.asp, constants, parts, differences));
    return this.programs.get(key);
  }

  /** What no fact states and an explanation may add, atoms of rules/why/left_out.lp: the same for all numbers of rooms. */
  absent(program, [part]) {
    if (part !== "house") return [];
    return (this.addable ??= program.atoms(["added'", 1]));
  }

  /** The program of a request's rooms. */
  rooms(request) {
    const parts = ["house", "typical", ...this.walls.map(([fact]) => fact), ...requirements(request)];
    return this.program({ rooms: request.rooms }, parts, this.differences);
  }

  /** The program of the furniture of a room of this type. */
  room(type, request) {
    const parts = ["room", "capacity", ...this.lengths[type].map(([fact]) => fact), ...this.requiredIn(type, request)];
    return this.program({ this_room: type }, parts);
  }

  /** The program of the furniture of a room whose size and doors are given. */
  givenRoom(type, doorways, request) {
    const facts = this.lengths[type].map(([fact]) => fact).filter((fact) => !fact.startsWith("reach("));
    const parts = ["room", "plan", ...facts, ...doorways, ...this.requiredIn(type, request)];
    return this.program({ this_room: type, ...this.bundle.given }, parts);
  }

  /** What a request requires of the furniture of a room of this type, all counts of a piece together. */
  requiredIn(type, request) {
    const counts = new Map();
    for (const [, piece, [least, most]] of this.counted(type, request)) {
      const [a, b] = counts.get(piece) ?? [0, MOST];
      counts.set(piece, [Math.max(a, least), Math.min(b, most ?? MOST)]);
    }
    return [...counts.keys()].sort().map((piece) => `has(${piece},${counts.get(piece)})`);
  }

  /** What a request counts in rooms of this type: each count's name, its piece, and from how many to how many. */
  counted(type, { furniture }) {
    return Object.keys(furniture).sort().map((name) => [name, name.split(".").at(-1), furniture[name]])
      .filter(([name, piece]) => (name === piece || name === `${type}.${piece}`) && this.furniture[type].includes(piece));
  }

  hasFurniture(type) {
    return this.furniture[type].length > 0;
  }

  /** What clingo remarks on in the user's files: warnings. */
  remarks() {
    const found = new Map();
    for (const program of [this.rooms(NOTHING), ...this.types.map((type) => this.room(type, NOTHING))]) {
      program.options; // grounds it
      for (const { kind, text, file, line, column } of this.clingo.placed)
        if (kind && this.files[file]) found.set(`${file}:${line}:${column}`, { severity: "warning", file, line, column, text });
    }
    return [...found.values()];
  }

  /** A mistake of the topology of the user's own, at the rules by which it has these edges. */
  topologyError(why, edges) {
    const rules = edges.flatMap((edge) => placesOf(edge, this.own))
      .sort((a, b) => (a.file < b.file ? -1 : a.file > b.file ? 1 : a.line - b.line || a.column - b.column));
    const [first] = rules;
    const others = [...new Set(rules.map(({ line }) => line))].filter((line) => line !== first?.line).sort((a, b) => a - b);
    return new RuleError(others.length ? `${why} (lines ${others.join(", ")} too)` : why, first?.file, first?.line, first?.column);
  }

  /** A mistake at the place of a fact in the files. */
  at(fact, why) {
    const { name, args } = fact.name === "companions" ? { name: fact.args[0].name, args: fact.args.slice(1) } : fact;
    for (const some of [args, args.slice(0, 1)]) {
      const pattern = new RegExp(`^[^%]*?\\b${name}\\(${some.map((each) => `.*\\b${termText(each)}\\b`).join("")}`);
      for (const { name: file, text } of this.own) {
        const lines = text.split("\n");
        const line = lines.findIndex((each) => pattern.test(each));
        if (line >= 0) return new RuleError(why, file, line + 1, lines[line].indexOf(`${name}(`) + 1);
      }
    }
    return new RuleError(why, this.own[0].name, 1, 1);
  }
}

const stated = (fact) => termText(fact.name === "companions" ? { name: fact.args[0].name, args: fact.args.slice(1) } : fact);

/** A mistake as the .pl core gives it. */
export const wrong = ([file, line, column, text]) => new RuleError(text, file.replace(`${OWN}/`, ""), line, column);

/** What a request requires of the rooms: see rules/request.lp. */
export function requirements({ types }) {
  return Object.keys(types).sort().map((type) => `among(${type},${types[type][0]},${types[type][1] ?? MOST})`);
}

/** The atom to assume where a requirement is to hold. */
export const granted = (requirement) => `granted(${requirement})`;

/** The atoms of which one holds where some room is of this type and is to be furnished. */
export const toFurnish = (type, rooms) => Array.from({ length: rooms }, (_, number) => `unfurnished(${number},${type})`);
