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

/* ---- plans ---- */

const SHEET = 24; // plans that are shown at first, and more at a time

async function showPlans(place) {
  const text = await (await inflated(document.getElementById("plans-data").textContent)).text();
  const plans = JSON.parse(text);
  place.append(document.getElementById("filters").content.cloneNode(true));
  const form = place.querySelector(".filters");
  const fields = form.elements;
  const sheet = place.querySelector(".sheet");
  const more = place.querySelector(".more");
  const dialog = place.querySelector("dialog");
  let chosen = plans;
  let open = 0; // which of the chosen is shown large

  function offer(field, values, any) {
    const sorted = [...new Set(values)].sort((a, b) => (typeof a === "number" ? a - b : a.localeCompare(b)));
    fields[field].append(...(any ? [made("option", { value: "" }, any)] : []));
    fields[field].append(...sorted.map((value) => made("option", { value }, String(value))));
  }
  const rooms = plans.map((plan) => plan.rooms);
  offer("file", plans.map((plan) => plan.file), "all");
  offer("grammar", plans.map((plan) => plan.grammar), "all");
  offer("least", rooms);
  offer("most", rooms);
  offer("type", plans.flatMap((plan) => Object.keys(plan.types)), "any");
  offer("piece", plans.flatMap((plan) => Object.keys(plan.pieces)), "any");
  const policies = [...new Set(plans.flatMap((plan) => Object.keys(plan.ratios)))];
  if (policies.length) {
    const group = made("optgroup", { label: "lowest ratio to the oracle first" });
    group.append(...policies.map((policy) => made("option", { value: policy }, policy)));
    fields.order.append(group);
  }
  // What a form's reset goes back to.
  fields.most.options[fields.most.options.length - 1].defaultSelected = true;
  fields.most.selectedIndex = fields.most.options.length - 1;

  function suits(plan) {
    const asked = (field) => fields[field].value;
    return (
      (!asked("file") || plan.file === asked("file")) &&
      (!asked("grammar") || plan.grammar === asked("grammar")) &&
      plan.rooms >= Number(asked("least")) &&
      plan.rooms <= Number(asked("most")) &&
      (!asked("type") || (plan.types[asked("type")] ?? 0) >= Number(asked("count"))) &&
      (!asked("piece") || asked("piece") in plan.pieces)
    );
  }

  function card(plan, place) {
    const where = `${plan.file}, house ${plan.index}`;
    const ratio = plan.ratios[fields.order.value];
    const words = ratio === undefined ? where : `${where}: ratio ${ratio ?? "none"}`;
    const button = made("button", { type: "button", "aria-label": `${words}: ${plan.rooms} rooms, ${plan.area} m²` });
    const drawn = picture(plan.svg);
    drawn.setAttribute("aria-hidden", "true");
    button.append(drawn, made("span", {}, words));
    button.addEventListener("click", () => enlarge(place));
    return made("li", {}, button);
  }

  function showMore() {
    const from = sheet.children.length;
    sheet.append(...chosen.slice(from, from + SHEET).map((plan, k) => card(plan, from + k)));
    more.hidden = sheet.children.length >= chosen.length;
    more.textContent = `Show more (${chosen.length - sheet.children.length} left)`;
  }

  function filter() {
    chosen = plans.filter(suits);
    const order = fields.order.value;
    const ratio = (plan) => plan.ratios[order] ?? Infinity; // what was not measured comes last
    if (order === "small") chosen.sort((a, b) => a.area - b.area);
    else if (order === "large") chosen.sort((a, b) => b.area - a.area);
    else if (order !== "file") chosen.sort((a, b) => (ratio(a) < ratio(b) ? -1 : Number(ratio(a) > ratio(b))));
    fields.count.disabled = !fields.type.value;
    form.querySelector("output").textContent = `${chosen.length} of ${plans.length} houses`;
    sheet.replaceChildren();
    showMore();
  }

  function enlarge(place) {
    open = (place + chosen.length) % chosen.length;
    const plan = chosen[open];
    dialog.querySelector(".large").replaceChildren(picture(plan.svg), made("p", {}, `${plan.file}, house ${plan.index}`));
    if (!dialog.open) dialog.showModal();
  }

  form.addEventListener("change", filter);
  form.addEventListener("submit", (event) => event.preventDefault());
  form.addEventListener("reset", () => setTimeout(filter)); // once its fields are as they were
  more.addEventListener("click", showMore);
  dialog.querySelector("[data-do=before]").addEventListener("click", () => enlarge(open - 1));
  dialog.querySelector("[data-do=after]").addEventListener("click", () => enlarge(open + 1));
  dialog.addEventListener("keydown", (event) => {
    if (event.key === "ArrowLeft") enlarge(open - 1);
    if (event.key === "ArrowRight") enlarge(open + 1);
  });
  filter();
}

/* ---- episodes ---- */

const HEADINGS = [[1, 0], [1, -1], [0, -1], [-1, -1], [-1, 0], [-1, 1], [0, 1], [1, 1]];
const SOUGHT = 1; // goal_kind: a viewpoint; 2: where it believes the target to be
const FORWARD = 2;

/** Colours of a map's ground, as red, green, blue and how much hides the house. */
const GROUND = [[70, 78, 92, 150], [110, 165, 215, 95], [255, 255, 255, 0], [25, 30, 38, 215]];
const BELIEF = [18, 148, 86];
const COLOURS = {
  ray: "rgb(84 108 140 / 50%)", fan: "rgb(84 108 140 / 12%)", hit: "#e07a14", path: "#1f5ea8", body: "#1f5ea8",
  target: "#f5b22d", edge: "#8a5a04", view: "#8c46a0", veto: "#c22a3c",
};

const LAYERS = [
  ["house", "House", "which the agent never sees"],
  ["target", "Target", "where it really is"],
  ["path", "Path", "the way it came"],
  ["rays", "Rays", "orange ones end on the target"],
  ["map", "Map", "what its planner knows"],
  ["belief", "Belief", "where it may be, by the planner"],
  ["goal", "Goal", "next viewpoint, or believed target"],
  ["values", "Q-values", "of the actions, below"],
  ["vetoes", "Vetoes", "what the avoidance layer forbade"],
];

class Episode {
  constructor(article, trace, columns, map) {
    Object.assign(this, { article, trace, map }, columns);
    this.step = 0;
    this.playing = false;
    this.layers = {};
    this.scale = Number(article.dataset.scale);
    this.left = Number(article.dataset.left);
    this.top = Number(article.dataset.top);
    this.stage = article.querySelector(".stage");
    this.plan = this.stage.querySelector("svg");
    this.width = this.plan.viewBox.baseVal.width;
    this.height = this.plan.viewBox.baseVal.height;
    this.canvas = this.stage.appendChild(made("canvas", { "aria-hidden": "true" }));
    this.stage.tabIndex = 0;
    this.stage.setAttribute("role", "group");
    this.stage.setAttribute("aria-label", "The episode from above. Space plays, arrows go step by step.");
    article.append(document.getElementById("player").content.cloneNode(true));
    this.range = article.querySelector("input[type=range]");
    this.range.max = trace.length;
    this.vetoes = this.wanted.reduce((steps, wanted, t) => (wanted === this.action[t] ? steps : [...steps, t]), []);
    this.pickups = [];
    for (let t = 1; t <= trace.length; t++) if (this.found[t] > this.found[t - 1]) this.pickups.push(t);
    this.addLayers();
    this.addValues();
    this.addTimeline();
    this.listen();
    new ResizeObserver(() => this.draw()).observe(this.stage);
    this.show(0);
  }

  /* -- what is there to see -- */

  has(layer) {
    if (layer === "map" || layer === "belief") return Boolean(this.map);
    if (layer === "goal") return Boolean(this.goal_kind);
    return layer !== "values" || Boolean(this.values);
  }

  /** The eye's place at a state, metres. */
  eye(t) {
    const { origin, sensor } = this.trace;
    const shift = this.heading[t] % 2 ? sensor.eye[1] - sensor.eye[0] : 0;
    return [origin[0] + this.east[t] * sensor.step + shift, origin[1] + this.south[t] * sensor.step + shift];
  }

  /** The place in the map's pictures of what it knew at a state. */
  frame(t) {
    return Math.min(Math.floor(Math.min(t, this.trace.length - 1) / this.trace.map.every), this.map.count - 1);
  }

  /* -- controls -- */

  addLayers() {
    const field = this.article.querySelector(".layers");
    LAYERS.forEach(([name, title, meaning], k) => {
      const box = made("input", { type: "checkbox", name });
      box.disabled = !this.has(name);
      box.checked = !box.disabled;
      this.layers[name] = box;
      const words = made("span", {}, `${title} `, made("small", {}, box.disabled ? "not in this episode" : meaning));
      field.append(made("label", {}, box, words, made("kbd", {}, String(k + 1))));
      box.addEventListener("change", () => this.show(this.step));
    });
    if (!this.map) return;
    const key = made("small", { class: "key" });
    const marks = [["never seen", GROUND[0]], ["seen before the last pick-up", GROUND[1]], ["occupied", GROUND[3]], ["belief", [...BELIEF, 160]]];
    for (const [words, [red, green, blue, alpha]] of marks) {
      const mark = made("i");
      const colour = `rgb(${red} ${green} ${blue} / ${alpha / 255})`;
      mark.style.background = `linear-gradient(${colour}, ${colour}), white`;
      key.append(made("span", {}, mark, words), " ");
    }
    field.append(key);
  }

  addValues() {
    const rows = this.trace.actions.map((name) => {
      const bar = made("svg", { class: "bar", viewBox: "-50 0 100 10", preserveAspectRatio: "none", "aria-hidden": "true" });
      bar.append(made("rect", { y: 1, height: 8 }), made("line", { x1: 0, x2: 0, y1: 0, y2: 10 }));
      return made("tr", {}, made("th", { scope: "row" }, name), made("td"), made("td", {}, bar), made("td"));
    });
    this.article.querySelector(".choice tbody").append(...rows);
    this.rows = rows;
    if (!this.values) return;
    // How far values lie from the mean of their step: a bar is full where few are farther.
    const apart = Array.from({ length: this.trace.length }, (_, t) => Math.max(...this.aboveMean(t).map(Math.abs)));
    this.spread = apart.sort((a, b) => a - b)[Math.floor(0.95 * apart.length)] || 1;
  }

  q(t) {
    const count = this.trace.actions.length;
    return [...this.values.slice(t * count, (t + 1) * count)].map((value) => value * this.trace.value_unit);
  }

  /** Q-values less their mean. */
  aboveMean(t) {
    const q = this.q(t);
    const mean = q.reduce((sum, value) => sum + value, 0) / q.length;
    return q.map((value) => value - mean);
  }

  addTimeline() {
    const svg = this.article.querySelector(".timeline");
    const { length } = this.trace;
    svg.setAttribute("viewBox", `0 0 ${length} 46`);
    if (this.values) {
      const best = Array.from({ length }, (_, t) => Math.max(...this.q(t)));
      const [low, high] = [Math.min(...best), Math.max(...best)];
      const points = best.map((value, t) => `${t},${(44 - (30 * (value - low)) / (high - low || 1)).toFixed(1)}`);
      svg.append(made("polyline", { class: "value", points: points.join(" ") }));
    }
    const tick = (kind, from, to) => (t) => svg.append(made("line", { class: kind, x1: t, x2: t, y1: from, y2: to }));
    this.pickups.forEach(tick("picked", 0, 46));
    this.vetoes.forEach(tick("veto", 0, 10));
    for (let t = 0; t < length; t++) if (this.blocked[t]) tick("bump", 10, 18)(t);
    this.now = svg.appendChild(made("line", { class: "now", y1: 0, y2: 46 }));
    const bumps = this.blocked.reduce((sum, value) => sum + value, 0);
    const key = this.article.querySelector(".timeline-key");
    const said = [[1, "pick-ups", this.pickups.length], [5, "vetoes", this.vetoes.length], [6, "blocked moves", bumps]];
    if (this.values) said.push([0, "greatest Q-value", ""]);
    for (const [slot, words, count] of said.filter((each) => each[2] !== 0)) {
      const mark = made("b", {}, "▍");
      mark.style.color = `var(--c${slot})`;
      key.append(made("span", {}, mark, `${count} ${words}`.trim()));
    }
  }

  listen() {
    this.article.querySelector(".transport").addEventListener("click", (event) => {
      const actions = { play: () => this.toggle(), back: () => this.go(-1), on: () => this.go(1), next: () => this.next(this.pickups) };
      actions[event.target.dataset.do]?.();
    });
    this.range.addEventListener("input", () => {
      this.pause();
      this.show(Number(this.range.value));
    });
    this.article.addEventListener("keydown", (event) => this.key(event));
  }

  key(event) {
    const on = event.target;
    if (event.ctrlKey || event.metaKey || event.altKey || on.matches("select")) return;
    const number = Number(event.key);
    const far = event.shiftKey ? 25 : 1;
    const keys = {
      " ": () => this.toggle(),
      ArrowLeft: () => this.go(-far),
      ArrowRight: () => this.go(far),
      Home: () => this.go(-Infinity),
      End: () => this.go(Infinity),
      n: () => this.next(this.pickups),
      v: () => this.next(this.vetoes),
    };
    if (number >= 1 && number <= LAYERS.length) {
      const box = this.layers[LAYERS[number - 1][0]];
      if (!box.disabled) box.click();
    } else if (event.key in keys && !(event.key === " " && on.matches("button, input[type=checkbox], summary"))) {
      keys[event.key]();
    } else return;
    event.preventDefault();
  }

  /* -- time -- */

  toggle() {
    if (this.playing) return this.pause();
    if (this.step >= this.trace.length) this.show(0);
    this.playing = true;
    this.label("Pause");
    let last = performance.now();
    let due = 0;
    const tick = (now) => {
      if (!this.playing) return;
      due += ((now - last) / 1000) * Number(this.article.querySelector(".speed").value);
      last = now;
      const steps = Math.floor(due);
      due -= steps;
      if (steps) this.show(this.step + steps);
      if (this.step >= this.trace.length) this.pause();
      else requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  pause() {
    this.playing = false;
    this.label("Play");
  }

  label(words) {
    const button = this.article.querySelector("[data-do=play]");
    button.textContent = words;
  }

  go(by) {
    this.pause();
    this.show(this.step + by);
  }

  next(steps) {
    const found = steps.find((step) => step > this.step);
    if (found !== undefined) this.go(found - this.step);
  }

  show(step) {
    this.step = Math.max(0, Math.min(this.trace.length, step));
    const targets = `${this.found[this.step]} target${this.found[this.step] === 1 ? "" : "s"}`;
    const place = `step ${this.step} of ${this.trace.length}, ${targets}`;
    this.range.value = this.step;
    this.range.setAttribute("aria-valuetext", place);
    this.article.querySelector(".place").textContent = place;
    this.now.setAttribute("x1", this.step);
    this.now.setAttribute("x2", this.step);
    this.tell();
    this.draw();
  }

  /** What it does at this step, and why, in the table. */
  tell() {
    const t = this.step;
    const over = t >= this.trace.length;
    const q = this.values && this.layers.values.checked && !over ? this.q(t) : null;
    const above = q ? this.aboveMean(t) : [];
    this.rows.forEach((row, action) => {
      const [, value, bar, note] = row.cells;
      const says = []; // of the action, at this step
      if (!over && this.action[t] === action) says.push("done");
      if (!over && this.advice?.[t] === action) says.push("advised");
      if (!over && !(this.allowed[t] & (1 << action))) says.push("forbidden");
      row.className = !over && this.action[t] === action ? "done" : "";
      note.textContent = says.join(", ");
      note.className = says.includes("forbidden") ? "vetoed" : "";
      value.textContent = q ? q[action].toFixed(3) : "";
      const wide = q ? Math.max(-50, Math.min(50, (50 * above[action]) / this.spread)) : 0;
      const rect = bar.querySelector("rect");
      rect.setAttribute("x", Math.min(0, wide));
      rect.setAttribute("width", Math.abs(wide));
    });
    const words = [];
    const { actions } = this.trace;
    if (over) words.push("The episode is over.");
    else if (this.layers.vetoes.checked && this.wanted[t] !== this.action[t]) {
      words.push(`Veto: it preferred “${actions[this.wanted[t]]}”, the avoidance layer left “${actions[this.action[t]]}”.`);
    }
    if (!over && this.blocked[t]) words.push("The move is blocked: it stays where it is.");
    if (!over && this.goal_kind?.[t] === 2) words.push("It has seen the target and goes to where it believes it to be.");
    if (!over && this.goal_kind?.[t] === SOUGHT) words.push("It goes to a viewpoint, to look for the target.");
    this.article.querySelector(".choice .words").textContent = words.join(" ");
  }

  /* -- picture -- */

  draw() {
    const box = this.stage.getBoundingClientRect();
    const density = window.devicePixelRatio || 1;
    const [width, height] = [Math.round(box.width * density), Math.round(box.height * density)];
    if (!width || !height) return;
    if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, { width, height });
    const pen = this.canvas.getContext("2d");
    const shown = (layer) => this.layers[layer].checked;
    const zoom = this.plan.getBoundingClientRect().width / this.width;
    this.plan.style.visibility = "visible";
    if (!shown("house")) this.plan.style.visibility = "hidden";
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, width, height);
    // From here on lengths are metres, as the house has them.
    const px = density * zoom;
    pen.setTransform(px * this.scale, 0, 0, px * this.scale, px * this.left, px * this.top);
    pen.lineJoin = pen.lineCap = "round";
    if (shown("map")) this.drawMap(pen);
    if (shown("belief")) this.drawBelief(pen);
    if (shown("target")) this.drawTarget(pen);
    if (shown("path")) this.drawPath(pen);
    if (shown("vetoes")) this.drawVetoes(pen);
    if (shown("rays")) this.drawRays(pen);
    if (shown("goal")) this.drawGoal(pen);
    this.drawBody(pen);
  }

  /** A picture of cells: ``colour`` gives red, green, blue and alpha of a value. */
  drawCells(pen, values, colour) {
    const { map } = this.trace;
    const [, height, width] = map.ground.shape;
    const image = new ImageData(width, height);
    const from = this.frame(this.step) * width * height;
    for (let k = 0; k < width * height; k++) image.data.set(colour(values[from + k]), 4 * k);
    this.cells ??= made("canvas");
    Object.assign(this.cells, { width, height });
    this.cells.getContext("2d").putImageData(image, 0, 0);
    pen.imageSmoothingEnabled = false;
    pen.drawImage(this.cells, map.west, map.north, width * map.cell, height * map.cell);
  }

  drawMap(pen) {
    this.drawCells(pen, this.map.ground, (kind) => GROUND[kind]);
  }

  drawBelief(pen) {
    this.drawCells(pen, this.map.belief, (count) => [...BELIEF, count && 30 + 1.3 * count]);
  }

  drawTarget(pen) {
    const [x, y] = this.trace.targets[this.found[this.step]];
    const side = this.trace.sensor.target;
    pen.fillStyle = COLOURS.target;
    pen.strokeStyle = COLOURS.edge;
    pen.lineWidth = 0.03;
    pen.fillRect(x - side / 2, y - side / 2, side, side);
    pen.strokeRect(x - side / 2, y - side / 2, side, side);
  }

  drawPath(pen) {
    pen.beginPath();
    for (let t = 0; t <= this.step; t++) pen.lineTo(...this.eye(t));
    pen.strokeStyle = COLOURS.path;
    pen.globalAlpha = 0.55;
    pen.lineWidth = 0.04;
    pen.stroke();
    pen.globalAlpha = 1;
  }

  drawVetoes(pen) {
    pen.strokeStyle = COLOURS.veto;
    for (const t of this.vetoes) {
      if (t > this.step) break;
      const [x, y] = this.eye(t);
      const arm = t === this.step ? 0.3 : 0.1;
      pen.lineWidth = t === this.step ? 0.08 : 0.035;
      const heading = HEADINGS[this.heading[t]];
      const ahead = this.wanted[t] === FORWARD ? 0.3 / Math.hypot(...heading) : 0;
      const [u, v] = [x + heading[0] * ahead, y + heading[1] * ahead];
      pen.beginPath();
      pen.moveTo(u - arm, v - arm);
      pen.lineTo(u + arm, v + arm);
      pen.moveTo(u - arm, v + arm);
      pen.lineTo(u + arm, v - arm);
      pen.stroke();
    }
  }

  drawRays(pen) {
    const { sensor } = this.trace;
    const [x, y] = this.eye(this.step);
    const bytes = Math.ceil(sensor.rays / 8);
    const ends = Array.from({ length: sensor.rays }, (_, ray) => {
      const angle = ((45 * this.heading[this.step] + sensor.first_ray - sensor.ray_spacing * ray) * Math.PI) / 180;
      const reach = (this.distance[this.step * sensor.rays + ray] / 65535) * sensor.range;
      const hits = (this.hits[this.step * bytes + (ray >> 3)] >> (7 - (ray & 7))) & 1;
      return [x + Math.cos(angle) * reach, y - Math.sin(angle) * reach, hits];
    });
    pen.beginPath();
    pen.moveTo(x, y);
    for (const [u, v] of ends) pen.lineTo(u, v);
    pen.closePath();
    pen.fillStyle = COLOURS.fan;
    pen.fill();
    for (const [u, v, hits] of ends) {
      pen.beginPath();
      pen.moveTo(x, y);
      pen.lineTo(u, v);
      pen.strokeStyle = hits ? COLOURS.hit : COLOURS.ray;
      pen.lineWidth = hits ? 0.03 : 0.015;
      pen.stroke();
    }
  }

  drawGoal(pen) {
    const t = Math.min(this.step, this.trace.length - 1);
    const kind = this.goal_kind[t];
    if (!kind) return;
    const [x, y] = [this.goal[2 * t] / 100, this.goal[2 * t + 1] / 100];
    pen.strokeStyle = kind === SOUGHT ? COLOURS.view : COLOURS.edge;
    pen.lineWidth = 0.06;
    pen.setLineDash([0.15, 0.12]);
    pen.beginPath();
    pen.moveTo(...this.eye(this.step));
    pen.lineTo(x, y);
    pen.stroke();
    pen.setLineDash([]);
    pen.beginPath();
    pen.arc(x, y, 0.2, 0, 2 * Math.PI);
    pen.stroke();
    pen.beginPath();
    pen.arc(x, y, 0.06, 0, 2 * Math.PI);
    pen.fillStyle = pen.strokeStyle;
    pen.fill();
  }

  drawBody(pen) {
    const { sensor } = this.trace;
    const diagonal = this.heading[this.step] % 2;
    const [x, y] = this.eye(this.step);
    const side = sensor.body[diagonal];
    const [west, north] = [x - sensor.eye[diagonal], y - sensor.eye[diagonal]];
    pen.fillStyle = COLOURS.body;
    pen.strokeStyle = "#ffffff";
    pen.lineWidth = 0.025;
    pen.fillRect(west, north, side, side);
    pen.strokeRect(west, north, side, side);
    pen.save();
    pen.translate(west + side / 2, north + side / 2);
    pen.rotate((-this.heading[this.step] * Math.PI) / 4);
    pen.beginPath();
    pen.moveTo(0.4 * side, 0);
    pen.lineTo(-0.25 * side, 0.3 * side);
    pen.lineTo(-0.25 * side, -0.3 * side);
    pen.closePath();
    pen.fillStyle = "#ffffff";
    pen.fill();
    pen.restore();
  }
}

async function play(article) {
  const trace = JSON.parse(article.querySelector("script[type='application/json']").textContent);
  const columns = {};
  for (const [name, column] of Object.entries(trace.columns)) columns[name] = await unpacked(column);
  const map = trace.map && {
    ground: await unpacked(trace.map.ground),
    belief: await unpacked(trace.map.belief),
    count: trace.map.ground.shape[0],
  };
  article.episode = new Episode(article, trace, columns, map);
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

for (const place of document.querySelectorAll(".plans")) attempted(place, showPlans);
for (const article of document.querySelectorAll(".episode")) attempted(article, play);
