"""Recognition of a path or a name, by a file's first bytes. ``reading`` then reads it; no code of it runs."""

import tempfile
from codecs import BOM_UTF8
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

from agent.algorithms.table import PRESETS
from agent.banks import BANKS, PAPER_HOUSE, benchmark_path
from agent.runs.released import located, released
from logic import HouseFileError, RequestError, load
from logic.dataset.sets import SET
from logic.grammar import shipped
from logic.house.files import HOUSE_FILES, stopped_by
from logic.house.files import MOST_BYTES as MOST_HOUSES
from logic.house.ros_map import DESCRIPTIONS, PICTURES
from logic.opener import PACKED, STANDARD, content_of, from_json, opened
from logic.readers import sketch
from logic.readers.features import SEPARATOR, from_text, is_geojson
from logic.readers.sketch import Sketch
from logic.spelling import closest, quoted, unknown
from vitruvius import settings
from vitruvius.info.kinds import Kind
from vitruvius.info.reading import (
    UnknownFileError,
    read_agent,
    read_games,
    read_grammar,
    read_houses,
    read_plan,
    read_run,
    read_scores,
    read_set_of_houses,
    read_settings,
    read_trace,
)

MOST_BYTES = 1 << 28
"""Largest size of an unpacked JSON file without houses that is read, in bytes."""


def recognised(name: str) -> list[Kind]:
    """Return all that a path or a name stands for: ``paper`` is a grammar, an agent and a preset.

    Raises ``UnknownFileError`` for an unknown kind, and each kind's own error for a damaged file.
    """
    if Path(name) == STANDARD:
        with tempfile.NamedTemporaryFile() as copy:
            copy.write(_content(name, STANDARD, unpack=False))
            copy.flush()
            return [_file(name, Path(copy.name))]
    path = Path(name)
    if path.is_dir():
        return [_folder(name, path)]
    if path.exists():
        return [_file(name, path)]
    found = list(_named(name))
    if not found:
        names = sorted({*BANKS, PAPER_HOUSE, *shipped(), *released(), *PRESETS})
        beside = [str(each) for each in sorted(path.parent.glob("*"))]
        if (close := closest(name, [*beside, *names])) in beside:
            raise UnknownFileError(f"{name}: there is no such file: did you mean {close}?")
        raise UnknownFileError(f"{name}: there is no such file, and {unknown('name', name, names)}")
    return found


def _named(name: str) -> Iterator[Kind]:
    """Yield the descriptions of what comes with Vitruvius by this name."""
    if name in BANKS:
        yield read_houses(name, load(benchmark_path(name)))
    if name == PAPER_HOUSE:
        file = Path(__file__).parents[2] / "sim" / "paper" / "house.json"
        yield read_houses(name, load(file, whole_pixels=True))
    if name in shipped():
        yield read_grammar(name, name)
    if name in released():
        yield read_agent(name, located(name))
    if name in PRESETS:
        yield read_settings(name, name, PRESETS[name])


def _folder(name: str, path: Path) -> Kind:
    """Return the description of a set, a run or a grammar."""
    if (path / SET).is_file():
        return read_set_of_houses(name, path)
    if (path / "config.json").is_file():
        return read_run(name, path)
    if any(path.glob("*.lp")) or any(path.glob("*.pl")):
        return read_grammar(name, path)
    there = sorted(each.name for each in path.iterdir())
    known = [each for each in there if each.endswith((*HOUSE_FILES, ".safetensors", "training"))]
    hint = f"look at {path / known[0]}" if known else "it has " + (", ".join(there[:5]) or "nothing")
    raise UnknownFileError(
        f"{name}: a folder that is no set ({SET}), no run (config.json) and no grammar (.lp): {hint}"
    )


def _file(name: str, path: Path) -> Kind:
    """Return the description of a file, by its first bytes, or by its name if that is more specific."""
    try:
        with opened(path, MOST_HOUSES, unpack=False) as file:
            start = file.read(16)
    except OSError as error:
        raise UnknownFileError(f"{name}: cannot be read: {error.strerror}") from None
    if not start:
        raise UnknownFileError(f"{name}: is empty")
    suffix = path.suffix.lower()
    if suffix == ".safetensors" or start[8:9] == b"{":
        return read_agent(name, path)
    if suffix == ".toml":
        preset, config, _ = settings.read(path)
        return read_settings(name, preset, config)
    if suffix in DESCRIPTIONS:
        return read_houses(name, load(path))
    if suffix in PICTURES:
        raise UnknownFileError(f"{name}: this is a picture: for a map, give its .yaml file")
    if suffix in (".lp", ".pl"):
        raise UnknownFileError(
            f"{name}: a rule file: look at its grammar, vitruvius info {quoted(path.parent)}"
        )
    if start.startswith(PACKED) or start.removeprefix(BOM_UTF8).lstrip()[:1] in (b"{", SEPARATOR):
        return _json(name, path)
    if plan := _sketch(name, _content(name, path), None):
        return read_plan(name, plan)
    raise _unknown(name)


def _sketch(name: str, content: bytes, record: Any) -> Sketch | None:
    """Return another program's plan, or None."""
    try:
        return sketch(content, record)
    except RequestError as error:
        raise UnknownFileError(f"{name}: {error}") from None


def _json(name: str, path: Path) -> Kind:
    """Return the description of a house file or of another JSON file of ours.

    The first line identifies the file, or else the whole file does.
    """
    content = _content(name, path).removeprefix(BOM_UTF8)
    first, _, _ = content.partition(b"\n")
    record: Any = None
    for text in (first, content):
        with suppress(ValueError):
            record = from_json(text, Any)
            break
    if record is None or is_geojson(record):
        try:
            record = from_text(content)  # GeoJSON with one feature per line
        except ValueError as error:
            if path.name.lower().endswith(HOUSE_FILES):
                load(path)  # raises an error with the place of the damage
            raise UnknownFileError(f"{name}: is damaged: {error}") from None
    if not isinstance(record, dict):
        raise _unknown(name)
    format_ = str(record.get("format"))
    if format_.startswith("vitruvius-game-"):
        return read_games(name, path)
    if format_.startswith("vitruvius-trace-"):
        return read_trace(name, record)
    if found := _plan(name, path, content, record):
        return found
    if {"bank", "targets"} <= record.keys():
        return read_scores(name, record)
    if {"preset", "algorithm", "config"} <= record.keys():
        return read_run(str(path.parent), path.parent)
    if format_ in ("vitruvius-1", "vitruvius-2") or "roomNumber" in record:
        return read_houses(name, load(path), stopped_by(content.rstrip().rpartition(b"\n")[2]))
    raise _unknown(name)


def _plan(name: str, path: Path, content: bytes, record: Any) -> Kind | None:
    """Return the description of a plan for ``generate``, or None for another file.

    A file that is no plan may hold houses that ``load`` reads.
    """
    try:
        plan = _sketch(name, content, record) or (is_geojson(record) and record)
        return read_plan(name, plan) if plan else None
    except UnknownFileError:
        with suppress(HouseFileError):
            return read_houses(name, load(path))
        raise


def _unknown(name: str) -> UnknownFileError:
    return UnknownFileError(
        f"{name}: Vitruvius does not know this kind of file: give a house file, plan, checkpoint, run, "
        "grammar, games, scores, trace or settings"
    )


def _content(name: str, path: Path, *, unpack: bool = True) -> bytes:
    try:
        return content_of(path, MOST_BYTES, unpack=unpack)
    except OSError as error:
        raise HouseFileError(f"{name}: cannot be read: {error.strerror}") from None
