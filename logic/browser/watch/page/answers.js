// Answers about the houses: why a part is as it is, or why there is no house.

import { byId, element } from "./dom.js";
import { linesWith, place } from "./rules.js";

/** CSS pixels that stay free around what was asked about. */
const MARGIN = 12;

/** Begin with no answer; `onClose` is called when the user closes one. */
export function initAnswer(onClose) {
  byId("close").addEventListener("click", onClose);
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape" && !byId("answer").hidden) onClose();
  });
}

/** Show this text or these elements under a title; where the answer lies over the page, what was asked about stays seen. */
export function showAnswer(title, ...content) {
  const answer = byId("answer");
  answer.hidden = false;
  answer.querySelector("h2").textContent = title;
  byId("answer-text").replaceChildren(...content);
  byId("answer-text").scrollTop = 0;
  const asked = document.querySelector(".asked")?.getBoundingClientRect();
  if (!asked || getComputedStyle(answer).position !== "fixed") return;
  const hidden = asked.bottom + MARGIN - answer.getBoundingClientRect().top;
  if (hidden > 0) scrollBy(0, Math.min(hidden, asked.top - MARGIN));
}

export function hideAnswer() {
  byId("answer").hidden = true;
}

/** A minimal conflict: the statements and choices, each with its place. */
export function showProof({ message, reasons, advice }) {
  const [claim] = message.split("\n");
  showAnswer("No such house", element("p", {}, claim), reasonList(reasons), ...advice ? [element("p", {}, advice)] : []);
}

/** Why a part of a house is as it is, section by section. */
export function showWhy(why) {
  const sections = [
    ["Derived from facts and picks", (why.derivations ?? []).map(derivation)],
    ["Alternatives, with all other picks unchanged", (why.choices ?? []).map(choice)],
    ["Lengths, and their possible ranges", (why.lengths ?? []).map(length)],
    ["Bounds that are tight: both sides are equal here", (why.tight ?? []).map(bound)],
  ];
  showAnswer(`Why ${why.target}`, element("p", {}, why.about), ...sections
    .filter(([, items]) => items.length)
    .map(([title, items]) => element("section", {}, element("h3", {}, title), element("ul", {}, ...items))));
}

/** What a part of a house is, and the rules that name its type. */
export function showPart(house, part, index) {
  const [name, inside] = part.split(".");
  const room = house.rooms.find((each) => each.name === name);
  const { type, width, height } = (inside ? piecesOf(room)[inside] : room) ?? {};
  const what = !type ? "A door or a window" : inside ? `A ${type} in ${name} (${room.type})` : `A ${type}`;
  const size = type ? `: ${width.toFixed(2)} m by ${height.toFixed(2)} m` : "";
  const named = type ? linesWith(type) : [];
  showAnswer(`${part} of house ${index}`, element("p", {}, `${what}${size}.`),
    ...named.length ? [element("h3", {}, `Rules that name ${type}`), reasonList(named)] : [],
    element("p", {}, "Why it is so: keep the houses as a file, then ",
      element("code", {}, `vitruvius explain houses.jsonl --house ${index} --why ${part}`)));
}

/** The pieces of a room by their names within it: bed, bed2, bedside. */
function piecesOf(room) {
  const family = (piece) => [piece, ...(piece.children ?? []).flatMap(family)];
  const [found, counts] = [{}, {}];
  for (const piece of (room?.children ?? []).flatMap(family)) {
    counts[piece.type] = (counts[piece.type] ?? 0) + 1;
    found[piece.type + (counts[piece.type] > 1 ? counts[piece.type] : "")] = piece;
  }
  return found;
}

/** An atom, the rule that derives it, and below it the atoms from which it does so. */
function derivation({ atom, rule, means, options, body = [] }) {
  let [source, below] = [rule, body];
  const said = [element("code", {}, atom)];
  if (options?.length) {
    // The rule of all picks says nothing that the options and their own rule do not.
    const option = body.find((each) => each.atom.startsWith("option("));
    [source, below] = [option?.rule, option?.body ?? []];
    said.push(element("span", { className: "pick" }, ` picked out of ${options.join(", ")}`));
  }
  said.push(" ", source ? reason(source) : "see above");
  if (means) said.push(element("p", { className: "means" }, means));
  const stated = below.filter((each) => !each.rule || each.body || !isCore(each.rule.file));
  return element("li", {}, ...said, ...stated.length ? [element("ul", {}, ...stated.map(derivation))] : []);
}

function choice({ name, value, instead = [] }) {
  const able = instead.filter((each) => each.possible).map((each) => each.value);
  const others = able.length ? `, or ${able.join(", ")}` : instead.length ? "" : ", the only value";
  return element("li", {}, element("b", {}, `${name} = ${value}`), others, element("ul", {}, ...instead
    .filter((each) => !each.possible)
    .map(({ value, also, because = [] }) => element("li", {},
      `${value}: ${also?.length ? `only if ${also.join(" and ")} changed too` : "impossible"}, because of`,
      reasonList(because)))));
}

function length({ name, value, least, greatest, no_less, no_more }) {
  const [is, from, to] = [value, least, greatest].map((metres) => metres.toFixed(3));
  if (from === to) return element("li", {}, element("b", {}, `${name} ${is} m`), ", no other", reasonList(no_less));
  const same = JSON.stringify(no_less) === JSON.stringify(no_more);
  return element("li", {}, element("b", {}, `${name} ${is} m`), `, of ${from} to ${to}`,
    ...same ? [reasonList(no_less)] : [" no less:", reasonList(no_less), "no more:", reasonList(no_more)]);
}

const bound = ({ text, because }) => element("li", {}, element("code", {}, text), reasonList(because));

/** Rules and clauses with their places, then what holds in the layout. */
function reasonList(reasons) {
  const stated = reasons.filter((each) => each.file);
  const atoms = reasons.filter((each) => !each.file).map((each) => each.text);
  const items = stated.map((each) => element("li", {}, reason(each)));
  if (atoms.length) items.push(element("li", {}, stated.length ? "with " : "", element("code", {}, atoms.join(", "))));
  if (!items.length) items.push(element("li", {}, "the core alone: rules/room/room.pl"));
  return element("ul", { className: "reasons" }, ...items);
}

function reason({ text, file, line }) {
  return element("span", { className: isCore(file) ? "reason core" : "reason" }, place(file, line), " ", element("code", {}, text));
}

const isCore = (file) => file.startsWith("rules/");
