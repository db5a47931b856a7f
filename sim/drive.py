"""Motion of a body in the backend ``free``: the limits of its speeds, and its commands."""

from dataclasses import dataclass
from math import hypot, isfinite, pi
from typing import Literal

from vitruvius.sim.fields import settle

MOST_COMMANDS = 1024
"""Largest number of commands that a discrete action chooses from."""

SPEED, TURN_SPEED = 0.7, 3.0
"""Default speeds, in metres and radians per second. They are about as fast as bodies on the lattice, which
take a step of 0.07 m in 0.1 s."""

THREE = (0.0, TURN_SPEED), (0.0, -TURN_SPEED), (SPEED, 0.0)
"""Turn left, turn right and forward, in the order of the lattice's actions, for agents of three actions."""

PARTS = (1 << 20) - 1
"""Number of parts of a greatest speed. If bodies drive sideways, speeds and commands are whole numbers of
parts."""

COMMANDS = (
    *THREE,
    *((SPEED, turn) for most in (0.4, 1.0, 2.0, TURN_SPEED) for turn in (most, -most)),
    *((speed, turn) for speed, most in ((SPEED / 2, TURN_SPEED), (0.0, 1.0)) for turn in (most, -most)),
)
"""``THREE``, then forward in curves from wide to narrow, then narrow curves at half speed, then slow turns;
each to both sides."""


@dataclass(frozen=True)
class Drive:
    """Motion in the backend ``free``, for a disc as wide as ``Config.body``. Metres, radians, seconds.

    A command is a forward speed v and a turn rate w. If the disc drives ``sideways``, a command is a speed
    forward, a speed to the left, and a turn rate (vx, vy, w). The disc approaches the commanded speeds as
    fast as its limits allow.
    """

    time_step: float = 0.1
    """Duration of a step, in seconds."""

    speed: float = SPEED
    """Largest speed forward, m/s."""

    reverse: float = 0.0
    """Largest speed backward, m/s."""

    sideways: float = 0.0
    """Largest speed to either side, m/s. Above 0, a body drives in all directions, independently of its
    heading."""

    turn_speed: float = TURN_SPEED
    """Largest turn rate, either way, rad/s."""

    acceleration: float = 2.0
    """Largest change of v, or of vx and vy each, in m/s². ``inf``: speeds change at once."""

    turn_acceleration: float = 12.0
    """Largest change of w, in rad/s². ``inf``: the turn rate changes at once."""

    at_contact: Literal["slide", "stop"] = "slide"
    """Motion of a body that touches an obstacle: it slides along the obstacle, or stops."""

    commands: tuple[tuple[float, ...], ...] = ()
    """Pairs (v, w), or triples (vx, vy, w), that a discrete action chooses from. Without commands, an action
    is any value of a ``Box``."""

    clips: bool = False
    """True if an action outside the ``Box`` is clipped to the ``Box``. Otherwise it is an error. NaN is
    always an error."""

    def __post_init__(self) -> None:
        """Raise ``ValueError`` for impossible values."""
        settle(self, "drive: ")
        if not (0 < self.time_step < float("inf") and 0 < self.speed < float("inf")):
            raise ValueError(
                f"drive: time_step {self.time_step} s, speed {self.speed} m/s: both must be above 0"
            )
        if not all(0 <= each < float("inf") for each in (self.reverse, self.sideways, self.turn_speed)):
            found = f"reverse {self.reverse} m/s, sideways {self.sideways} m/s"
            found += f", turn_speed {self.turn_speed} rad/s"
            raise ValueError(f"drive: {found}: none may be negative")
        if not (self.acceleration > 0 and self.turn_acceleration > 0):
            found = f"acceleration {self.acceleration}, turn_acceleration {self.turn_acceleration}"
            raise ValueError(f"drive: {found}: both must be above 0")
        if self.turn_speed * self.time_step > pi:
            raise ValueError(
                f"drive: {self.turn_speed} rad/s is more than half a turn per step: lower "
                "turn_speed or time_step"
            )
        if self.at_contact not in ("slide", "stop"):
            raise ValueError(f"drive: at_contact is {self.at_contact!r}: choose slide or stop")
        if len(self.commands) > MOST_COMMANDS:
            raise ValueError(f"drive: {len(self.commands)} commands: at most {MOST_COMMANDS:,} are supported")
        for pair in self.commands:
            if not self.allows(pair):
                raise ValueError(f"drive: command {pair}: {self.names} must not exceed the maximum speeds")

    def allows(self, command: tuple[float, ...]) -> bool:
        """Return True if a command is within the largest speeds."""
        if len(command) != len(self.high) or not all(map(isfinite, command)):
            return False
        return all(low <= each <= high for low, each, high in zip(self.low, command, self.high, strict=True))

    @property
    def names(self) -> str:
        """Names of the values of a command."""
        return "(vx, vy, w)" if self.sideways else "(v, w)"

    @property
    def low(self) -> tuple[float, ...]:
        """Smallest value of each number of a command."""
        aside = (-self.sideways,) * (self.sideways > 0)
        return 0.0 - self.reverse, *aside, -self.turn_speed

    @property
    def high(self) -> tuple[float, ...]:
        """Largest value of each number of a command."""
        return self.speed, *((self.sideways,) * (self.sideways > 0)), self.turn_speed

    @property
    def part(self) -> tuple[float, ...]:
        """Unit of each number of a command; commands are whole multiples of it: see ``PARTS``."""
        most = zip(self.low, self.high, strict=True)
        return tuple(max(-low, high, 1e-9) / PARTS for low, high in most)

    @property
    def travel(self) -> float:
        """Largest distance that a body covers in a step, in metres."""
        return hypot(max(self.speed, self.reverse), self.sideways) * self.time_step

    def require_heading(self, who: str) -> None:
        """Raise ``ValueError`` if bodies drive sideways, for a caller ``who`` that only drives forward."""
        if self.sideways:
            raise ValueError(f"{who} drives only along its heading: use a drive with sideways=0")
