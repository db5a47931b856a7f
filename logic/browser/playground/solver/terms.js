/** Terms of clingo: a number, or { name, args }, where a string is { string } and a tuple has no name. */

/** Parse a term as clingo prints it. */
export function parseTerm(text) {
  let place = 0;
  const args = () => {
    const found = [];
    place++;
    while (text[place] !== ")") {
      found.push(term());
      if (text[place] === ",") place++;
    }
    place++;
    return found;
  };
  const term = () => {
    const token = /-?\d+|"(?:[^"\\]|\\.)*"|-?[_']*[A-Za-z][\w']*|#(?:inf|sup)|/y;
    token.lastIndex = place;
    const [word] = token.exec(text);
    place += word.length;
    if (/^-?\d/.test(word)) return Number(word);
    if (word[0] === '"') return { string: word };
    return { name: word, args: text[place] === "(" ? args() : [] };
  };
  return term();
}

/** The text of a term, as clingo prints it. */
export function termText(term) {
  if (typeof term === "number") return String(term);
  if (term.string) return term.string;
  const comma = term.name === "" && term.args.length === 1 ? "," : "";
  return term.name + (term.args.length || !term.name ? `(${term.args.map(termText).join(",")}${comma})` : "");
}

const quoted = (name) => `'${name.replace(/[\\']/g, "\\$&")}'`;

/** The same term as Prolog reads it; what Prolog has no term for is an atom of its text. */
export function prologText(term) {
  if (typeof term === "number") return String(term);
  if (term.string || !term.name || !term.args.length || term.name[0] === "-") return quoted(termText(term));
  return `${quoted(term.name)}(${term.args.map(prologText).join(",")})`;
}

/** A compound term of Prolog: its arguments are texts, numbers, or lists of these. */
export const compound = (name, ...args) => `${quoted(name)}(${args.map(argument).join(",")})`;
export const atom = quoted;
/** A number that Prolog reads as a real one. */
export const real = (value) => (Number.isInteger(value) ? `${value}.0` : String(value).replace(/^(-?\d+)e/, "$1.0e"));
export const list = (values) => `[${values.map(argument).join(",")}]`;
const argument = (value) => (Array.isArray(value) ? list(value) : String(value));

/** A value as a Lua expression: numbers, booleans, texts, lists and plain objects. */
export function luaText(value) {
  if (Array.isArray(value)) return `{${value.map(luaText).join(",")}}`;
  if (value && typeof value === "object")
    return `{${Object.entries(value).map(([key, each]) => `${key}=${luaText(each)}`).join(",")}}`;
  return typeof value === "string" ? JSON.stringify(value).replace(/\\u([0-9a-f]{4})/g, "\\u{$1}") : String(value);
}
