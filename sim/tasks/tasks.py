"""Tasks of an episode: the places of targets, the rewards, and the end of the episode.

A new task is a class of a few lines, given to an environment as ``targets=``:

    @dataclass(frozen=True)
    class Largest:
        "Pick up targets in the largest room."
        ends_on_pick_up: ClassVar[bool] = False

        def spaces(self, house: House) -> list[Box]:
            return [max(house.rooms, key=lambda room: room.area).box]
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass, field, fields, is_dataclass, replace
from pathlib import Path
from typing import Any, ClassVar, Protocol, runtime_checkable

import numpy as np

from vitruvius.logic import House
from vitruvius.logic.spelling import unknown
from vitruvius.sim.allowed import class_name, imported, is_class_name
from vitruvius.sim.config import PIXEL
from vitruvius.sim.fields import settle, stated
from vitruvius.sim.geometry import Box
from vitruvius.sim.tasks.base import BaseTask, require_at_once
from vitruvius.sim.tasks.furniture import Habit, Object, WeightedTask
from vitruvius.sim.tasks.remembering import Battery, Visit
from vitruvius.sim.tasks.terms import PLAIN, Terms, terms_of

UNITS = {"m": 1.0, "px": PIXEL}
"""Length of each unit in metres."""


class Task(Protocol):
    """A task with targets that appear one after the other in some spaces of a house; a pick-up earns 1.

    A task may also have:

    - ``terms``: other rewards and ends of episodes (``sim.tasks.terms``).
    - ``stages(house)``: lists of rectangles. The first target lies in a rectangle of the first list, the
      second target in one of the second list, and so on.
    - ``at_once``: the number of targets at once.
    - ``start_spaces(house)``: the rectangles where episodes start; an empty list stands for ``House.start``.
    - ``has_targets``: False for a task without targets. The body must be able to reach all of ``spaces``.
    - ``check(houses)``: raises ``ValueError`` for a bank in which the task cannot be played.
    - ``suits(house)``: returns True if the task can be played in the house.
    """

    ends_on_pick_up: ClassVar[bool]
    """True if the first pick-up terminates the episode."""

    def spaces(self, house: House) -> list[Box]:
        """Return rectangles; each target lies completely in one of them.

        Examples are ``room.box`` and ``house.main.box`` for the hub (in a star: the floor without the rooms,
        in all files).
        """
        ...


@runtime_checkable
class FixedTask(Protocol):
    """A task that gives the place of each target; it may also give the start of episodes."""

    ends_on_pick_up: ClassVar[bool]
    """True if the first pick-up terminates the episode."""

    def positions(self, house: House) -> Sequence[Sequence[float]]:
        """Return the centres (x, y) of the targets in a house, metres.

        The simulator draws each next target from the other centres with equal probability, if possible at
        least 0.82 m from the last target along one axis. If the task's ``in_order`` is True, targets appear
        in the order of the list.
        """
        ...

    def pose(self, house: House) -> Sequence[float] | None:
        """Return the eye's pose at the start of an episode, (x, y, heading) in metres and radians.

        ``None`` stands for anywhere free in the main room.
        """
        ...


@dataclass(frozen=True)
class Points:
    """Task to pick up as many targets as possible at given places.

    Lengths are in metres, or for the ``unit`` "px" in the paper's pixels; headings are in radians.
    """

    points: Sequence[Sequence[float]]
    """Centres (x, y) of targets."""
    start: Sequence[float] | None = None
    """Pose (x, y, heading) of the eye where all episodes start; by default anywhere free in the main room."""
    unit: str = "m"
    in_order: bool = field(default=False, kw_only=True, repr=False)
    """True if targets appear in the order of ``points``, again from the first after the last."""
    at_once: int = field(default=1, kw_only=True, repr=False)
    """Number of targets at once: see ``BaseTask``."""
    terms: Terms = field(default=PLAIN, kw_only=True, repr=False)
    ends_on_pick_up: ClassVar[bool] = False

    def __post_init__(self) -> None:
        """Raise ``ValueError`` for invalid points, an invalid pose or an unknown unit."""
        settle(self)
        if not np.iterable(self.points) or not all(_finite(point, 2) for point in [*self.points] or [None]):
            raise ValueError(f"points: give a list of [x, y], not {self.points!r}")
        if self.start is not None and not _finite(self.start, 3):
            raise ValueError(f"start: give [x, y, heading], not {self.start!r}")
        if self.unit not in UNITS:
            raise ValueError(unknown("unit", self.unit, UNITS))
        require_at_once(self.at_once)

    def positions(self, house: House) -> list[tuple[float, ...]]:
        """Return the centres in metres: see ``FixedTask``."""
        return [tuple(UNITS[self.unit] * value for value in point) for point in self.points]

    def pose(self, house: House) -> tuple[float, ...] | None:
        """Return the pose in metres and radians: see ``FixedTask``."""
        if self.start is None:
            return None
        return (*(UNITS[self.unit] * value for value in self.start[:2]), self.start[2])


def _finite(values: Any, count: int) -> bool:
    """Return True if ``values`` are ``count`` finite numbers."""
    array = np.asarray(values)
    return array.shape == (count,) and array.dtype.kind in "if" and bool(np.isfinite(array).all())


@dataclass(frozen=True)
class Collect(BaseTask):
    """Task to pick up as many targets as possible in the main room (the hub), the other rooms, or both."""

    main: bool = True
    secondary: bool = True
    ends_on_pick_up: ClassVar[bool] = False

    def spaces(self, house: House) -> list[Box]:
        """Return the rectangles of targets: see ``Task``.

        Raises ``ValueError`` for ``main`` in a house without a hub.
        """
        if self.main and not self.secondary and not house.hub:
            types = sorted({room.type for room in house.rooms})
            raise ValueError(
                f'it names no hub, so it has no main room: use targets="all" or {{"rooms": {types}}}'
            )
        hub = [house.main.box] if self.main and house.hub else []
        return hub + [room.box for room in house.secondary] * self.secondary


@dataclass(frozen=True)
class Rooms(BaseTask):
    """Task to pick up as many targets as possible in rooms of these types."""

    rooms: Sequence[str]
    ends_on_pick_up: ClassVar[bool] = False

    def __post_init__(self) -> None:
        """Raise ``TypeError`` unless ``rooms`` is a list of names."""
        if isinstance(self.rooms, str) or not all(isinstance(name, str) for name in self.rooms):
            raise TypeError(f"rooms: give a list of room types, not {self.rooms!r}")
        super().__post_init__()

    def spaces(self, house: House) -> list[Box]:
        """Return the rooms of the types: see ``Task``."""
        return [room.box for room in house.rooms if room.type in self.rooms]


@dataclass(frozen=True)
class Order(Rooms):
    """Task to pick up targets in a given order of room types.

    The first target lies in a room of the first type, the next target in a room of the second type, and so
    on. After the last type the order begins again.
    """

    def __post_init__(self) -> None:
        """Raise ``TypeError`` unless ``rooms`` is a list of names, with at least one."""
        super().__post_init__()
        if not [*self.rooms]:
            raise TypeError(f"rooms: give a list of room types, in order, not {self.rooms!r}")

    def stages(self, house: House) -> list[list[Box]]:
        """Return for each target of a round the rectangles in one of which the target lies completely."""
        return [[room.box for room in house.rooms if room.type == name] for name in self.rooms]


@dataclass(frozen=True)
class Reach(BaseTask):
    """Task to reach a room of a type: a target lies in such a room, and picking it up ends the episode."""

    room: str
    ends_on_pick_up: ClassVar[bool] = True

    def __post_init__(self) -> None:
        """Raise ``TypeError`` unless ``room`` is a string."""
        if not isinstance(self.room, str):
            raise TypeError(f"room: give a room type, not {self.room!r}")
        super().__post_init__()

    def spaces(self, house: House) -> list[Box]:
        """Return the rooms of the type: see ``Task``."""
        return [room.box for room in house.rooms if room.type == self.room]


@dataclass(frozen=True)
class Roam(BaseTask):
    """A task without targets, whose terms define the rewards. The body must be able to reach all rooms."""

    ends_on_pick_up: ClassVar[bool] = False
    has_targets: ClassVar[bool] = False

    def spaces(self, house: House) -> list[Box]:
        """Return all rooms: see ``Task``."""
        return [room.box for room in house.rooms]


TARGETS = {
    "main": Collect(secondary=False),
    "secondary": Collect(main=False),
    "mixed": Collect(),
    "all": Collect(),
    "habit": Habit(),
    "roam": Roam(),
    "visit": Roam(terms=Visit()),
    "battery": Collect(terms=Battery()),
}
"""Tasks with a name. ``mixed`` and ``all`` are the same: anywhere in a house."""

TERMS = {"plain": Terms, "visit": Visit, "battery": Battery}
"""Built-in terms, by name."""

PAPER = Path(__file__).parents[1] / "paper"
PAPER_TASKS = {path.stem: path for path in sorted(PAPER.glob("paper-*.json"))}
"""Files of the tasks in the paper's house, by name: see the README in their folder."""

TASKS = {
    "collect": Collect, "habit": Habit, "object": Object, "points": Points, "reach": Reach, "rooms": Rooms,
    "order": Order, "roam": Roam,
}  # fmt: skip
"""Tasks that take arguments."""

BY_FIRST_ARGUMENT = "rooms", "points"
"""Tasks that a dictionary may state by their first argument alone."""

AnyTask = Task | FixedTask | WeightedTask
Targets = str | dict[str, Any] | AnyTask


def task(targets: Targets) -> AnyTask:
    """Return the task that a name, a JSON text or a dictionary describes; a task is returned as it is.

    ``TARGETS`` and ``PAPER_TASKS`` have the names. A dictionary is ``{"task": name, **arguments}``, such as
    ``{"task": "reach", "room": "kitchen"}``. ``{"rooms": ["bedroom", "study"]}`` is short for the task
    ``rooms``, and ``{"points": [[2.5, 3.0]], "start": [1.0, 2.0, 0.0]}`` for the task ``points``. A
    ``module:Class`` in place of a name must be allowed (``vitruvius.sim.allow``), because the text may come
    from a file.

    An environment's ``spec`` keeps names, texts and dictionaries in JSON. Raises ``ValueError`` for an
    unknown task or wrong arguments.
    """
    if isinstance(targets, str) and targets in TARGETS:
        return TARGETS[targets]
    given = _read(targets) if isinstance(targets, str) else targets
    if not isinstance(given, dict):
        found = isinstance(given, FixedTask | WeightedTask) or callable(getattr(given, "spaces", None))
        if not (found and hasattr(given, "ends_on_pick_up")):
            raise ValueError(
                f"targets: {given!r} is not a task: a task has spaces(house) and ends_on_pick_up"
            )
        return given
    arguments = dict(given)
    name = arguments.pop("task", next((short for short in BY_FIRST_ARGUMENT if short in arguments), None))
    if name is None:
        raise ValueError(
            f"targets: {unknown('argument', next(iter(arguments), '{}'), ('task', *BY_FIRST_ARGUMENT))}"
        )
    if name not in [*TASKS, *TARGETS] and not is_class_name(name):
        names = TASKS if given is targets else [*TARGETS, *PAPER_TASKS]
        raise ValueError(
            f'targets: {unknown("task", name, names)}, or give module:Class, or JSON, as {{"task": NAME}}, '
            f"where NAME is {', '.join(TASKS)} or module:Class"
        )
    try:
        if "terms" in arguments:
            usual = terms_of(TARGETS.get(name))
            arguments["terms"] = read_terms(arguments["terms"], type(usual))
        if name in TARGETS and name not in TASKS:
            return replace(TARGETS[name], **arguments)
        return (TASKS.get(name) or imported(name))(**arguments)
    except (ImportError, AttributeError, TypeError, ValueError) as error:
        raise ValueError(f"targets {targets!r} cannot be used: {error}") from None


def read_terms(given: Any, usual: type[Terms] = Terms) -> Terms:
    """Return the terms that JSON describes: see ``task``.

    Without a class in the JSON, the class is ``usual``. Raises ``ValueError`` for JSON that does not describe
    terms.
    """
    if isinstance(given, Terms):
        return given
    given = {"class": given} if isinstance(given, str) else given
    if not isinstance(given, dict):
        raise ValueError(f'terms: give {{"step": -0.01}} or "module:Class", not {given!r}')
    arguments: dict[str, Any] = {**given}
    name = arguments.pop("class", None)
    if not (name is None or name in list(TERMS) or is_class_name(name)):
        raise ValueError(f"terms: {unknown('class', name, TERMS)}, or give module:Class")
    make = usual if name is None else TERMS[name] if name in TERMS else imported(name)
    if not (isinstance(make, type) and issubclass(make, Terms)):
        raise ValueError(f"terms: {name} is not a subclass of vitruvius.sim.tasks.terms.Terms")
    known = [each.name for each in fields(make)]
    if strange := next((key for key in arguments if key not in known), None):
        raise ValueError(f"terms: {unknown('term', strange, known)}")
    return make(**arguments)


def at_once(task: AnyTask) -> int:
    """Return the number of targets at once in a task."""
    return getattr(task, "at_once", 1)


def has_targets(task: AnyTask) -> bool:
    """Return True if a task has targets."""
    return getattr(task, "has_targets", True)


def stated_task(targets: Targets) -> Any:
    """Return a JSON description from which ``task`` creates the same task: a name, a text or a dictionary.

    The function returns the task itself if no ``module:Class`` names its class, or if the task has attributes
    but is not a dataclass.
    """
    if isinstance(targets, str):
        return targets
    if isinstance(targets, dict):
        return {key: _stated_terms(value) for key, value in targets.items()}
    name = next((name for name, kind in TASKS.items() if type(targets) is kind), class_name(type(targets)))
    if "<locals>" in name or not (is_dataclass(targets) or not vars(targets)):
        return targets
    record = {"task": name}
    for each in fields(targets) if is_dataclass(targets) else ():
        value = getattr(targets, each.name)
        if each.name != "terms" or value != each.default:
            record[each.name] = _stated_terms(value)
    return record


def _stated_terms(value: Any) -> Any:
    """Return an argument of a task in JSON types; ``read_terms`` reads terms."""
    if not isinstance(value, Terms):
        return stated(value)
    kind = type(value)
    return {"class": next((name for name in TERMS if TERMS[name] is kind), class_name(kind))} | stated(value)


def suited(targets: Targets, houses: Sequence[House]) -> list[House]:
    """Return the houses in which a task can be played, in their order; for most tasks all houses."""
    suits = getattr(task(targets), "suits", lambda house: True)
    return [house for house in houses if suits(house)]


def _read(text: str) -> dict[str, Any]:
    """Return a task's name and arguments from a name or a JSON text."""
    if text in PAPER_TASKS:
        return _object(PAPER_TASKS[text].read_text(), text)
    return _object(text, text) if text.startswith("{") else {"task": text}


def _object(text: str, name: str) -> dict[str, Any]:
    """Return the JSON object of a text. Raises ``ValueError`` with the text's name if there is none."""
    try:
        given = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise ValueError(f"targets: {name} is not JSON: {error}") from None
    if not isinstance(given, dict):
        raise ValueError(f"targets: {name} holds no task: a task is a JSON object")
    return given
