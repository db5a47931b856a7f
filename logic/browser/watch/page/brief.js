// A brief: rooms by name in a table, what joins them as lines between bubbles. It is the JSON of docs/briefs.md, and
// what the table has no column for stays in it as it is. It stands in the page's address.

import { address, note } from "./address.js";
import { initBubbles, showBubbles } from "./bubbles.js";
import { byId, element } from "./dom.js";

/** Milliseconds: a text that goes on sooner asks for nothing in between. */
const PAUSE = 400;
const SPAN = /^(\d+(?:\.\d+)?)(?:\s*\.\.\s*(\d+(?:\.\d+)?))?$/;
const NO_BRIEF = 'this is no JSON of a brief: {"rooms": [{"name": "Hall"}, ...]}';
const SIDES = ["north", "east", "south", "west"];

/** What may be between two rooms: its key in a brief, in words. */
export const JOINTS = { doors: "a door", next_to: "next to", apart: "apart", no_doors: "no door" };

let brief = null;
/** Words about what is no brief, by the field they are of. */
let wrong = {};
let types = [];
let changed = () => {};

/** `onChange()` is called after each change; a brief begins as what `shownHouse()` is, so that there is a house of it. */
export function initBrief(onChange, shownHouse) {
  let pause = 0;
  changed = (soon = true) => {
    note({ brief: brief && JSON.stringify(brief) }, "brief");
    clearTimeout(pause);
    pause = setTimeout(onChange, soon ? 0 : PAUSE);
  };
  byId("by-brief").addEventListener("change", ({ target }) => {
    brief = target.checked ? briefOf(shownHouse()) : null;
    draw();
    changed();
  });
  byId("add-room").addEventListener("click", () => {
    brief.rooms.push({ name: unused("Room") });
    draw();
    changed();
    byId("wanted").querySelector("tbody tr:last-child input").focus();
  });
  byId("join").addEventListener("submit", (event) => {
    event.preventDefault();
    const { one, kind, other } = event.target.elements;
    join(one.value, other.value, kind.value);
  });
  for (const name of ["width", "depth"]) {
    byId(`outline-${name}`).addEventListener("input", ({ target }) => measured(target, (span) => {
      set(brief.outline ??= {}, name, span);
      if (!Object.keys(brief.outline).length) delete brief.outline;
    }));
  }
  byId("house-area").addEventListener("input", ({ target }) => measured(target, (span) => set(brief, "area", span)));
  byId("brief-json").addEventListener("input", ({ target }) => readJson(target.value));
  initBubbles(join, (joint) => setKind(joint, after(joint.kind)));
  readBriefAddress();
}

/** The rooms of a house, named by their types, and the doors between them; of no house two rooms with a door. */
function briefOf(house = { rooms: [{ name: "R0" }, { name: "R1" }], doors: [{ between: ["R0", "R1"] }] }) {
  const names = new Map();
  for (const { name, type = "room", part_of } of house.rooms) {
    const number = house.rooms.filter((each) => (each.type ?? "room") === type && names.has(each.name)).length + 1;
    const words = type.replace(/[A-Z]/g, (letter) => ` ${letter.toLowerCase()}`);
    if (!part_of) names.set(name, `${words[0].toUpperCase()}${words.slice(1)} ${number}`);
  }
  const rooms = house.rooms.filter(({ name }) => names.has(name)).map(({ name, type }) => ({ name: names.get(name), type }));
  const order = [...names.keys()];
  const inner = house.doors.map(({ between }) => between).filter((pair) => pair.every((name) => names.has(name)));
  const pairs = inner.map((pair) => pair.toSorted((one, other) => order.indexOf(one) - order.indexOf(other)));
  return { rooms, doors: pairs.map((pair) => pair.map((name) => names.get(name))) };
}

/** Show what the address says. */
export function readBriefAddress() {
  const said = address().get("brief");
  brief = said && (parsed(said) ?? { rooms: [] });
  draw();
  if (brief && !parsed(said)) {
    byId("brief-json").value = said;
    say("As JSON", NO_BRIEF);
  }
}

/** The room types of a grammar. */
export function showTypes(names) {
  if (JSON.stringify(names) === JSON.stringify(types)) return;
  types = names;
  if (brief) draw();
}

/** The brief as engines take it; undefined without one, null where a field is wrong. */
export const readBrief = () => (!brief ? undefined : Object.values(wrong).some(Boolean) ? null : brief);

function readJson(text) {
  const read = parsed(text);
  say("As JSON", read ? "" : NO_BRIEF);
  if (read) {
    brief = read;
    draw(false);
    changed(false);
  } else changed(false);
}

/** A brief whose rooms have names; all else is the engine's to judge. Null for anything else. */
function parsed(text) {
  try {
    const read = JSON.parse(text);
    const pairs = Object.keys(JOINTS).flatMap((kind) => read[kind] ?? []);
    return read.rooms.length && read.rooms.every(({ name }) => typeof name === "string") && pairs.every((pair) => pair.length === 2) ? read : null;
  } catch {
    return null;
  }
}

/** All of it as it is; with `whole`, the JSON too, in which the user may be writing. */
function draw(whole = true) {
  wrong = {};
  byId("brief").hidden = !brief;
  byId("by-brief").checked = Boolean(brief);
  byId("request").classList.toggle("by-brief", Boolean(brief));
  say();
  if (!brief) return;
  const names = brief.rooms.map(({ name }) => name);
  byId("wanted").querySelector("tbody").replaceChildren(...brief.rooms.map(row));
  byId("joints").replaceChildren(...joints().map(line));
  for (const each of ["one", "other"]) byId("join").elements[each].replaceChildren(...names.map((name) => new Option(name)));
  byId("join").elements.other.selectedIndex = Math.min(1, names.length - 1);
  byId("outline-width").value = spelt(brief.outline?.width);
  byId("outline-depth").value = spelt(brief.outline?.depth);
  byId("house-area").value = spelt(brief.area);
  drawn(whole);
}

/** What follows from the fields that are shown. */
function drawn(whole = true) {
  showBubbles(brief.rooms, joints());
  const text = JSON.stringify(brief, null, 1);
  if (whole) byId("brief-json").value = text;
  byId("brief-file").href = `data:application/json,${encodeURIComponent(text)}`;
}

/** What is between rooms: its key, its place in that list, and both names. */
function joints() {
  return Object.keys(JOINTS).flatMap((kind) => (brief[kind] ?? []).map(([one, other], place) => ({ kind, place, one, other })));
}

function row(room, place) {
  const name = element("input", { value: room.name, aria: { label: `Name of room ${place + 1}` } });
  name.addEventListener("input", () => rename(room, name));
  const type = choice(`Type of ${room.name}`, ["", ...types], ["any type", ...types], room.type ?? "");
  type.addEventListener("change", () => edit(() => set(room, "type", type.value || undefined)));
  const area = element("input", { value: spelt(room.area), placeholder: "any", size: 7, aria: { label: `Area of ${room.name}, square metres` } });
  area.addEventListener("input", () => measured(area, (span) => set(room, "area", span)));
  const outside = choice(`Outer wall of ${room.name}`, ["", "any", ...SIDES], ["any", "yes", ...SIDES], wallOf(room));
  outside.addEventListener("change", () => edit(() => set(room, "outside", { "": undefined, any: true }[outside.value] ?? sides(outside.value))));
  const entry = element("input", { type: "radio", name: "entrance", checked: (brief.entrance?.room ?? brief.entrance) === room.name, aria: { label: `The house is entered by ${room.name}` } });
  entry.addEventListener("change", () => edit(() => { brief.entrance = room.name; }));
  const out = element("button", { type: "button", title: `Leave ${room.name} out`, disabled: brief.rooms.length === 1, aria: { label: `Leave ${room.name} out` } }, "×");
  out.addEventListener("click", () => leaveOut(room));
  return element("tr", {}, ...[name, type, area, outside, entry, out].map((each) => element("td", {}, each)));
}

function line(joint) {
  const { one, other } = joint;
  const kind = choice(`Between ${one} and ${other}`, Object.keys(JOINTS), Object.values(JOINTS), joint.kind);
  kind.addEventListener("change", () => setKind(joint, kind.value));
  const out = element("button", { type: "button", aria: { label: `Nothing between ${one} and ${other}` } }, "×");
  out.addEventListener("click", () => setKind(joint, null));
  return element("li", {}, `${one} – ${other} `, kind, " ", out);
}

const wallOf = ({ outside }) => (outside === true ? "any" : outside?.length === 1 ? outside[0] : "");
const sides = (side) => (SIDES.includes(side) ? [side] : undefined);
const spelt = (span) => (span == null ? "" : [span].flat().join(".."));
const after = (kind) => [...Object.keys(JOINTS), null][Object.keys(JOINTS).indexOf(kind) + 1];

function choice(label, values, words, value) {
  const made = element("select", { aria: { label } }, ...values.map((each, place) => new Option(words[place], each)));
  made.value = value;
  return made;
}

/** A change after which all is drawn again; the control in use keeps the focus. */
function edit(change) {
  change();
  drawn();
  changed();
}

function set(record, key, value) {
  if (value === undefined) delete record[key];
  else record[key] = value;
}

/** A number or a range from a field, undefined for nothing. */
function measured(field, take) {
  const text = field.value.trim();
  const [, least, most] = text.match(SPAN) ?? [];
  const label = field.getAttribute("aria-label") ?? field.parentElement.textContent.trim();
  const bad = text && (least === undefined || Number(most ?? least) < Number(least));
  field.setAttribute("aria-invalid", Boolean(bad));
  say(label, bad ? `“${text}” is not a length or an area: write 12, 10..14 or nothing` : "");
  if (!bad) {
    take(text === "" ? undefined : most === undefined ? Number(least) : [Number(least), Number(most)]);
    drawn();
  }
  changed(false);
}

/** Say what is wrong with a field, or that nothing is. */
function say(field = "", words = "") {
  if (field) wrong[field] = words;
  byId("brief-wrong").textContent = Object.entries(wrong).filter(([, each]) => each).map(([name, each]) => `${name}: ${each}.`).join(" ");
}

function rename(room, field) {
  const taken = brief.rooms.some((other) => other !== room && other.name === field.value);
  const bad = !field.value.trim() || taken;
  field.setAttribute("aria-invalid", bad);
  say(field.getAttribute("aria-label"), !bad ? "" : taken ? `another room is called ${field.value}` : "a room has a name");
  if (!bad) {
    const named = (name) => (name === room.name ? field.value : name);
    for (const kind of Object.keys(JOINTS)) if (brief[kind]) brief[kind] = brief[kind].map((pair) => pair.map(named));
    if (typeof brief.entrance === "string") brief.entrance = named(brief.entrance);
    else if (brief.entrance) brief.entrance.room = named(brief.entrance.room);
    room.name = field.value;
    byId("joints").replaceChildren(...joints().map(line));
    for (const each of ["one", "other"]) byId("join").elements[each].replaceChildren(...brief.rooms.map(({ name }) => new Option(name)));
    drawn();
  }
  changed(false);
}

function leaveOut(room) {
  brief.rooms = brief.rooms.filter((other) => other !== room);
  for (const kind of Object.keys(JOINTS)) set(brief, kind, some(brief[kind]?.filter((pair) => !pair.includes(room.name))));
  if ((brief.entrance?.room ?? brief.entrance) === room.name) delete brief.entrance;
  draw();
  changed();
}

/** Two rooms that nothing is between have a door then. */
function join(one, other, kind = "doors") {
  if (one === other || joints().some((each) => [each.one, each.other].includes(one) && [each.one, each.other].includes(other))) return;
  (brief[kind] ??= []).push([one, other]);
  draw();
  changed();
}

/** Another thing is between two rooms, or nothing. */
function setKind({ kind, place, one, other }, next) {
  brief[kind].splice(place, 1);
  set(brief, kind, some(brief[kind]));
  if (next) (brief[next] ??= []).push([one, other]);
  draw();
  changed();
}

const some = (list) => (list?.length ? list : undefined);

function unused(word) {
  for (let number = brief.rooms.length + 1; ; number++) {
    if (!brief.rooms.some(({ name }) => name === `${word} ${number}`)) return `${word} ${number}`;
  }
}
