"""What the body, its eye, its task and its episodes are like. Metres and degrees."""

from dataclasses import dataclass, field, replace
from math import isclose
from typing import Any, Literal, cast

import numpy as np

from logic.spelling import unknown
from sim.drive import COMMANDS, Drive
from sim.fields import Derived, settle

FOOT = 0.3048
PIXEL = FOOT / 8.5
"""The paper's lengths are in pixels, 8.5 to a foot."""

MOST_RAYS = 1024
"""Memory of environments and networks grows with their rays: 360, a degree apart, look all around."""

MOST_KINDS = 64
"""Kinds of pieces that an observation tells apart at most."""

LEAST_SPACING = 0.1
"""Smallest angle between rays on a lattice, in degrees: a table has a row for each direction."""

MOST_ANGLE_NOISE = 45
"""Degrees."""

DEVIATIONS = 4.0
"""Standard deviations at which the error of a ray's direction is cut."""

MOST_LATENCY = 255
"""Steps: poses are kept for so long."""

MOST_PUSHES = 255
"""Steps that a door may take to open: they are counted in 8 bits."""


RAYS = "rays"
EXTRAS = {"bump": 1, "last_action": 3, "odometry": 4, "goal": 2, "geodesic": 1, "speed": 2}
"""What can be observed beside rays, and how many numbers each is: see ``Config.observe``."""

VARIABLE = "noise", "dropout", "slip", "drift", "speed", "acceleration", "width"
"""Names for ``Config.varied``, whose values may be random in each episode."""

SHARES = "dropout", "slip", "speed", "acceleration", "width"
"""Names of ``VARIABLE`` whose values are at most 1."""

MEMORY = "memory"
"""Part of an observation with the numbers that the task's terms keep."""

OBSERVABLE = RAYS, *EXTRAS, MEMORY

SENSOR = "sensor"
"""In a field's metadata: it says what a body senses, which an agent takes along to where it is measured."""


def sensed(default: Any) -> Any:
    """A field of the sensor."""
    return field(default=default, metadata={SENSOR: True})


@dataclass(frozen=True)
class Config:
    """What environments are like. The defaults are the paper's lengths; ``PAPER`` has its quirks too."""

    body: tuple[float, float] = (8 * PIXEL, 8 * PIXEL)
    """Side of the axis-aligned square body, metres: at the headings along an axis, and on a diagonal."""

    eye: tuple[float, float] = cast(Any, None)
    """Offset of the eye, metres both east and south from the body's north-west corner: at the headings along
    an axis, and on a diagonal. By default the eye is in the middle of the body."""

    step: float = 2 * PIXEL
    """How far ``forward`` goes along an axis, metres; on a diagonal it goes as far along both axes."""

    in_cells: bool = False
    """Whether the body fills a cell of a grid and goes from cell to cell: the grid backend sets it."""

    collision: Literal["swept", "original"] = "swept"
    """The rule that blocks a move: ``swept``, what the body touches on its way, or the ``original``
    program's, which looks at the new place only and forgets which wall a door is in."""

    ends_on_collision: bool = False
    """Whether a blocked move ends the episode."""

    rays: int = sensed(40)
    """Number of rays."""

    first_ray: float = sensed(58.5)
    """Degrees from the heading to ray 0, counter-clockwise. 58.5 makes 40 rays mirror-symmetric."""

    ray_spacing: float = sensed(3)
    """Degrees from a ray to the next ray, clockwise. The value must divide 45, as 3 or 22.5 does, so that the
    table of directions is small; the backend ``free`` accepts any value."""

    range: float = sensed(220 * PIXEL)
    """How far a ray sees, metres."""

    sees_angle: bool = sensed(False)
    """Whether an observation begins with each ray's absolute direction."""

    sees_kind: bool = sensed(False)
    """Whether an observation says for each ray if it ends on a wall and if on a piece, before the target;
    where doors are closed, after these, also if on one of them."""

    closed_doors: int = 0
    """Steps of walking at a closed door until it opens for the rest of the episode: all doors between rooms
    begin an episode closed. 0: doorways are open."""

    kinds: tuple[str, ...] = sensed(())
    """Kinds of pieces that an observation tells apart: of each, before the distance, whether the ray ends on
    such a piece. One at least must be in some house of the bank."""

    noise: float = sensed(0.0)
    """Standard deviation of each distance, metres: normal, cut to 0 and the range."""

    angle_noise: float = sensed(0.0)
    """Standard deviation of each ray's direction, degrees: normal, cut at four of them; ``free`` alone."""

    dropout: float = sensed(0.0)
    """The probability that a ray returns nothing, as if there were nothing in its range."""

    latency: int = sensed(0)
    """Steps by which rays and the target are seen late: at an episode's begin, as they were then."""

    observe: tuple[str, ...] = sensed((RAYS,))
    """Parts of an observation. ``rays``: the sensor. ``bump``: 1 if the last move was blocked.
    ``last_action``: one-hot vector of three numbers, all 0 at the start of an episode. ``odometry``:
    estimated pose, metres forward and left of the start, cosine and sine of the turn. ``goal``: metres
    forward and left from the body to the target. ``geodesic``: fewest actions to the target, -1 if no path
    leads there. ``speed`` (backend ``free``): forward in m/s and turn to the left in rad/s; for bodies that
    drive sideways, forward and left in m/s and the turn. ``memory``: the numbers that the task's terms
    keep."""

    flat: bool = sensed(False)
    """Whether an observation is one row of numbers, in the order of ``observe``."""

    drift: float = sensed(0.0)
    """Standard deviation of the errors of which ``odometry`` is the sum, as a share of each step and turn."""

    memory: int = 0
    """Number of values that the task's terms keep; environments set this field."""

    drives: bool = False
    """Whether bodies move freely: the backend ``free`` sets it."""

    drive: Drive = field(default_factory=Drive)
    """How bodies move in the backend ``free``."""

    slip: float = 0.0
    """The probability that an action does nothing, and that nothing says so."""

    varied: tuple[tuple[str, float, float], ...] = ()
    """Domain randomisation: fields with a uniformly random value in each episode, as ("noise", 0.0, 0.05).

    ``noise``, ``dropout``, ``slip`` and ``drift`` replace the value of the field. ``width`` scales the body's
    width; the eye stays in the middle. In the backend ``free``, ``speed`` scales the speed of each command,
    and ``acceleration`` scales the limits of acceleration."""

    target: float = 15 * PIXEL
    """Side of the square target, metres."""

    steps: int = 1500
    """Steps until an episode is truncated: the paper's 15 s."""

    geodesic: bool = False
    """Whether infos say how many actions a shortest path to the target takes, as ``distance``."""

    random_start: bool = True
    """Whether an episode starts anywhere free in the main room with any heading, or always at the free
    place nearest to the main room's middle, heading north."""

    def __post_init__(self) -> None:
        """Raise ``ValueError`` for impossible values."""
        settle(self)
        lengths = (*self.body, self.step, self.range, self.target)
        if not all(0 < length < float("inf") for length in lengths):
            raise ValueError("body, step, range and target must be positive lengths in metres")
        if self.eye is None:
            object.__setattr__(self, "eye", Derived(side / 2 for side in self.body))
        if not all(0 <= at <= side for at, side in zip(self.eye, self.body, strict=True)):
            raise ValueError(f"eye is {self.eye} m: it must lie in the body, which is {self.body} m wide")
        if not (1 <= self.rays <= MOST_RAYS and 1 <= self.steps < 2**31):
            found = f"{self.rays} rays and {self.steps} steps"
            raise ValueError(f"{found}: 1 to {MOST_RAYS:,} rays and 1 to {2**31 - 1:,} steps")
        if not 0 < self.ray_spacing <= 360 or not abs(self.first_ray) < float("inf"):
            found = f"ray_spacing is {self.ray_spacing} degrees, first_ray {self.first_ray}"
            raise ValueError(f"{found}: the one above 0 and at most 360, the other finite")
        if not 0 <= self.angle_noise <= MOST_ANGLE_NOISE:
            raise ValueError(f"angle_noise is {self.angle_noise} degrees: from 0 to {MOST_ANGLE_NOISE}")
        if not (0 <= self.noise < float("inf") and 0 <= self.dropout <= 1 and 0 <= self.slip <= 1):
            found = f"noise {self.noise} m, dropout {self.dropout} and slip {self.slip}"
            raise ValueError(f"{found}: not negative, and the last two at most 1")
        if not 0 <= self.latency <= MOST_LATENCY:
            raise ValueError(f"latency is {self.latency} steps: from 0 to {MOST_LATENCY}")
        if len(set(self.kinds)) < len(self.kinds) or len(self.kinds) > MOST_KINDS:
            raise ValueError(f"kinds are {', '.join(self.kinds)}: each once, {MOST_KINDS} at most")
        if strange := next((each for each in self.observe if each not in OBSERVABLE), None):
            raise ValueError(f"observe: {unknown('observation', strange, OBSERVABLE)}")
        if not self.observe or len(set(self.observe)) < len(self.observe):
            raise ValueError(f"observe is {', '.join(self.observe) or 'nothing'}: one at least, each once")
        if not 0 <= self.drift < float("inf"):
            raise ValueError(f"drift is {self.drift}: not negative")
        self._require_varied()
        if self.collision not in ("swept", "original"):
            raise ValueError(f"unknown collision {self.collision!r}: there are swept, original")
        if not 0 <= self.closed_doors <= MOST_PUSHES:
            raise ValueError(f"closed_doors is {self.closed_doors} steps: from 0 to {MOST_PUSHES}")
        if self.closed_doors and (
            self.collision != "swept" or self.ends_on_collision or self.body[0] != self.body[1]
        ):
            raise ValueError(
                "closed_doors needs collision 'swept', a body as wide on a diagonal as along an axis, and "
                "episodes that do not end on a collision: walking at a door is one"
            )

    def _require_varied(self) -> None:
        """Raise ``ValueError`` for names and ranges in ``varied`` that are not possible."""
        for name, low, high in self.varied:
            if name not in VARIABLE:
                raise ValueError(f"varied: {unknown('field', name, VARIABLE)}")
            most = 1.0 if name in SHARES else float("inf")
            if not (0 <= low <= high <= most and high < float("inf")):
                raise ValueError(f"varied: {name} from {low} to {high}: it must be between 0 and {most:g}")
        if len({name for name, *_ in self.varied}) < len(self.varied):
            raise ValueError("varied: name each field once")
        if self.varies("width") and (self.closed_doors or self.knows_distance or self.collision != "swept"):
            raise ValueError(
                "varied: width cannot vary with closed doors, distances or the collision 'original'"
            )

    def most(self, name: str) -> float:
        """Return the largest value of a field in any episode."""
        return next((high for each, _, high in self.varied if each == name), getattr(self, name, 1.0))

    def varies(self, *names: str) -> bool:
        """Return True if one of the fields has a random value in each episode."""
        return any(name in names for name, *_ in self.varied)

    def require_lattice(self, who: str) -> None:
        """Raise ``ValueError`` where bodies move freely, which is not for who counts steps on a lattice."""
        if self.drives:
            raise ValueError(
                f"{who} counts steps on a lattice: take the backend continuous or grid, not free"
            )

    def require_few_directions(self) -> None:
        """Raise ``ValueError`` where rays have more directions than a table of eight headings can serve."""
        if not (self.ray_spacing >= LEAST_SPACING and isclose(45 / self.ray_spacing, self.rays_in_a_turn)):
            raise ValueError(
                f"ray_spacing is {self.ray_spacing:g} degrees: it must divide 45 and be at least "
                f"{LEAST_SPACING}, except in the backend free"
            )
        if self.angle_noise:
            raise ValueError(f"angle_noise is {self.angle_noise:g} degrees: the backend free alone has it")

    @property
    def rays_in_a_turn(self) -> int:
        """Number of rays between two headings of the lattice, which are 45 degrees apart."""
        return round(45 / self.ray_spacing)

    @property
    def ray_angles(self) -> np.ndarray:
        """The rays' directions (R,) float64: radians from the heading, counter-clockwise."""
        return np.deg2rad(self.first_ray - self.ray_spacing * np.arange(self.rays))

    @property
    def columns(self) -> tuple[str, ...]:
        """What an observation says of each ray, in this order; ``is target`` is the last. ``Episodes.look``
        writes it, in numbers from 0 to 1 but for the angle: see ``single_spaces``.
        """
        return (
            *(("angle",) if self.sees_angle else ()),
            *(f"kind {kind}" for kind in self.kinds),
            "distance",
            *(("is wall", "is piece") if self.sees_kind else ()),
            *(("is door",) if self.sees_doors else ()),
            "is target",
        )

    def column(self, name: str) -> int:
        """Where an observation says this of each ray: see ``columns``."""
        return self.columns.index(name)

    @property
    def channels(self) -> int:
        """Numbers in an observation for each ray."""
        return len(self.columns)

    @property
    def extras(self) -> tuple[str, ...]:
        """What is observed beside rays."""
        return tuple(name for name in self.observe if name != RAYS)

    @property
    def extra_numbers(self) -> int:
        """How many numbers that is."""
        return sum(map(self.numbers_of, self.extras))

    def numbers_of(self, name: str) -> int:
        """How many numbers a part is that is observed beside rays."""
        return {**EXTRAS, "speed": len(self.drive.low), MEMORY: self.memory}[name]

    def extra(self, name: str) -> int:
        """Where a part begins among these numbers."""
        before = self.extras[: self.extras.index(name)]
        return sum(map(self.numbers_of, before))

    @property
    def knows_distance(self) -> bool:
        """Whether the distance to the target is asked for."""
        return self.geodesic or "geodesic" in self.observe

    @property
    def notes_hits(self) -> bool:
        """Whether a backend must say of a ray that it ends on a wall, or on a piece and of which kind."""
        return self.sees_kind or bool(self.kinds)

    @property
    def sees_doors(self) -> bool:
        """Whether an observation says for each ray if it ends on a closed door."""
        return self.sees_kind and self.closed_doors > 0


DEFAULT = Config()
"""Environments for which nothing else is asked."""

PAPER = replace(
    DEFAULT,
    body=(8 * PIXEL, 11 * PIXEL),
    eye=(4 * PIXEL, 5 * PIXEL),
    collision="original",
    ends_on_collision=True,
    first_ray=60.0,
    sees_angle=True,
    random_start=False,
)
"""The original program, as measured (its ray casting is made exact: it cut hits to whole pixels)."""

NOISY = replace(DEFAULT, noise=0.02, dropout=0.02, slip=0.01)
"""A sensor and wheels such as cheap ones are."""

LONG = replace(DEFAULT, steps=3000)
"""Episodes for houses of 8 to 12 rooms."""

DOORS = replace(DEFAULT, closed_doors=4, sees_kind=True)
"""All doors between rooms are closed at first, and rays tell a door from a wall."""

DRIVE = replace(DEFAULT, drive=Drive(commands=COMMANDS))
"""In the backend ``free``: left, right and forward, as agents of three actions know them, and bows."""

PRESETS = {
    "default": DEFAULT, "doors": DOORS, "drive": DRIVE, "long": LONG, "noisy": NOISY, "paper": PAPER,
}  # fmt: skip
