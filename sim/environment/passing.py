"""Environments with rotating houses: a thread packs the next period's houses while the environments step."""

from collections.abc import Iterator, Mapping
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any
from weakref import WeakSet

import numpy as np

from vitruvius.logic.errors import HouseFileError, RequestError
from vitruvius.sim.environment.rotation import HouseRotation
from vitruvius.sim.world.arrays import OVER
from vitruvius.sim.world.phases import TERMINATED, TRUNCATED
from vitruvius.sim.world.world import PackedHouses, World

_going_on = WeakSet["Passing"]()


def close_all() -> None:
    """Wait for all packing in this process, because nothing may be packed when its compiler ends."""
    for each in list(_going_on):
        each.close()


class Standing:
    """Houses that stay: the interface of ``Passing`` for a bank that does not rotate."""

    rotation: HouseRotation | None = None
    steps = 0

    def __init__(self, world: World) -> None:
        """Take a world, which already has its houses."""
        self.world = world

    def go_to(self, steps: int) -> bool:
        """Return False, because the houses have not changed: see ``Passing``."""
        return False

    @property
    def state(self) -> dict[str, np.ndarray]:
        """Part of the state that identifies the houses: none."""
        return {}

    def go_on_from(self, state: Mapping[str, Any]) -> bool:
        """Return False, because the houses have not changed: see ``Passing``."""
        return False

    def step(self) -> bool:
        """Run a step of the world, and return False: see ``Passing``."""
        self.world.run("step")
        return False

    def close(self) -> None:
        """Do nothing: see ``Passing``."""

    @contextmanager
    def unless_refused(self) -> Iterator[None]:
        """Go back to the previous houses if the call in this context is refused."""
        before = self.steps
        try:
            yield
        except BaseException:
            self.go_to(before)
            raise


class Passing(Standing):
    """Current period of a world's rotation."""

    def __init__(self, world: World, rotation: HouseRotation) -> None:
        """Begin with the first period, whose houses the world already has."""
        super().__init__(world)
        self.rotation: HouseRotation = rotation  # pyright: ignore[reportIncompatibleVariableOverride]
        self.pool = ThreadPoolExecutor(1, "rotation")
        self.number = self.steps = 0
        self._begin(1)
        _going_on.add(self)

    def _begin(self, number: int) -> None:
        """Pack the houses of a period, and stop packing any others."""
        self._asked: int | None = number
        self._next: Future[PackedHouses] = self.pool.submit(self._packed, number)

    def _packed(self, number: int) -> PackedHouses:
        """Return the packed houses of a period.

        Raises ``CancelledError`` between two houses if another period, or none, is needed by then.
        """
        houses = []
        for house in self.rotation.period(number):
            if self._asked != number:
                raise CancelledError
            houses.append(house)
        try:
            return self.world.packed(houses)
        except ValueError as error:
            first = number * self.rotation.size % len(self.rotation.houses)
            raise HouseFileError(f"from house {first} of {len(self.rotation.houses)} on, {error}") from None

    def go_to(self, steps: int) -> bool:
        """Go to the period of a number of steps since the first period began.

        Return True if the houses have changed.

        Raises ``HouseFileError`` if the body or a target has no place in a house of the period, and any error
        of reading or generating a house.
        """
        number = max(0, steps - 1) // self.rotation.steps
        changes = number != self.number
        if changes:
            if number != self._asked:
                self._begin(number)
            self.world.take(self._next.result())
            self.number = number
            self._begin(number + 1)
        self.steps = steps
        return changes

    @property
    def state(self) -> dict[str, np.ndarray]:
        """Part of the state that identifies the houses.

        ``passed`` is the number of steps, and the rotation's size and steps: (3,) int64.
        """
        return {"passed": np.array([self.steps, self.rotation.size, self.rotation.steps])}

    def go_on_from(self, state: Mapping[str, Any]) -> bool:
        """Go to the period of ``state``, if it has one; see ``go_to``.

        Raises ``RequestError``, a ``ValueError``, for the state of another rotation.
        """
        if "passed" not in state:
            return False
        own, given = self.state["passed"], np.asarray(state["passed"])
        if (given.dtype, given.shape) != (own.dtype, own.shape):
            raise RequestError(f"the state's counter passed must be {own.dtype} {own.shape}")
        steps, *others = given.tolist()
        if steps < 0 or others != own[1:].tolist():
            raise RequestError(
                f"the state belongs to another rotation ({others} houses and steps), or has a negative "
                "counter"
            )
        return self.go_to(steps)

    def close(self) -> None:
        """Wait until the current packing ends, and pack no more."""
        self._asked = None
        self.pool.shutdown(cancel_futures=True)

    def step(self) -> bool:
        """Run a step of the world, in the next period if this one is over; see ``go_to``."""
        changes = self.go_to(self.steps + 1)
        self.world.run("step")
        if self.steps % self.rotation.steps == 0:
            arrays, count = self.world.arrays, self.world.num_envs
            flags, wholes = arrays["flags"].numpy().reshape(-1, count), arrays["wholes"].numpy()
            flags[TRUNCATED] |= 1 - flags[TERMINATED]
            wholes[:, OVER] = 1
            arrays["flags"].fill(flags.ravel())
            arrays["wholes"].fill(wholes)
        return changes


def passing(world: World, houses: Any) -> Standing:
    """Return the rotation of a world's houses, or the houses that stay."""
    return Passing(world, houses) if isinstance(houses, HouseRotation) else Standing(world)
