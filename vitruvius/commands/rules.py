"""Commands ``vitruvius lint`` and ``explain``: mistakes in rules; rules behind a request or a house."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import reduce
from pathlib import Path
from typing import Annotated, ClassVar

import tyro

from vitruvius.commands.common import Repeated, counts, print_answer, require_plan, say_warnings
from vitruvius.logic.errors import RequestError
from vitruvius.logic.spelling import numbered, printable, quoted
from vitruvius.logic.terminal import say
from vitruvius.options import Streamed


@dataclass(frozen=True)
class Explain:
    """Explain why no house satisfies a request (--rooms), or why a house is so (HOUSES --why R3.bed)."""

    groups: ClassVar = {"why": "Part of a house", "rooms": "A request", "grammar": "Rules, limits, answer"}

    file: tyro.conf.Positional[Annotated[Streamed | None, tyro.conf.arg(metavar="[HOUSES]")]] = None
    """House file: the command explains a part of a house in it."""

    why: str | None = None
    """Part to explain: a room (R3) or a piece (R3.bed, R3.bed2 for the second). In a star also a door
    (R3.door) or main; in a plan also a door (R1-R3), the entrance, a window (R3.window) or a whole unit
    (U1)."""

    house: int = 0
    """Index of the house in the file, counted from 0."""

    rooms: int | None = None
    """Number of rooms, 1 to 128, without the main room in family."""

    type: Annotated[tuple[str, ...], Repeated, tyro.conf.arg(metavar="TYPE=COUNT")] = ()
    """Number of rooms of a type: bedroom=2, bedroom=1..3 or bedroom=2.. ."""

    piece: Annotated[tuple[str, ...], Repeated, tyro.conf.arg(metavar="[TYPE.]PIECE=COUNT")] = ()
    """Number of pieces in each room that may have them: bed=1, bedroom.wardrobe=1..2."""

    brief: Streamed | None = None
    """JSON file (docs/briefs.md): requirements on rooms, each by its name."""

    plan: Streamed | None = None
    """House file of one house, GeoJSON, or a plan of HouseExpo, ResPlan, CubiCasa5K, IMDF or IFC, with all
    rooms in their places."""

    plan_unit: str | None = None
    """Unit of a plan that is not a house file: m, dm, cm, mm, ft, in, or metres per unit, as in 0.02; by
    default the file's unit, or m."""

    snap: float = 0.01
    """Distance in metres within which edges of the plan's rooms become one wall; the command prints what it
    moves."""

    storey: str | None = None
    """Name of the storey to read, for a plan with several storeys."""

    cell: float = 0.0
    """Side of a grid's cells in metres; 0 for no grid."""

    grammar: str | None = None
    """Name of a shipped grammar, or a directory of rules; by default family, or the house's own grammar."""

    seconds: float = 60.0
    """Time limit in seconds."""

    json: bool = False
    """Print one answer as JSON, for programs."""

    def run(self) -> int:
        """Print the reasons; return 1 if a request has a house after all."""
        from vitruvius.answers.houses import Explained
        from vitruvius.logic import Unsatisfiable, generate

        say_warnings()
        if self.file is not None:
            return self._house(self.file)
        if (self.rooms is None and self.plan is None and self.brief is None) or self.why is not None:
            raise RequestError(
                "explain a request, as in explain --rooms 3 --type bathroom=9, or a part of a house, as in "
                "explain houses.jsonl --why R3"
            )
        require_plan(self.plan, self.plan_unit, self.snap, self.storey)
        houses = generate(
            rooms=self.rooms,
            types=counts("--type", self.type),
            furniture=counts("--piece", self.piece),
            brief=self.brief,
            plan=self.plan,
            plan_unit=self.plan_unit,
            snap=self.snap,
            storey=self.storey,
            cell=self.cell,
            grammar=self.grammar,
            seconds=self.seconds,
        )
        try:
            next(houses)
        except Unsatisfiable as proof:
            if self.json:
                conflict = (proof.reasons, proof.advice, proof.unfurnishable)
                print_answer("explain", Explained(False, proof.grammar, proof.request, *conflict))
            else:
                print(printable(str(proof), "\n"))
            return 0
        if self.json:
            print_answer("explain", Explained(True, self.grammar or ("plain" if self.brief else "family")), 1)
        else:
            print(f"There are such houses: {self._generate()}")
        return 1

    def _generate(self) -> str:
        """Return the command that generates a house of the request."""
        asked = {"--grammar": self.grammar, "--rooms": self.rooms, "--brief": self.brief, "--plan": self.plan}
        words = [(flag, value) for flag, value in asked.items() if value is not None]
        words += [("--type", each) for each in self.type] + [("--piece", each) for each in self.piece]
        words += [("--cell", self.cell)] if self.cell else []
        words += [("--plan-unit", self.plan_unit)] if self.plan_unit else []
        words += [("--storey", self.storey)] if self.storey else []
        return " ".join(["vitruvius generate", *(f"{flag} {quoted(value)}" for flag, value in words)])

    def _house(self, file: Path) -> int:
        """Print why a part of a house is as it is."""
        from vitruvius.answers.houses import Explained
        from vitruvius.logic import load
        from vitruvius.logic.why.answer import Why, as_text
        from vitruvius.logic.workers.explain import explained

        asked = {"--rooms": self.rooms, "--type": self.type, "--piece": self.piece, "--cell": self.cell}
        asked |= {"--brief": self.brief, "--plan": self.plan}
        if given := [option for option, value in asked.items() if value]:
            raise RequestError(
                f"{' and '.join(given)}: for a request, not for {file}: leave out the options or the file"
            )
        if self.why is None:
            raise RequestError(
                f"explain {file}: name a part with --why, as in --why R0 or --why R0.bed; of a star --why "
                "main, --why R0.door; of a plan --why entrance, --why R0-R1, --why R0.window"
            )
        houses = load(file)
        if not 0 <= self.house < len(houses):
            raise RequestError(f"--house {self.house}: {file} has houses 0 to {len(houses) - 1}")
        parts = explained(houses[self.house], self.why, grammar=self.grammar, seconds=self.seconds)
        kept = list[Why]()

        def shown() -> "Iterator[Why]":
            for part in parts:
                kept.append(part)
                yield part

        for line in as_text(shown()):
            if not self.json:
                print(printable(line), flush=True)
        answer = reduce(Why.joined, kept)
        code = 4 if answer.limit else 0
        if self.json:
            print_answer("explain", Explained(file=str(file), house=self.house, why=answer), code)
        if answer.limit:
            say(answer.limit)
        return code


@dataclass(frozen=True)
class Lint:
    """Find the mistakes in rule files that clingo and Prolog do not report."""

    grammar: tyro.conf.Positional[str] = "family"
    """Name of a shipped grammar, or a directory of rules."""

    seconds: float = 60.0
    """Time limit in seconds."""

    json: bool = False
    """Print one answer as JSON, for programs."""

    def run(self) -> int:
        """Print a line for each finding; return 1 if any is an error."""
        from vitruvius.answers.houses import Linted
        from vitruvius.logic import lint

        found = list(lint(self.grammar, self.seconds))
        errors = sum(finding.severity == "error" for finding in found)
        if self.json:
            answer = Linted(self.grammar, errors, len(found) - errors, found)
            print_answer("lint", answer, int(errors > 0))
        for finding in [] if self.json else found:
            print(printable(str(finding)))
        say(f"{self.grammar}: {_no(errors, 'error')}, {_no(len(found) - errors, 'warning')}")
        return 1 if errors else 0


def _no(number: int, noun: str) -> str:
    return numbered(number, noun) if number else f"no {noun}s"
