/** The statements of .lp files, and what a grammar may not state: what logic/language/audit.py and vocabulary.py say of it. */

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

/** Why a grammar may not have a statement; empty where it may. */
export function objection(text) {
  const [, directive] = /^#(\w+)/.exec(text) ?? [];
  if (["minimize", "maximize"].includes(directive) || text.startsWith(":~"))
    return "layouts are sampled, not optimised: use weight/2 or a constraint";
  if (directive === "include") return "all .lp files of the grammar are read: leave #include out";
  if (directive && !["program", "const", "defined", "count", "sum", "min", "max", "true", "false"].includes(directive))
    return `a grammar holds rules, and the core alone shows what makes a layout: leave #${directive} out`;
  const head = rule(text)?.head ?? "";
  if (head.startsWith("&")) return "a grammar holds rules without theories";
  if (/[{|]/.test(head.replace(/"(?:[^"\\]|\\.)*"/g, "")))
    return "a choice is made by option/3, as in option(colour,(red;blue),1): see rules/pick.lp";
  return "";
}

/** The names that the heads of these files have, or that they declare. */
export function derivedNames(files) {
  const found = new Set();
  for (const file of files)
    for (const { text } of statements(file)) {
      const head = rule(text)?.head ?? (/^#(defined|program)\b/.test(text) ? text : "");
      for (const [name] of head.matchAll(/\b[a-z_]\w*/g)) found.add(name);
    }
  return found;
}

/** The names of atoms in the bodies of a file's rules, { name, file, line, column } each: words before a bracket that are no
 * terms, since they begin a literal. */
export function usedNames(file) {
  const lines = file.text.split("\n");
  return [...statements(file)].flatMap(({ text, line }) => {
    const body = (rule(text)?.body ?? "").replace(/"(?:[^"\\]|\\.)*"/g, "");
    const found = [];
    let depth = 0;
    for (const part of body.matchAll(/[()]|(?<=(?:^|[,;:{]|\bnot)\s*)[a-z_]\w*(?=\()/g))
      if (part[0] === "(") depth++;
      else if (part[0] === ")") depth--;
      else if (depth === 0) found.push(part[0]);
    return found.map((name) => {
      const row = lines.findIndex((each, index) => index >= line - 1 && new RegExp(`\\b${name}\\(`).test(each));
      return { name, file: file.name, line: row + 1, column: lines[row].search(new RegExp(`\\b${name}\\(`)) + 1 };
    });
  });
}

/** The name that is meant by a misspelt one: at most a third of its letters are other ones. Of two as near, the one that begins alike. */
export function closest(name, names) {
  const distances = [...names].map((other) => [distance(name, other) + (name[0] === other[0] ? 0 : 0.5), other]).sort(([a], [b]) => a - b);
  const [[least, meant] = [Infinity, ""]] = distances;
  return least <= Math.max(1, name.length / 3) ? meant : "";
}

/** How many letters are put in, left out or changed (Levenshtein), or swapped with the next one. */
function distance(one, other) {
  const rows = [[...other, ""].map((_, column) => column)];
  for (let i = 1; i <= one.length; i++) {
    rows[i] = [i];
    for (let j = 1; j <= other.length; j++) {
      const changed = rows[i - 1][j - 1] + (one[i - 1] !== other[j - 1]);
      rows[i][j] = Math.min(rows[i - 1][j] + 1, rows[i][j - 1] + 1, changed);
      if (i > 1 && j > 1 && one[i - 1] === other[j - 2] && one[i - 2] === other[j - 1])
        rows[i][j] = Math.min(rows[i][j], rows[i - 2][j - 2] + 1);
    }
  }
  return rows[one.length][other.length];
}
