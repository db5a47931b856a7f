"""Trace: the visible course of an episode, in a small file that is played without a simulator.

Poses are whole numbers of steps on the lattice that the body moves on. Integer arrays are stored as
differences along their first axis, modulo their size, then deflated (RFC 1950) and written in base64.
Unchanged values take almost no space, so a map of every fifth step takes little, too.

Axes: N steps, N + 1 states from the first to the last, R rays, A actions, K pictures of the planner's map.
"""

import base64
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec
import numpy as np
from msgspec import Meta

from vitruvius.logic import House
from vitruvius.logic.errors import VitruviusError
from vitruvius.logic.files.writing import write_whole
from vitruvius.logic.opener import content_of, from_json

FORMAT = "vitruvius-trace-1"
"""Format of traces. Other versions are refused: what a column means may have changed."""

ENDING = ".trace.json"
"""Suffix of traces."""

MARGIN_M = 0.5
"""Margin around the house in pictures of a map, in metres: planners take some of the margin for floor."""

MAX_BYTES, MAX_NUMBERS = 1 << 26, 1 << 26
"""Largest size of an uncompressed file in bytes, and largest number of values in one of its arrays."""

Count = Annotated[int, Meta(ge=0)]


class TraceError(VitruviusError):
    """Error for a file that is absent, no trace, or a trace of another version."""

    exit_code = 5


class Packed(msgspec.Struct, frozen=True):
    """Packed array of integers."""

    type: Literal["uint8", "uint16", "int16"]
    shape: tuple[Count, ...]
    data: str

    @classmethod
    def of(cls, array: np.ndarray) -> "Packed":
        """Pack an array (n, ...) of one of these types."""
        changes = np.diff(array, axis=0, prepend=np.zeros_like(array[:1]))
        little = np.ascontiguousarray(changes, array.dtype.newbyteorder("<"))
        data = base64.b64encode(zlib.compress(little.tobytes(), 9)).decode()
        return cls(array.dtype.name, array.shape, data)  # pyright: ignore[reportArgumentType]

    def array(self) -> np.ndarray:
        """Return the array. Raises ``ValueError`` if the data do not match its type and shape."""
        kind, count = np.dtype(self.type), int(np.prod(self.shape, dtype=object))
        if count > MAX_NUMBERS:
            raise ValueError(f"an array of {count:,} numbers: at most {MAX_NUMBERS:,} are read")
        most = count * kind.itemsize
        packed = zlib.decompressobj()
        try:
            content = packed.decompress(base64.b64decode(self.data, validate=True), most + 1)
        except zlib.error as error:
            raise ValueError(f"cannot be unpacked: {error}") from None
        if len(content) != most:
            raise ValueError(f"its data are not of shape {self.shape}")
        changes = np.frombuffer(content, kind.newbyteorder("<")).reshape(self.shape)
        return np.cumsum(changes, axis=0, dtype=kind)


class Sensor(msgspec.Struct, frozen=True):
    """Body and rays: fields of ``sim.config.Config``, metres and degrees.

    Pairs are the values at headings along an axis and on a diagonal.
    """

    body: tuple[float, float]
    eye: tuple[float, float]
    step: float
    rays: Count
    first_ray: float
    ray_spacing: float
    range: float
    target: float


class Map(msgspec.Struct, frozen=True):
    """Knowledge and beliefs of a planner, in the house's orientation.

    Rows go from north to south, cells from west to east. ``ground`` (K, height, width) has indices in
    ``GROUND``. ``belief`` (K, height, width) is how much a target in a place counts when the planner chooses
    where to look, 0 to 100. A picture shows the planner's knowledge at a choice, in a state that is a
    multiple of ``every``.
    """

    every: Annotated[int, Meta(ge=1)]
    west: float
    north: float
    cell: float
    """Side of a cell, in metres, as are ``west`` and ``north``, the edges of the pictures."""
    ground: Packed
    belief: Packed


GROUND = ("never seen", "seen before the last pick-up", "seen since", "occupied")
"""Kinds of a cell in a map."""

COLUMNS: dict[str, tuple[str, str]] = {
    "east": ("int16", "state"),
    "south": ("int16", "state"),
    "heading": ("uint8", "state"),
    "distance": ("uint16", "state"),
    "hits": ("uint8", "state"),
    "found": ("uint16", "state"),
    "action": ("uint8", "step"),
    "blocked": ("uint8", "step"),
    "allowed": ("uint8", "step"),
    "wanted": ("uint8", "step"),
    "values": ("int16", "step"),
    "advice": ("uint8", "step"),
    "goal": ("int16", "step"),
    "goal_kind": ("uint8", "step"),
}
"""Type of each column, and kind of its rows, by name: see ``Trace``."""


class Trace(msgspec.Struct, frozen=True):
    """Trace of an episode.

    Columns of states (N + 1, ...):

    - ``east`` and ``south``: steps from ``origin``;
    - ``heading``: eighths of a turn counter-clockwise from east;
    - ``distance`` (R): 65535ths of the range;
    - ``hits`` (R / 8): a bit for each ray that ends on the target;
    - ``found``: number of targets picked up, and so the index of the present one in ``targets``.

    Columns of steps (N, ...):

    - ``action``, and ``blocked``: 1 if the action was blocked;
    - ``allowed``: a bit for each action that the avoidance layer allowed;
    - ``wanted``: the preferred action before avoidance.

    Optional columns of steps:

    - ``values`` (A): Q-values in units of ``value_unit``;
    - ``advice``: the planner's action;
    - ``goal`` (2): the goal in hundredths of a metre east and south of the house's origin;
    - ``goal_kind``: 0 none, 1 a viewpoint, 2 the believed place of the target.
    """

    format: Literal["vitruvius-trace-1"]
    agent: str
    house: dict[str, Any]
    """House in its JSON form."""
    mode: str
    """Mode of the targets."""
    seed: int
    actions: tuple[str, ...]
    """Names of the A actions."""
    sensor: Sensor
    origin: tuple[float, float]
    """First place of the eye, metres."""
    targets: tuple[tuple[float, float], ...]
    """Centres of the targets, metres, in the order in which they appeared."""
    length: Count
    """Number of steps, N."""
    longest: Count
    """Number of steps of an episode that does not end early."""
    columns: dict[str, Packed]
    value_unit: float = 0.0
    map: Map | None = None

    def column(self, name: str) -> np.ndarray:
        """Return a column of ``COLUMNS``. Raises ``KeyError`` if the episode lacks it."""
        return self.columns[name].array()


def packed(columns: Mapping[str, np.ndarray]) -> dict[str, Packed]:
    """Return columns as a trace stores them."""
    return {name: Packed.of(array.astype(COLUMNS[name][0])) for name, array in columns.items()}


def save(trace: Trace, path: str | Path) -> None:
    """Write a trace; the same episode gives the same bytes."""
    write_whole(path, msgspec.json.encode(trace) + b"\n")


def load(path: Path) -> Trace:
    """Read a trace. Raises ``TraceError`` if it is absent, of another version or no trace."""
    try:
        content = content_of(path, MAX_BYTES)
    except OSError as error:
        raise TraceError(f"{path}: cannot be read: {error.strerror or error}") from None
    try:
        _require_version(content, path)
        trace = from_json(content, Trace)
        _require_whole(trace)
    except (ValueError, RecursionError) as error:
        raise TraceError(f"{path}: not a trace: {error}. Write one: vitruvius record --out") from None
    return trace


def _require_version(content: bytes, path: Path) -> None:
    """Raise ``TraceError`` for a trace of another version."""
    found = from_json(content)
    version = found.get("format") if isinstance(found, dict) else None
    if version != FORMAT and str(version).startswith("vitruvius-trace-"):
        raise TraceError(f"{path}: a trace of version {version}, not {FORMAT}. Record the episode again")


def _require_whole(trace: Trace) -> None:
    """Raise ``ValueError`` if a column is absent, or does not match the episode."""
    House.from_dict(trace.house)
    shapes = {
        "distance": (trace.sensor.rays,),
        "hits": (-(-trace.sensor.rays // 8),),
        "values": (len(trace.actions),),
        "goal": (2,),
    }
    optional = {"values", "advice", "goal", "goal_kind"}
    if missing := COLUMNS.keys() - trace.columns.keys() - optional:
        raise ValueError(f"column {min(missing)} is missing")
    for name, column in trace.columns.items():
        if name not in COLUMNS:
            raise ValueError(f"there is no column {name}")
        kind, rows = COLUMNS[name]
        shape = (trace.length + (rows == "state"), *shapes.get(name, ()))
        if (column.type, column.shape) != (kind, shape):
            raise ValueError(f"column {name} must be {kind} of shape {shape}")
        column.array()
    if int(trace.column("found").max(initial=0)) >= len(trace.targets):
        raise ValueError("it lists fewer targets than were picked up")
    if trace.map:
        for name in ("ground", "belief"):
            picture: Packed = getattr(trace.map, name)
            if picture.type != "uint8" or len(picture.shape) != 3 or picture.shape != trace.map.ground.shape:
                raise ValueError(f"{name} must be uint8 with three axes, of the same size as ground")
            picture.array()
