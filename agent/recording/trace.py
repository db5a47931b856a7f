"""A trace: all that there is to see of an episode, in a small file that is played without a simulator.

Poses are whole numbers of steps on the lattice that the body moves on. Arrays of whole numbers are kept as
differences along their first axis, modulo their size, then deflated (RFC 1950) and written in base64: what
stays as it was costs next to nothing, so a map of every fifth step does too. Axes: N steps, N + 1 states
from the first to the last, R rays, A actions, K pictures of the planner's map.
"""

import base64
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec
import numpy as np
from msgspec import Meta

from logic import House
from logic.errors import VitruviusError
from logic.house.files import write_whole
from logic.opener import content_of, from_json

FORMAT = "vitruvius-trace-1"
"""Traces of another version are refused: what a column means may have changed."""

ENDING = ".trace.json"
"""How names of traces end."""

AROUND = 0.5
"""Metres around the house that pictures of a map show: planners take some of it for floor."""

MOST_BYTES, MOST_NUMBERS = 1 << 26, 1 << 26
"""Size of an uncompressed file in bytes, and number of values in one of its arrays."""

Count = Annotated[int, Meta(ge=0)]


class TraceError(VitruviusError):
    """A file is absent, no trace, or one of another version."""

    exit_code = 5


class Packed(msgspec.Struct, frozen=True):
    """An array of whole numbers."""

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
        """The array. Raises ``ValueError`` where the data are not of it."""
        kind, count = np.dtype(self.type), int(np.prod(self.shape, dtype=object))
        if count > MOST_NUMBERS:
            raise ValueError(f"an array of {count:,} numbers: {MOST_NUMBERS:,} are read at most")
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
    """The body and its rays: fields of ``sim.config.Config``, metres and degrees; two numbers are those at
    headings along an axis and on a diagonal.
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
    """What a planner knew and believed, as the house lies: rows from north to south, cells from west to east.

    ``ground`` (K, height, width): a member of ``GROUND``. ``belief`` (K, height, width): how much a target
    in a place counts when the planner chooses where to look, 0 to 100. A picture is what it knew when it
    chose at a state that is a multiple of ``every``.
    """

    every: Annotated[int, Meta(ge=1)]
    west: float
    north: float
    cell: float
    """Metres: the edges of the pictures, and a cell's side."""
    ground: Packed
    belief: Packed


GROUND = ("never seen", "seen before the last pick-up", "seen since", "occupied")
"""What a map shows of a cell."""

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
"""By name, the type of a column and what its rows are: see ``Trace``."""


class Trace(msgspec.Struct, frozen=True):
    """An episode.

    Columns of states (N + 1, ...): ``east`` and ``south``, steps from ``origin``; ``heading``, eighths of a
    turn counter-clockwise from east; ``distance`` (R), 65535ths of the range; ``hits`` (R / 8), a bit for
    each ray that ends on the target; ``found``, targets picked up, so which of ``targets`` is there.

    Columns of steps (N, ...): ``action``; ``blocked``, whether it came to nothing; ``allowed``, a bit for
    each action that the avoidance layer left; ``wanted``, what was preferred before it. Where the agent has
    them: ``values`` (A), its Q-values in units of ``value_unit``; ``advice``, the planner's action; ``goal``
    (2), where it went, hundredths of a metre east and south of the house's origin; and ``goal_kind``: 0
    none, 1 a viewpoint, 2 where it believes the target to be.
    """

    format: Literal["vitruvius-trace-1"]
    agent: str
    house: dict[str, Any]
    """Its JSON form."""
    mode: str
    """Where targets lay."""
    seed: int
    actions: tuple[str, ...]
    """Names of the A actions."""
    sensor: Sensor
    origin: tuple[float, float]
    """Metres: the eye's first place."""
    targets: tuple[tuple[float, float], ...]
    """Metres: the centres of the targets, in the order in which they appeared."""
    length: Count
    """N."""
    longest: Count
    """Steps of an episode that is not ended early."""
    columns: dict[str, Packed]
    value_unit: float = 0.0
    map: Map | None = None

    def column(self, name: str) -> np.ndarray:
        """A column of ``COLUMNS``. Raises ``KeyError`` where the episode has none."""
        return self.columns[name].array()


def packed(columns: Mapping[str, np.ndarray]) -> dict[str, Packed]:
    """Columns as a trace keeps them."""
    return {name: Packed.of(array.astype(COLUMNS[name][0])) for name, array in columns.items()}


def save(trace: Trace, path: str | Path) -> None:
    """Write a trace: the same episode gives the same bytes."""
    write_whole(path, msgspec.json.encode(trace) + b"\n")


def load(path: Path) -> Trace:
    """Read a trace. Raises ``TraceError`` where it is absent, of another version or none."""
    try:
        content = content_of(path, MOST_BYTES)
    except OSError as error:
        raise TraceError(f"{path}: cannot be read: {error.strerror or error}") from None
    try:
        _require_version(content, path)
        trace = from_json(content, Trace)
        _require_whole(trace)
    except (ValueError, RecursionError) as error:
        raise TraceError(f"{path}: no trace: {error}. Write one by vitruvius record --out") from None
    return trace


def _require_version(content: bytes, path: Path) -> None:
    """Raise ``TraceError`` for a trace of another version."""
    found = from_json(content)
    version = found.get("format") if isinstance(found, dict) else None
    if version != FORMAT and str(version).startswith("vitruvius-trace-"):
        raise TraceError(f"{path}: a trace of version {version}: this is {FORMAT}. Record the episode again")


def _require_whole(trace: Trace) -> None:
    """Raise ``ValueError`` where a column is absent, or not of the episode."""
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
        raise ValueError("it has fewer targets than were picked up")
    if trace.map:
        for name in ("ground", "belief"):
            picture: Packed = getattr(trace.map, name)
            if picture.type != "uint8" or len(picture.shape) != 3 or picture.shape != trace.map.ground.shape:
                raise ValueError(f"{name} must be uint8 of three axes, as large as ground")
            picture.array()
