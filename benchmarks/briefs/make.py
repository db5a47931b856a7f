"""Make the frozen bank of briefs from seeds only: ``python -m benchmarks.briefs.make FILE``.

A brief is read off a known plan, so that it has a house by construction. For other briefs, a line is changed,
or lines are added that make the brief impossible, for a reason that needs no solver. The same solver versions
(``requirements.lock``) give the same houses, and so the same bank.
"""

import sys
from argparse import ArgumentParser
from collections.abc import Callable, Iterator
from copy import deepcopy
from itertools import combinations, islice, pairwise
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.briefs.bank import BriefEntry, save_entries
from benchmarks.briefs.boxes import SIDES
from benchmarks.briefs.judge import faults, lines
from benchmarks.briefs.plans import KnownPlan, of_dissection, of_houses
from vitruvius.logic.dataset.splits import TEST

HOUSES = {
    "home": {5: 20, 8: 20, 10: 20, 12: 20},
    "clinic": {5: 6, 8: 6, 10: 6, 12: 6, 16: 10},
    "apartments": {8: 6, 10: 6, 12: 6, 16: 10},
    "plain": {5: 6, 8: 6, 10: 6, 12: 6},
}
"""Number of briefs that are read off houses of each grammar, by number of rooms."""

DISSECTIONS = {5: 30, 8: 30, 10: 30, 12: 25, 16: 15}
"""Number of briefs from random dissections, by number of rooms."""

CHANGED = {5: 28, 8: 28, 10: 28, 12: 20}
"""Number of briefs of both kinds that have a line changed, by number of rooms."""

IMPOSSIBLE = {5: 2, 8: 3, 10: 3, 12: 2}
"""Number of impossible briefs for each reason, by number of rooms."""

Json = dict[str, Any]


def read_off(plan: KnownPlan, rng: np.random.Generator) -> Json:
    """Return a brief whose lines a plan keeps."""
    count = len(plan.boxes)
    west, north, east, south = plan.outline
    names = [f"{type_[:1].upper()}{type_[1:]} {number}" for number, type_ in enumerate(plan.types, start=1)]
    sized = count // 3 if rng.random() < 1 / 3 else 0
    rooms = []
    for number, box in enumerate(plan.boxes):
        width, depth = round(box[2] - box[0], 2), round(box[3] - box[1], 2)
        room: Json = {"name": names[number], "type": plan.types[number]}
        if number < sized:
            room["size"] = [width, depth]
        else:
            room["area"] = round(width * depth, 1)
        outer = plan.outer(number)
        if outer and rng.random() < 0.3:
            room["outside"] = True if rng.random() < 0.5 else [outer[0]]
        rooms.append(room)
    brief: Json = {"rooms": rooms, "doors": _named(plan.doors, names), "entrance": names[plan.entrance]}
    if rng.random() < 0.3:
        brief["entrance"] = {"room": names[plan.entrance], "side": plan.outer(plan.entrance)[0]}
    near = [pair for pair in plan.pairs(0.3, np.inf) if pair not in plan.doors]
    brief["next_to"] = _named(_some(near, count // 5, rng), names)
    brief["no_doors"] = _named(_some(near, count // 8, rng), names)
    brief["apart"] = _named(
        _some([pair for pair in plan.pairs(-1, 0) if pair not in near], count // 4, rng), names
    )
    outline: Json = {}
    if rng.random() < 0.6:
        outline |= {"width": round(east - west, 2), "depth": round(south - north, 2)}
    if plan.voids:
        outline["voids"] = [_void(void, plan) for void in plan.voids]
    return brief | ({"outline": outline} if outline else {})


def _void(void: tuple[float, ...], plan: KnownPlan) -> Json:
    size = {"width": round(void[2] - void[0], 2), "depth": round(void[3] - void[1], 2)}
    rim = [abs(a - b) < 1e-9 for a, b in zip(void, plan.outline, strict=True)]
    at = [side for side, there in zip(SIDES, rim, strict=True) if there]
    corner = [side for side in ("north", "south", "west", "east") if side in at]
    if len(corner) == 2 and corner[0] in ("north", "south") and corner[1] in ("west", "east"):
        return size | {"corner": "-".join(corner)}
    return size | {"x": round(void[0], 2), "y": round(void[1], 2)}


def _named(pairs: Any, names: list[str]) -> list[list[str]]:
    return [[names[one], names[other]] for one, other in pairs]


def _some(pairs: list[Any], count: int, rng: np.random.Generator) -> list[Any]:
    return [pairs[place] for place in sorted(rng.permutation(len(pairs))[:count])]


def proven(entry: BriefEntry, plan: KnownPlan) -> BriefEntry:
    """Return the entry, after a check that a plan keeps its brief."""
    brief = entry.read
    house = plan.house(brief.names)
    wrong = faults(house, brief) + [line.words for line in lines(house, brief) if not line.kept]
    if wrong:
        raise ValueError(f"{entry.name}: {wrong[0]}")
    return entry


# - one line changed ----------------------------------------------------------


def larger_room(brief: Json, rng: np.random.Generator) -> None:
    """Make the area of a room half as large again."""
    room = rng.choice([room for room in brief["rooms"] if "area" in room])
    room["area"] = round(1.5 * room["area"], 1)


def exact_areas(brief: Json, rng: np.random.Generator) -> None:
    """Let areas be exact to 2 %."""
    brief["tolerance"] = 0.02


def another_door(brief: Json, rng: np.random.Generator) -> None:
    """Add a door between two more rooms."""
    there = {frozenset(pair) for key in ("doors", "apart", "no_doors") for pair in brief[key]}
    names = [room["name"] for room in brief["rooms"]]
    others = [list(pair) for pair in combinations(names, 2) if frozenset(pair) not in there]
    brief["doors"].append(others[rng.integers(len(others))])


def another_outer_wall(brief: Json, rng: np.random.Generator) -> None:
    """Give one more room an outer wall, in the south."""
    room = rng.choice([room for room in brief["rooms"] if "outside" not in room])
    room["outside"] = ["south"]


def another_entrance(brief: Json, rng: np.random.Generator) -> None:
    """Move the entrance to another room."""
    entrance = brief["entrance"]
    now = entrance["room"] if isinstance(entrance, dict) else entrance
    names = [room["name"] for room in brief["rooms"] if room["name"] != now]
    brief["entrance"] = names[rng.integers(len(names))]


def longer_outline(brief: Json, rng: np.random.Generator) -> None:
    """Make the outline 1.4 times as long, with the same area."""
    outline = brief["outline"]
    outline["width"], outline["depth"] = round(1.4 * outline["width"], 2), round(outline["depth"] / 1.4, 2)


def more_apart(brief: Json, rng: np.random.Generator) -> None:
    """Keep rooms apart that were next to each other."""
    brief["apart"].append(brief["next_to"].pop())


CHANGES: dict[str, tuple[Callable[[Json, np.random.Generator], None], Callable[[Json], Any]]] = {
    "a room has half as much area again": (larger_room, lambda brief: True),
    "areas are within 2 %": (exact_areas, lambda brief: True),
    "a door between two more rooms": (another_door, lambda brief: True),
    "one more room has an outer wall, in the south": (another_outer_wall, lambda brief: True),
    "another room has the entrance": (another_entrance, lambda brief: True),
    "the outline is 1.4 times as long, and as large": (
        longer_outline,
        lambda brief: "width" in brief.get("outline", {}) and "voids" not in brief["outline"],
    ),
    "rooms that were next to each other are apart": (more_apart, lambda brief: brief["next_to"]),
}
"""Changes of a brief, each with a condition on the brief."""


# - impossible ----------------------------------------------------------------


def _add(brief: Json, key: str, one: str, other: str) -> None:
    if {one, other} not in map(set, brief[key]):
        brief[key].append([one, other])


def doors_of_five(brief: Json, names: list[str]) -> None:
    """Ask for doors between each two of five rooms, which is impossible: the graph is not planar."""
    for one, other in combinations(names[:5], 2):
        _add(brief, "doors", one, other)
    brief["apart"] = []


def doors_of_four(brief: Json, names: list[str]) -> None:
    """Ask for doors between each two of four rooms, which is impossible with rectangles.

    Three of four such rectangles would enclose one, which takes four rectangles.
    """
    for one, other in combinations(names[:4], 2):
        _add(brief, "doors", one, other)
    brief["apart"] = []


def enclosed_entrance(brief: Json, names: list[str]) -> None:
    """Ask for an entrance in a room with four rooms around it, each next to the following one.

    No three of these five rooms enclose others, so the four enclose the room.
    """
    hub, *ring = names[:5]
    for room in ring:
        _add(brief, "doors", hub, room)
    for one, other in pairwise([*ring, ring[0]]):
        _add(brief, "next_to", one, other)
    brief["apart"], brief["entrance"] = [], hub


def door_and_apart(brief: Json, names: list[str]) -> None:
    """Ask for a door between rooms that are apart; a door is in a wall that both rooms share."""
    brief["apart"].append(brief["doors"][0])


def four_outer_walls(brief: Json, names: list[str]) -> None:
    """Ask for a room at all four sides of the outline, which would be the whole outline."""
    brief["rooms"][1]["outside"] = list(SIDES)


def crossing_rooms(brief: Json, names: list[str]) -> None:
    """Ask for two rooms that reach across the outline in both directions, and would cross."""
    brief["rooms"][0]["outside"], brief["rooms"][1]["outside"] = ["north", "south"], ["west", "east"]


def too_large_together(brief: Json, names: list[str]) -> None:
    """Enlarge all areas until their least total is larger than the outline."""
    for room in brief["rooms"]:
        room["area"] = round(1.25 * room["area"], 1)


def too_small_house(brief: Json, names: list[str]) -> None:
    """Limit the whole house to less than the least total of all areas."""
    total = sum(room["area"] for room in brief["rooms"])
    brief["area"] = [round(0.5 * total, 1), round(0.85 * total, 1)]


def wider_than_the_outline(brief: Json, names: list[str]) -> None:
    """Ask for a square room that is longer than the shorter side of the outline."""
    side = round(1.2 * min(brief["outline"]["width"], brief["outline"]["depth"]), 2)
    brief["rooms"][0].pop("area")
    brief["rooms"][0]["size"] = [side, side]


def too_many_in_the_north(brief: Json, names: list[str]) -> None:
    """Ask for four rooms at the north side, each wider than a quarter of the outline."""
    side = round(0.3 * brief["outline"]["width"], 2)
    for room in brief["rooms"][:4]:
        room.pop("area")
        room |= {"size": [side, side], "outside": ["north"]}


REASONS: dict[str, Callable[[Json, list[str]], None]] = {
    "doors of each of five rooms to each": doors_of_five,
    "doors of each of four rooms to each": doors_of_four,
    "the entrance of an enclosed room": enclosed_entrance,
    "a door between rooms that are apart": door_and_apart,
    "outer walls on all sides": four_outer_walls,
    "rooms that would cross": crossing_rooms,
    "areas larger than the outline": too_large_together,
    "areas larger than the house": too_small_house,
    "a room larger than the outline": wider_than_the_outline,
    "rooms too wide for the north side": too_many_in_the_north,
}
"""Changes that make a possible brief of a random dissection impossible, by reason."""


# - the bank ------------------------------------------------------------------


def of_all_houses(seed: int) -> Iterator[BriefEntry]:
    """Yield briefs read off houses."""
    for number, (grammar, sizes) in enumerate(HOUSES.items()):
        for rooms, count in sizes.items():
            rng = np.random.default_rng([seed, 0, number, rooms])
            for index, plan in enumerate(islice(of_houses(grammar, rooms, TEST.start + seed), count)):
                furnished = grammar if grammar == "home" else ""
                name = f"{grammar}-{rooms}-{index:02}"
                entry = BriefEntry(name, "house", grammar, read_off(plan, rng), "house", furnished)
                yield proven(entry, plan)


def of_all_dissections(seed: int) -> Iterator[BriefEntry]:
    """Yield briefs read off random dissections."""
    for rooms, count in DISSECTIONS.items():
        rng = np.random.default_rng([seed, 1, rooms])
        for index in range(count):
            plan = of_dissection(rooms, rng)
            brief = read_off(plan, rng)
            yield proven(BriefEntry(f"dissection-{rooms}-{index:02}", "dissection", "", brief, "house"), plan)


def changed(entries: list[BriefEntry], seed: int) -> Iterator[BriefEntry]:
    """Yield some of the entries with a line changed; the changes take turns."""
    for rooms, count in CHANGED.items():
        rng = np.random.default_rng([seed, 2, rooms])
        some = [each for each in entries if each.rooms == rooms and each.source != "apartments"]
        changes = list(CHANGES.items())
        for index in range(count):
            words, (change, can) = changes[index % len(changes)]
            able = [each for each in some if can(each.brief)]
            entry = able[rng.integers(len(able))]
            brief = deepcopy(entry.brief)
            change(brief, rng)
            yield BriefEntry(f"changed-{rooms}-{index:02}", "changed", words, brief)


def impossible(seed: int) -> Iterator[BriefEntry]:
    """Yield impossible briefs, made from random dissections."""
    for rooms, count in IMPOSSIBLE.items():
        rng = np.random.default_rng([seed, 3, rooms])
        for number, (words, change) in enumerate(REASONS.items()):
            for index in range(count):
                plan = of_dissection(rooms, rng)
                brief = _plain_brief(plan)
                change(brief, [room["name"] for room in brief["rooms"]])
                name = f"impossible-{rooms}-{number}{index}"
                yield BriefEntry(name, "impossible", words, brief, "impossible")


def _plain_brief(plan: KnownPlan) -> Json:
    """Return a brief with the areas, doors, entrance and outline of a plan."""
    west, north, east, south = plan.outline
    names = [f"Room {number}" for number in range(1, len(plan.boxes) + 1)]
    return {
        "rooms": [
            {"name": name, "area": round((box[2] - box[0]) * (box[3] - box[1]), 1)}
            for name, box in zip(names, plan.boxes, strict=True)
        ],
        "doors": _named(plan.doors, names),
        "next_to": [],
        "apart": [],
        "entrance": names[plan.entrance],
        "outline": {"width": round(east - west, 2), "depth": round(south - north, 2)},
    }


def made(seed: int = 0) -> list[BriefEntry]:
    """Return the entries of the bank."""
    known = [*of_all_houses(seed), *of_all_dissections(seed)]
    return [*known, *changed(known, seed), *impossible(seed)]


def main(file: str) -> int:
    """Make the bank and save it. Return 1 if the file exists already, because a bank is frozen."""
    if Path(file).exists():
        print(f"{file}: is frozen. A new bank needs a new name", file=sys.stderr)
        return 1
    entries = made()
    print(f"{file}: {len(entries)} briefs, {save_entries(entries, Path(file))}")
    return 0


if __name__ == "__main__":
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("file")
    sys.exit(main(parser.parse_args().file))
