/* ---- episodes ---- */

const LAYERS = [
  ["house", "House", "which the agent never sees"],
  ["target", "Target", "its true place"],
  ["path", "Path", "the robot's path so far"],
  ["rays", "Rays", "orange ones end on the target"],
  ["map", "Map", "the planner's map"],
  ["belief", "Belief", "the planner's probability of the target's place"],
  ["goal", "Goal", "next viewpoint, or believed target"],
  ["values", "Q-values", "of the actions, below"],
  ["vetoes", "Vetoes", "actions that the safety shield forbade"],
];

class Episode extends EpisodePicture {
  constructor(article, trace, columns, map) {
    super();
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

  /* -- controls -- */

  has(layer) {
    if (layer === "map" || layer === "belief") return Boolean(this.map);
    if (layer === "goal") return Boolean(this.goal_kind);
    return layer !== "values" || Boolean(this.values);
  }

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
    const said = [
      [1, "pick-up", "pick-ups", this.pickups.length], [5, "veto", "vetoes", this.vetoes.length],
      [6, "blocked move", "blocked moves", bumps],
    ];
    if (this.values) said.push([0, "", "greatest Q-value", ""]);
    for (const [slot, one, more, count] of said.filter((each) => each[3] !== 0)) {
      const words = count === 1 ? one : more;
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
      words.push(`Veto: the agent preferred “${actions[this.wanted[t]]}”, the safety shield chose “${actions[this.action[t]]}”.`);
    }
    if (!over && this.blocked[t]) words.push("The move is blocked: the robot does not move.");
    if (!over && this.goal_kind?.[t] === 2) words.push("The robot has seen the target and goes to its estimated place.");
    if (!over && this.goal_kind?.[t] === SOUGHT) words.push("The robot goes to a viewpoint, to look for the target.");
    this.article.querySelector(".choice .words").textContent = words.join(" ");
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

for (const article of document.querySelectorAll(".episode")) attempted(article, play);
