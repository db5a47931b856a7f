"use strict";

/* ---- what Python packed: see agent/recording/trace.py and page.py ---- */

const NUMBERS = { uint8: Uint8Array, uint16: Uint16Array, int16: Int16Array };

async function inflated(base64) {
  const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate")));
}

/** The numbers of an array that is kept as differences along its first axis. */
async function unpacked({ type, shape, data }) {
  const values = new NUMBERS[type](await (await inflated(data)).arrayBuffer());
  const row = shape.slice(1).reduce((product, side) => product * side, 1);
  for (let k = row; k < values.length; k++) values[k] += values[k - row]; // modulo its size, as it was packed
  return values;
}

/** An element with attributes and children. */
function made(name, attributes = {}, ...children) {
  const spaced = ["svg", "line", "polyline", "rect"].includes(name) ? "http://www.w3.org/2000/svg" : null;
  const element = spaced ? document.createElementNS(spaced, name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

/** The SVG element of a plan's text; nothing in it can run. */
function picture(text) {
  return document.importNode(new DOMParser().parseFromString(text, "image/svg+xml").documentElement, true);
}

/* ---- theme ---- */

const THEMES = ["system", "light", "dark"];
const theme = document.getElementById("theme");
theme.addEventListener("click", () => {
  const next = THEMES[(THEMES.indexOf(document.documentElement.dataset.theme ?? "system") + 1) % THEMES.length];
  document.documentElement.dataset.theme = next;
  theme.textContent = `Theme: ${next}`;
});

/* ---- tables: a click on a heading sorts the rows ---- */

function sortBy(heading) {
  const table = heading.closest("table");
  const body = table.tBodies[0];
  const falls = heading.getAttribute("aria-sort") !== "descending";
  const order = (row) => {
    const cell = row.cells[heading.cellIndex];
    const number = Number(cell.dataset.order ?? cell.textContent.replace(/,/g, ""));
    return Number.isNaN(number) ? cell.textContent : number;
  };
  const rows = [...body.rows].sort((one, other) => {
    const [a, b] = [order(one), order(other)];
    const sign = typeof a === "number" && typeof b === "number" ? a - b : String(a).localeCompare(String(b));
    return falls ? -sign : sign;
  });
  for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
  heading.setAttribute("aria-sort", falls ? "descending" : "ascending");
  body.append(...rows);
}

for (const button of document.querySelectorAll("table.figures thead button")) {
  button.addEventListener("click", () => sortBy(button.closest("th")));
}

/** One clear line where a browser cannot show a part. */
async function attempted(element, work) {
  try {
    if (!("DecompressionStream" in window)) throw new Error("this browser is older than 2023: use a newer one");
    await work(element);
    element.dataset.ready = "yes";
  } catch (error) {
    element.append(made("p", { class: "trouble", role: "alert" }, `This part cannot be shown: ${error.message}`));
  }
}
