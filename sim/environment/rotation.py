"""Houses in rotation: of more than can be held, or packed at once, some at a time."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from gymnasium.vector import AutoresetMode

from logic import House


@dataclass(frozen=True)
class HouseRotation:
    """Some houses for some steps, then the next ones in their order, and after the last the first again.

    In place of the houses of ``HouseVectorEnv``, in its mode ``NEXT_STEP``: those of two periods are held, of
    which a thread packs the next one's. In the last step of a period all episodes are truncated that have not
    ended, and the next step begins new ones in the next houses: where ``steps`` is a multiple of an
    episode's, some steps are cut at most; an episode that begins in that very step ends without any. Which
    period it is, is a function of the steps since a ``reset`` with a seed, so all that happens is one of the
    seed still.
    """

    houses: Sequence[House]
    """As a ``logic.HouseSet`` or ``logic.HouseStream``, which read or make them as they are asked for."""

    size: int = 128
    """Houses of a period."""

    steps: int = 3000
    """Of every environment in a period."""

    def __post_init__(self) -> None:
        """Raise ``ValueError`` for no houses, and for numbers that are none."""
        for name in ("size", "steps"):
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, int) or value < 1:
                raise ValueError(f"rotation: {name} must be a whole number from 1, not {value!r}")
        if not len(self.houses):
            raise ValueError("no house to simulate: the rotation is of none")

    def period(self, number: int) -> Iterator[House]:
        """The houses of a period, from 0 on."""
        count = len(self.houses)
        first = number * self.size
        return (self.houses[(first + k) % count] for k in range(min(self.size, count)))


def require_next_step(houses: Any, mode: AutoresetMode) -> None:
    """Raise ``ValueError`` for houses in rotation where episodes begin otherwise than they need."""
    if isinstance(houses, HouseRotation) and mode is not AutoresetMode.NEXT_STEP:
        raise ValueError("houses in rotation need autoreset_mode='NextStep'")
