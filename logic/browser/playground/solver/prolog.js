/** Stage 2 in SWI-Prolog for WebAssembly: predicates of the core, called with terms, answer in JSON. */

export class Prolog {
  /** `swipl` is what swipl-wasm's factory gives; `core` the .pl files of the core by path. */
  constructor(swipl, core, json) {
    this.swipl = swipl;
    swipl.FS.mkdirTree("/swipl/library/http");
    swipl.FS.writeFile("/swipl/library/http/json.pl", json);
    this.write("/rules", core);
    this.query("use_module('/rules/core.pl')");
  }

  /** Write files, by name, into a directory. */
  write(directory, files) {
    for (const [name, text] of Object.entries(files)) {
      const file = `${directory}/${name}`;
      this.swipl.FS.mkdirTree(file.slice(0, file.lastIndexOf("/")));
      this.swipl.FS.writeFile(file, text);
    }
  }

  /** What a predicate of the core answers in its last argument; the others are texts of terms. */
  ask(predicate, ...args) {
    const names = args.map((_, place) => `A${place}`);
    const call = `core:${predicate}(${[...names, "Answer"].join(",")}), string_concat(Answer, "", Json)`;
    const read = args.length ? `term_string(args(${names.join(",")}), Text), ` : "";
    return JSON.parse(this.query(read + call, { Text: `args(${args.join(",")})` }).Json.v);
  }

  query(goal, bindings = {}) {
    const answer = this.swipl.prolog.query(goal, bindings).once();
    if (answer.error) throw new Error(`SWI-Prolog: ${answer.message}`);
    if (!answer.success) throw new Error(`SWI-Prolog has no answer to ${goal}`);
    return answer;
  }
}
