"""Test for false refutations of walls or furniture: CLP(R), CLP(Q) and HiGHS on the same linear systems."""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from itertools import chain, count
from typing import Any
from unittest.mock import patch

import numpy as np
from clingo import Function, Number, Symbol
from scipy.optimize import linprog

from benchmarks.briefs.bank import frozen
from benchmarks.common.houses import INFERENCES
from vitruvius.logic.errors import LimitReached
from vitruvius.logic.generation.brief import brief_maker
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.generation.furnish import Frame
from vitruvius.logic.generation.loop import NoLayout, Stages, Work, made
from vitruvius.logic.generation.shared_walls import Assumed, PlanDraft, PlanRules, given_room
from vitruvius.logic.grammar import find
from vitruvius.logic.layout.differences import DIFFERENCES
from vitruvius.logic.layout.program import Program
from vitruvius.logic.layout.programs import GIVEN_ROOM_CONSTANTS
from vitruvius.logic.layout.terms import parts
from vitruvius.logic.placement import prolog
from vitruvius.logic.placement.placer import Placer
from vitruvius.logic.placement.plan import Plan
from vitruvius.logic.request.brief import alone
from vitruvius.logic.request.house_request import HouseRequest

WIDE = [Number(mm) for mm in (1, 99_999, 1, 99_999)]

Row = tuple[Sequence[tuple[int, float]], float, str]
"""Row of a linear system: numbers of unknowns with their factors, a constant, and the relation of the sum to
zero."""


def feasible(rows: Sequence[Row]) -> bool:
    """Return True if HiGHS finds a linear system feasible, with its tolerance of 1e-7."""
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
    """Count the combinations of the verdicts of CLP(R), CLP(Q) and HiGHS: True for a solution."""
    return Counter((each["real"], each["rational"], feasible(each["rows"])) for each in systems)


def wall_systems(builder: Builder, rooms: int, seeds: range) -> Iterator[dict[str, Any]]:
    """Yield linear systems of the walls of sampled layouts, with the verdicts of CLP(R) and CLP(Q).

    The layouts are sampled without stage 1's knowledge of lengths, so most are infeasible.
    """
    files = [file for file in builder.grammar.asp if file != DIFFERENCES]
    facts = [fact for fact, _ in builder.loaded.house_facts if fact.name in ("reach", "length")]
    program = Program(files, {"rooms": rooms}, [("house", []), *parts(facts)])
    for seed in seeds:
        layout = program.sample(np.random.default_rng([seed, rooms]))
        assert layout is not None
        yield prolog.ask("plan_system", layout)


def furniture_systems(builder: Builder, seeds: range) -> Iterator[dict[str, Any]]:
    """Yield systems of the furniture of single rooms of a star, with every size unknown, and verdicts."""
    types = sorted(builder.loaded.furniture)
    programs = {type_: Program(*_lax(builder, type_, "capacity")) for type_ in types}
    for seed in seeds:
        type_ = types[seed % len(types)]
        layout = programs[type_].sample(np.random.default_rng(seed))
        assert layout is not None
        yield prolog.ask("room_system", type_, layout)


def given_systems(builder: Builder, rooms: int, seeds: range) -> Iterator[dict[str, Any]]:
    """Yield systems of the furniture of sampled plans' rooms, with given sizes and doors, and verdicts."""
    rules = PlanRules(builder.grammar, builder.loaded, builder.maker.feasibility, builder.programs)
    request = HouseRequest(rooms)
    for seed in seeds:
        rng = np.random.default_rng(seed)
        draft = PlanDraft(
            rules, request, Work(rng, INFERENCES), Assumed(*builder.programs.rooms_for(request))
        )
        plan = made(Stages(draft.sample, draft.place, lambda _, plan: plan, draft.learn))
        for number in range(rooms):
            room = given_room(plan, number)
            if not builder.programs.has_furniture(room.type):
                continue
            frame = Frame(room)
            program = Program(*_lax(builder, room.type, "plan", frame.facts()))
            layout = program.sample(rng, *frame.given())
            assert layout is not None
            yield prolog.ask("given_room_system", frame.term(number, room.type, layout, 0))


def brief_systems(builder: Builder, rooms: Sequence[int]) -> Iterator[dict[str, Any]]:
    """Yield, without end, systems of the layouts that occur when houses of frozen briefs are made.

    The briefs have these numbers of rooms. The verdict of CLP(R) is that of ``brief.pl``, which refutes
    layouts.
    """
    entries = [entry for entry in frozen() if entry.rooms in rooms]
    for seed in count():
        for entry in entries:
            brief = alone(entry.read)
            request = HouseRequest(entry.rooms, brief=brief)
            maker, systems = brief_maker(builder.grammar, builder.loaded, brief), list[dict[str, Any]]()
            with suppress(NoLayout, LimitReached), _noted(builder.placer, systems):
                maker.made(request, Work(np.random.default_rng(seed), INFERENCES))
            yield from systems


@contextmanager
def _noted(placer: Placer, systems: list[dict[str, Any]]) -> Iterator[None]:
    """Add the systems of all layouts that stage 2 is asked about."""
    walls = placer.walls

    def noted(layout: Sequence[Symbol], *others: Any, **how: Any) -> Plan:
        systems.append(prolog.ask("plan_system", layout))
        return walls(layout, *others, **how)

    with patch.object(placer, "walls", noted):
        yield


def until_refuted(systems: Iterable[dict[str, Any]], number: int) -> Iterator[dict[str, Any]]:
    """Yield systems until ``number`` of them are refuted."""
    for system in systems:
        yield system
        number -= not system["real"]
        if number <= 0:
            return


def _lax(builder: Builder, type_: str, part: str, doorways: Sequence[Symbol] = ()) -> tuple[Any, ...]:
    """Return the rules of a room's furniture for a program without knowledge of lengths."""
    facts = [
        Function(fact.name, [fact.arguments[0], *([Number(0)] if fact.name == "length" else WIDE)])
        for fact, _ in builder.loaded.lengths[type_]
        if part == "capacity" or fact.name != "reach"
    ]
    constants = {"this_room": type_, **(GIVEN_ROOM_CONSTANTS if part == "plan" else {})}
    return builder.grammar.asp, constants, [("room", []), (part, []), *parts([*facts, *doorways])]


@dataclass(frozen=True)
class Verdicts:
    """Count the verdicts of three solvers on sampled plans' walls, and on rooms' furniture."""

    grammar: str = "home"
    """Grammar whose houses are plans."""

    star: str = "family"
    """Grammar whose houses are stars, for the furniture of rooms of any size."""

    rooms: tuple[int, ...] = (6, 8, 10)
    """Numbers of rooms."""

    systems: int = 10_000
    """Number of linear systems of walls."""

    furniture: int = 3000
    """Approximate number of systems of furniture, in stars and in plans each."""

    briefs: int = 2000
    """Number of refuted systems of layouts of frozen briefs, with 5, 8 and 10 rooms."""

    def run(self) -> int:
        """Print the count of each combination of verdicts. Return 1 if CLP(Q) and HiGHS differ."""
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
        """Yield the systems, grammar by grammar, because SWI-Prolog holds one grammar at a time."""
        yield "furniture, stars", furniture_systems(Builder(find(self.star)), range(self.furniture))
        yield "briefs", until_refuted(brief_systems(Builder(find("plain")), (5, 8, 10)), self.briefs)
        builder = Builder(find(self.grammar))
        for name, systems, some in (
            ("furniture, plans", given_systems, self.furniture // sum(self.rooms)),
            ("walls", wall_systems, self.systems // len(self.rooms)),
        ):
            each = (systems(builder, rooms, range(some)) for rooms in self.rooms)
            yield name, chain.from_iterable(each)
