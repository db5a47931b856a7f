// The engine of the playground: clingo and SWI-Prolog in a worker of this page. See page.js for what each member does.

import { element } from "./dom.js";

const FIRST = "home"; // the grammar where the address names none
const TYPING = 300; // milliseconds without a key, after which the rules are read
const GRACE = 3000; // milliseconds that the solvers have to leave an older question
const LIMIT = 30_000; // milliseconds for a house, or for a proof that there is none
const LATE = `The solvers have worked on one answer for ${LIMIT / 1000} s and are ended: does a rule recur without end? Else take `
  + "fewer rooms, another seed, or Vitruvius on your machine.";

let bundle = null; // rules.json
let grammar = ""; // the shipped one that the rules come from
let files = {};
let version = 0;
let changes = () => {}; // where the page takes rules
let tell = () => {}; // where it takes a line
let typing = 0;

let worker = null;
let asked = null; // { id, question, onPart, resolve, reject, timer }, the open question
let last = 0;
let warnings = [];
const houses = [];

export const engine = {
  editable: true,
  why: null,

  async open(onRules, onLost) {
    [changes, tell] = [onRules, onLost];
    if (typeof WebAssembly !== "object" || typeof Worker !== "function")
      return tell("This browser has no WebAssembly, in which the solvers run: take a newer one, or install Vitruvius.");
    try {
      bundle = await (await fetch("rules.json")).json();
    } catch (error) {
      return tell(`The rules cannot be read (${error.message}): serve this folder, as vitruvius playground does.`);
    }
    controls();
    tell("Loading the solvers, 7 MB.");
    take(new URLSearchParams(location.search).get("grammar") ?? FIRST);
  },

  write(name, text) {
    files[name] = text;
    const saved = Date.now();
    clearTimeout(typing);
    typing = setTimeout(() => changed(saved), TYPING);
  },

  async sheet(_, request, onPart) {
    houses.length = 0;
    await ask({ grammar, files, request }, (part) => {
      if (part.house) houses[part.index] = part.house;
      warnings = part.warnings ?? warnings;
      onPart(part);
    });
  },

  async lint() {
    return warnings;
  },
};

/** Begin with the rules of a shipped grammar, as they were last changed in this browser. */
function take(name) {
  clearTimeout(typing);
  grammar = bundle.grammars[name] ? name : FIRST;
  files = { ...bundle.grammars[grammar], ...JSON.parse(localStorage.getItem(kept()) ?? "{}") };
  document.getElementById("shipped").value = grammar;
  changed(Date.now());
}

/** Where the browser keeps what is changed of a grammar. */
const kept = () => `vitruvius ${bundle.version} ${grammar}`;

/** Keep what is changed, and tell the page. */
function changed(saved) {
  const edited = Object.entries(files).filter(([file, text]) => text !== bundle.grammars[grammar][file]);
  if (edited.length) localStorage.setItem(kept(), JSON.stringify(Object.fromEntries(edited)));
  else localStorage.removeItem(kept());
  document.getElementById("undo").disabled = !edited.length;
  changes({
    version: ++version,
    saved,
    grammar: edited.length ? `${grammar}-edited` : grammar,
    files: Object.entries(files).map(([name, text]) => ({ name, text })),
  });
}

/** A question to the worker; a newer one ends it. Where the worker does not leave an older one, another takes its place. */
function ask(question, onPart) {
  const busy = asked !== null;
  stop();
  return new Promise((resolve, reject) => {
    asked = { id: ++last, question, onPart, resolve, reject, timer: 0 };
    if (busy) asked.timer = setTimeout(begin, GRACE, true);
    document.getElementById("stop").disabled = false;
    begin(false);
  });
}

/** Put the open question to the worker, or to a new one. */
function begin(anew) {
  if (anew) worker.terminate();
  if (anew || !worker) worker = started();
  worker.postMessage({ id: asked.id, ...asked.question });
}

/** Nobody waits for the open question any more. */
function stop(error) {
  if (!asked) return;
  const { resolve, reject, timer } = asked;
  asked = null;
  clearTimeout(timer);
  document.getElementById("stop").disabled = true;
  if (error) reject(error);
  else resolve();
}

/** End the solvers where they are: the next question starts others. */
function end(text) {
  worker?.terminate();
  worker = null;
  stop(new Error(text));
}

function started() {
  const begun = new Worker("worker.js");
  begun.onerror = (event) => end(`The solvers cannot be started: ${event.message ?? "worker.js cannot be read"}.`);
  begun.onmessage = ({ data: { id, part, done, error } }) => {
    if (asked?.id !== id) return;
    clearTimeout(asked.timer);
    if (part) asked.onPart(part);
    if (done) stop();
    else if (error) stop(new Error(error));
    else asked.timer = setTimeout(end, LIMIT, LATE);
  };
  return begun;
}

/** What this page has beside that of a folder of rules: whose rules to begin with, a way to stop, the houses as a file. */
function controls() {
  const button = (id, text, onclick) => element("button", { type: "button", id, onclick }, text);
  const shipped = element("select", { id: "shipped", onchange: () => take(shipped.value) },
    ...Object.keys(bundle.grammars).map((name) => element("option", { value: name }, name)));
  const undo = button("undo", "As shipped", () => {
    localStorage.removeItem(kept());
    take(grammar);
  });
  const halt = button("stop", "Stop", () => end("Stopped."));
  document.getElementById("grammar").hidden = true;
  document.getElementById("grammar").before(
    element("label", {}, "Rules of ", shipped), undo, halt, button("keep", "Houses as a file", download));
}

/** The houses of the sheet, as `vitruvius check` and `load` read them. */
function download() {
  const made = houses.filter(Boolean);
  if (!made.length) return tell("There is no house to keep.");
  const lines = made.map((house) => `${JSON.stringify(house)}\n`);
  const address = URL.createObjectURL(new Blob(lines, { type: "application/jsonl" }));
  element("a", { href: address, download: "houses.jsonl" }).click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}
