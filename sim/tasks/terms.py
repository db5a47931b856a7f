# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false
"""What a task rewards and when it ends, compiled into the step.

A task has terms in its attribute ``terms``; without it they are ``PLAIN``, and the kernel is what it would be
if there were none. In JSON they stand in the task: ``{"task": "secondary", "terms": {"step": -0.01}}``, or
``"terms": "module:Class"`` of a class of your own:

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

Terms may keep some numbers for each environment, ``memory`` of them, which are 0 as an episode begins:

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

from logic import House
from sim.fields import settle
from sim.runtime import ti

MAX_MEMORY = 64
"""Numbers that terms keep for each environment at most: kernels hold them in registers."""

Now = ti.types.struct(
    action=ti.i32,  # as environments number them
    picked=ti.i32,  # 1 where this step picked the target up
    blocked=ti.i32,  # 1 where something was in the way
    found=ti.i32,  # targets picked up in this episode, this step's included
    time=ti.i32,  # steps of this episode, this one included
    house=ti.i32,  # its number in the bank
    eye=ti.math.vec2,  # where the eye is after the step, metres
    heading=ti.i32,  # eighths of a turn, counter-clockwise from east
    target=ti.math.vec2,  # the target that this step was made for, its centre, metres
    before=ti.i32,  # fewest actions to that target before the step and
    distance=ti.i32,  # after it, where ``sees_distance``; -1 where no path leads there, or unasked
    bumped=ti.i32,  # what was in the way, where ``sees_bumped``: see ``Terms.sees_bumped``
    room=ti.i32,  # where the eye is after the step, a number in ``House.rooms``, where ``sees_room``
    mark=ti.i32,  # that room's mark, 0 in none; and
    marked=ti.i32,  # how many rooms of the house have a mark: see ``Terms.marks``
)
"""What ``Terms.reward``, ``Terms.ends`` and ``Terms.remember`` see of a step. Of terms with a ``memory`` it
has also ``was``, the numbers that were kept before the step, and ``memory``, those that are kept after it:
vectors of float32.
"""


@cache
def now_of(memory: int) -> Any:
    """What terms see that keep so many numbers."""
    if not memory:
        return Now
    kept = ti.types.vector(memory, ti.f32)
    return ti.types.struct(**Now.members, was=kept, memory=kept)


@ti.data_oriented
@dataclass(frozen=True)
class Terms:
    """What a step earns, and when an episode ends. A subclass may have ``reward``, ``ends`` and ``remember``,
    which are ``ti.func``s, and fields of its own, which are compiled in.
    """

    pick_up: float = 1.0
    """For a pick-up."""

    step: float = 0.0
    """For each step."""

    bump: float = 0.0
    """For a step that is blocked."""

    progress: float = 0.0
    """For each action that the target is nearer by, of those that a shortest path takes. It is a difference
    of potentials, the new target's and an end's included, so it changes no optimum: a step from distance d to
    d' earns ``progress * (d - discount * d')``, with d' = 0 where the episode terminates and for no path.
    """

    discount: float = 1.0
    """The learner's own, in ``progress``."""

    targets: int = 0
    """Pick-ups after which an episode terminates; 0 for none."""

    steps: int = 0
    """Steps after which an episode is truncated; 0 for those of the configuration."""

    sees_distance: ClassVar[bool] = False
    """Whether ``reward`` or ``ends`` of a subclass reads ``before`` or ``distance``: they cost time."""

    sees_room: ClassVar[bool] = False
    """Whether a subclass reads ``room``, ``mark`` or ``marked``. The room is -1 in a doorway of a thick wall;
    of rooms that overlap it is the first."""

    sees_bumped: ClassVar[bool] = False
    """Whether a subclass reads ``bumped``: 0 for nothing, else what a ray would say that ends there,
    ``WALL``, ``PIECE`` or ``DOOR`` of ``sim.backends.backend``, or for a piece of the k-th of
    ``Config.kinds`` ``NAMED`` + k. Of several things at once a closed door counts, then a piece."""

    memory: ClassVar[int] = 0
    """Numbers that a subclass keeps for each environment; a property may say how many."""

    finite: ClassVar[tuple[str, ...]] = ("pick_up", "step", "bump", "progress", "discount")
    """Fields that must be finite numbers."""

    def __post_init__(self) -> None:
        """Raise ``ValueError`` for what are no finite numbers, and for counts that are none."""
        settle(self, "terms: ")
        for name in self.finite:
            if not isfinite(value := getattr(self, name)):
                raise ValueError(f"terms: {name} must be a finite number, not {value!r}")
        if not 0 <= self.discount <= 1:
            raise ValueError(f"terms: discount is {self.discount}: from 0 to 1")
        for name in ("targets", "steps"):
            if not 0 <= (value := getattr(self, name)) < 2**31:
                raise ValueError(f"terms: {name} must be a whole number from 0, not {value!r}")
        if not isinstance(self.memory, int) or not 0 <= self.memory <= MAX_MEMORY:
            raise ValueError(f"terms: memory is {self.memory!r}: from 0 to {MAX_MEMORY} numbers")

    @property
    def asks_distance(self) -> bool:
        """Whether a step must know the distance to its target."""
        return self.sees_distance or self.progress != 0

    @property
    def surveys(self) -> bool:
        """Whether a step must know what is about the body."""
        return self.sees_room or self.sees_bumped

    def marks(self, house: House) -> Sequence[int]:
        """A whole number for each room of a house, which kernels see as ``mark``. ``ValueError`` for a house
        where the task cannot be played.
        """
        return [0] * len(house.rooms)

    @ti.func
    def remember(self, now):
        """The numbers that are kept after this step, a vector; ``now.memory`` is still ``now.was``."""
        return now.was

    @ti.func
    def reward(self, now):
        """What a step earns but for its progress (f32)."""
        return self.basic(now)

    @ti.func
    def basic(self, now):
        """What the fields say that a step earns (f32)."""
        earned = ti.static(float(self.pick_up)) * ti.cast(now.picked, ti.f32)
        if ti.static(self.step != 0):
            earned += ti.static(float(self.step))
        if ti.static(self.bump != 0):
            earned += ti.static(float(self.bump)) * ti.cast(now.blocked, ti.f32)
        return earned

    @ti.func
    def ends(self, now):
        """Whether the episode terminates after this step, beside what ``targets`` says (i32)."""
        return 0


PLAIN = Terms()
"""1 for each pick-up."""

T = TypeVar("T")


def terms_of(task: Any) -> Terms:
    """A task's terms."""
    return getattr(task, "terms", PLAIN)


def with_terms(task: T, terms: Terms) -> T:
    """A task with other terms."""
    other = copy(task)
    object.__setattr__(other, "terms", terms)  # tasks are frozen
    return other


@ti.data_oriented
@dataclass(frozen=True)
class Counting(Terms):
    """A pick-up earns 1, all else nothing; episodes end as those of ``others`` do."""

    others: Terms = PLAIN

    @property
    def asks_distance(self) -> bool:
        """See ``Terms``."""
        return self.others.sees_distance

    @property
    def sees_room(self) -> bool:  # pyright: ignore[reportIncompatibleVariableOverride]
        """See ``Terms``."""
        return self.others.sees_room

    @property
    def sees_bumped(self) -> bool:  # pyright: ignore[reportIncompatibleVariableOverride]
        """See ``Terms``."""
        return self.others.sees_bumped

    @property
    def memory(self) -> int:  # pyright: ignore[reportIncompatibleVariableOverride]
        """See ``Terms``."""
        return self.others.memory

    def marks(self, house: House) -> Sequence[int]:
        """See ``Terms``."""
        return self.others.marks(house)

    @ti.func
    def remember(self, now):
        """See ``Terms``."""
        return self.others.remember(now)

    @ti.func
    def ends(self, now):
        """See ``Terms``."""
        return self.others.ends(now)


def counted(task: T) -> T:
    """A task in which rewards count pick-ups, and all else is as it was; one without targets is itself."""
    terms = terms_of(task)
    if not getattr(task, "has_targets", True):
        return task
    if type(terms) is Terms:
        return with_terms(task, replace(PLAIN, targets=terms.targets, steps=terms.steps))
    return with_terms(task, Counting(targets=terms.targets, steps=terms.steps, others=terms))
