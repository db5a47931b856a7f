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

for (const place of document.querySelectorAll(".plans")) attempted(place, showPlans);
