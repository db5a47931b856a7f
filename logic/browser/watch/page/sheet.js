// The contact sheet: a plan in each cell, whose parts are asked about by a click or by the keyboard.

import { byId, element, neighbour } from "./dom.js";

const sheet = () => byId("sheet");
const houses = new WeakMap();

/** Ask `onAsk(house, part, index)` about the parts that are clicked, or chosen by Enter. */
export function initSheet(onAsk) {
  const ask = (part) => {
    const cell = part.closest("li");
    mark(part);
    onAsk(houses.get(cell), part.dataset.part, [...sheet().children].indexOf(cell));
  };
  sheet().addEventListener("click", (event) => {
    const part = event.target.closest("[data-part]");
    if (part && !outdated(part)) ask(part);
  });
  sheet().addEventListener("keydown", (event) => {
    const part = event.target.closest("[data-part]");
    if (!part) return;
    if (event.key === "Enter" || event.key === " ") {
      if (!outdated(part)) ask(part);
    } else if (!move(part, event.key)) return;
    event.preventDefault();
  });
}

/** House `index` has this plan from now on; `types` are those of its rooms. */
export function showHouse(index, house, types, svg) {
  const plan = document.importNode(new DOMParser().parseFromString(svg, "image/svg+xml").documentElement, true);
  plan.setAttribute("role", "group");
  plan.setAttribute("aria-label", `House ${index}: arrow keys go through its parts, Enter asks why`);
  const parts = [...plan.querySelectorAll("[data-part]")];
  parts.forEach((part, turn) => {
    const [room] = part.dataset.part.split(".");
    part.setAttribute("role", "button");
    part.setAttribute("tabindex", turn ? -1 : 0);
    part.setAttribute("aria-label", [part.dataset.part, types[room]].filter(Boolean).join(", "));
  });
  const cell = cellOf(index);
  houses.set(cell, house);
  fill(cell, plan);
}

/** The first house that is shown; undefined without one. */
export const firstHouse = () => [...sheet().children].map((cell) => houses.get(cell)).find(Boolean);

/** There is no house `index`, for this reason. */
export function showProblem(index, text) {
  fill(cellOf(index), element("p", { className: "problem" }, text));
}

/** What is shown is of another request, or of rules that are not those of the files any more. */
export function setOutdated() {
  for (const cell of sheet().children) cell.classList.add("old");
}

/** Grey cells where houses will come: so many cells in all, if there are not more. */
export function showWaiting(count) {
  if (count) cellOf(count - 1);
}

/** No cells of houses that will not come. */
export function dropWaiting() {
  for (const cell of [...sheet().children]) if (!cell.hasChildNodes()) cell.remove();
}

/** No more than these cells. */
export function keepFirst(count) {
  while (sheet().children.length > count) sheet().lastChild.remove();
}

/** Nothing is asked about. */
export function mark(part = null) {
  sheet().querySelector(".asked")?.classList.remove("asked");
  part?.classList.add("asked");
}

const outdated = (part) => part.closest("li").classList.contains("old");

function cellOf(index) {
  while (sheet().children.length <= index) sheet().append(element("li", { className: "old" }));
  return sheet().children[index];
}

function fill(cell, content) {
  const held = cell.contains(document.activeElement);
  cell.classList.remove("old");
  cell.replaceChildren(content);
  if (held) cell.querySelector("[tabindex='0']")?.focus();
}

/** Move the focus within a plan, or to the same place of the plan above or below; whether it moved. */
function move(part, key) {
  const parts = [...part.closest("svg").querySelectorAll("[data-part]")];
  const to = neighbour(key, parts.indexOf(part), parts.length);
  if (to !== undefined) {
    part.setAttribute("tabindex", -1);
    parts[to].setAttribute("tabindex", 0);
    parts[to].focus();
    return true;
  }
  const cells = [...sheet().children];
  const cell = cells[cells.indexOf(part.closest("li")) + ({ ArrowDown: 1, ArrowUp: -1 }[key] ?? 0)];
  if (!["ArrowDown", "ArrowUp"].includes(key) || !cell) return false;
  cell.querySelector("[tabindex='0']")?.focus();
  return true;
}
