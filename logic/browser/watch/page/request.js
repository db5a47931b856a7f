// What houses are asked for: sliders and boxes, kept in the page's address.

import { address, note } from "./address.js";
import { byId, element } from "./dom.js";

/** Milliseconds: a slider that moves on sooner asks for nothing in between. */
const PAUSE = 60;
const COUNT = /^(\d{1,3}|\d{1,3}\.\.\d{0,3}|\.\.\d{1,3})$/;
const PLAIN = ["rooms", "seed", "count", "size"];

const initial = {};
let kinds = null;
/** Counts by the names of their boxes, as texts: type.bedroom, piece.bedroom.bed. */
let wanted = {};
/** Which control is being used, and how often one was left: the changes between are one step back. */
let gesture = "";
let left = 0;
/** Counts that were dropped, until the next change. */
let lost = [];

/**
 * `onChange()` is called after each change that asks for other houses, and `onWrong()` where what is asked for is
 * no request.
 */
export function initRequest(onChange, onWrong) {
  const form = byId("request");
  for (const name of PLAIN) initial[name] = form.elements[name].value;
  const ask = () => {
    write(gesture);
    if (tellWrong()) onWrong();
    else onChange();
  };
  let pause = 0;
  form.addEventListener("input", ({ target }) => {
    if (target.name?.includes(".")) wanted[target.name] = target.value.trim();
    gesture = `${target.name} ${left}`;
    lost = [];
    label();
    clearTimeout(pause);
    if (target.name === "size") note({ size: target.value }, null);
    else pause = setTimeout(ask, PAUSE);
  });
  form.addEventListener("change", () => left++);
  form.addEventListener("submit", (event) => event.preventDefault());
  form.addEventListener("keydown", step);
  byId("another").addEventListener("click", () => {
    form.elements.seed.value = (Number(form.elements.seed.value) + 1) % 2 ** 31;
    for (const kind of ["input", "change"]) form.elements.seed.dispatchEvent(new Event(kind, { bubbles: true }));
  });
  readAddress();
}

/** Ask for what the address says. */
export function readAddress() {
  const { elements } = byId("request");
  const said = address();
  for (const name of PLAIN) elements[name].value = said.get(name) ?? initial[name];
  wanted = Object.fromEntries([...said].filter(([name]) => name.includes(".")));
  lost = [];
  for (const each of boxes()) each.value = wanted[each.name] ?? "";
  label();
  tellWrong();
}

/** Boxes for the room types and pieces that a grammar has. Whether counts were dropped, of names that it has not. */
export function showKinds(newKinds) {
  const names = Object.entries(newKinds.types).flatMap(
    ([type, pieces]) => [`type.${type}`, ...pieces.map((piece) => `piece.${type}.${piece}`)]);
  const dropped = Object.keys(wanted).filter((name) => !names.includes(name));
  for (const name of dropped) delete wanted[name];
  lost.push(...dropped);
  if (JSON.stringify(newKinds) !== JSON.stringify(kinds)) drawBoxes(newKinds);
  kinds = newKinds;
  byId("request").elements.rooms.max = Math.min(kinds.most_rooms, 32);
  label();
  // Nothing else: what the user changes just now is a step of its own.
  note(Object.fromEntries(dropped.map((name) => [name, null])), null);
  tellWrong();
  return dropped.length > 0;
}

function drawBoxes({ types }) {
  byId("types").replaceChildren(element("legend", {}, "Rooms of each type"),
    ...Object.keys(types).map((type) => box(`type.${type}`, type)));
  byId("pieces").replaceChildren(...Object.entries(types).filter(([, pieces]) => pieces.length).map(
    ([type, pieces]) => element("fieldset", {}, element("legend", {}, `In each ${type}`),
      ...pieces.map((piece) => box(`piece.${type}.${piece}`, piece)))));
}

/** The request as engines take it; null where a field is wrong. */
export function readRequest() {
  if (mistakes().length) return null;
  const { rooms, seed, count } = byId("request").elements;
  const of = (prefix) => Object.fromEntries(counts()
    .filter(([name]) => name.startsWith(prefix))
    .map(([name, text]) => [name.slice(prefix.length), range(text)]));
  return {
    rooms: rooms.valueAsNumber,
    seed: seed.valueAsNumber,
    count: count.valueAsNumber,
    types: of("type."),
    furniture: of("piece."),
  };
}

/** Show the command that writes the houses of the page into a file; `before` says what it needs. */
export function showCommand(grammar, before = "", byBrief = false) {
  const { rooms, seed, count } = byId("request").elements;
  const options = counts().map(([name, text]) => {
    const [what, ...rest] = name.split(".");
    return `--${what} ${rest.join(".")}=${text}`;
  });
  const [words, code] = byId("command").children;
  words.textContent = before;
  const what = byBrief ? ["--brief brief.json"] : [`--rooms ${rooms.value}`, ...options];
  code.textContent = ["vitruvius generate --grammar", grammar, ...what,
    `--seed ${seed.value} --count ${count.value} --out houses.jsonl`].join(" ");
}

function box(name, title) {
  return element("label", {}, `${title} `, element("input", {
    name,
    value: wanted[name] ?? "",
    type: "text",
    placeholder: "any",
    inputMode: "text",
    title: "2, 1..3, 2.. or nothing for any number; arrow up and down count",
    autocomplete: "off",
  }));
}

const boxes = () => [...byId("request").querySelectorAll("[placeholder=any]")];

/** Arrow up and down count in a box of counts. */
function step(event) {
  const by = { ArrowUp: 1, ArrowDown: -1 }[event.key];
  const { value, placeholder } = event.target;
  if (!by || placeholder !== "any" || !/^\d*$/.test(value)) return;
  event.preventDefault();
  const next = value === "" ? (by > 0 ? 0 : -1) : Number(value) + by;
  event.target.value = next < 0 ? "" : next;
  for (const kind of ["input", "change"]) event.target.dispatchEvent(new Event(kind, { bubbles: true }));
}

const counts = () => Object.entries(wanted).filter(([, text]) => text !== "");

function range(text) {
  if (!text.includes("..")) return Number(text);
  const [least, most] = text.split("..");
  return [Number(least || 0), most ? Number(most) : null];
}

/** What is wrong, as [name of the field, words]. */
function mistakes() {
  const { seed } = byId("request").elements;
  const found = counts().flatMap(([name, text]) => {
    const title = name.split(".").slice(1).reverse().join(" of a ");
    if (!COUNT.test(text)) return [[name, `${title}: “${text}” is not a count: write 2, 1..3, 2.. or nothing.`]];
    const [least, most] = [range(text)].flat();
    return most != null && least > most ? [[name, `${title}: ${text} has its minimum above its maximum.`]] : [];
  });
  return seed.checkValidity() ? found : [["seed", `Seed: a whole number from ${seed.min} to ${seed.max}.`], ...found];
}

/** Say in words what is wrong, and at which fields; whether anything is. */
function tellWrong() {
  const found = mistakes();
  const names = found.map(([name]) => name);
  for (const each of byId("request").querySelectorAll("input")) {
    const wrong = names.includes(each.name);
    each.setAttribute("aria-invalid", wrong);
    if (wrong) each.setAttribute("aria-describedby", "wrong");
    else each.removeAttribute("aria-describedby");
  }
  const leftOut = lost.map((name) => `These rules have no ${name.split(".").slice(1).join(".")}: its count is left out.`);
  byId("wrong").textContent = [...found.map(([, words]) => words), ...leftOut].join(" ");
  return found.length > 0;
}

/** Numbers beside the sliders, and the size of the plans. */
function label() {
  const { elements } = byId("request");
  for (const output of byId("request").querySelectorAll("output")) output.value = elements[output.htmlFor.value].value;
  byId("sheet").style.setProperty("--plan", `${elements.size.value}px`);
}

/** Note all of it in the address. */
function write(gesture) {
  const { elements } = byId("request");
  const gone = [...address().keys()].filter((name) => name.includes(".") && !wanted[name]);
  note({
    ...Object.fromEntries(PLAIN.map((name) => [name, elements[name].value])),
    ...Object.fromEntries(gone.map((name) => [name, null])),
    ...Object.fromEntries(counts()),
  }, gesture);
}
