"""``vitruvius bench planted``: briefs, grammars and plans that known houses keep at their limits.

A house exists for each request, so any proof of the opposite is false.
"""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import msgspec

from benchmarks.briefs.at_limits import planted
from benchmarks.briefs.attempts import INTERRUPTED, Attempt, attempt, attempt_at, within
from benchmarks.briefs.bank import BriefEntry
from benchmarks.briefs.make import Json
from benchmarks.briefs.run import ALONE, warm
from benchmarks.briefs.score import judged
from benchmarks.briefs.tightened import tightened
from benchmarks.common.processes import say
from benchmarks.common.rows import read_rows, write_rows
from vitruvius.logic.errors import RequestError
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import find
from vitruvius.logic.request.brief import alone
from vitruvius.logic.request.given_plan import read_plan
from vitruvius.logic.request.house_request import HouseRequest

BRIEF, GIVEN = "brief", ("grammar", "plan")
"""Kinds of requests: a brief of a random tiling, and a grammar and a plan of a generated house."""

SEED = 56
"""Seed of the houses."""

BASES = (("plain", 3), ("home", 5), ("plain", 5), ("clinic", 6))
"""Grammars and numbers of rooms of the houses, in turn."""

PLANTED = "planted.jsonl"
"""Name of the file with a row for each answer."""


class PlantedRow(msgspec.Struct, frozen=True, omit_defaults=True):
    """The answer to a brief, grammar or plan that a known house keeps."""

    number: int
    kind: str
    """``grammar`` or ``plan``; for a brief, its source, as ``sizes, exact``."""
    rooms: int
    said: str
    """``house``, ``undecided``, ``limit``, ``interrupted``, ``false proof`` or ``wrong house``."""
    seconds: float
    """Processor time."""
    because: tuple[str, ...] = ()
    """Lines of a false proof, faults of a wrong house, or the limit."""
    brief: Json | None = None
    """The brief, if no house keeps it."""

    @property
    def of(self) -> tuple[str, int]:
        """Kind and number of the request."""
        return self.kind if self.kind in GIVEN else BRIEF, self.number

    @property
    def wrong(self) -> bool:
        """True for a false answer."""
        return self.said in ("false proof", "wrong house")


@dataclass(frozen=True)
class PlantedStudy:
    """Answer briefs, grammars and plans that known houses keep at their limits: any proof is false."""

    briefs: int = 2000
    """Number of briefs. The study does not repeat the requests with an answer in the folder."""

    houses: int = 100
    """Number of houses, each with a grammar that the house keeps at its limits."""

    boxes: tuple[int, int] = (2, 8)
    """Smallest and largest number of rooms and voids of a brief."""

    seconds: int = 60
    """Seconds of processor time for each answer."""

    out: Path = Path("runs/planted")
    """Folder for planted.jsonl, which has an answer a line."""

    replace: bool = False
    """Write into the folder even if it holds other files."""

    def run(self) -> int:
        """Print the number of each answer by kind, and return 1 if an answer is false."""
        if not 1 <= self.boxes[0] <= self.boxes[-1]:
            raise RequestError("--boxes: the least comes first, and is 1 or more")
        self.out.mkdir(parents=True, exist_ok=True)
        path = self.out / PLANTED
        rows = [row for row in read_rows(path, PlantedRow) if row.said != INTERRUPTED]
        for row in self._answers({row.of for row in rows}):
            rows.append(row)
            say(f"{row.kind} {row.number}: {row.said}, {row.seconds} s")
            write_rows(path, rows)
        counts = Counter((row.kind, row.said) for row in rows)
        for (kind, said), times in sorted(counts.items()):
            print(f"{kind:16}{said:12}{times:6}")
        return int(any(row.wrong for row in rows))

    def _answers(self, done: set[tuple[str, int]]) -> Iterator[PlantedRow]:
        """Yield the answers that are not done. SWI-Prolog holds one grammar at a time."""
        builder = warm(ALONE, ())
        for number in range(self.briefs):
            if (BRIEF, number) not in done:
                entry = planted(number, *self.boxes)
                found = within(self.seconds, partial(attempt, builder, alone(entry.read)))
                yield row_of(number, entry, found)
        for number in range(self.houses):
            if kinds := [kind for kind in GIVEN if (kind, number) not in done]:
                yield from self._of_a_house(number, kinds)

    def _of_a_house(self, number: int, kinds: list[str]) -> Iterator[PlantedRow]:
        base, rooms = BASES[number % len(BASES)]
        builder = Builder(find(base))
        house = builder.house(HouseRequest(rooms), SEED, number)
        with TemporaryDirectory() as folder:
            strict = Builder(find(tightened(builder, house, Path(folder) / "mine")))
            types = Counter(room.type for room in house.rooms)
            exact = {type_: (times, times) for type_, times in types.items()}
            requests = {
                "grammar": HouseRequest(rooms, exact),
                "plan": HouseRequest(rooms, plan=read_plan(house)),
            }
            for kind in kinds:
                found = within(self.seconds, partial(attempt_at, strict, requests[kind]))
                proved = found.because is not None
                said = "false proof" if proved else "house" if found.houses else unanswered(found.limit)
                because = found.because or tuple(filter(None, [found.limit]))
                yield PlantedRow(number, kind, rooms, said, round(found.seconds, 3), because)


def row_of(number: int, entry: BriefEntry, found: Attempt) -> PlantedRow:
    """Return the row of an answer to a planted brief."""
    answer = judged(entry, found.answer(entry))
    faults = [*answer.faults, *(line.words for line in answer.lines if not line.kept)]
    if answer.said == "impossible":
        said, because = "false proof", found.because or ()
    elif answer.said == "house":
        said, because = ("wrong house", tuple(faults)) if faults else ("house", ())
    else:
        said, because = unanswered(found.limit), (found.limit,)
    brief = None if said == "house" else entry.brief
    return PlantedRow(number, entry.source, entry.rooms, said, round(found.seconds, 3), because, brief)


def unanswered(limit: str) -> str:
    """Return the kind of an answer that is neither a house nor a proof."""
    if limit == INTERRUPTED:
        return limit
    return "undecided" if "could not be decided" in limit else "limit"
