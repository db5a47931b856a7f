/** Houses of a grammar, as messages for the page: what it calls the parts of a sheet (page.js). */

import { LimitReached, RequestError, Unsatisfiable } from "./answers.js";
import { planSvg } from "./drawing.js";
import { Grammar } from "./grammar.js";
import { plan } from "./plans.js";
import { RuleError } from "./program.js";
import { inWords, isFurnishable, proofs } from "./proof.js";
import { Generator } from "./random.js";
import { unknown } from "./spelling.js";
import { star } from "./star.js";

export class Houses {
  constructor(bundle, clingo, prolog) {
    Object.assign(this, { bundle, clingo, prolog });
  }

  /** Load a grammar's files by name, unless they are loaded. `name`: that of the shipped grammar that they come from. */
  async load(files, name) {
    await this.clingo.load();
    const key = JSON.stringify([name, files]);
    if (key === this.loaded) return;
    this.loaded = null;
    this.grammar = new Grammar(files, this.bundle, this.clingo, this.prolog);
    this.source = await this.sourceOf(files, name);
    this.loaded = key;
  }

  /** What a house file says of its rules; null where the page's address is no secure one, as browsers have no hashes there. */
  async sourceOf(files, name) {
    if (!globalThis.crypto?.subtle) return null;
    const own = Object.keys(files).filter((each) => /\.(lp|pl)$/.test(each));
    const all = [...this.grammar.written, ...Object.entries(this.bundle.rules)];
    const content = new TextEncoder();
    const parts = all.flatMap(([path, text]) => {
      const bytes = content.encode(text);
      return [content.encode(`${path.split("/").at(-1)} ${bytes.length}\n`), bytes];
    });
    const digest = new Uint8Array(await crypto.subtle.digest("SHA-256", await new Blob(parts).arrayBuffer()));
    const shipped = this.bundle.grammars[name] ?? {};
    const edited = own.length !== Object.keys(shipped).length || own.some((each) => files[each] !== shipped[each]);
    const number = this.prolog.ask("solver_version");
    return {
      grammar: edited ? `${name}-edited` : name,
      grammar_hash: [...digest].map((byte) => byte.toString(16).padStart(2, "0")).join(""),
      versions: {
        vitruvius: this.bundle.version,
        clingo: this.clingo.version,
        "swi-prolog": [number / 10000, (number / 100) % 100, number % 100].map(Math.trunc).join("."),
      },
    };
  }

  /** The parts of a sheet, one by one; the caller may stop between them. */
  async *sheet(files, name, asked) {
    try {
      await this.load(files, name);
      const request = read(asked);
      const { furniture, mostRooms, warnings } = this.grammar;
      yield { kinds: { types: furniture, most_rooms: mostRooms }, warnings };
      requireKnown(request, furniture);
      if (request.rooms > mostRooms)
        throw new LimitReached(`a house of this grammar has at most ${mostRooms} rooms, by its topology`);
      for (let index = 0; index < asked.count; index++) {
        const house = { ...this.house(request, asked.seed, index), ...this.provenance(asked, index) };
        const types = Object.fromEntries(house.rooms.map(({ name, type }) => [name, type]));
        yield { index, house, types, svg: planSvg(house, this.bundle.looks[name], this.bundle.palette, this.bundle.widths) };
      }
    } catch (error) {
      if (error instanceof RuleError) yield { findings: error.findings };
      else if (error instanceof Unsatisfiable) yield* this.proofs(read(asked), error);
      else if (error instanceof RequestError) yield { index: 0, problem: { kind: "RequestError", message: error.message } };
      else if (error instanceof LimitReached) yield { index: 0, problem: { kind: "LimitReached", message: error.message } };
      else throw error;
    }
  }

  /** A house, as in a house file without its provenance: a function of the rules, the request, the seed and the index. */
  house(request, seed, index) {
    const { grammar } = this, { inferences } = this.bundle, rng = new Generator([seed, index]);
    if (!grammar.sharesWalls) return ofStar(star(grammar, request, rng, inferences));
    const made = plan(grammar, request, rng, inferences, (type) => isFurnishable(grammar, type, request));
    return { format: "vitruvius-2", unit: "m", ...made, topology: grammar.topology.name };
  }

  provenance({ rooms, types, furniture, seed }, index) {
    if (!this.source) return {};
    const request = { rooms, types, ...(Object.keys(furniture).length && { furniture }) };
    return { provenance: { ...this.source, request, seed, index } };
  }

  /** A problem of kind Unsatisfiable, with a minimal conflict; then with advice, if there is any. */
  *proofs(request, { unfurnishable }) {
    const types = Object.entries(request.types).map(([type, counts]) => `, ${inWords(counts)} of type ${type}`).join("");
    for (const found of proofs(this.grammar, request, unfurnishable)) {
      const since = found.unfurnishable.map((type) => `, since no ${type} can be furnished`).join("");
      const only = found.reasons.length === 1 ? "this forbids it" : "these conflict, so one of them must change";
      const count = `${request.rooms} room${request.rooms === 1 ? "" : "s"}`;
      yield { index: 0, problem: { kind: "Unsatisfiable", message: `No house has ${count}${types}${since}: ${only}.`, ...found } };
    }
  }
}

/** A star as a house file of today's format has it. */
function ofStar({ floor, rooms }) {
  const named = rooms.map(({ door, ...room }, number) => ({ ...room, name: `R${number}`, storey: 0 }));
  const main = { ...floor, name: "main", type: "main", children: [], storey: 0 };
  const doors = rooms.map(({ door }, number) => ({ ...door, between: [`R${number}`, "main"] }));
  return { format: "vitruvius-2", unit: "m", rooms: [...named, main], doors, hub: "main", topology: "star" };
}

/** Refuse types and pieces that a grammar does not have: `furniture` of each type. As Builder.require_known. */
function requireKnown(request, furniture) {
  const known = (what, name, names) => {
    if (!names.includes(name)) throw new RequestError(unknown(what, name, names));
  };
  for (const type of Object.keys(request.types)) known("room type", type, Object.keys(furniture));
  for (const name of Object.keys(request.furniture)) {
    const [piece, type] = name.split(".").reverse();
    if (type) known("room type", type, Object.keys(furniture));
    known("piece", piece, type ? furniture[type] : [...new Set(Object.values(furniture).flat())]);
  }
}

const range = (count) => (typeof count === "number" ? [count, count] : count);
const ranges = (counts) => Object.fromEntries(Object.entries(counts).map(([name, count]) => [name, range(count)]));

/** A request of the page's. */
function read({ rooms, types, furniture }) {
  return { rooms, types: ranges(types), furniture: ranges(furniture) };
}
