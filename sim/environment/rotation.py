"""Rotation of houses: parts of a set that is too large to keep or pack at once, one after the other."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from gymnasium.vector import AutoresetMode

from vitruvius.logic import House


@dataclass(frozen=True)
class HouseRotation:
    """Sequence of periods, each with some houses for some steps; after the last house comes the first one.

    A rotation replaces the houses of ``HouseVectorEnv``, in its mode ``NEXT_STEP``. Memory holds the houses
    of two periods; a thread packs those of the next one. In the last step of a period, all episodes that have
    not ended are truncated, and the next step begins new ones in the next houses. If ``steps`` is a multiple
    of an episode's length, few steps are lost; an episode that begins in the last step ends without any step.
    The period is a function of the steps since a ``reset`` with a seed, so everything that happens remains a
    function of the seed.
    """

    houses: Sequence[House]
    """A ``vitruvius.HouseSet`` or ``HouseStream`` reads or makes them as they are asked for."""

    size: int = 128
    """Number of houses of a period."""

    steps: int = 3000
    """Number of steps of every environment in a period."""

    def __post_init__(self) -> None:
        """Raise ``ValueError`` without houses, and for invalid numbers."""
        for name in ("size", "steps"):
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, int) or value < 1:
                raise ValueError(f"rotation: {name} must be a whole number, 1 or more, not {value!r}")
        if not len(self.houses):
            raise ValueError("no house to simulate: the rotation is empty")

    def period(self, number: int) -> Iterator[House]:
        """Return the houses of a period, counted from 0."""
        count = len(self.houses)
        first = number * self.size
        return (self.houses[(first + k) % count] for k in range(min(self.size, count)))


def require_next_step(houses: Any, mode: AutoresetMode) -> None:
    """Raise ``ValueError`` for houses in rotation unless the mode is ``NEXT_STEP``."""
    if isinstance(houses, HouseRotation) and mode is not AutoresetMode.NEXT_STEP:
        raise ValueError("rotating houses need autoreset_mode='NextStep'")
