"""``vitruvius bench realism``: similarity of two sets of plans, and weights that increase it."""

import re
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from clingo import Control

from benchmarks.common.pages import table_rows, versions, write
from benchmarks.realism.figures import PlanFigures, features
from benchmarks.realism.fit import fitted, off, shares, with_weights, written
from benchmarks.realism.plans import made, plans_of
from benchmarks.realism.statistics import Distance, distance, told_apart
from vitruvius.logic.errors import RequestError
from vitruvius.logic.files.writing import write_whole
from vitruvius.logic.grammar import Grammar, find

FEWEST = 20
"""Smallest number of rooms of a type in each set for a comparison, and of plans in a set."""
FITTED_COPY = "fitted"
"""Folder name of a grammar with fitted weights."""
PAIRS = 12
"""Number of pairs of types in the list, which has those with the largest differences."""

PAGE = """{} plans of `{}`, {} of `{}`. A classifier distinguishes unseen plans of both sets
with an area under the curve of **{:.3f}** ± {:.3f} (one standard error; 0.5 is a guess).

| | ours | other | distance | of one set |
|---|---|---|---|---|
{}

The table has means and the 1-D Wasserstein distance of both samples. "of one set" is the threshold that 95 of
100 random splits of both samples together stay below. Proportions are the longer side over the shorter one.

| pair of types | walls that they share in a plan: ours | other |
|---|---|---|
{}
"""

FITTED = """## With the weights of `weights.lp`

A plan has {:.2f} rooms of other types before, {:.2f} after.

"""


@dataclass(frozen=True)
class Realism:
    """Compare areas, proportions, doors and walls of two sets, and classify their plans, in realism.md."""

    ours: str = "home"
    """A grammar, a file of houses, or a folder of plans."""

    other: str = "home"
    """The set to compare with, in the same form. By default the same grammar, which shows the noise without a
    difference."""

    rooms: tuple[int, ...] = tuple(range(4, 11))
    """Numbers of rooms of a grammar's houses."""

    houses: int = 30
    """Number of houses of each number of rooms."""

    seed: int = 0
    """Seed of all random numbers; the other set has the next seed."""

    fit: bool = False
    """Fit the weights of types of the grammar --ours to the other set, and write weights.lp."""

    rounds: int = 4
    """Number of rounds of the fit."""

    out: Path = Path("runs/bench")
    """Folder for realism.md and weights.lp."""

    replace: bool = False
    """Write into the folder even if it holds other files."""

    def run(self) -> None:
        """Read or generate both sets, compare them and write the page; then fit, and compare again."""
        if self.houses < 1 or self.rounds < 1 or not self.rooms or min(self.rooms) < 1:
            raise RequestError("--houses, --rounds and each of --rooms must be 1 or more")
        grammar = find(self.ours) if self.fit else None
        if grammar and (self.out / FITTED_COPY).exists():
            raise RequestError(f"{self.out / FITTED_COPY} already exists: choose another --out folder")
        ours = plans_of(self.ours, self.rooms, self.houses, self.seed)
        other = plans_of(self.other, self.rooms, self.houses, self.seed + 1)
        if min(len(ours), len(other)) < FEWEST:
            raise RequestError(
                f"{len(ours)} and {len(other)} plans are too few: give {FEWEST} or more of each"
            )
        page = [compared(ours, other, self.ours, self.other, self.seed)]
        if grammar:
            weights = self._fitted(grammar, other)
            write_whole(self.out / "weights.lp", written(weights, f", as in {self.other}").encode())
            make = self._maker(self.seed)
            after = _in_copy(grammar, weights, make, self.out / FITTED_COPY)
            page.append(
                FITTED.format(*(off(shares(plans), shares(other)) for plans in (ours, after)))
                + compared(after, other, f"{self.ours}, fitted", self.other, self.seed)
            )
        text = "\n".join(
            [
                "# Realism of plans",
                "",
                *page,
                versions("vitruvius", "clingo", "numpy", "scipy"),
                "",
            ]
        )
        write({"realism.md": text.encode()}, self.out)
        print(text)

    def _maker(self, seed: int) -> Callable[[Path], Sequence[PlanFigures]]:
        return lambda folder: made(folder, self.rooms, self.houses, seed)

    def _fitted(self, grammar: Grammar, other: Sequence[PlanFigures]) -> dict[str, int]:
        """Fit the weights, with houses of other seeds than those of the comparison."""
        make = self._maker(self.seed + 2)
        return fitted(grammar, stated_weights(grammar), other, make, self.rounds, print)


def _in_copy(
    grammar: Grammar, weights: dict[str, int], make: Callable[[Path], Sequence[PlanFigures]], folder: Path
) -> Sequence[PlanFigures]:
    """Return houses with these weights; the copy of the grammar stays for inspection."""
    return make(with_weights(grammar, weights, folder))


def stated_weights(grammar: Grammar) -> dict[str, int]:
    """Return the weight of each type of a grammar."""
    control = Control(["--warn=none"])
    text = "\n".join(f"#program base.\n{file.read_text(encoding='utf-8')}" for file in grammar.own)
    # A type's weight is a fact; statements of other programs about it do not count.
    control.add("base", [], re.sub(r"^\s*#include.*$", "", text, flags=re.MULTILINE))
    control.ground([("base", [])])
    atoms = control.symbolic_atoms
    weights = {str(atom.symbol.arguments[0]): 1 for atom in atoms.by_signature("type", 1)}
    for atom in atoms.by_signature("weight", 2):
        weights[str(atom.symbol.arguments[0])] = atom.symbol.arguments[1].number
    return weights


def compared(
    ours: Sequence[PlanFigures], other: Sequence[PlanFigures], name: str, beside: str, seed: int
) -> str:
    """Return the comparison of both sets, as Markdown."""
    rng = np.random.default_rng(seed)
    types = sorted({type_ for plan in (*ours, *other) for type_ in plan.types})
    area = told_apart(features(ours, types), features(other, types), rng)
    return PAGE.format(
        len(ours),
        name,
        len(other),
        beside,
        *area,
        table_rows(_rows(ours, other, types, rng)),
        table_rows(_pairs(ours, other)),
    )


def _rows(
    ours: Sequence[PlanFigures], other: Sequence[PlanFigures], types: Sequence[str], rng: np.random.Generator
) -> Iterator[list[str]]:
    figures: list[tuple[str, Callable[[PlanFigures], float]]] = [
        ("rooms", lambda plan: float(len(plan.rooms))),
        ("area, m²", lambda plan: plan.area),
        ("doors a room", lambda plan: plan.doors_a_room),
    ]
    figures += [(f"{name}: share of the area", lambda plan, name=name: plan.share(name)) for name in types]
    for name, figure in figures:
        one, beside = (np.array(list(map(figure, plans))) for plans in (ours, other))
        yield _row(name, one, beside, rng)
    for type_ in types:
        for title, index in (("area, m²", 1), ("proportions", 2)):
            one, beside = (
                np.array([room[index] for plan in plans for room in plan.rooms if room[0] == type_])
                for plans in (ours, other)
            )
            if min(len(one), len(beside)) >= FEWEST:
                yield _row(f"{type_}: {title}", one, beside, rng)


def _row(name: str, one: np.ndarray, other: np.ndarray, rng: np.random.Generator) -> list[str]:
    found: Distance = distance(one, other, rng)
    numbers = (one.mean(), other.mean(), found.distance, found.by_halves)
    return [name, *(f"{number:.3g}" for number in numbers)]


def _pairs(ours: Sequence[PlanFigures], other: Sequence[PlanFigures]) -> Iterator[list[str]]:
    sums = [sum((plan.adjacent for plan in plans), Counter[tuple[str, str]]()) for plans in (ours, other)]
    each = {pair: (sums[0][pair] / len(ours), sums[1][pair] / len(other)) for pair in {*sums[0], *sums[1]}}
    for pair, (one, beside) in sorted(
        each.items(), key=lambda item: (-abs(item[1][0] - item[1][1]), item[0])
    )[:PAIRS]:
        yield [" and ".join(pair), f"{one:.2f}", f"{beside:.2f}"]
