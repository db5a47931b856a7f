"""Answers to the bank's briefs, and their figures, which are the same for every generator."""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

import msgspec
import numpy as np

from benchmarks.briefs.bank import BriefEntry
from benchmarks.briefs.judge import JudgedLine, faults, lines, plan_of
from vitruvius.logic.errors import HouseFileError
from vitruvius.logic.files.house_files import MOST_BYTES
from vitruvius.logic.house.house import House
from vitruvius.logic.opener import opened
from vitruvius.logic.spelling import unknown


class Answer(msgspec.Struct, frozen=True, omit_defaults=True):
    """Answer of a generator to a brief: houses, or ``impossible``; with neither, no answer."""

    brief: str
    """Name of the brief in the bank."""
    houses: tuple[dict[str, Any], ...] = ()
    """Houses in the form of ``docs/house.schema.json``: the first one is judged, all count for diversity."""
    impossible: bool = False
    because: tuple[str, ...] = ()
    """Lines that are in conflict, in words."""
    seconds: float | None = None
    """Processor time until the first house or the proof."""


def read_answers(path: Path) -> list[Answer]:
    """Return answers from JSON Lines. Raises ``HouseFileError`` with the number of an invalid line."""
    found = []
    with opened(path, MOST_BYTES) as file:
        for number, line in enumerate(file, start=1):
            try:
                found.append(msgspec.json.decode(line, type=Answer))
            except msgspec.DecodeError as error:
                raise HouseFileError(f"{path}:{number}: no answer: {error}") from None
    return found


class JudgedAnswer(NamedTuple):
    """An answer with its judgement."""

    entry: BriefEntry
    said: str
    """``house``, ``impossible`` or ``nothing``."""
    faults: list[str]
    lines: list[JudgedLine]
    plans: int
    """Number of houses, and number of those that differ in the rooms that share walls, or in the side."""
    different: int
    seconds: float | None

    @property
    def right(self) -> bool:
        """True for a house that keeps all lines, or a correct "impossible".

        "Impossible" is correct unless the brief is known to have a house.
        """
        if self.said == "house":
            return not self.faults and all(line.kept for line in self.lines)
        return self.said == "impossible" and self.entry.answer != "house"


def judged(entry: BriefEntry, answer: Answer | None) -> JudgedAnswer:
    """Judge an answer."""
    if answer is None or not (answer.houses or answer.impossible):
        return JudgedAnswer(entry, "nothing", [], [], 0, 0, answer and answer.seconds)
    if answer.impossible:
        return JudgedAnswer(entry, "impossible", [], [], 0, 0, answer.seconds)
    brief = entry.read
    try:
        houses = [House.from_dict(record) for record in answer.houses]
    except ValueError as error:
        return JudgedAnswer(entry, "house", [f"no house: {error}"], [], 0, 0, answer.seconds)
    wrong = faults(houses[0], brief)
    kept = (
        list(lines(houses[0], brief)) if {room.name for room in houses[0].rooms} == set(brief.names) else []
    )
    return JudgedAnswer(
        entry, "house", wrong, kept, len(houses), len(set(map(plan_of, houses))), answer.seconds
    )


def judged_all(bank: Sequence[BriefEntry], answers: Iterable[Answer]) -> list[JudgedAnswer]:
    """Judge the answer to each brief, or the lack of an answer.

    Raises ``HouseFileError`` for an answer to an unknown brief, and for a second answer to a brief.
    """
    known, found = {entry.name for entry in bank}, dict[str, Answer]()
    for answer in answers:
        if answer.brief not in known:
            raise HouseFileError(f"answers: {unknown('brief', answer.brief, known)}")
        if answer.brief in found:
            raise HouseFileError(f"answers: {answer.brief} has two")
        found[answer.brief] = answer
    return [judged(entry, found.get(entry.name)) for entry in bank]


def score(answers: Sequence[JudgedAnswer]) -> dict[str, Any]:
    """Return the figures of a table: counts, and fractions from 0 to 1; None if there is nothing to count."""
    houses = [each for each in answers if each.said == "house"]
    proofs = [each for each in answers if each.said == "impossible"]
    of_kind: Mapping[str, list[bool]] = defaultdict(list)
    for each in houses:
        for line in each.lines:
            of_kind[line.kind].append(line.kept)
    known = [each for each in answers if each.entry.answer == "impossible"]
    return {
        "briefs": len(answers),
        "right": share([each.right for each in answers]),
        "houses": len(houses),
        "valid": share([not each.faults for each in houses]),
        "all lines kept": share([each.right for each in houses]),
        "edges kept": share(of_kind["edge"]),
        "areas kept": share(of_kind["area"]),
        "other lines kept": share(of_kind["other"]),
        "impossible": len(proofs),
        "false refutations": sum(each.entry.answer == "house" for each in proofs),
        "known impossible, named so": share([each.said == "impossible" for each in known]),
        "different plans": mean([each.different / each.plans for each in houses if each.plans > 1]),
        "seconds": {
            rooms: spread(some)
            for rooms in sorted({each.entry.rooms for each in answers})
            if (
                some := [
                    each.seconds for each in answers if each.entry.rooms == rooms and each.seconds is not None
                ]
            )
        },
    }


def share(kept: Sequence[bool]) -> float | None:
    """Return the fraction of True values."""
    return mean(list(map(float, kept)))


def mean(values: Sequence[float]) -> float | None:
    """Return the mean of some values, or None for no values."""
    return sum(values) / len(values) if values else None


def spread(seconds: Sequence[float]) -> tuple[float, float]:
    """Return the median and the 95th percentile."""
    return median(seconds), float(np.percentile(seconds, 95))
