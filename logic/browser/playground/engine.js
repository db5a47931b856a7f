// The engine of the playground: clingo and SWI-Prolog in a worker of this page. See page.js for what each member does.

import { address, note } from "./address.js";
import { element } from "./dom.js";
import { deflated, inflated, zip } from "./packing.js";

const FIRST = "home"; // the grammar where the address names none
const OPENED = "sizes.pl"; // the file that is shown first: a number changed there changes the houses at once
const TYPING = 300; // milliseconds without a key, after which the rules are read
const GRACE = 3000; // milliseconds that the solvers have to leave an older question
const LIMIT = 30_000; // milliseconds for a house, or for a proof that there is none
const LATE = `The solvers were stopped after ${LIMIT / 1000} s on one answer: does a rule recur without end? Otherwise use `
  + "fewer rooms, another seed, or Vitruvius on your machine.";

const GONE = "The solvers cannot be loaded: the server of this page has stopped, or there is no network. Run vitruvius playground "
  + "again, and open the address that it prints.";

let bundle = null; // rules.json
let grammar = ""; // the shipped one that the rules come from
let files = {};
let version = 0;
let changes = () => {}; // where the page takes rules
let tell = () => {}; // where it takes a line
let typing = 0;
let isLoading = false;

let worker = null;
let asked = null; // { id, question, onPart, resolve, reject, timer }, the open question
let last = 0;
let warnings = [];
const houses = [];

export const engine = {
  editable: true,
  briefs: false,
  why: null,

  async open(onRules, onLost, onStatus) {
    [changes, tell] = [onRules, onStatus];
    if (typeof WebAssembly !== "object" || typeof Worker !== "function")
      return onLost("The solvers need WebAssembly, which this browser lacks: use a newer one, or install Vitruvius.");
    try {
      bundle = await (await fetch("rules.json")).json();
    } catch (error) {
      return onLost(`The rules cannot be read (${error.message}): serve this folder, as vitruvius playground does.`);
    }
    controls();
    const { grammar: named, edits } = await said();
    if (edits) begin(named, edits, null);
    else take(named, null);
  },

  write(name, text) {
    files[name] = text;
    clearTimeout(typing);
    typing = setTimeout(() => {
      keep();
      changed(`edit ${name}`);
    }, TYPING);
  },

  async travel() {
    if (!bundle) return false;
    clearTimeout(typing);
    const { grammar: named, edits } = await said();
    if (named === grammar && same(edits ?? {}, edited())) return false;
    begin(named, edits ?? {}, null);
    return true;
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

/** What the address says of the rules: a grammar, and the files that are changed of it, if it says so. */
async function said() {
  const says = address();
  const named = says.get("grammar") ?? new URLSearchParams(location.search).get("grammar") ?? FIRST;
  const grammar = bundle.grammars[named] ? named : FIRST;
  if (!says.has("edits")) return { grammar, edits: says.has("grammar") ? {} : null };
  try {
    const edits = JSON.parse(await inflated(says.get("edits")));
    const known = Object.entries(edits).filter(([file, text]) => file in bundle.grammars[grammar] && typeof text === "string");
    return { grammar, edits: Object.fromEntries(known) };
  } catch {
    tell("The changed rules in this address are damaged: the rules are as shipped.");
    return { grammar, edits: {} };
  }
}

/** Begin with the rules of a shipped grammar, as they were last changed in this browser. */
function take(name, gesture) {
  let edits = {};
  try {
    edits = JSON.parse(localStorage.getItem(kept(name)) ?? "{}");
  } catch {
    // Whatever else stands there, or no storage at all.
  }
  begin(name, edits, gesture);
}

/** Begin with the rules of a shipped grammar and these changes of its files. */
function begin(name, edits, gesture = `grammar ${version}`) {
  clearTimeout(typing);
  grammar = name;
  files = { ...bundle.grammars[grammar], ...edits };
  document.getElementById("shipped").value = grammar;
  changed(gesture);
}

/** Where the browser keeps what is changed of a grammar. */
const kept = (name) => `vitruvius ${bundle.version} ${name}`;

/** The files that are not as shipped. */
const edited = () => Object.fromEntries(
  Object.entries(files).filter(([file, text]) => text !== bundle.grammars[grammar][file]));

const same = (one, other) => JSON.stringify(one) === JSON.stringify(other);

/** Keep what the user has changed for the next visit. */
function keep() {
  try {
    if (isEdited()) localStorage.setItem(kept(grammar), JSON.stringify(edited()));
    else localStorage.removeItem(kept(grammar));
  } catch {
    // A browser that stores nothing: the address holds it all.
  }
}

const isEdited = () => Object.keys(edited()).length > 0;

/** Tell the page of the rules, and note them in the address: see `note` for the gesture. */
async function changed(gesture) {
  const now = ++version;
  for (const id of ["undo", "zip"]) document.getElementById(id).disabled = !isEdited();
  changes({
    version,
    grammar: isEdited() ? `${grammar}-edited` : grammar,
    first: OPENED,
    before: isEdited() ? "These rules are changed: press “Rules as a zip”, unpack the file, and beside it run" : "",
    files: Object.entries(files).map(([name, text]) => ({ name, text })),
  });
  const edits = isEdited() ? await deflated(JSON.stringify(edited())) : null;
  if (now === version) note({ grammar, edits }, gesture);
}

/** A question to the worker; a newer one ends it. Where the worker does not leave an older one, another takes its place. */
function ask(question, onPart) {
  const busy = asked !== null;
  stop();
  return new Promise((resolve, reject) => {
    asked = { id: ++last, question, onPart, resolve, reject, timer: 0 };
    if (busy) asked.timer = setTimeout(put, GRACE, true);
    document.getElementById("stop").disabled = false;
    put(false);
  });
}

/** Put the open question to the worker, or to a new one. */
function put(anew) {
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
  isLoading = true;
  begun.onerror = (event) => end(event.message ? `The solvers cannot be started: ${event.message}.` : GONE);
  begun.onmessage = ({ data: { id, part, done, error, loaded, unloaded } }) => {
    if (unloaded) return end(`${GONE} (${unloaded})`);
    if (loaded) return tell(loading(loaded));
    if (isLoading) tell("Drawing.");
    isLoading = false;
    if (asked?.id !== id) return;
    clearTimeout(asked.timer);
    if (part) asked.onPart(part);
    if (done) stop();
    else if (error) stop(new Error(error));
    else asked.timer = setTimeout(end, LIMIT, LATE);
  };
  return begun;
}

/** How far the solvers are loaded, in words. */
function loading(bytes) {
  const all = Object.values(bundle.bytes).reduce((sum, each) => sum + each);
  const megabytes = (number) => (number / 1e6).toFixed(1);
  return bytes < all ? `Loading the solvers: ${megabytes(bytes)} of ${megabytes(all)} MB.` : "Starting the solvers.";
}

/** What this page has beside that of a folder of rules: whose rules to begin with, a way to stop, files to keep. */
function controls() {
  const button = (id, text, onclick) => element("button", { type: "button", id, onclick }, text);
  const shipped = element("select", { id: "shipped", onchange: () => take(shipped.value) },
    ...Object.keys(bundle.grammars).map((name) => element("option", { value: name }, name)));
  const undo = button("undo", "As shipped", () => {
    files = { ...bundle.grammars[grammar] };
    keep();
    begin(grammar, {});
  });
  const halt = button("stop", "Stop", () => end("Stopped."));
  document.getElementById("grammar").hidden = true;
  document.getElementById("grammar").before(
    element("label", {}, "Rules of ", shipped), undo, halt,
    button("keep", "Houses as a file", keepHouses), button("zip", "Rules as a zip", keepRules));
}

/** The houses of the sheet, as `vitruvius check` and `load` read them. */
function keepHouses() {
  const made = houses.filter(Boolean);
  if (!made.length) return tell("There is no house to save.");
  download("houses.jsonl", "application/jsonl", made.map((house) => `${JSON.stringify(house)}\n`));
}

/** The folder of rules as it is here, as `--grammar` takes it once it is unpacked. */
function keepRules() {
  const all = { ...bundle.others[grammar], ...files };
  const entries = Object.entries(all).map(([name, text]) => [`${grammar}-edited/${name}`, text]);
  download(`${grammar}-edited.zip`, "application/zip", [zip(entries)]);
}

function download(name, type, parts) {
  const url = URL.createObjectURL(new Blob(parts, { type }));
  element("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
}
