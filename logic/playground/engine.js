// The engine of the playground: clingo and SWI-Prolog in a worker of this page. See page.js for what each member does.

import { element } from "./dom.js";

const LIMIT = 30; // seconds for a house, or a proof that there is none
const LATE = `The solvers have worked on one answer for ${LIMIT} s and are ended: does a rule recur without end? Else take
fewer rooms, another seed, or Vitruvius on your machine.`;

let worker = null;
let last = 0;
let asked = null; // { id, onPart, resolve, reject, timer }, the open question
let bundle = null;
let grammar = "";
let files = {};
let version = 0;
let tell = () => {};
const houses = [];
let warnings = [];

export const engine = {
  editable: true,
  why: null,

  async open(onRules, onLost) {
    if (typeof WebAssembly !== "object" || typeof Worker !== "function")
      return onLost("This browser has no WebAssembly, in which the solvers run: take a newer one, or install Vitruvius.");
    tell = onLost;
    try {
      bundle = await (await fetch("rules.json")).json();
    } catch (error) {
      return onLost(`The rules cannot be read (${error.message}): serve this folder, as vitruvius playground does.`);
    }
    controls(onRules);
    onLost("Loading the solvers, 7 MB.");
    take(new URLSearchParams(location.search).get("grammar") ?? "family", onRules);
  },

  write: (() => {
    let waiting = 0;
    return (name, text) => {
      files[name] = text;
      const saved = Date.now();
      clearTimeout(waiting);
      waiting = setTimeout(() => engine.changed(saved), 300);
    };
  })(),

  async sheet(wanted, request, onPart) {
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
function take(name, onRules) {
  grammar = bundle.grammars[name] ? name : "family";
  files = { ...bundle.grammars[grammar], ...JSON.parse(localStorage.getItem(kept()) ?? "{}") };
  document.getElementById("shipped").value = grammar;
  engine.changed = (saved) => {
    const changes = Object.entries(files).filter(([file, text]) => text !== bundle.grammars[grammar][file]);
    if (changes.length) localStorage.setItem(kept(), JSON.stringify(Object.fromEntries(changes)));
    else localStorage.removeItem(kept());
    document.getElementById("undo").disabled = !changes.length;
    onRules({
      version: ++version, saved, grammar: changes.length ? `${grammar}-edited` : grammar,
      files: Object.entries(files).map(([file, text]) => ({ name: file, text })),
    });
  };
  engine.changed(Date.now());
}

/** Where the browser keeps what is changed of a grammar. */
const kept = () => `vitruvius ${grammar} ${bundle.version}`;

/** A question to the worker; a newer one ends it. */
function ask(question, onPart) {
  stop();
  worker ??= started();
  return new Promise((resolve, reject) => {
    asked = { id: ++last, onPart, resolve, reject, timer: 0 };
    document.getElementById("stop").disabled = false;
    worker.postMessage({ id: last, ...question });
  });
}

/** Nobody waits for the open question any more; the worker sees a newer one, or ends. */
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
    else asked.timer = setTimeout(() => end(LATE), 1000 * LIMIT);
  };
  return begun;
}

/** What this page has beside that of a folder of rules: whose rules to begin with, a way to stop, the houses as a file. */
function controls(onRules) {
  const shipped = element("select", { id: "shipped", onchange: () => take(shipped.value, onRules) },
    ...Object.keys(bundle.grammars).map((name) => element("option", { value: name }, name)));
  const undo = element("button", { type: "button", id: "undo", onclick: () => {
    localStorage.removeItem(kept());
    take(grammar, onRules);
  } }, "As shipped");
  const halt = element("button", { type: "button", id: "stop", disabled: true, onclick: () => end("Stopped.") }, "Stop");
  const keep = element("button", { type: "button", id: "keep", onclick: download }, "Houses as a file");
  document.getElementById("grammar").before(element("label", {}, "Rules of ", shipped), undo, halt, keep);
  document.getElementById("grammar").hidden = true;
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
