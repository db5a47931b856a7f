// Elements by one call, and by their ids.

export const byId = (id) => document.getElementById(id);

/** An element with these properties (of which `dataset` and `aria` are objects) and children. */
export function element(tag, { dataset = {}, aria = {}, ...properties } = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  Object.assign(made.dataset, dataset);
  for (const [name, value] of Object.entries(aria)) made.setAttribute(`aria-${name}`, value);
  made.append(...children);
  return made;
}

/** Which of a row of items takes the focus after this key; undefined for other keys. */
export function neighbour(key, index, count) {
  const to = { ArrowRight: index + 1, ArrowLeft: index - 1, Home: 0, End: count - 1 }[key];
  return to === undefined ? undefined : (to + count) % count;
}
