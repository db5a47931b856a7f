# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false
"""Rewards and ends of episodes, compiled into the step.

A task's attribute ``terms`` holds its terms. A task without the attribute has the terms ``PLAIN``, which add
no code to the kernel. JSON states terms in the task, as in ``{"task": "secondary", "terms": {"step":
-0.01}}``. ``"terms": "module:Class"`` names a class of your own:

    @ti.data_oriented
    @dataclass(frozen=True)
    class Careful(Terms):
        "A pick-up is worth less, the longer it took; from step 100 on a bump ends the episode."

        worth: float = 1.0

        @ti.func
        def reward(self, now):
            return ti.static(self.worth) * now.picked / now.time

        @ti.func
        def ends(self, now):
            return now.blocked & ti.cast(now.time > 100, ti.i32)

Terms may keep ``memory`` numbers for each environment, which are 0 at the start of an episode:

    @ti.data_oriented
    @dataclass(frozen=True)
    class Bruises(Terms):
        "The third bump into a piece of furniture ends the episode."

        memory: ClassVar[int] = 1
        sees_bumped: ClassVar[bool] = True

        @ti.func
        def remember(self, now):
            return now.was + ti.cast(now.bumped == PIECE, ti.f32)

        @ti.func
        def ends(self, now):
            return ti.cast(now.memory[0] > 2, ti.i32)
"""

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cache
from math import isfinite
from typing import Any, ClassVar, TypeVar

from vitruvius.logic import House
from vitruvius.sim.fields import settle
from vitruvius.sim.runtime import ti

MAX_MEMORY = 64
"""Largest number of values that terms keep for each environment. Kernels hold the values in registers."""

Now = ti.types.struct(
    action=ti.i32,  # the action's number in environments
    picked=ti.i32,  # 1 if this step picked up the target
    blocked=ti.i32,  # 1 if something was in the way
    found=ti.i32,  # targets picked up in this episode, including this step's
    time=ti.i32,  # steps of this episode, including this one
    house=ti.i32,  # its number in the bank
    eye=ti.math.vec2,  # the eye's place after the step, metres
    heading=ti.i32,  # eighths of a turn, counter-clockwise from east
    target=ti.math.vec2,  # centre of the target before the step, metres
    before=ti.i32,  # fewest actions to that target before the step and
    distance=ti.i32,  # after it, with ``sees_distance``; -1 without a path or if not needed
    bumped=ti.i32,  # the obstacle in the way, with ``Terms.sees_bumped``
    room=ti.i32,  # the eye's room after the step, an index of ``House.rooms``, with ``Terms.sees_room``
    mark=ti.i32,  # the room's mark, 0 outside rooms: see ``Terms.marks``
    marked=ti.i32,  # number of rooms in the house with a mark other than 0
)
"""Data of a step for ``Terms.reward``, ``Terms.ends`` and ``Terms.remember``. For terms with a ``memory``,
there are also two vectors of float32: ``was``, the memory before the step, and ``memory``, the memory after
the step.
"""


@cache
def now_of(memory: int) -> Any:
    """Return the type ``Now`` for terms with ``memory`` numbers."""
    if not memory:
        return Now
    kept = ti.types.vector(memory, ti.f32)
    return ti.types.struct(**Now.members, was=kept, memory=kept)


@ti.data_oriented
@dataclass(frozen=True)
class Terms:
    """Rewards of a step, and conditions that end an episode.

    A subclass may define the ``ti.func``s ``reward``, ``ends`` and ``remember``, and further fields, which
    become constants of the kernel.
    """

    pick_up: float = 1.0
    """Reward for a pick-up."""

    step: float = 0.0
    """Reward for each step."""

    bump: float = 0.0
    """Reward for a blocked step."""

    progress: float = 0.0
    """Reward for each action by which the shortest path to the target gets shorter. It is a difference of
    potentials, also for a new target and at an end, so it does not change the optimal policy. A step from
    distance d to d' earns ``progress * (d - discount * d')``, with d' = 0 if the episode terminates or there
    is no path."""

    discount: float = 1.0
    """Discount factor in ``progress``; use the learner's."""

    targets: int = 0
    """Number of pick-ups after which an episode terminates; 0 for no limit."""

    steps: int = 0
    """Number of steps after which an episode is truncated; 0 for the configuration's number."""

    sees_distance: ClassVar[bool] = False
    """True if ``reward`` or ``ends`` of a subclass reads ``before`` or ``distance``, which take time to
    compute."""

    sees_room: ClassVar[bool] = False
    """True if a subclass reads ``room``, ``mark`` or ``marked``. The room is -1 in the doorway of a thick
    wall; if rooms overlap, it is the first of them."""

    sees_bumped: ClassVar[bool] = False
    """True if a subclass reads ``bumped``: 0 for no obstacle, else ``WALL``, ``PIECE`` or ``DOOR`` of
    ``sim.backends.backend``, or ``NAMED`` + k for a piece of the k-th kind in ``Config.kinds``. Of several
    obstacles a closed door takes precedence, then a piece."""

    memory: ClassVar[int] = 0
    """Number of values that a subclass keeps for each environment; it may be a property."""

    finite: ClassVar[tuple[str, ...]] = ("pick_up", "step", "bump", "progress", "discount")
    """Fields that must be finite numbers."""

    def __post_init__(self) -> None:
        """Raise ``ValueError`` for numbers that are not finite, and for invalid counts."""
        settle(self, "terms: ")
        for name in self.finite:
            if not isfinite(value := getattr(self, name)):
                raise ValueError(f"terms: {name} must be a finite number, not {value!r}")
        if not 0 <= self.discount <= 1:
            raise ValueError(f"terms: discount is {self.discount}: it must be 0 to 1")
        for name in ("targets", "steps"):
            if not 0 <= (value := getattr(self, name)) < 2**31:
                raise ValueError(f"terms: {name} must be a whole number, 0 or more, not {value!r}")
        if not isinstance(self.memory, int) or not 0 <= self.memory <= MAX_MEMORY:
            raise ValueError(f"terms: memory is {self.memory!r}: it must be 0 to {MAX_MEMORY} numbers")

    @property
    def asks_distance(self) -> bool:
        """True if a step needs the distance to its target."""
        return self.sees_distance or self.progress != 0

    @property
    def surveys(self) -> bool:
        """True if the terms read the body's room or the obstacle in its way."""
        return self.sees_room or self.sees_bumped

    def marks(self, house: House) -> Sequence[int]:
        """Return an integer for each room of a house, which kernels read as ``mark``.

        Raises ``ValueError`` for a house in which the task cannot be played.
        """
        return [0] * len(house.rooms)

    @ti.func
    def remember(self, now):
        """Return the memory after this step, a vector. Here ``now.memory`` equals ``now.was``."""
        return now.was

    @ti.func
    def reward(self, now):
        """Return the reward of a step, without the reward for progress (f32)."""
        return self.basic(now)

    @ti.func
    def basic(self, now):
        """Return the reward for a pick-up, a step and a bump, by the fields (f32)."""
        earned = ti.static(float(self.pick_up)) * ti.cast(now.picked, ti.f32)
        if ti.static(self.step != 0):
            earned += ti.static(float(self.step))
        if ti.static(self.bump != 0):
            earned += ti.static(float(self.bump)) * ti.cast(now.blocked, ti.f32)
        return earned

    @ti.func
    def ends(self, now):
        """Return 1 (i32) if the episode terminates after this step, apart from the limit ``targets``."""
        return 0


PLAIN = Terms()
"""Terms with reward 1 for each pick-up."""

T = TypeVar("T")


def terms_of(task: Any) -> Terms:
    """Return the terms of a task."""
    return getattr(task, "terms", PLAIN)


def with_terms(task: T, terms: Terms) -> T:
    """Return a copy of a task with other terms."""
    other = copy(task)
    object.__setattr__(other, "terms", terms)  # tasks are frozen
    return other


@ti.data_oriented
@dataclass(frozen=True)
class Counting(Terms):
    """Terms with reward 1 for a pick-up and nothing else; episodes end as with the terms ``others``."""

    others: Terms = PLAIN

    @property
    def asks_distance(self) -> bool:
        """True if the other terms read the distance: see ``Terms``."""
        return self.others.sees_distance

    @property
    def sees_room(self) -> bool:  # pyright: ignore[reportIncompatibleVariableOverride]
        """True if the other terms read the room: see ``Terms``."""
        return self.others.sees_room

    @property
    def sees_bumped(self) -> bool:  # pyright: ignore[reportIncompatibleVariableOverride]
        """True if the other terms read the obstacle: see ``Terms``."""
        return self.others.sees_bumped

    @property
    def memory(self) -> int:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Number of values that the other terms keep: see ``Terms``."""
        return self.others.memory

    def marks(self, house: House) -> Sequence[int]:
        """Return the marks of the other terms: see ``Terms``."""
        return self.others.marks(house)

    @ti.func
    def remember(self, now):
        """Return the memory of the other terms: see ``Terms``."""
        return self.others.remember(now)

    @ti.func
    def ends(self, now):
        """Return 1 if the other terms end the episode: see ``Terms``."""
        return self.others.ends(now)


def counted(task: T) -> T:
    """Return a copy of a task whose rewards count pick-ups; a task without targets is returned as it is."""
    terms = terms_of(task)
    if not getattr(task, "has_targets", True):
        return task
    if type(terms) is Terms:
        return with_terms(task, replace(PLAIN, targets=terms.targets, steps=terms.steps))
    return with_terms(task, Counting(targets=terms.targets, steps=terms.steps, others=terms))
