"""Kinds of worlds: all that kernels and arrays depend on, except houses and the number of environments."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from vitruvius.sim.arrays import ArrayRow, record
from vitruvius.sim.config import Config
from vitruvius.sim.parts import PARTS
from vitruvius.sim.tasks.terms import PLAIN, Terms
from vitruvius.sim.world.arrays import (
    BANK,
    COUNTERS,
    DISTANCE,
    HEADING,
    LAST,
    NEXT_STEP,
    OUTPUTS,
    SAME_STEP,
    SHOWN,
    STATE,
    TABLE,
)
from vitruvius.sim.world.states import state_type


@dataclass(frozen=True)
class WorldKind:
    """Properties of a world that its kernels and its arrays depend on.

    The houses and the number of environments are not among them. Rows of ``sim.world.arrays`` state by these
    properties which worlds have an array (``asked``).
    """

    config: Config
    """The simulator's settings. Their ``steps`` are 1 in each kind: kernels read the array ``limit``."""

    mode: int = NEXT_STEP
    """Behaviour after an episode's end."""

    by_ray: bool = False
    """True if a kernel has a parallel task for each ray, as on a GPU; otherwise for each environment."""

    serial: bool = False
    """True if kernels run in the calling thread, because waking other threads takes longer than stepping a
    few environments."""

    ends_on_pick_up: bool = False
    """True if a pick-up ends the episode."""

    terms: Terms = PLAIN
    """Rewards and other ends of the episode."""

    at_once: int = 1
    """Number of targets at once."""

    guided: bool = False
    """True if episodes that begin automatically use the options ``next_wholes`` and ``next_reals``."""

    overlays: tuple[type, ...] = ()
    """Classes of overlays on the houses: see ``sim.backends.overlay``."""

    @property
    def knows_distance(self) -> bool:
        """True if a step computes the distance to the target."""
        return self.config.knows_distance or self.terms.asks_distance

    @property
    def commanded(self) -> bool:
        """True if actions are the speeds of bodies that drive, and not numbers."""
        return self.config.drives and not self.config.drive.commands

    @property
    def sees_room(self) -> bool:
        """True if terms or a part of the observation read the room that the body is in."""
        return self.terms.sees_room or any(PARTS[name].sees_room for name in self.config.extras)

    @property
    def surveys(self) -> bool:
        """True if kernels read the table of rooms and pieces."""
        return self.sees_room or self.terms.surveys

    @cached_property
    def pairs(self) -> bool:
        """True if a ray has two columns. Kernels then write both at once, as one number of 64 bits."""
        return self.config.channels == 2

    @cached_property
    def rows(self) -> tuple[ArrayRow, ...]:
        """Rows of the table for this kind of world."""
        over = (row for overlay in self.overlays for row in overlay.ROWS)
        return tuple(row for row in (*TABLE, *over) if row.asked(self))

    def sizes(self, num_envs: int = 1) -> dict[str, int]:
        """Return the sizes by their letters: see ``SIZES``."""
        config = self.config
        return {
            "E": num_envs,
            "R": config.rays,
            "C": 1 if self.pairs else config.channels,
            "X": config.extra_numbers,
            "L": config.latency + 1,
            "M": self.terms.memory,
            "T": 2 * (self.at_once - 1),
            "F": 4 if self.mode == SAME_STEP else 3,
            "V": len(config.drive.low),
            "A": len(config.drive.low) if self.commanded else 1,
            "W": COUNTERS if config.drives else COUNTERS + 3,
            "P": HEADING + 1 if config.drives else HEADING,
        }

    def record(self, *groups: Sequence[ArrayRow]) -> Any:
        """Return the record type of the arrays in some groups of the table, for kernels."""
        chosen = {row.name for group in groups for row in group}
        rows = [row for row in self.rows if row.name in chosen]
        return record(rows, self, self.sizes(), state_type(len(self.config.drive.low) * self.config.drives))

    @cached_property
    def arrays(self) -> Any:
        """Record of the arrays that a step of one environment may read and write."""
        return self.record(BANK, STATE, DISTANCE, LAST, *(overlay.ROWS for overlay in self.overlays))

    @cached_property
    def results(self) -> Any:
        """Record of ``arrays`` and of the action and the results of a step."""
        over = (overlay.ROWS for overlay in self.overlays)
        return self.record(BANK, STATE, DISTANCE, LAST, *over, OUTPUTS, SHOWN * self.serial)

    @cached_property
    def states(self) -> Any:
        """Record of the arrays from which a state is loaded."""
        return self.record([row for row in STATE if row.name in ("reals", "wholes", "speeds")])
