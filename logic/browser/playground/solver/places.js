/** Which rules of the user's a ground atom comes from. As `places` of logic/language/asp/facts.py. */

import { atomOf, parted, rule, statements } from "./statements.js";
import { termText } from "./terms.js";

/** The statements, in the order of the files, whose heads name the atom, or else those that may derive it. */
export function placesOf(atom, files) {
  const wanted = atom.args.map(termText);
  const heads = files.flatMap((file) => [...statements(file)])
    .map((each) => ({ ...each, ...rule(each.text) })).filter(({ head }) => atomOf(head ?? "")?.name === atom.name);
  const named = heads.filter(({ head }) => wanted.every((each) => names(each, head)));
  const inPlace = named.filter(({ head }) => {
    const { args } = atomOf(head);
    return args.length === wanted.length && args.every((each, place) => names(wanted[place], each));
  });
  const rules = heads.filter(({ body }) => body);
  const possible = rules.filter(({ head }) => mayBe(head, atom, new Map()));
  return [inPlace, named, possible, rules].find((some) => some.length) ?? heads;
}

const names = (word, text) => new RegExp(`(?<!\\w)${word.replace(/[()]/g, "\\$&")}(?!\\w)`).test(text);

/** Whether a term with variables, of which some are bound, can be a value, by its form. */
function mayBe(text, value, bound) {
  if (/^_*[A-Z]\w*$|^_$/.test(text)) {
    if (text !== "_" && !bound.has(text)) bound.set(text, termText(value));
    return text === "_" || bound.get(text) === termText(value);
  }
  const pool = parted(/^\(([^]*)\)$/.exec(text)?.[1] ?? text, ";");
  if (pool.length > 1) return pool.some((each) => mayBe(each.trim(), value, new Map(bound)));
  if (/^-?\d+$|^"/.test(text)) return text === termText(value);
  const term = atomOf(text);
  if (!term || typeof value === "number") return typeof value === "number" && !term?.args.length;
  const alike = term.name === value.name && term.args.length === value.args.length;
  return alike && term.args.every((each, place) => mayBe(each, value.args[place], bound));
}
