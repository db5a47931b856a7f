/** The statements of .lp files, read as text. */

/** The statements of a file: { text, file, line, column }, comments left out of the text. */
export function* statements({ name: file, text }) {
  const token = /%\*[^]*?\*%|%[^\n]*|"(?:[^"\\]|\\.)*"|\.\.|\.|\s+|[^]/g;
  let begin = -1, source = "";
  for (const found of text.matchAll(token)) {
    const [part] = found;
    const blank = part[0] === "%" || /^\s/.test(part);
    if (begin < 0 && blank) continue;
    if (begin < 0) begin = found.index;
    source += blank ? " " : part;
    if (part === ".") {
      const before = text.slice(0, begin).split("\n");
      yield { text: source.replace(/ +/g, " "), file, line: before.length, column: before.at(-1).length + 1 };
      begin = -1;
      source = "";
    }
  }
}

/** Head and body of a rule, without the full stop; null for a directive. */
export function rule(text) {
  if (text[0] === "#" && !/^#(count|sum|min|max|true|false)\b/.test(text)) return null;
  const parts = /^((?:"(?:[^"\\]|\\.)*"|[^"])*?)(?::-([^]*))?\.$/.exec(text);
  return { head: parts[1].trim(), body: (parts[2] ?? "").trim() };
}

/** The parts of a text between these signs, those in brackets and in strings left alone. */
export function parted(text, sign) {
  const found = [""];
  let depth = 0;
  for (const [part] of text.matchAll(/"(?:[^"\\]|\\.)*"|[^]/g)) {
    depth += "([{".includes(part) - ")]}".includes(part);
    if (part === sign && depth === 0) found.push("");
    else found[found.length - 1] += part;
  }
  return found;
}

/** An atom, or all in a pool as lit(hall;study), as { name, args, signature }, as that of the first; null for anything else. */
export function atomOf(head) {
  const [, name, , within] = /^-?([a-z_][\w']*)\s*(\(([^]*)\))?$/.exec(head) ?? [];
  if (!name || (within !== undefined && parted(`${within})`, "\0").length > 1)) return null;
  const args = within === undefined ? [] : parted(parted(within, ";")[0], ",").map((each) => each.trim());
  return { name, args, signature: `${name}/${args.length}` };
}
