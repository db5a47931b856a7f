// What houses are asked for: sliders and boxes, kept in the page's address so that they outlive a reload.

import { byId, element } from "./dom.js";

/** Milliseconds: a slider that moves on sooner asks for nothing in between. */
const PAUSE = 60;
const COUNT = /^(\d{1,3})?(\.\.(\d{1,3})?)?$/;
let kinds = null;

/** Read the page's address; `onChange(when)` is called after each change that asks for other houses. */
export function initRequest(onChange) {
  const form = byId("request");
  for (const [name, value] of new URLSearchParams(location.hash.slice(1))) {
    const field = form.elements[name];
    if (field) field.value = value;
  }
  let pause = 0;
  form.addEventListener("input", (event) => {
    label();
    clearTimeout(pause);
    if (event.target.name !== "size" && form.checkValidity()) pause = setTimeout(onChange, PAUSE, Date.now());
  });
  form.addEventListener("submit", (event) => event.preventDefault());
  form.addEventListener("keydown", step);
  byId("another").addEventListener("click", () => {
    form.elements.seed.value = Number(form.elements.seed.value) + 1;
    form.dispatchEvent(new Event("input"));
  });
  label();
}

/** Boxes for the room types and pieces that a grammar has; what was typed in them stays. */
export function showKinds(newKinds) {
  if (JSON.stringify(newKinds) === JSON.stringify(kinds)) return;
  kinds = newKinds;
  const before = counts();
  const boxes = (names, title) => names.map((name) => box(name, before[name] ?? "", title(name)));
  byId("types").replaceChildren(element("legend", {}, "Rooms of each type"),
    ...boxes(Object.keys(kinds.types).map((type) => `type.${type}`), (name) => name.slice(5)));
  byId("pieces").replaceChildren(...Object.entries(kinds.types).filter(([, pieces]) => pieces.length).map(
    ([type, pieces]) => element("fieldset", {}, element("legend", {}, `In each ${type}`),
      ...boxes(pieces.map((piece) => `piece.${type}.${piece}`), (name) => name.split(".")[2]))));
  byId("request").elements.rooms.max = Math.min(kinds.most_rooms, 32);
  label();
}

/** The request as engines take it; counts of types that the grammar has lost are left out. */
export function readRequest() {
  const { rooms, seed, count } = byId("request").elements;
  const wanted = counts();
  const of = (prefix) => Object.fromEntries(Object.entries(wanted)
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

/** The command that writes the houses of the page into a file. */
export function command(grammar) {
  const { rooms, seed, count } = byId("request").elements;
  const options = Object.entries(counts()).map(([name, text]) => {
    const [what, ...rest] = name.split(".");
    return `--${what} ${rest.join(".")}=${text}`;
  });
  return ["vitruvius generate --grammar", grammar, `--rooms ${rooms.value}`, ...options,
    `--seed ${seed.value} --count ${count.value} --out houses.jsonl`].join(" ");
}

function box(name, value, title) {
  return element("label", {}, `${title} `, element("input", {
    name,
    value,
    type: "text",
    placeholder: "any",
    inputMode: "numeric",
    pattern: "\\d{1,3}(\\.\\.\\d{0,3})?|\\.\\.\\d{1,3}",
    title: "2, 1..3, 2.. or nothing for any number; arrow up and down count",
    autocomplete: "off",
  }));
}

/** Arrow up and down count in a box of counts. */
function step(event) {
  const by = { ArrowUp: 1, ArrowDown: -1 }[event.key];
  const { value, placeholder } = event.target;
  if (!by || placeholder !== "any" || value.includes("..")) return;
  event.preventDefault();
  const next = value === "" ? (by > 0 ? 0 : -1) : Number(value) + by;
  event.target.value = next < 0 ? "" : next;
  event.target.dispatchEvent(new Event("input", { bubbles: true }));
}

/** What is typed in the boxes of counts, by their names, and before there are boxes what the address says. */
function counts() {
  const form = byId("request");
  const given = kinds && form.querySelector("#types input")
    ? [...form.querySelectorAll("[placeholder=any]")].map((each) => [each.name, each.value])
    : [...new URLSearchParams(location.hash.slice(1))].filter(([name]) => name.includes("."));
  return Object.fromEntries(given.filter(([, text]) => text && COUNT.test(text)));
}

function range(text) {
  if (!text.includes("..")) return Number(text);
  const [least, most] = text.split("..");
  return [Number(least || 0), most ? Number(most) : null];
}

/** Numbers beside the sliders, the size of the plans, and the page's address. */
function label() {
  const { rooms, seed, count, size } = byId("request").elements;
  for (const output of byId("request").querySelectorAll("output")) {
    output.value = byId("request").elements[output.htmlFor.value].value;
  }
  byId("sheet").style.setProperty("--plan", `${size.value}px`);
  const plain = { rooms: rooms.value, seed: seed.value, count: count.value, size: size.value };
  history.replaceState(null, "", `#${new URLSearchParams({ ...plain, ...counts() })}`);
}
