"""Configuration of the body, its sensor and its episodes. Lengths in metres, angles in degrees."""

from dataclasses import dataclass, field, replace
from math import isclose
from typing import Any, Literal, cast

import numpy as np

from vitruvius.logic.spelling import unknown
from vitruvius.sim.drive import COMMANDS, Drive
from vitruvius.sim.fields import Derived, settle
from vitruvius.sim.parts import MEMORY, PARTS

FOOT = 0.3048
PIXEL = FOOT / 8.5
"""Length of a pixel of the original program in metres: 8.5 pixels are a foot. The paper's lengths are in
pixels."""

MOST_RAYS = 1024
"""Largest number of rays. The memory of environments and networks grows with it; 360 rays, a degree apart,
cover all directions."""

MOST_KINDS = 64
"""Largest number of kinds of furniture that an observation distinguishes."""

LEAST_SPACING = 0.1
"""Smallest angle between rays on a lattice, in degrees: a table has a row for each direction."""

MOST_ANGLE_NOISE = 45
"""Largest standard deviation of a ray's direction, in degrees."""

DEVIATIONS = 4.0
"""Number of standard deviations at which the error of a ray's direction is clipped."""

MOST_LATENCY = 255
"""Largest latency, in steps: environments keep the poses of so many past steps."""

MOST_PUSHES = 255
"""Largest number of steps that a door may take to open, because doors count them in 8 bits."""


RAYS = "rays"
EXTRAS = tuple(name for name in PARTS if name != MEMORY)
"""Parts of an observation other than rays and memory: see ``sim.parts``."""

VARIABLE = "noise", "dropout", "slip", "drift", "speed", "acceleration", "width"
"""Names for ``Config.varied``, whose values may be random in each episode."""

SHARES = "dropout", "slip", "speed", "acceleration", "width"
"""Names of ``VARIABLE`` whose values are at most 1."""

OBSERVABLE = RAYS, *PARTS

SENSOR = "sensor"
"""Key in the metadata of a field that describes the sensor. Evaluation copies these fields from the agent's
training config."""


def sensed(default: Any) -> Any:
    """Return a dataclass field that describes the sensor."""
    return field(default=default, metadata={SENSOR: True})


@dataclass(frozen=True)
class Config:
    """Configuration of an environment.

    The defaults are the paper's lengths; ``PAPER`` adds its other rules.
    """

    body: tuple[float, float] = (8 * PIXEL, 8 * PIXEL)
    """Side of the axis-aligned square body in metres, as two values: at headings along an axis, and at
    diagonal headings."""

    eye: tuple[float, float] = cast(Any, None)
    """Offset of the eye from the body's north-west corner, in metres, the same east and south. Two values: at
    headings along an axis, and at diagonal headings. By default the eye is in the middle of the body."""

    step: float = 2 * PIXEL
    """Distance that ``forward`` covers at headings along an axis, in metres. At diagonal headings it covers
    this distance along both axes."""

    in_cells: bool = False
    """True if the body fills a cell of a grid and moves from cell to cell; the grid backend sets this
    field."""

    collision: Literal["swept", "original"] = "swept"
    """Rule that blocks a move. ``swept`` blocks it if the body touches anything on its way. ``original`` is
    the rule of the original program, which checks only the new place and ignores which wall a door is in."""

    ends_on_collision: bool = False
    """True if a blocked move ends the episode."""

    rays: int = sensed(40)
    """Number of rays."""

    first_ray: float = sensed(58.5)
    """Angle from the heading to ray 0, in degrees counter-clockwise. At 58.5 degrees, 40 rays are
    mirror-symmetric."""

    ray_spacing: float = sensed(3)
    """Degrees from a ray to the next ray, clockwise. The value must divide 45, as 3 or 22.5 does, so that the
    table of directions is small; the backend ``free`` accepts any value."""

    range: float = sensed(220 * PIXEL)
    """Range of a ray, in metres."""

    sees_angle: bool = sensed(False)
    """True if an observation begins with the absolute direction of each ray."""

    sees_kind: bool = sensed(False)
    """True if an observation says for each ray if it ends on a wall and if it ends on furniture: two values
    before the one for the target. With closed doors, a third value says if the ray ends on a door."""

    closed_doors: int = 0
    """Number of steps that a body must push a closed door before it opens for the rest of the episode. All
    doors between rooms are closed when an episode begins. 0: doorways are always open."""

    kinds: tuple[str, ...] = sensed(())
    """Kinds of furniture that an observation distinguishes. For each kind, before the distance, an
    observation says if the ray ends on such furniture. Some house of the bank must have at least one of these
    kinds."""

    noise: float = sensed(0.0)
    """Standard deviation of each measured distance, in metres. The error is normal; the distance is clipped
    to 0 and the range."""

    angle_noise: float = sensed(0.0)
    """Standard deviation of each ray's direction, in degrees. The error is normal, clipped at four standard
    deviations. Only for the backend ``free``."""

    dropout: float = sensed(0.0)
    """Probability that a ray returns nothing, as if nothing were in its range."""

    latency: int = sensed(0)
    """Delay of rays and target, in steps. In the first steps of an episode, the observation shows the first
    state."""

    observe: tuple[str, ...] = sensed((RAYS,))
    """Parts of an observation: ``rays``, the sensor, and those in ``sim.parts``."""

    flat: bool = sensed(False)
    """True if an observation is one flat array, in the order of ``observe``."""

    drift: float = sensed(0.0)
    """Standard deviation of the errors that accumulate in ``odometry``, as a fraction of each step and
    turn."""

    memory: int = 0
    """Number of values that the task's terms keep; environments set this field."""

    drives: bool = False
    """True if bodies move continuously; the backend ``free`` sets this field."""

    drive: Drive = field(default_factory=Drive)
    """Limits of the motion in the backend ``free``."""

    slip: float = 0.0
    """Probability that an action is silently ignored."""

    varied: tuple[tuple[str, float, float], ...] = ()
    """Domain randomisation: fields with a uniformly random value in each episode, as ("noise", 0.0, 0.05).

    ``noise``, ``dropout``, ``slip`` and ``drift`` replace the value of the field. ``width`` scales the body's
    width; the eye stays in the middle. In the backend ``free``, ``speed`` scales the speed of each command,
    and ``acceleration`` scales the limits of acceleration."""

    target: float = 15 * PIXEL
    """Side of the square target, metres."""

    steps: int = 1500
    """Number of steps after which an episode is truncated; the default is the paper's 15 s."""

    geodesic: bool = False
    """True if infos have ``distance``, the number of actions of a shortest path to the target."""

    random_start: bool = True
    """True if an episode starts at a random free place in the main room, with a random heading. Otherwise it
    starts at the free place nearest to the main room's middle, heading north."""

    def __post_init__(self) -> None:
        """Raise ``ValueError`` for impossible values."""
        settle(self)
        lengths = (*self.body, self.step, self.range, self.target)
        if not all(0 < length < float("inf") for length in lengths):
            raise ValueError("body, step, range and target must be positive lengths in metres")
        if self.eye is None:
            object.__setattr__(self, "eye", Derived(side / 2 for side in self.body))
        if not all(0 <= at <= side for at, side in zip(self.eye, self.body, strict=True)):
            raise ValueError(
                f"eye is {self.eye} m: it must lie within the body, which measures {self.body} m"
            )
        if not (1 <= self.rays <= MOST_RAYS and 1 <= self.steps < 2**31):
            found = f"{self.rays} rays and {self.steps} steps"
            raise ValueError(f"{found}: give 1 to {MOST_RAYS:,} rays and 1 to {2**31 - 1:,} steps")
        if not 0 < self.ray_spacing <= 360 or not abs(self.first_ray) < float("inf"):
            found = f"ray_spacing is {self.ray_spacing} degrees, first_ray {self.first_ray}"
            raise ValueError(
                f"{found}: ray_spacing must be above 0 and at most 360, first_ray must be finite"
            )
        if not 0 <= self.angle_noise <= MOST_ANGLE_NOISE:
            raise ValueError(f"angle_noise is {self.angle_noise} degrees: it must be 0 to {MOST_ANGLE_NOISE}")
        if not (0 <= self.noise < float("inf") and 0 <= self.dropout <= 1 and 0 <= self.slip <= 1):
            found = f"noise {self.noise} m, dropout {self.dropout} and slip {self.slip}"
            raise ValueError(f"{found}: none may be negative; dropout and slip must be at most 1")
        if not 0 <= self.latency <= MOST_LATENCY:
            raise ValueError(f"latency is {self.latency} steps: it must be 0 to {MOST_LATENCY}")
        if len(set(self.kinds)) < len(self.kinds) or len(self.kinds) > MOST_KINDS:
            raise ValueError(f"kinds are {', '.join(self.kinds)}: name each once, and at most {MOST_KINDS}")
        if strange := next((each for each in self.observe if each not in OBSERVABLE), None):
            raise ValueError(f"observe: {unknown('observation', strange, OBSERVABLE)}")
        if not self.observe or len(set(self.observe)) < len(self.observe):
            raise ValueError(
                f"observe is {', '.join(self.observe) or 'nothing'}: name at least one part, "
                "and each part once"
            )
        if not 0 <= self.drift < float("inf"):
            raise ValueError(f"drift is {self.drift}: it must not be negative")
        self._require_varied()
        if self.collision not in ("swept", "original"):
            raise ValueError(f"unknown collision {self.collision!r}: choose swept or original")
        if not 0 <= self.closed_doors <= MOST_PUSHES:
            raise ValueError(f"closed_doors is {self.closed_doors} steps: it must be 0 to {MOST_PUSHES}")
        if self.closed_doors and (
            self.collision != "swept" or self.ends_on_collision or self.body[0] != self.body[1]
        ):
            raise ValueError(
                "closed_doors needs collision 'swept', a square body, and ends_on_collision=False, since "
                "pushing a door is a collision"
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
                "varied: width cannot vary together with closed doors, distances to the target or collision "
                "'original'"
            )

    def most(self, name: str) -> float:
        """Return the largest value of a field in any episode."""
        return next((high for each, _, high in self.varied if each == name), getattr(self, name, 1.0))

    def varies(self, *names: str) -> bool:
        """Return True if one of the fields has a random value in each episode."""
        return any(name in names for name, *_ in self.varied)

    def require_lattice(self, who: str) -> None:
        """Raise ``ValueError`` if bodies move continuously: the caller ``who`` counts steps on a lattice."""
        if self.drives:
            raise ValueError(f"{who} counts grid steps: use the backend continuous or grid, not free")

    def require_few_directions(self) -> None:
        """Raise ``ValueError`` if rays have too many directions for a table of eight headings."""
        if not (self.ray_spacing >= LEAST_SPACING and isclose(45 / self.ray_spacing, self.rays_in_a_turn)):
            raise ValueError(
                f"ray_spacing is {self.ray_spacing:g} degrees: it must divide 45 and be at least "
                f"{LEAST_SPACING}, except in the backend free"
            )
        if self.angle_noise:
            raise ValueError(
                f"angle_noise is {self.angle_noise:g} degrees: only the backend free supports it"
            )

    @property
    def rays_in_a_turn(self) -> int:
        """Number of rays between two headings of the lattice, which are 45 degrees apart."""
        return round(45 / self.ray_spacing)

    @property
    def ray_angles(self) -> np.ndarray:
        """Directions of the rays, (R,) float64, in radians counter-clockwise from the heading."""
        return np.deg2rad(self.first_ray - self.ray_spacing * np.arange(self.rays))

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the values of each ray in an observation, in their order; ``is target`` is the last.

        ``look`` in ``sim/world/observing.py`` writes the values. They are from 0 to
        1, except the angle: see ``single_spaces``.
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
        """Return the index of a column among ``columns``."""
        return self.columns.index(name)

    @property
    def channels(self) -> int:
        """Numbers in an observation for each ray."""
        return len(self.columns)

    @property
    def extras(self) -> tuple[str, ...]:
        """Names of the parts of an observation other than rays."""
        return tuple(name for name in self.observe if name != RAYS)

    @property
    def extra_numbers(self) -> int:
        """Number of values of the parts other than rays."""
        return sum(map(self.numbers_of, self.extras))

    def numbers_of(self, name: str) -> int:
        """Return the number of values of a part other than rays."""
        numbers = PARTS[name].numbers
        return numbers if isinstance(numbers, int) else numbers(self)

    def extra(self, name: str) -> int:
        """Return the index of a part's first value among the values of all parts other than rays."""
        before = self.extras[: self.extras.index(name)]
        return sum(map(self.numbers_of, before))

    @property
    def knows_distance(self) -> bool:
        """True if infos or observations have the distance to the target."""
        return self.geodesic or "geodesic" in self.observe

    @property
    def notes_hits(self) -> bool:
        """True if a backend must report what each ray ends on: a wall, or a kind of furniture."""
        return self.sees_kind or bool(self.kinds)

    @property
    def sees_doors(self) -> bool:
        """True if an observation says for each ray if it ends on a closed door."""
        return self.sees_kind and self.closed_doors > 0


DEFAULT = Config()
"""Configuration without any options."""

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
"""The original program, as measured. Ray casting is exact here; the original rounded hits to whole pixels."""

NOISY = replace(DEFAULT, noise=0.02, dropout=0.02, slip=0.01)
"""Noise of cheap sensors and wheels."""

LONG = replace(DEFAULT, steps=3000)
"""Episodes for houses of 8 to 12 rooms."""

DOORS = replace(DEFAULT, closed_doors=4, sees_kind=True)
"""Doors between rooms that are closed at first, and rays that distinguish a door from a wall."""

DRIVE = replace(DEFAULT, drive=Drive(commands=COMMANDS))
"""Discrete commands in the backend ``free``: left, right and forward, as for agents of three actions, and
curves."""

PRESETS = {
    "default": DEFAULT, "doors": DOORS, "drive": DRIVE, "long": LONG, "noisy": NOISY, "paper": PAPER,
}  # fmt: skip
