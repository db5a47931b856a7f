/** Stage 1 in clingo for WebAssembly: every discrete choice of a house, sampled as logic/layout/program.py samples it.
 *
 * A call of clingo-wasm reads a program and ends; nothing stays grounded. So each sample grounds its program again. The
 * layout is the same: it depends on the rules and the random numbers alone.
 */

import { luaText } from "./terms.js";

/** Mistakes in the rules: `findings`, { severity, file, line, column, text } each. */
export class RuleError extends Error {
  constructor(text, file = "", line = 1, column = 1) {
    super(text);
    this.findings = [{ severity: "error", file, line, column, text }];
  }
}

/** clingo, with the script that does a task. */
export class Clingo {
  /** `script` is program.lua; `hints`: [pattern, text] of lines with syntax errors. */
  constructor(factory, script, hints) {
    Object.assign(this, { factory, script, hints });
  }

  /** Load the module, again where an error has ended it; `run` then needs no waiting. */
  async load() {
    if (this.module) return;
    const lines = (this.lines = []), remarks = (this.remarks = []);
    this.module = await this.factory({ print: (line) => lines.push(line), printErr: (line) => remarks.push(line) });
    this.call("", "--outf=0");
    this.version = lines[0].replace("clingo version ", "");
  }

  /** Run a task on files, [{ name, text }]. Answers its lines, without the @: [tag, ...fields]. */
  run(files, constants, task) {
    this.lines.length = this.remarks.length = 0;
    const starts = [];
    let source = "", line = 1;
    for (const { name, text } of files) {
      source += "#program base.\n";
      starts.push({ name, line: ++line });
      source += `${text}\n`;
      line += text.split("\n").length;
    }
    source += `#program base.\n#script (lua)\ntask = ${luaText(task)}\n${this.script}\n#end.\n`;
    const options = Object.entries(constants).map(([name, value]) => `-c ${name}=${value}`);
    const failed = this.call(source, `--outf=0 ${task.atoms ? "" : "-Wno-atom-undefined "}${options.join(" ")} 1`);
    this.placed = this.remarks.join("\n").split("\n\n").map((remark) => placed(remark.trim(), starts));
    const errors = this.placed.filter(({ kind }) => kind === "error");
    if (errors.length) {
      const error = new RuleError(errors[0].text);
      error.findings = errors.map((each) => this.finding(each, files, starts));
      throw error;
    }
    if (failed) throw new RuleError(`clingo has failed: ${failed} ${this.remarks.join(" ")}`.trim());
    return this.lines.filter((each) => each[0] === "@").map((each) => each.slice(1).split("\t"));
  }

  /** An error of clingo's with what is likely meant, and what stands there. */
  finding({ text, file, line, column }, files, starts) {
    const lines = files.find(({ name }) => name === file)?.text.split("\n") ?? [];
    const written = (number) => (lines[number - 1] ?? "").trim();
    const unsafe = /(-:\d+:\d+\S*) note: '([^']+)' is unsafe/.exec(text);
    const severity = "error";
    if (unsafe) {
      const place = placed(`${unsafe[1]} note: `, starts), name = unsafe[2].replace(/^#Anon.*/, "_");
      const why = written(place.line).includes(":-")
        ? `no literal without not gives it values, as in room(${name},_)`
        : "a fact has no variables, and a name begins in lower case";
      return { severity, file, line: place.line, column: place.column, text: `${name} is unsafe: ${why}: ${written(place.line)}` };
    }
    if (!/^(syntax|lexer) error/.test(text)) return { severity, file, line, column, text };
    const [, hint] = this.hints.find(([pattern]) => new RegExp(pattern).test(written(line))) ?? [];
    const otherwise = text.includes("EOF")
      ? "the last statement has no period at its end"
      : "perhaps a comma is missing before it, or a period after the statement above";
    return { severity, file, line, column, text: [text, hint ?? otherwise, written(line)].filter(Boolean).join(": ") };
  }

  /** Have clingo read and solve a program; what went wrong, if anything did. */
  call(source, options) {
    try {
      const status = this.module.ccall("run", "number", ["string", "string"], [source, options]);
      const said = this.lines.find((line) => line.startsWith("@failed"));
      return said?.slice(8) ?? (this.lines.includes("@done") ? "" : `status ${status}.`);
    } catch (error) {
      this.module = null;
      return `${error.message}.`;
    }
  }
}

/** A remark of clingo's, at its place in the files. */
function placed(remark, starts) {
  const found = /^-:(\d+):(\d+)[^ ]* (\w+): ([^]*)$/.exec(remark);
  if (!found) return { kind: remark.startsWith("*** ERROR") ? "failure" : "", text: remark };
  const [, line, column, kind, text] = found;
  const file = starts.findLast((start) => start.line <= Number(line)) ?? { name: "", line: 0 };
  return { kind, text: text.replace(/\s+/g, " "), file: file.name, line: line - file.line + 1, column: Number(column) };
}

/** One program: the rooms of a house, or the furniture of one type of room. */
export class Program {
  /** `parts`: texts of terms, each a #program part with its arguments. `differences`: whether it states any. */
  constructor(clingo, files, constants, parts, differences = false) {
    Object.assign(this, { clingo, files, constants, parts, differences });
  }

  run(task) {
    return this.clingo.run(this.files, this.constants, { parts: this.parts, ...task });
  }

  /** The atoms of these signatures, [name, arity], that may hold in any model: texts. */
  atoms(...signatures) {
    return this.run({ what: "read", atoms: signatures }).filter(([tag]) => tag === "atom").map(([, text]) => text);
  }

  /** The variables in order, each { turn, single, number }, and the weights of all options. */
  get options() {
    if (!this.known) {
      const lines = this.run({ what: "read" });
      const of = (tag) => lines.filter(([each]) => each === tag).map(([, ...fields]) => fields);
      const variables = of("variable").map(([turn, single, number]) =>
        ({ turn: Number(turn), single: single === "true", number: Number(number) }));
      this.known = { variables, weights: of("weight").map(([weight]) => Number(weight)) };
      const wrong = this.known.weights.find((weight) => !(weight >= 1));
      if (wrong !== undefined) throw new RuleError(`option/3: a weight must be a positive integer, not ${wrong}`);
    }
    return this.known;
  }

  /** Sample a layout: its atoms, texts in order; null where there is none. As `Program.sample` of logic/layout/program.py. */
  sample(rng, holds = [], fails = [], nogoods = []) {
    const { variables, weights } = this.options;
    const keys = rng.exponentials(weights.length).map((key, place) => key / weights[place]);
    let places = rng.permutation(variables.length);
    if (variables.some(({ turn }) => turn)) {
      const byTurn = places.map((_, place) => place).sort((a, b) => variables[a].turn - variables[b].turn || places[a] - places[b]);
      byTurn.forEach((variable, place) => (places[variable] = place));
    }
    const options = variables.flatMap(({ number, single }, variable) => Array.from({ length: number }, () => ({ variable, single })));
    const order = options.map((_, option) => option).sort((a, b) =>
      places[options[a].variable] - places[options[b].variable] || keys[a] - keys[b]);
    // Where a variable picks one value, the first that is taken settles its others.
    const ends = [];
    order.forEach((option, place) => (ends[options[option].variable] = place + 1));
    const after = order.map((option, place) => (options[option].single ? ends[options[option].variable] : place + 1));
    const lines = this.run({
      what: "sample", differences: this.differences, holds, fails, nogoods,
      order: order.map((option) => option + 1), after: after.map((place) => place + 1),
    });
    return lines.some(([tag]) => tag === "model") ? lines.filter(([tag]) => tag === "atom").map(([, text]) => text) : null;
  }
}
