// The rule files: a tab for each, its text with line numbers, and mistakes at their lines.

import { byId, element, neighbour } from "./dom.js";

let files = [];
let findings = [];
let shown = "";
let write = null;

/**
 * Show these files. Where they may be changed, `onWrite(name, text)` is called for each change; else the one
 * that has changed comes to the front. `first` names the file that is shown first.
 */
export function showRules(newFiles, onWrite, first) {
  const changed = files.length ? newFiles.find(({ name, text }) => text !== textOf(name)) : undefined;
  const before = changed ? textOf(changed.name) : "";
  files = newFiles;
  write = onWrite;
  if (!files.some((file) => file.name === shown)) shown = files.find(({ name }) => name === first)?.name ?? files[0]?.name ?? "";
  draw();
  if (changed && !write) goTo(changed.name, firstDifference(before, changed.text));
}

const textOf = (name) => files.find((file) => file.name === name)?.text ?? "";

/** The number of the first line of a text that is not that of the text before it. */
function firstDifference(before, after) {
  const [old, now] = [before.split("\n"), after.split("\n")];
  const at = now.findIndex((line, index) => line !== old[index]);
  return (at < 0 ? now.length - 1 : at) + 1;
}

/** Show these mistakes at their lines; the first file with an error comes to the front. */
export function showFindings(newFindings) {
  findings = newFindings;
  const first = findings.find((each) => each.severity === "error");
  draw();
  if (first) goTo(first.file, first.line);
}

/** Bring a line of a file to the front of its file; whether there is one. */
function goTo(name, line) {
  if (!files.some((file) => file.name === name)) return null;
  if (name !== shown) {
    shown = name;
    draw();
  }
  const code = byId("code");
  const row = code.querySelector(`[data-line="${line}"]`);
  if (!row) return null;
  code.scrollTop = row.offsetTop - code.clientHeight / 3;
  code.querySelector(".here")?.classList.remove("here");
  row.classList.add("here");
  return row;
}

/** Show a line of a file that the user asks for: where the page scrolls, it goes there. */
function visit(name, line) {
  const row = goTo(name, line);
  if (row && document.documentElement.scrollHeight > innerHeight) row.scrollIntoView({ block: "start" });
}

/** The rules of the files in which a name stands outside comments. */
export function linesWith(name) {
  const word = new RegExp(`\\b${name}\\b`);
  return files.flatMap(({ name: file, text }) => text.split("\n").flatMap((line, index) =>
    word.test(stated(line)) ? [{ file, line: index + 1, text: stated(line).trim() }] : []));
}

/** A button that shows the line of a file, as in rooms.lp:9; for files that are not shown here plain words. */
export function place(name, line, column) {
  const text = [name, line, column].filter(Boolean).join(":");
  if (!files.some((file) => file.name === name)) return element("span", { className: "place" }, text);
  return element("button", { type: "button", className: "place", onclick: () => visit(name, line) }, text);
}

function draw() {
  drawTabs();
  drawList();
  const file = files.find((each) => each.name === shown);
  const code = byId("code");
  const scrolled = code.dataset.file === shown ? code.scrollTop : 0;
  code.dataset.file = shown;
  code.setAttribute("aria-labelledby", `tab-${shown}`);
  if (!file) code.replaceChildren();
  else if (write) drawEditor(code, file);
  else code.replaceChildren(...lines(file).flatMap(([row, notes]) => [row, ...notes]));
  code.scrollTop = scrolled;
}

function drawTabs() {
  const hadFocus = byId("tabs").contains(document.activeElement);
  const tabs = files.map(({ name }) => {
    const wrong = findings.filter((each) => each.file === name);
    const tab = element("button", {
      type: "button",
      role: "tab",
      id: `tab-${name}`,
      className: severest(wrong),
      tabIndex: name === shown ? 0 : -1,
      aria: { selected: name === shown, controls: "code" },
      onclick: () => select(name),
    }, name);
    if (wrong.length) tab.append(element("span", { className: "badge", title: counted(wrong) }, wrong.length));
    return tab;
  });
  byId("tabs").replaceChildren(...tabs);
  if (hadFocus) tabs.find((tab) => tab.tabIndex === 0)?.focus();
}

byId("tabs").addEventListener("keydown", (event) => {
  const to = neighbour(event.key, files.findIndex((file) => file.name === shown), files.length);
  if (to === undefined) return;
  event.preventDefault();
  select(files[to].name);
});

function select(name) {
  shown = name;
  draw();
}

/** Mistakes that do not stand at their lines below, each with its place, which leads to its line. */
function drawList() {
  const listed = findings.filter((each) => write || each.file !== shown);
  byId("findings").replaceChildren(...listed.map((each) => element("li", { className: each.severity },
    place(each.file, each.line, each.column), `: ${each.severity}: ${each.text}`)));
}

/** The lines of a file, each with what is said of it. */
function lines({ name, text }) {
  const texts = text.replace(/\n$/, "").split("\n");
  return texts.map((line, index) => {
    const number = index + 1;
    const said = findings.filter((each) => each.file === name
      && Math.min(each.line, texts.length) === number);
    const row = element("div", { className: `line ${severest(said)}`, dataset: { line: number } },
      element("span", { className: "number", aria: { hidden: "true" } }, number),
      element("code", {}, ...written(line, said[0]?.column)));
    const notes = said.map((each) => element("p", { className: `note ${each.severity}` },
      `${name}:${each.line}:${each.column}: ${each.severity}: ${each.text}`));
    return [row, notes];
  });
}

/** A line without its comment. */
const stated = (line) => line.slice(0, endOf(line));

const endOf = (line) => {
  const comment = line.search(/%(?=([^"]*"[^"]*")*[^"]*$)/);
  return comment < 0 ? line.length : comment;
};

/** The text of a line: its comment stands back, and the word at a mistake's column is marked. */
function written(line, column) {
  const end = endOf(line);
  const parts = [];
  const word = column && column <= end ? line.slice(column - 1, end).match(/^\w+|^\S?/)[0] : "";
  if (word) parts.push(line.slice(0, column - 1), element("mark", {}, word), line.slice(column - 1 + word.length, end));
  else parts.push(line.slice(0, end) || (end < line.length ? "" : " "));
  if (end < line.length) parts.push(element("span", { className: "comment" }, line.slice(end)));
  return parts;
}

/** A text area with line numbers beside it. What is typed stays where it is while answers come. */
function drawEditor(code, { name, text }) {
  let area = code.querySelector("textarea");
  if (!area) {
    area = element("textarea", { spellcheck: false, wrap: "off", aria: { label: "Text of the rule file" } });
    area.addEventListener("input", () => {
      number(code, area.value);
      write(area.dataset.file, area.value);
    });
    code.replaceChildren(element("div", { className: "gutter", aria: { hidden: "true" } }), area);
  }
  if (area.dataset.file !== name || area.value !== text) area.value = text;
  area.dataset.file = name;
  number(code, area.value);
}

function number(code, text) {
  const count = text.split("\n").length;
  const wrong = findings.filter((each) => each.file === shown);
  code.querySelector(".gutter").replaceChildren(...Array.from({ length: count }, (_, index) => {
    const said = wrong.filter((each) => Math.min(each.line, count) === index + 1);
    return element("div", {
      className: severest(said),
      title: said.map((each) => each.text).join("\n"),
      dataset: { line: index + 1 },
    }, index + 1);
  }));
  code.querySelector("textarea").rows = count;
}

function severest(found) {
  return found.some((each) => each.severity === "error") ? "error" : found.length ? "warning" : "";
}

function counted(found) {
  const errors = found.filter((each) => each.severity === "error").length;
  return `${errors} errors, ${found.length - errors} warnings`;
}
