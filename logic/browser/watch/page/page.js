// The page of a grammar: rule files on the left, the houses that they make on the right.
//
// It asks an engine, which is the one thing that differs between `vitruvius watch` (engine.js here: a server
// on this machine) and a page that works by itself. An engine.js exports `engine`, an object of this shape:
//
//   editable: boolean               whether the page may change the rule files: it calls write() then
//   briefs: boolean                 whether it makes houses by a brief
//   open(onRules, onLost, onStatus) begin: call onRules(rules) now and after each change of a rule file,
//                                   onLost(text) when no more will come, with what the user can do about it, and
//                                   onStatus(text) of what the user may want to know
//   write(name, text)               a rule file has this text from now on; leads to onRules(rules)
//   travel(): Promise<boolean>      optional: the address is another one (Back, Forward): whether that leads to
//                                   onRules(rules)
//   sheet(version, request, onPart, signal): Promise<void>
//                                   make houses, and call onPart with each part of the answer as it is known
//   lint(version, signal): Promise<Finding[]>
//                                   mistakes in the rules of which sheet() says nothing
//   why(version, house, part, signal): Promise<Why> | null
//                                   why a part of a house is as it is; the member is null where it cannot say
//
// where
//
//   rules   = {version, grammar, files: [{name, text}], before?, first?}
//             version: a number, greater for each change; grammar: what --grammar takes, a name or a folder;
//             before: what the user does first where there is no such folder yet; first: the file to show first
//   request = {rooms, seed, count, types: {bedroom: 2, hall: [0, 1]}, furniture: {"bedroom.bed": [1, null]}, brief?}
//             a count is exact, or the least and the greatest number, null for no bound; brief: see docs/briefs.md
//   part    = {kinds: {types: {bedroom: ["bed", ...]}, most_rooms}}   comes first, where the rules are right
//           | {findings: Finding[]}                                 the rules are wrong: the whole answer
//           | {index, house, types, svg}   house `index`, from 0: what why() takes, its rooms' types by their
//                                      names ({R0: "bedroom"}), and its plan, whose groups have
//                                      data-part="R3.bed": the name by which why() is asked
//           | {index, problem}         why there is no house `index`
//   problem = {kind, message, reasons?, advice?}    kind Unsatisfiable: proved, so there is no house at all,
//             by reasons: [{text, file?, line?, column?}]; LimitReached; RequestError; ...
//   Finding = {severity: "error" | "warning", file, line, column, text}   line and column from 1
//   Why     = what `vitruvius explain HOUSES --why R3.bed --json` prints
//
// `file` is a file's name, as in rules.files; a file of the shared core begins with "rules/". A promise whose
// signal is aborted may do what it likes: the page takes no answer of it. An Error's message is shown as is.

import { engine } from "./engine.js";
import { onTravel } from "./address.js";
import { hideAnswer, initAnswer, showAnswer, showPart, showProof, showWhy } from "./answers.js";
import { initBrief, readBrief, readBriefAddress, showTypes } from "./brief.js";
import { byId, element } from "./dom.js";
import { initRequest, readAddress, readRequest, showCommand, showKinds } from "./request.js";
import { showFindings, showRules } from "./rules.js";
import { dropWaiting, firstHouse, initSheet, keepFirst, mark, setOutdated, showHouse, showProblem, showWaiting } from "./sheet.js";

/** Milliseconds after which it is said that an answer is on its way. */
const PATIENCE = 500;

let rules = null;
let linted = 0;
let linting = new AbortController();
let drawing = new AbortController();
let asking = new AbortController();
let patience = 0;

/** Other rules: what is shown of the old ones is out of date at once. */
function receive(newRules) {
  rules = newRules;
  linting.abort();
  byId("grammar").textContent = rules.grammar;
  showRules(rules.files, engine.editable ? engine.write : null, rules.first);
  redraw();
}

/** Ask for the sheet. A newer call ends this one, and nothing of it comes late. */
async function redraw() {
  if (!rules) return;
  const [request, brief] = [readRequest(), readBrief()];
  if (!request || brief === null) return refuse();
  if (brief) Object.assign(request, { rooms: brief.rooms.length, types: {}, furniture: {}, brief });
  clear();
  showWaiting(request.count);
  const { signal } = drawing;
  const { version, grammar, before } = rules;
  const asked = performance.now();
  showCommand(grammar, before, Boolean(brief));
  clearTimeout(patience);
  patience = setTimeout(() => signal.aborted || say("Drawing."), PATIENCE);
  let right = true;
  try {
    await engine.sheet(version, request, (part) => {
      if (!signal.aborted) right = receivePart(part, request) && right;
    }, signal);
  } catch (error) {
    right = false;
    if (!signal.aborted) say(error.message);
  }
  if (signal.aborted) return;
  clearTimeout(patience);
  if (!right) dropWaiting();
  byId("sheet").dataset.version = version;
  if (!right) return;
  keepFirst(request.count);
  const houses = request.count === 1 ? "1 house" : `${request.count} houses`;
  say(`${houses}, drawn in ${((performance.now() - asked) / 1000).toFixed(2)} s.`);
  lint(version);
}

/** What is asked for is no request: nothing that is shown answers it. */
function refuse() {
  if (!rules) return;
  clear();
  say("No houses are drawn: a field below is invalid.");
}

/** What is shown answers another question. */
function clear() {
  drawing.abort();
  drawing = new AbortController();
  setOutdated();
  closeAnswer();
}

/** Show a part of the answer; whether it is one of a sheet without mistakes and proofs. */
function receivePart({ kinds, findings, index, house, types, svg, problem }, request) {
  if (findings) {
    linted = 0;
    showFindings(findings);
    say("The rules have a mistake: the page shows the houses of the last valid rules.");
    return false;
  }
  if (kinds) {
    // Asked again once this answer is aborted, which is not of what is asked for now.
    showTypes(Object.keys(kinds.types));
    if (showKinds(kinds)) setTimeout(redraw);
    if (linted !== rules.version) showFindings([]);
  } else if (house) {
    showHouse(index, house, types, svg);
  } else if (problem.kind === "LimitReached") {
    showProblem(index, problem.message);
  } else {
    if (problem.reasons) showProof(problem);
    else showAnswer("No house", element("p", {}, problem.message));
    say(problem.reasons ? "There is no such house." : "No house was generated.");
    return false;
  }
  return true;
}

/** Once for each version of the rules: what is wrong with them that houses do not show. */
async function lint(version) {
  if (linted === version) return;
  linted = version;
  linting = new AbortController();
  const { signal } = linting;
  try {
    const findings = await engine.lint(version, signal);
    if (!signal.aborted) showFindings(findings);
  } catch (error) {
    // The houses are there: that line stays.
    if (!signal.aborted) say(`${byId("status").textContent} Some rules were not checked.`, error.message);
  }
}

/** Ask why a part of a house is as it is; where the engine cannot say, what it is. */
async function ask(house, part, index) {
  asking.abort();
  asking = new AbortController();
  if (!engine.why) return showPart(house, part, index);
  const { signal } = asking;
  showAnswer(`Why ${part}`, element("p", {}, `Vitruvius is regenerating house ${index}.`));
  try {
    const why = await engine.why(rules.version, house, part, signal);
    if (!signal.aborted) showWhy(why);
  } catch (error) {
    if (!signal.aborted) showAnswer(`Why ${part}`, element("p", {}, error.message));
  }
}

function closeAnswer() {
  asking.abort();
  hideAnswer();
  mark();
}

/** Say how things are; `more` where the pointer rests on it. */
function say(text, more = "") {
  byId("status").textContent = text;
  byId("status").title = more;
}

onTravel(async () => {
  clear();
  readAddress();
  readBriefAddress();
  if (!(await engine.travel?.())) redraw();
});
initRequest(redraw, refuse);
byId("brief-switch").hidden = !engine.briefs;
byId("no-briefs").hidden = engine.briefs;
initBrief(redraw, firstHouse);
initSheet(ask);
initAnswer(() => {
  const part = document.querySelector(".asked");
  closeAnswer();
  part?.focus(); // where the user was, which may be far from the rules
});
byId("hint").textContent = `Choose a room, a piece, a door or a window to see ${engine.why ? "why it is there" : "what it is"}`
  + "; or arrow keys, then Enter.";
showWaiting(readRequest()?.count ?? 0);
engine.open(receive, (text) => {
  linting.abort();
  dropWaiting();
  say(text);
}, (text) => {
  clearTimeout(patience); // what the engine says is more than that it works
  say(text);
});
