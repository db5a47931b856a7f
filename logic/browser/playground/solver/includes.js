/** Rule files that others include. As logic/includes.py, whose patterns and words are in rules.json. */

import { RuleError } from "./program.js";
import { closest } from "./spelling.js";

/** The files of one ending, those of shipped grammars first, each after those that it includes: [{ name, written, text }], where
 * solvers read `text`; `isShipped` if it is of a shipped grammar. */
export function withIncluded(files, ending, { includes: { lines, examples }, shipped, says }) {
  const pattern = new RegExp(lines[ending]), found = [], places = new Map();

  function follow(name, written, above) {
    const rows = written.split("\n"), path = [...above, name];
    let height = 0;
    for (const [number, row] of rows.entries()) {
      const [all, sign, file] = pattern.exec(row) ?? [];
      if (all === undefined) break;
      if (!sign) continue;
      height = number + 1;
      const wrong = (what, parts = {}) => {
        const said = { file, suffix: ending, example: examples[ending], ...parts };
        return new RuleError(says.includes[what].replace(/\{(\w+)\}/g, (_, part) => said[part]), name, height, row.indexOf(sign) + 1);
      };
      const other = resolved(name, file, wrong);
      if (path.includes(other)) {
        const way = path.slice(path.indexOf(other) + 1).join(", ");
        throw wrong("circle", { file: other, way: way && ` by way of ${way}` });
      }
      if (places.has(other)) throw wrong("twice", { file: other, place: places.get(other) });
      if (other in files) throw wrong("anyway", { file: other });
      places.set(other, `${name}:${height}`);
      follow(other, shipped[other], path);
    }
    found.push({ name, written, isShipped: !(name in files), text: "\n".repeat(height) + rows.slice(height).join("\n") });
  }

  /** The file that is meant: beside the one that includes it, or else one of a shipped grammar. */
  function resolved(name, file, wrong) {
    if (file.startsWith("/") || file.split("/").includes("..")) throw wrong("outside");
    if (!file.endsWith(ending) && Object.keys(examples).some((other) => file.endsWith(other))) throw wrong("kind");
    const beside = name.slice(0, name.lastIndexOf("/") + 1) + file;
    const other = [beside, file].find((each) => each.endsWith(ending) && (each in files || each in shipped));
    if (other) return other;
    const near = closest(file, Object.keys(shipped).filter((each) => each.endsWith(ending)));
    throw wrong("absent", { hint: near ? `did you mean ${near}?` : "neither beside this file nor in a shipped grammar" });
  }

  for (const name of Object.keys(files).filter((each) => each.endsWith(ending)).sort()) follow(name, files[name], []);
  return [...found.filter(({ name }) => !(name in files)), ...found.filter(({ name }) => name in files)];
}
