// The rooms of a brief as bubbles, and what joins them as lines. A bubble that is dropped on another gets a door to
// it; dropped elsewhere, it stays there. A line that is clicked says the next thing.

import { byId } from "./dom.js";

const SVG = "http://www.w3.org/2000/svg";
const [WIDTH, HEIGHT] = [360, 240];
/** Radius of a room of no area, and of the largest, in the drawing's units. */
const [SMALL, LARGE] = [20, 40];
/** How often places are improved. */
const ROUNDS = 150;

/** Places of rooms by name; those that the user has chosen. */
const places = new Map();
const held = new Set();
let dropped = () => {};
let clicked = () => {};
let shown = { rooms: [], joints: [] };

/** `onJoin(one, other)` is called where a bubble is dropped on another, `onLine(joint)` for a line that is clicked. */
export function initBubbles(onJoin, onLine) {
  [dropped, clicked] = [onJoin, onLine];
}

export function showBubbles(rooms, joints) {
  shown = { rooms, joints };
  const names = rooms.map(({ name }) => name);
  for (const name of [...places.keys()].filter((each) => !names.includes(each))) {
    places.delete(name);
    held.delete(name);
  }
  names.forEach((name, number) => {
    const angle = 2 * Math.PI * number / names.length;
    if (!places.has(name)) places.set(name, { x: WIDTH / 2 + 90 * Math.cos(angle), y: HEIGHT / 2 + 70 * Math.sin(angle) });
  });
  settle();
  paint();
}

/** Rooms that are joined come near each other, all others keep away: each goes a little that way, many times. */
function settle() {
  const { rooms, joints } = shown;
  for (let round = 0; round < ROUNDS; round++) {
    for (const room of rooms.filter(({ name }) => !held.has(name))) {
      const here = places.get(room.name);
      let [x, y] = [(WIDTH / 2 - here.x) * 0.01, (HEIGHT / 2 - here.y) * 0.02];
      for (const other of rooms) {
        if (other === room) continue;
        const there = places.get(other.name);
        const [dx, dy] = [here.x - there.x, here.y - there.y];
        const away = Math.hypot(dx, dy) || 1;
        const free = radius(room) + radius(other) + 24;
        const joined = joints.some(({ kind, one, other: end }) => kind !== "apart" && kind !== "no_doors" && [one, end].includes(room.name) && [one, end].includes(other.name));
        const push = away < free ? (free - away) * 0.2 : joined ? (free - away) * 0.05 : 0;
        x += dx / away * push;
        y += dy / away * push;
      }
      Object.assign(here, inside(here.x + x, here.y + y, radius(room)));
    }
  }
}

const inside = (x, y, edge) => ({ x: Math.min(WIDTH - edge, Math.max(edge, x)), y: Math.min(HEIGHT - edge, Math.max(edge, y)) });

function radius({ area }) {
  const middle = area == null ? 0 : [area].flat().reduce((sum, each) => sum + each, 0) / [area].flat().length;
  return Math.min(LARGE, SMALL + 3.2 * Math.sqrt(Math.max(0, middle) || 0));
}

function paint() {
  const { rooms, joints } = shown;
  const known = joints.filter(({ one, other }) => places.has(one) && places.has(other));
  byId("bubbles").replaceChildren(...known.map(lineOf), ...rooms.map(bubble));
}

function lineOf(joint) {
  const [from, to] = [places.get(joint.one), places.get(joint.other)];
  const ends = { x1: from.x, y1: from.y, x2: to.x, y2: to.y };
  const drawn = shape("g", { class: `joint ${joint.kind}` }, shape("line", { ...ends, class: "reach" }), shape("line", ends),
    shape("title", {}, `${joint.one} – ${joint.other}: click for the next kind`));
  drawn.addEventListener("click", () => clicked(joint));
  return drawn;
}

function bubble(room) {
  const { x, y } = places.get(room.name);
  const edge = radius(room);
  const words = room.name.length > 11 ? `${room.name.slice(0, 10)}…` : room.name;
  const drawn = shape("g", { class: "bubble", transform: `translate(${x} ${y})` },
    shape("circle", { r: edge }), shape("text", {}, words), shape("title", {}, `${room.name}: drop it on a room for a door to it`));
  drawn.addEventListener("pointerdown", (event) => drag(event, drawn, room));
  return drawn;
}

function drag(event, drawn, room) {
  event.preventDefault();
  drawn.setPointerCapture(event.pointerId);
  const begun = { ...places.get(room.name) };
  const move = (moved) => {
    Object.assign(places.get(room.name), inside(...point(moved), 0));
    drawn.setAttribute("transform", `translate(${places.get(room.name).x} ${places.get(room.name).y})`);
  };
  const drop = () => {
    drawn.removeEventListener("pointermove", move);
    const here = places.get(room.name);
    const other = shown.rooms.find((each) => each !== room
      && Math.hypot(places.get(each.name).x - here.x, places.get(each.name).y - here.y) < radius(each));
    if (other) {
      Object.assign(here, begun);
      dropped(room.name, other.name);
    } else if (Math.hypot(here.x - begun.x, here.y - begun.y) > 2) held.add(room.name);
    paint();
  };
  drawn.addEventListener("pointermove", move);
  drawn.addEventListener("pointerup", drop, { once: true });
  drawn.addEventListener("pointercancel", drop, { once: true });
}

/** Where a pointer is, in the drawing's units. */
function point({ clientX, clientY }) {
  const matrix = byId("bubbles").getScreenCTM().inverse();
  const { x, y } = new DOMPoint(clientX, clientY).matrixTransform(matrix);
  return [x, y];
}

function shape(tag, attributes, ...children) {
  const made = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}
