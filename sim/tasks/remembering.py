# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIncompatibleMethodOverride=false
"""Terms with a memory: visit all rooms, or keep a battery charged."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from vitruvius.logic import House
from vitruvius.logic.spelling import unknown
from vitruvius.sim.runtime import ti
from vitruvius.sim.tasks.terms import MAX_MEMORY, Terms

BITS = 24
"""Number of rooms that one float32 can represent, a bit for each room."""

MAX_ROOMS = BITS * (MAX_MEMORY - 1)
"""Largest number of rooms in a house."""


def _of_types(house: House, types: Sequence[str], purpose: str) -> list[int]:
    """Return 1 for each room of one of the types, else 0. Raises ``ValueError`` if no room matches."""
    marks = [int(room.type in types) for room in house.rooms]
    if not any(marks):
        known = sorted({room.type for room in house.rooms})
        lacking = next((name for name in types if name not in known), "")
        raise ValueError(f"no room {purpose}: {unknown('room type', lacking, known)}")
    return marks


@ti.data_oriented
@dataclass(frozen=True)
class Visit(Terms):
    """Terms that reward the first visit of each room, and end the episode after the last room.

    A room counts as visited when the eye is in it after a step. The memory holds the number of visited rooms
    and a bit for each room.
    """

    pick_up: float = 0.0
    """Reward for a pick-up."""

    visit: float = 1.0
    """Reward for the first visit of a room."""

    types: tuple[str, ...] = ()
    """Types of the rooms to visit; empty for all rooms."""

    most: int = 48
    """Largest number of rooms in a house. The memory has one number, and one more for every 24 rooms."""

    sees_room: ClassVar[bool] = True
    finite: ClassVar[tuple[str, ...]] = (*Terms.finite, "visit")

    def __post_init__(self) -> None:
        """Raise ``ValueError`` for values out of range."""
        object.__setattr__(self, "types", (self.types,) if isinstance(self.types, str) else (*self.types,))
        if not isinstance(self.most, int) or not 1 <= self.most <= MAX_ROOMS:
            raise ValueError(f"terms: most is {self.most!r}: it must be 1 to {MAX_ROOMS:,} rooms")
        super().__post_init__()

    @property
    def memory(self) -> int:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Number of values in the memory: see ``Terms``."""
        return 1 + -(-self.most // BITS)

    def marks(self, house: House) -> list[int]:
        """Return 1 for each room to visit, else 0: see ``Terms``."""
        if len(house.rooms) > self.most:
            raise ValueError(
                f"it has {len(house.rooms)} rooms, more than the terms' most of {self.most}: raise most"
            )
        return _of_types(house, self.types or [room.type for room in house.rooms], "to visit")

    @ti.func
    def remember(self, now):
        """Return the memory with a newly visited room: see ``Terms``."""
        kept = now.was
        for word in ti.static(range(1, self.memory)):
            bit = now.room - ti.static(BITS * (word - 1))
            if now.mark != 0 and 0 <= bit < ti.static(BITS):
                fresh = 1 - (ti.cast(kept[word], ti.i32) >> bit & 1)
                kept[0] += ti.cast(fresh, ti.f32)
                kept[word] += ti.cast(fresh << bit, ti.f32)
        return kept

    @ti.func
    def reward(self, now):
        """Return the reward of a step: see ``Terms``."""
        return self.basic(now) + ti.static(float(self.visit)) * (now.memory[0] - now.was[0])

    @ti.func
    def ends(self, now):
        """Return 1 after the last room: see ``Terms``."""
        return ti.cast(now.memory[0] >= ti.cast(now.marked, ti.f32), ti.i32)


@ti.data_oriented
@dataclass(frozen=True)
class Battery(Terms):
    """Terms with a battery that each step drains. An empty battery ends the episode.

    A step in a room with a charger recharges the battery. The memory holds the used charge, in steps; 0 is
    full.
    """

    capacity: int = 400
    """Number of steps that a full battery lasts."""

    charge: float = 10.0
    """Charge that a step in a room with a charger adds, in steps."""

    charger: str = ""
    """Type of the rooms with a charger; by default the charger is in ``House.start``."""

    empty: float = 0.0
    """Reward for the step that empties the battery, usually negative."""

    sees_room: ClassVar[bool] = True
    memory: ClassVar[int] = 1
    finite: ClassVar[tuple[str, ...]] = (*Terms.finite, "charge", "empty")

    def __post_init__(self) -> None:
        """Raise ``ValueError`` for values out of range."""
        if not isinstance(self.capacity, int) or not 0 < self.capacity < 1 << BITS:
            raise ValueError(
                f"terms: capacity is {self.capacity!r}: it must be 1 to {(1 << BITS) - 1:,} steps"
            )
        if not isinstance(self.charger, str):
            raise ValueError(f"terms: charger: give a room type, not {self.charger!r}")
        super().__post_init__()
        if self.charge < 0:
            raise ValueError(f"terms: charge is {self.charge}: it must not be negative")

    def marks(self, house: House) -> list[int]:
        """Return 1 for each room with a charger, else 0: see ``Terms``."""
        if self.charger:
            return _of_types(house, [self.charger], "with a charger")
        return [int(room is house.start) for room in house.rooms]

    @ti.func
    def remember(self, now):
        """Return the used charge: see ``Terms``."""
        given = ti.select(now.mark != 0, ti.static(float(self.charge)), 0.0)
        return ti.max(0.0, now.was + 1.0 - given)

    @ti.func
    def reward(self, now):
        """Return the reward of a step: see ``Terms``."""
        return self.basic(now) + ti.static(float(self.empty)) * ti.cast(self.ends(now), ti.f32)

    @ti.func
    def ends(self, now):
        """Return 1 if the battery is empty: see ``Terms``."""
        return ti.cast(now.memory[0] >= ti.static(float(self.capacity)), ti.i32)
