"""How a body drives where it moves freely: the limits of its speeds, and what it can be told to do."""

from dataclasses import dataclass
from math import hypot, isfinite, pi
from typing import Literal

from sim.fields import settle

MOST_COMMANDS = 1024
"""Commands that a discrete action chooses from at most."""

SPEED, TURN_SPEED = 0.7, 3.0
"""Metres and radians a second: of bodies about as fast as those that make a step of 0.07 m in 0.1 s."""

THREE = (0.0, TURN_SPEED), (0.0, -TURN_SPEED), (SPEED, 0.0)
"""Turn left, turn right and forward, in the order of the lattice's actions: for agents of three actions."""

PARTS = (1 << 20) - 1
"""Of a greatest speed: where bodies drive sideways, speeds and what is told are whole numbers of them."""

COMMANDS = (
    *THREE,
    *((SPEED, turn) for most in (0.4, 1.0, 2.0, TURN_SPEED) for turn in (most, -most)),
    *((speed, turn) for speed, most in ((SPEED / 2, TURN_SPEED), (0.0, 1.0)) for turn in (most, -most)),
)
"""And forward in bows, wide to narrow, in a narrow one at half speed, and slow turns: each to both sides."""


@dataclass(frozen=True)
class Drive:
    """The motion of the backend ``free``: a disc, as wide as ``Config.body``, that is told a forward speed v
    and a turn rate w, or where it drives ``sideways`` a speed forward, one to the left, and a turn rate (vx,
    vy, w), and comes as near to them as its limits let it. Metres, radians, seconds.
    """

    time_step: float = 0.1
    """Seconds of a step."""

    speed: float = SPEED
    """The greatest speed forward, m/s."""

    reverse: float = 0.0
    """The greatest speed backward, m/s."""

    sideways: float = 0.0
    """The greatest speed to either side, m/s; above 0 a body drives in all directions as it turns."""

    turn_speed: float = TURN_SPEED
    """The greatest turn rate, either way, rad/s."""

    acceleration: float = 2.0
    """How fast v changes at most, m/s², or vx and vy each; ``inf`` for at once."""

    turn_acceleration: float = 12.0
    """How fast w changes at most, rad/s²; ``inf`` for at once."""

    at_contact: Literal["slide", "stop"] = "slide"
    """What a body does that touches something: it goes on along it, or stays there."""

    commands: tuple[tuple[float, ...], ...] = ()
    """Pairs (v, w), or (vx, vy, w), that a discrete action chooses from; without them an action is any in a
    ``Box``.
    """

    clips: bool = False
    """Whether an action beyond the ``Box`` becomes the nearest in it; else it is refused. NaN always is."""

    def __post_init__(self) -> None:
        """Raise ``ValueError`` for impossible values."""
        settle(self, "drive: ")
        if not (0 < self.time_step < float("inf") and 0 < self.speed < float("inf")):
            raise ValueError(f"drive: time_step {self.time_step} s, speed {self.speed} m/s: both above 0")
        if not all(0 <= each < float("inf") for each in (self.reverse, self.sideways, self.turn_speed)):
            found = f"reverse {self.reverse} m/s, sideways {self.sideways} m/s"
            found += f", turn_speed {self.turn_speed} rad/s"
            raise ValueError(f"drive: {found}: not negative")
        if not (self.acceleration > 0 and self.turn_acceleration > 0):
            found = f"acceleration {self.acceleration}, turn_acceleration {self.turn_acceleration}"
            raise ValueError(f"drive: {found}: both above 0")
        if self.turn_speed * self.time_step > pi:
            raise ValueError(f"drive: {self.turn_speed} rad/s are more than half a turn in a step")
        if self.at_contact not in ("slide", "stop"):
            raise ValueError(f"drive: at_contact is {self.at_contact!r}: there are slide, stop")
        if len(self.commands) > MOST_COMMANDS:
            raise ValueError(f"drive: {len(self.commands)} commands: {MOST_COMMANDS:,} at most")
        for pair in self.commands:
            if not self.allows(pair):
                raise ValueError(f"drive: command {pair}: {self.names} within the greatest speeds")

    def allows(self, command: tuple[float, ...]) -> bool:
        """Whether a command is within the greatest speeds."""
        if len(command) != len(self.high) or not all(map(isfinite, command)):
            return False
        return all(low <= each <= high for low, each, high in zip(self.low, command, self.high, strict=True))

    @property
    def names(self) -> str:
        """The numbers of a command."""
        return "(vx, vy, w)" if self.sideways else "(v, w)"

    @property
    def low(self) -> tuple[float, ...]:
        """The least of each number of a command."""
        aside = (-self.sideways,) * (self.sideways > 0)
        return 0.0 - self.reverse, *aside, -self.turn_speed

    @property
    def high(self) -> tuple[float, ...]:
        """The greatest of each number of a command."""
        return self.speed, *((self.sideways,) * (self.sideways > 0)), self.turn_speed

    @property
    def part(self) -> tuple[float, ...]:
        """Of each number of a command, the part of which it is a whole number: see ``PARTS``."""
        most = zip(self.low, self.high, strict=True)
        return tuple(max(-low, high, 1e-9) / PARTS for low, high in most)

    @property
    def travel(self) -> float:
        """Metres that a step goes at most."""
        return hypot(max(self.speed, self.reverse), self.sideways) * self.time_step

    def require_heading(self, who: str) -> None:
        """Raise ``ValueError`` for bodies that drive sideways, which is not for who drives as they head."""
        if self.sideways:
            raise ValueError(f"{who} drives where its body heads: take a drive without sideways")
