"""What is learnt in which order: lessons, each with its houses, furniture and targets."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from msgspec.structs import replace

from agent.config import TARGET_MODES, TargetMode
from logic import House
from logic.errors import RequestError


@dataclass(frozen=True)
class Lesson:
    """A part of a run in one kind of house. Raises ``RequestError`` for what no lesson can be."""

    until: float
    """Fraction of the run at which it ends, above 0; the last lesson's is 1."""

    targets: TargetMode
    """Where targets lie."""

    rooms: tuple[int, int | None] = (0, None)
    """Least and most secondary rooms of its houses; None: however many."""

    furnished: bool = True
    """Whether its houses keep their furniture."""

    def __post_init__(self) -> None:
        """Refuse what no lesson can be."""
        if not 0 < self.until <= 1:
            raise RequestError(f"until must lie above 0 and be at most 1, not {self.until}")
        if self.targets not in TARGET_MODES:
            raise RequestError(f"targets must be one of {', '.join(TARGET_MODES)}, not {self.targets!r}")
        least, most = self.rooms
        if least < 0 or (most is not None and most < least):
            raise RequestError(f"rooms must be the least and the most of a house, not {self.rooms}")
        if self.targets == "secondary" and least < 1:
            raise RequestError(f"rooms must be at least 1 where targets are secondary, not {least}")

    def houses(self, bank: Sequence[House]) -> list[House]:
        """Those houses of the bank that it is about, without furniture where it has none; perhaps none."""
        least, most = self.rooms
        chosen = [
            house
            for house in bank
            if least <= len(house.rooms) and (most is None or len(house.rooms) <= most)
        ]
        return chosen if self.furnished else [emptied(house) for house in chosen]

    def __str__(self) -> str:
        """As in ``mixed targets, 2 to 3 rooms, furnished``."""
        least, most = self.rooms
        rooms = f"{least} or more" if most is None else f"{least}" if least == most else f"{least} to {most}"
        return f"{self.targets} targets, {rooms} rooms, {'furnished' if self.furnished else 'empty'}"


@dataclass(frozen=True)
class Curriculum:
    """Lessons in their order. The learner makes new worlds at each lesson's end: all episodes begin anew.

    Raises ``RequestError`` unless lessons end one after the other and the last with the run.
    """

    lessons: tuple[Lesson, ...]

    def __post_init__(self) -> None:
        """Refuse what no run can follow."""
        ends = [lesson.until for lesson in self.lessons]
        if not ends or ends[-1] != 1:
            raise RequestError(f"until must be 1 for the last lesson: lessons end at {ends}")
        if any(one >= other for one, other in pairwise(ends)):
            raise RequestError(f"until must rise from lesson to lesson: they end at {ends}")

    def at(self, fraction: float) -> int:
        """The number of the lesson, from 0, when this fraction of the run is done, 0 to 1."""
        return min(sum(lesson.until <= fraction for lesson in self.lessons), len(self.lessons) - 1)

    def banks(self, bank: Sequence[House], name: object = "the bank") -> list[list[House]]:
        """Each lesson's houses out of a bank; ``name`` is the bank's, for errors, such as its file.

        Raises ``RequestError`` where a lesson has none: ask before the run begins.
        """
        banks = [lesson.houses(bank) for lesson in self.lessons]
        for number, (lesson, houses) in enumerate(zip(self.lessons, banks, strict=True), start=1):
            if not houses:
                counts = ", ".join(map(str, sorted({len(house.rooms) for house in bank})))
                raise RequestError(
                    f"lesson {number} of {len(banks)} ({lesson}): {name} has no such house, only with "
                    f"{counts or 'no'} rooms. Add some: vitruvius generate --rooms {max(1, lesson.rooms[0])}"
                )
        return banks


def emptied(house: House) -> House:
    """The house without its furniture; no request makes it so, hence it has no provenance."""
    rooms = tuple(replace(room, children=()) for room in house.rooms)
    return replace(house, rooms=rooms, provenance=None)


CURRICULA: dict[TargetMode, Curriculum] = {
    "main": Curriculum(
        (
            Lesson(0.1, "main", (0, 2), furnished=False),
            Lesson(0.3, "main", (0, 4)),
            Lesson(1.0, "main"),
        )
    ),
    "mixed": Curriculum(
        (
            Lesson(0.05, "main", (1, 2), furnished=False),
            Lesson(0.15, "main", (1, 3)),
            Lesson(0.4, "mixed", (1, 4)),
            Lesson(1.0, "mixed"),
        )
    ),
    "secondary": Curriculum(
        (
            Lesson(0.05, "main", (1, 2), furnished=False),
            Lesson(0.15, "main", (1, 3)),
            Lesson(0.4, "mixed", (1, 4)),
            Lesson(1.0, "secondary", (1, None)),
        )
    ),
}
"""By where targets lie in the end: first to walk and to turn to what is seen, in the main room; then to go
through doors, in ever more rooms; last all houses of the bank."""
