"""Whether walls are refuted falsely: CLP(R), CLP(Q) and HiGHS on the same linear systems of plans."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from clingo import Symbol
from scipy.optimize import linprog

from logic import prolog
from logic.builder import Builder
from logic.differences import DIFFERENCES
from logic.grammar import find
from logic.layout import Program
from logic.terms import parts

Row = tuple[Sequence[tuple[int, float]], float, str]
"""Numbers of unknowns with their factors, a constant, and how the sum of all that is related to zero."""


def feasible(rows: Sequence[Row]) -> bool:
    """What HiGHS says of a linear system, with its tolerance of 1e-7."""
    unknowns = 1 + max(number for pairs, _, _ in rows for number, _ in pairs)
    matrix = np.zeros((len(rows), unknowns))
    for row, (pairs, _, _) in zip(matrix, rows, strict=True):
        for number, factor in pairs:
            row[number] += factor
    bounds = -np.array([constant for _, constant, _ in rows])
    equal = np.array([relation == "=" for _, _, relation in rows])
    found = linprog(
        np.zeros(unknowns),
        matrix[~equal],
        bounds[~equal],
        matrix[equal] if equal.any() else None,
        bounds[equal] if equal.any() else None,
        bounds=[(None, None)] * unknowns,
    )
    return found.status == 0


def systems(builder: Builder, rooms: int, seeds: range) -> Iterator[dict[str, Any]]:
    """Linear systems of the walls of sampled layouts, with what CLP(R) and CLP(Q) say of each.

    The layouts are sampled without what stage 1 knows of lengths: so most are infeasible.
    """
    files = [file for file in builder.grammar.asp if file != DIFFERENCES]
    program = Program(files, {"rooms": rooms}, [("house", []), *parts(_lengths(builder))])
    for seed in seeds:
        layout = program.sample(np.random.default_rng([seed, rooms]))
        assert layout is not None
        yield prolog.ask("plan_system", layout)


def _lengths(builder: Builder) -> list[Symbol]:
    return [fact for fact, _ in builder.loaded.walls if fact.name in ("reach", "length")]


@dataclass(frozen=True)
class Verdicts:
    """Count the verdicts of three solvers on the walls of sampled plans."""

    grammar: str = "home"
    """A grammar whose houses are plans."""

    rooms: tuple[int, ...] = (6, 8, 10)
    """Numbers of rooms."""

    systems: int = 10_000
    """How many linear systems in all."""

    def run(self) -> int:
        """Print how often each combination of verdicts came; 1 where the exact one differs from HiGHS."""
        builder = Builder(find(self.grammar))
        counts: Counter[tuple[bool, bool, bool]] = Counter()
        for rooms in self.rooms:
            for system in systems(builder, rooms, range(self.systems // len(self.rooms))):
                counts[system["real"], system["rational"], feasible(system["rows"])] += 1
        print("CLP(R)  CLP(Q)  HiGHS  systems")
        for verdict, count in sorted(counts.items()):
            print("  ".join("yes   " if each else "no    " for each in verdict), count)
        return int(any(rational != highs for _, rational, highs in counts))
