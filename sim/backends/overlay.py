"""Interface of an overlay: things that lie over the houses of a backend and change during an episode.

A backend's houses never change. Over them lie doors that bodies push open (``sim.backends.doors``), and
whatever else moves. Bodies meet and push the things of an overlay, rays end on them, pictures show them, and
states save them. Episodes, sensors and states use all overlays alike, without code for any one of them. An
overlay works with every backend whose bodies and rays it understands.

An environment's step uses an overlay in this order:

    cut      the body has moved: the overlay shortens its way at the first thing that it meets
    advance  the things move, pushed by the body or by themselves
    hide     rays that reach a thing end there

To add an overlay, write a class with these methods, and add it to ``OVERLAYS`` in ``sim.world.overlays``. Its
method ``asked`` returns True if a field of ``Config`` asks for the overlay.
"""

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Protocol

import numpy as np

from vitruvius.sim.arrays import ArrayRow
from vitruvius.sim.config import Config
from vitruvius.sim.geometry import Geometry
from vitruvius.sim.runtime import Array


class Overlay(Protocol):
    """Things over the houses of a backend.

    ``begin``, ``cut``, ``advance`` and ``hide`` are ``ti.func``s. Their argument ``world`` is a record of
    arrays that includes those of ``ROWS``; ``e`` is the number of the environment.
    """

    ROWS: ClassVar[tuple[ArrayRow, ...]]
    """Arrays of the overlay: see ``sim.world.arrays``. Those that are ``saved`` belong to the state."""

    KIND: ClassVar[int]
    """Code of its things in rays and in ``Now.bumped``: see ``sim.backends.backend``."""

    COLUMN: ClassVar[str]
    """Name of the overlay's column, if ``Config.columns`` has it: 1 for a ray that ends on a thing."""

    def __init__(self, config: Config, body: Any, lanes: int) -> None:
        """Take a configuration, a backend's body, and the number of rays that are cast together."""
        ...

    @staticmethod
    def asked(config: Config) -> bool:
        """Return True if a configuration asks for the overlay."""
        ...

    @staticmethod
    def check(knows_distance: bool) -> None:
        """Raise ``ValueError`` if the overlay does not support the distance to the target."""
        ...

    @staticmethod
    def arrays(shapes: Sequence[Geometry], num_envs: int) -> dict[str, Array]:
        """Return the arrays of ``ROWS`` for houses of these shapes."""
        ...

    def begin(self, world: Any, e: Any, state: Any) -> None:
        """Put the things in their places at the start of an episode."""
        ...

    def cut(self, world: Any, e: Any, state: Any, action: Any, moved: Any, blocked: Any) -> Any:
        """Return the state after the move, ``blocked``, and the thing that the body meets, -1 for none (i32).

        ``state`` is from before the move. ``moved`` and ``blocked`` are the results of the move in the house
        alone: the state, and whether something stopped the body.
        """
        ...

    def advance(self, world: Any, e: Any, state: Any, met: Any) -> None:
        """Move the things by one step; ``met`` is the thing that the body pushes, -1 for none."""
        ...

    def hide(self, world: Any, e: Any, state: Any, ray: Any, distance: Any, kind: Any) -> None:
        """Shorten each ray that ends on a thing, among the rays from number ``ray`` on."""
        ...

    @staticmethod
    def drawn(config: Config, arrays: Mapping[str, np.ndarray], shape: Geometry, e: int) -> np.ndarray:
        """Return boxes (n, 4) of the things to draw in environment ``e``, whose house has this shape.

        ``arrays``: copies of the arrays of ``ROWS``. A box is west, north, east, south, in metres.
        """
        ...
