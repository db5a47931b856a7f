/** What a grammar may not state, and what is misspelt in it: what logic/language says of it, by the tables of rules.json. */

import { closest } from "./spelling.js";
import { atomOf, parted, rule, statements } from "./statements.js";

const meant = (name, names) => {
  const near = closest(name, names);
  return near && `: did you mean ${near}?`;
};

/** The first thing that these files, [{ name, text }], may not state, { why, file, line, column }; null where there is none.
 * `topology`: its `name`, and what is closed by it. `bundle`: rules.json. */
export function refused(own, topology, bundle) {
  const all = own.flatMap((file) => [...statements(file)]);
  for (const { text, ...place } of all) {
    const why = objection(text, bundle) || closed(text, place.file, topology, bundle);
    if (why) return { ...place, why };
  }
  return tooLarge(own, bundle) ?? unknownChoice(own, all, topology) ?? misspeltLine(all);
}

/** Why no grammar has a statement; empty where it may. */
function objection(text, { says, programs }) {
  const [, directive, words] = /^#(\w+)([^]*)/.exec(text) ?? [];
  if (text.startsWith(":~") || directive === "maximize") return says.directives.minimize;
  if (says.directives[directive]) return says.directives[directive];
  if (directive === "program") {
    const name = words.replace(/\.$/, "").trim();
    const hint = meant(name, programs) || `: there are ${programs.slice(0, 2).join(" and ")}, and base for both`;
    return ["base", ...programs].includes(name) ? "" : `#program ${name} is part of no layout${hint}`;
  }
  if (directive && !["const", "defined", "count", "sum", "sum+", "min", "max", "true", "false"].includes(directive))
    return `a grammar holds rules: leave #${directive} out`;
  const head = rule(text)?.head ?? "";
  if (head.startsWith("&")) return says.directives.theory;
  const code = head.replace(/"(?:[^"\\]|\\.)*"/g, "");
  return /[{|]/.test(code) || [";", ":"].some((sign) => parted(code, sign).length > 1) || /^#(?!true|false)/.test(code) ? says.choice : "";
}

/** Why this grammar does not have a statement: it is the core's, or for the topology to say. */
function closed(text, file, { name, isOwn, table }, { says }) {
  const [, constant] = /^#const\s+([\w']+)/.exec(text) ?? [];
  if (table.defined.includes(constant)) return `${constant} comes from the request: leave #const ${constant} out`;
  if (table.constants.includes(constant)) return `${constant} is a word of the core: choose another name`;
  const head = atomOf(rule(text)?.head ?? "");
  if (!head) return "";
  const filled = (said) => said.replace("{name}", head.signature).replace("{topology}", name).replace("{topology}", name);
  if (table.stated.includes(head.signature) && !(isOwn && file === `${name}.lp`)) return filled(isOwn ? says.moved : says.elsewhere);
  if (table.closed[head.signature]) return table.closed[head.signature];
  if (!["option/3", "picks/2"].includes(head.signature)) return "";
  const choice = atomOf(head.args[0]);
  if (!choice) return says.unnamed;
  const known = choice.signature.replace(/\/0$/, "");
  return table.choices.includes(choice.signature) ? says.taken.replace("{name}", known) : "";
}

/** A choice that is picked, or given a turn, and that nobody offers. */
function unknownChoice(own, all, { table }) {
  const offered = all.flatMap(({ text }) => {
    const head = atomOf(rule(text)?.head ?? "");
    return head?.signature === "option/3" ? [head.args[0]] : [];
  });
  const names = new Set(table.choices.map((each) => each.split("/")[0]));
  for (const each of offered) names.add(/^[a-z]\w*/.exec(each)?.[0]);
  for (const file of own) {
    const code = blank(file.text);
    for (const { 1: name, index, ...found } of code.matchAll(/\b(?:picks?|turn)\(\s*([a-z]\w*)/g)) {
      if (names.has(name)) continue;
      const atom = `${code.slice(index).match(/^\w+\((?:[^()]|\((?:[^()]|\([^()]*\))*\))*\)/)?.[0] ?? found[0]}`;
      return { why: `${atom}: no option/3 has this name${meant(name, names)}`, file: file.name, ...placeOf(code, index) };
    }
  }
  return null;
}

/** A line of a topology's that stands once, and is named nearly as another one is: of those that have arguments. */
function misspeltLine(all) {
  const uses = new Map([["outline", []]]);
  for (const { text, ...place } of all) {
    const head = atomOf(rule(text)?.head ?? "");
    if (head?.signature !== "edge/3") continue;
    for (const [name] of head.args[2].matchAll(/\b[a-z]\w*(?=\()/g)) uses.set(name, [...(uses.get(name) ?? []), place]);
  }
  for (const [name, places] of uses) {
    const others = [...uses.keys()].filter((each) => each !== name);
    const near = name === "outline" || places.length !== 1 ? "" : closest(name, others);
    if (near) return { ...places[0], why: `${name} is a line that occurs nowhere else: did you mean ${near}?` };
  }
  return null;
}

/** A name that no other statement names, or no fact or head: { why, isNear, file, line, column }. `lengths`: texts of the .pl files. */
export function misspeltName(own, lengths, { table }) {
  const all = own.flatMap((file) => [...statements(file)]);
  const heads = all.map(({ text }) => rule(text)?.head ?? "");
  const stated = new Set(heads.flatMap((head) => [...head.matchAll(CONSTANT)].map(([name]) => name)));
  const defined = all.flatMap(({ text }) => /^#const\s+([\w']+)/.exec(text)?.[1] ?? []);
  const atoms = [...table.known, ...heads.flatMap((head) => atomOf(head)?.signature ?? [])];
  const apart = heads.map(atomOf).filter((head) => head && ["option/3", "topology/1"].includes(head.signature))
    .map(({ args, signature }) => args[signature === "option/3" ? 1 : 0]);
  const sized = lengths.flatMap((text) => [...text.matchAll(/^\s*\w+\(\s*([a-z]\w*)/gm)].map(([, name]) => name));
  const words = apart.flatMap((text) => text.match(/[\w']+/g) ?? []);
  const elsewhere = new Set([...table.constants, ...table.defined, ...sized, ...words]);
  const borrowed = new Set(own.filter(({ isShipped }) => isShipped).map(({ name }) => name));
  const lines = new Set(heads.flatMap((head) => (atomOf(head)?.signature === "edge/3" ? atomOf(head).args[2].match(/\b[a-z]\w*/g) ?? [] : [])));
  // A value in a table of the grammar's own, such as zone(kitchen,loud).
  const tables = heads.map(atomOf).filter((head) => head && !table.known.includes(head.signature));
  const others = new Set([...elsewhere, ...stated, ...defined]);
  const uses = new Map();
  for (const file of own) {
    const code = blank(file.text).replace(/#(?:program|const|defined)\b[^.]*\./g, (part) => part.replace(/[^\n]/g, " "));
    for (const { 0: name, index } of code.matchAll(CONSTANT)) {
      if (name === "not" || elsewhere.has(name) || defined.includes(name) || atoms.includes(`${name}/0`)) continue;
      uses.set(name, [...(uses.get(name) ?? []), { file: file.name, ...placeOf(code, index) }]);
    }
  }
  for (const [name, places] of uses) {
    const near = meant(name, [...others].filter((each) => each !== name));
    if (borrowed.has(places[0].file)) continue; // The grammar may lack what a shipped file names.
    const isOnce = places.length === 1;
    if ((lines.has(name) && !near) || (isOnce && tables.some(({ args }) => args.some((each) => new RegExp(`\\b${name}\\b`).test(each))))) continue;
    if (isOnce || !stated.has(name)) return { ...places[0], isNear: near !== "", why: `${name} ${isOnce ? "occurs nowhere else" : "stands in no fact or head"}${near}` };
  }
  return null;
}

/** A word that is no predicate's, function's or variable's. */
const CONSTANT = /(?<![\w'#])[a-z][\w']*(?![\w']|\s*\()/g;

/** The first number that clingo reads as another one. */
function tooLarge(own, { greatest }) {
  for (const file of own) {
    const code = blank(file.text);
    for (const { 1: sign, 2: number, 0: text, index } of code.matchAll(/((?<![\w)])-\s*)?(?<![\w'])(0x[0-9a-fA-F]+|0o[0-7]+|0b[01]+|\d+)(?![\w'])/g))
      if (BigInt(number) > BigInt(greatest) + (sign ? 1n : 0n))
        return { why: `${number}: a whole number is ${greatest} at most`, file: file.name, ...placeOf(code, index + text.length - number.length) };
  }
  return null;
}

/** A file's text with blanks in the place of comments and strings. */
export const blank = (text) => text.replace(/"(?:[^"\\]|\\.)*"|%\*[^]*?\*%|%[^\n]*/g, (part) => part.replace(/[^\n]/g, " "));

/** The line and the column at a place in a text. */
export function placeOf(text, index) {
  const before = text.slice(0, index).split("\n");
  return { line: before.length, column: before.at(-1).length + 1 };
}

/** The first predicate that nothing derives, { why, file, line, column }, or that nothing uses; null where there is none.
 * `without`: what clingo says of atoms without a rule, { text, file, line, column } each, in some programs of a layout. */
export function unknownPredicate(own, { table }, without) {
  const all = own.flatMap((file) => [...statements(file)]);
  const heads = all.flatMap(({ text, ...place }) => ({ ...atomOf(rule(text)?.head ?? ""), ...place })).filter(({ signature }) => signature);
  const known = [...table.known, ...heads.map(({ signature }) => signature)];
  for (const { text, ...place } of without) {
    const { signature } = atomOf(text.replace(/^.*?: */, "")) ?? {};
    if (signature && !known.includes(signature)) return { ...place, why: `nothing derives ${signature}${like(signature, known, table)}` };
  }
  for (const { name, signature, ...place } of heads) {
    const isUsed = all.some(({ text }) => new RegExp(`\\b${name}\\b`).test(rule(text)?.body ?? ""));
    if (!isUsed && !table.known.includes(signature))
      return { ...place, why: `nothing uses ${signature}${like(signature, table.inputs, table)}` };
  }
  return null;
}

/** The predicate that was meant: of this name or the most similar one, with as many arguments if it can be. */
function like(signature, known, { documented }) {
  const [name, arity] = signature.split("/");
  const others = [...new Set(known)].filter((each) => each !== signature);
  const names = new Set(others.map((each) => each.split("/")[0]));
  const close = names.has(name) ? name : closest(name, names);
  const rank = (each) => `${each.split("/")[1] !== arity} ${!documented.includes(each)} ${each}`;
  const [near] = others.filter((each) => each.split("/")[0] === close).sort((a, b) => (rank(a) < rank(b) ? -1 : 1));
  return near ? `: did you mean ${near}?` : "";
}
