"""Environments in houses that rotate: those of the next period are packed by a thread while they step."""

from concurrent.futures import Future, ThreadPoolExecutor
from weakref import WeakSet

from sim.environment.rotation import HouseRotation
from sim.world.episodes import OVER
from sim.world.kernels import TERMINATED, TRUNCATED
from sim.world.world import PackedHouses, World

_going_on = WeakSet["Passing"]()


def close_all() -> None:
    """Wait for all that is being packed in this process: nothing may be, when its compiler ends."""
    for each in list(_going_on):
        each.close()


class Passing:
    """In which period of its rotation a world is."""

    def __init__(self, world: World, rotation: HouseRotation) -> None:
        """The world has the houses of the first one."""
        self.world, self.rotation = world, rotation
        self.pool = ThreadPoolExecutor(1, "rotation")
        self.number, self.next = 0, (1, self._packed(1))
        self.steps = 0
        _going_on.add(self)

    def _packed(self, number: int) -> "Future[PackedHouses]":
        return self.pool.submit(lambda: self.world.packed(self.rotation.period(number)))

    def go_to(self, steps: int) -> None:
        """Be where so many steps lead since the first period began.

        Raises ``ValueError`` where a house of the period cannot be had.
        """
        number = max(0, steps - 1) // self.rotation.steps
        if number != self.number:
            asked, future = self.next
            self.world.take((future if asked == number else self._packed(number)).result())
            self.number = number
            self.next = number + 1, self._packed(number + 1)
        self.steps = steps

    def close(self) -> None:
        """Wait for what is being packed, and pack no more."""
        self.pool.shutdown(cancel_futures=True)

    def step(self) -> None:
        """Run a step of the world, in the next period if this one is over."""
        self.go_to(self.steps + 1)
        self.world.run("step")
        if self.steps % self.rotation.steps == 0:
            arrays, count = self.world.arrays, self.world.num_envs
            flags, wholes = arrays["flags"].numpy().reshape(-1, count), arrays["wholes"].numpy()
            flags[TRUNCATED] |= 1 - flags[TERMINATED]
            wholes[:, OVER] = 1
            arrays["flags"].fill(flags.ravel())
            arrays["wholes"].fill(wholes)
