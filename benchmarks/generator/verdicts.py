"""Whether walls or furniture are refuted falsely: CLP(R), CLP(Q) and HiGHS on the same linear systems."""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import chain, count
from typing import Any

import numpy as np
from clingo import Function, Number, Symbol
from scipy.optimize import linprog

from benchmarks.briefs.bank import frozen
from benchmarks.common.houses import INFERENCES
from logic.errors import LimitReached
from logic.generation.brief import BriefMaker
from logic.generation.builder import Builder
from logic.generation.evidence import NoLayout
from logic.generation.furnish import Frame
from logic.generation.shared_walls import SharedWallsMaker, given_room
from logic.grammar import find
from logic.layout.differences import DIFFERENCES
from logic.layout.program import Program
from logic.layout.programs import GIVEN
from logic.layout.terms import parts
from logic.placement import prolog
from logic.placement.plan import Plan
from logic.request.brief import alone
from logic.request.request import Request

WIDE = [Number(mm) for mm in (1, 99_999, 1, 99_999)]

Row = tuple[Sequence[tuple[int, float]], float, str]
"""Numbers of unknowns with their factors, a constant, and how the sum of all that is related to zero."""


def feasible(rows: Sequence[Row]) -> bool:
    """What HiGHS says of a linear system, with its tolerance of 1e-7."""
    unknowns = 1 + max((number for pairs, _, _ in rows for number, _ in pairs), default=0)
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


def verdicts(systems: Iterable[dict[str, Any]]) -> Counter[tuple[bool, bool, bool]]:
    """How often each combination came of what CLP(R), CLP(Q) and HiGHS say: there is a solution, or none."""
    return Counter((each["real"], each["rational"], feasible(each["rows"])) for each in systems)


def wall_systems(builder: Builder, rooms: int, seeds: range) -> Iterator[dict[str, Any]]:
    """Linear systems of the walls of sampled layouts, with what CLP(R) and CLP(Q) say of each.

    The layouts are sampled without what stage 1 knows of lengths: so most are infeasible.
    """
    files = [file for file in builder.grammar.asp if file != DIFFERENCES]
    facts = [fact for fact, _ in builder.loaded.house_facts if fact.name in ("reach", "length")]
    program = Program(files, {"rooms": rooms}, [("house", []), *parts(facts)])
    for seed in seeds:
        layout = program.sample(np.random.default_rng([seed, rooms]))
        assert layout is not None
        yield prolog.ask("plan_system", layout)


def furniture_systems(builder: Builder, seeds: range) -> Iterator[dict[str, Any]]:
    """The same of the furniture of single rooms of a star, of which every size is unknown."""
    types = sorted(builder.loaded.furniture)
    programs = {type_: Program(*_lax(builder, type_, "capacity")) for type_ in types}
    for seed in seeds:
        type_ = types[seed % len(types)]
        layout = programs[type_].sample(np.random.default_rng(seed))
        assert layout is not None
        yield prolog.ask("room_system", type_, layout)


def given_systems(builder: Builder, rooms: int, seeds: range) -> Iterator[dict[str, Any]]:
    """The same of the furniture of all rooms of sampled plans, of which the sizes and doors are given."""
    maker = builder.maker
    assert isinstance(maker, SharedWallsMaker)
    for seed in seeds:
        rng = np.random.default_rng(seed)
        plan, *_ = maker.unfurnished(Request(rooms), rng, INFERENCES, [])
        for number in range(rooms):
            room = given_room(plan, number)
            if not builder.programs.has_furniture(room.type):
                continue
            frame = Frame(room)
            program = Program(*_lax(builder, room.type, "plan", frame.facts()))
            layout = program.sample(rng, *frame.given())
            assert layout is not None
            yield prolog.ask("given_room_system", frame.term(number, room.type, layout, 0))


class AskedMaker(BriefMaker):
    """Keeps the systems of all layouts that stage 2 is asked about."""

    systems: list[dict[str, Any]]

    def _walls(self, request: Request, layout: list[Symbol], seed: int, inferences: int) -> Plan:
        self.systems.append(prolog.ask("plan_system", layout))
        return super()._walls(request, layout, seed, inferences)


def brief_systems(builder: Builder, rooms: Sequence[int]) -> Iterator[dict[str, Any]]:
    """The same of the layouts that come up in making houses of the frozen briefs with these rooms, without
    end; in the place of CLP(R) is what refutes layouts (``brief.pl``).
    """
    entries = [entry for entry in frozen() if entry.rooms in rooms]
    for seed in count():
        for entry in entries:
            maker = AskedMaker(builder.grammar, builder.loaded, alone(entry.read))
            maker.systems = []
            with suppress(NoLayout, LimitReached):
                maker.made(Request(entry.rooms, brief=maker.brief), np.random.default_rng(seed), INFERENCES)
            yield from maker.systems


def until_refuted(systems: Iterable[dict[str, Any]], number: int) -> Iterator[dict[str, Any]]:
    """Systems until so many of them are refuted."""
    for system in systems:
        yield system
        number -= not system["real"]
        if number <= 0:
            return


def _lax(builder: Builder, type_: str, part: str, doorways: Sequence[Symbol] = ()) -> tuple[Any, ...]:
    """The rules of a room's furniture for a program that knows no lengths."""
    facts = [
        Function(fact.name, [fact.arguments[0], *([Number(0)] if fact.name == "length" else WIDE)])
        for fact, _ in builder.loaded.lengths[type_]
        if part == "capacity" or fact.name != "reach"
    ]
    constants = {"this_room": type_, **(GIVEN if part == "plan" else {})}
    return builder.grammar.asp, constants, [("room", []), (part, []), *parts([*facts, *doorways])]


@dataclass(frozen=True)
class Verdicts:
    """Count the verdicts of three solvers on sampled plans' walls, and on rooms' furniture."""

    grammar: str = "home"
    """A grammar whose houses are plans."""

    star: str = "family"
    """A grammar whose houses are stars, for the furniture of rooms of any size."""

    rooms: tuple[int, ...] = (6, 8, 10)
    """Numbers of rooms."""

    systems: int = 10_000
    """How many linear systems of walls."""

    furniture: int = 3000
    """About how many of furniture, in stars and in plans each."""

    briefs: int = 2000
    """How many refuted ones of layouts of frozen briefs, with 5, 8 and 10 rooms."""

    def run(self) -> int:
        """Print how often each combination of verdicts came; 1 where the exact one differs from HiGHS."""
        print("system            CLP(R)  CLP(Q)  HiGHS   systems")
        wrong = False
        for name, found in self._found():
            counts = verdicts(found)
            for verdict, times in sorted(counts.items()):
                said = "".join("yes     " if each else "no      " for each in verdict)
                print(f"{name:18}{said}{times}", flush=True)
            wrong |= any(rational != highs for _, rational, highs in counts)
        return int(wrong)

    def _found(self) -> Iterator[tuple[str, Iterable[dict[str, Any]]]]:
        """One grammar after the other: SWI-Prolog holds one at a time."""
        yield "furniture, stars", furniture_systems(Builder(find(self.star)), range(self.furniture))
        yield "briefs", until_refuted(brief_systems(Builder(find("plain")), (5, 8, 10)), self.briefs)
        builder = Builder(find(self.grammar))
        for name, systems, some in (
            ("furniture, plans", given_systems, self.furniture // sum(self.rooms)),
            ("walls", wall_systems, self.systems // len(self.rooms)),
        ):
            each = (systems(builder, rooms, range(some)) for rooms in self.rooms)
            yield name, chain.from_iterable(each)
