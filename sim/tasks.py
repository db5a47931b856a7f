"""What an episode asks of the body: where its targets lie, and whether one pick-up is all.

A new task is a class of a few lines, given to an environment as ``targets=``:

    @dataclass(frozen=True)
    class Largest:
        "Pick up targets in the largest room."
        ends_on_pick_up: ClassVar[bool] = False

        def spaces(self, house: House) -> list[Box]:
            return [max(house.rooms, key=lambda room: room.area).box]
"""

import importlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv, VectorWrapper

from logic import House
from logic.spelling import unknown

Box = tuple[float, float, float, float]
"""(west, north, east, south), metres."""


class Task(Protocol):
    """Targets appear one after the other in some spaces of a house; picking one up earns 1."""

    ends_on_pick_up: ClassVar[bool]
    """Whether the first pick-up terminates the episode."""

    def spaces(self, house: House) -> list[Box]:
        """The rectangles of which targets lie wholly in one: ``room.box``, ``house.main.box`` for the hub (of
        a star: the floor without the rooms, in all files), or any others.
        """
        ...


@dataclass(frozen=True)
class Collect:
    """Pick up targets, as many as can be: in the main room (the hub), in the other rooms, or in both."""

    main: bool = True
    secondary: bool = True
    ends_on_pick_up: ClassVar[bool] = False

    def spaces(self, house: House) -> list[Box]:
        """See ``Task``. Raises ``ValueError`` for the main room of a house without a hub."""
        if self.main and not self.secondary and not house.hub:
            types = sorted({room.type for room in house.rooms})
            raise ValueError(
                f'it names no hub, so it has no main room: ask for targets="all" or {{"rooms": {types}}}'
            )
        hub = [house.main.box] if self.main and house.hub else []
        return hub + [room.box for room in house.secondary] * self.secondary


@dataclass(frozen=True)
class Rooms:
    """Pick up targets, as many as can be, in rooms of these types."""

    rooms: Sequence[str]
    ends_on_pick_up: ClassVar[bool] = False

    def __post_init__(self) -> None:
        """Raise ``TypeError`` for what is no list of names."""
        if isinstance(self.rooms, str) or not all(isinstance(name, str) for name in self.rooms):
            raise TypeError(f"rooms: a list of room types, not {self.rooms!r}")

    def spaces(self, house: House) -> list[Box]:
        """See ``Task``."""
        return [room.box for room in house.rooms if room.type in self.rooms]


@dataclass(frozen=True)
class Reach:
    """Reach a room of a type: a target lies in one of those, and picking it up ends the episode."""

    room: str
    ends_on_pick_up: ClassVar[bool] = True

    def spaces(self, house: House) -> list[Box]:
        """See ``Task``."""
        return [room.box for room in house.rooms if room.type == self.room]


TARGETS = {
    "main": Collect(secondary=False),
    "secondary": Collect(main=False),
    "mixed": Collect(),
    "all": Collect(),
}
"""Tasks that have a name. ``mixed`` and ``all`` are the same: anywhere in a house."""

TASKS = {"collect": Collect, "reach": Reach, "rooms": Rooms}
"""Tasks that take arguments."""

Targets = str | dict[str, Any] | Task


def task(targets: Targets) -> Task:
    """The task that is meant: by a name of ``TARGETS``, as ``{"task": name or "module:Class", **arguments}``,
    such as ``{"task": "reach", "room": "kitchen"}``, or that as a JSON text, as ``"module:Class"`` alone, or
    itself. ``{"rooms": ["bedroom", "study"]}`` is short for the task ``rooms``.

    All but the last go through JSON, as an environment's ``spec`` does. Raises ``ValueError`` if there is
    no such task, or not with these arguments.
    """
    if isinstance(targets, str) and targets in TARGETS:
        return TARGETS[targets]
    if isinstance(targets, str) and targets.startswith("{"):
        try:
            targets = json.loads(targets)
        except ValueError as error:
            raise ValueError(f"targets: {targets} is no JSON: {error}") from None
    given = {"task": targets} if isinstance(targets, str) else targets
    if not isinstance(given, dict):
        if not (callable(getattr(given, "spaces", None)) and hasattr(given, "ends_on_pick_up")):
            raise ValueError(f"targets: {given!r} is no task, which has spaces(house) and ends_on_pick_up")
        return given
    arguments = dict(given)
    name = arguments.pop("task", "rooms" if list(arguments) == ["rooms"] else None)
    if name not in TASKS and (not isinstance(name, str) or ":" not in name):
        names = TASKS if given is targets else TARGETS
        raise ValueError(
            f"targets: {unknown('task', name, names)}, module:Class, and"
            f' {{"task": ...}} with {", ".join(TASKS)} or module:Class'
        )
    try:
        return (TASKS.get(name) or named(name))(**arguments)
    except (ImportError, AttributeError, TypeError) as error:
        raise ValueError(f"targets {targets!r} cannot be had: {error}") from None


def named(name: str) -> Any:
    """What ``module:attribute`` names; ``ImportError`` or ``AttributeError`` where there is no such thing."""
    module, _, attribute = name.partition(":")
    return getattr(importlib.import_module(module), attribute)


class Cover(VectorWrapper):
    """Cover the house: a reward of 1 for each square of floor that the eye is over for the first time in its
    episode, in place of the environment's. The one where it starts earns nothing.

    The info says how many there are: ``covered`` (E,) int64. All autoreset modes are right, as are banks
    that are swapped by ``set_houses``.
    """

    def __init__(self, env: VectorEnv, cell: float = 0.5) -> None:
        """Over a ``HouseVectorEnv``, or wrappers of one; ``cell`` is the side of a square, metres."""
        if not 0 < cell < float("inf"):
            raise ValueError(f"cell is {cell}: a square's side in metres")
        super().__init__(env)
        self.cell = cell
        self._over = np.zeros(self.num_envs, bool)

    def reset(
        self, *, seed: int | Sequence[int] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """See ``HouseVectorEnv.reset``."""
        observation, info = self.env.reset(seed=seed, options=options)  # pyright: ignore[reportArgumentType]
        mask = (options or {}).get("reset_mask")
        if mask is None or mask.all():
            self._survey()
            mask = np.ones(self.num_envs, bool)
        self._begin(mask, info)
        return observation, info | {"covered": self._covered.copy()}

    def step(self, actions: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """See ``HouseVectorEnv.step``."""
        observation, _, terminated, truncated, info = self.env.step(actions)
        ended, mode = terminated | truncated, self.env.metadata["autoreset_mode"]
        if mode is AutoresetMode.NEXT_STEP:
            self._begin(self._over, info)
        pose, house = info["pose"], info["house"]
        if "final_info" in info:
            pose = np.where(ended[:, None], info["final_info"]["pose"], pose)
            house = np.where(ended, info["final_info"]["house"], house)
        reward = self._visit(pose, house).astype(np.float32)
        self._over = ended
        if "final_info" in info:
            final = {"covered": self._covered.copy(), "_covered": ended.copy()}
            info["final_info"] = info["final_info"] | final
            self._begin(ended, info)
        return observation, reward, terminated, truncated, info | {"covered": self._covered.copy()}

    def _survey(self) -> None:
        """Divide the bank's houses into squares."""
        envs: Any = self.env.unwrapped
        bounds = np.array([shape.bounds for shape in envs.geometries])
        self._corner = bounds[:, :2]
        self._size = np.ceil((bounds[:, 2:] - bounds[:, :2]) / self.cell).astype(int)
        self._visited = np.zeros((self.num_envs, *self._size.max(axis=0)), bool)
        self._covered = np.zeros(self.num_envs, np.int64)

    def _begin(self, mask: np.ndarray, info: dict[str, Any]) -> None:
        """Forget what these environments (E,) bool covered, but for where they are."""
        self._visited[mask], self._covered[mask] = False, 0
        self._visit(info["pose"], info["house"], mask)
        self._over = self._over & ~mask

    def _visit(self, pose: np.ndarray, house: np.ndarray, mask: np.ndarray | None = None) -> np.ndarray:
        """Note where these environments are; whether they are there for the first time (E,) bool."""
        square = ((pose[:, :2] - self._corner[house]) / self.cell).astype(int)
        at = (np.arange(self.num_envs), *np.clip(square, 0, self._size[house] - 1).T)
        new = ~self._visited[at] if mask is None else ~self._visited[at] & mask
        self._visited[at] |= new
        self._covered += new
        return new
