// The page's address: what stands behind its # outlives a reload, goes with a link, and is undone by Back.

let last = null;

/** What the address says, by name. */
export const address = () => new URLSearchParams(location.hash.slice(1));

/**
 * Note these values in the address; an empty one is left out. Changes of one gesture in a row are one step back,
 * and those of no gesture (null) are none.
 */
export function note(values, gesture) {
  const params = address();
  for (const [name, value] of Object.entries(values)) {
    if (value === "" || value === null) params.delete(name);
    else params.set(name, value);
  }
  if (`${params}` === `${address()}`) return;
  const isStep = gesture !== null && gesture !== last && location.hash !== "";
  history[isStep ? "pushState" : "replaceState"](null, "", `#${params}`);
  if (gesture !== null) last = gesture;
}

/** Call this when the user goes back, forward, or writes another address. */
export function onTravel(go) {
  addEventListener("popstate", () => {
    last = null;
    go();
  });
}
