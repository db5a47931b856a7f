"""What a path or a name is: told by how a file begins, and read as one of ``things``. Nothing of it runs."""

import gzip
import json
import zlib
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from math import prod
from os import SEEK_END
from pathlib import Path
from typing import Any

import msgspec

from agent.banks import BANKS, bank_hash, benchmark_path
from agent.config import PRESETS, TrainConfig, differences
from agent.info.things import (
    Agent,
    Games,
    Grammar,
    Houses,
    Keras,
    Plan,
    Run,
    Scores,
    Settings,
    Thing,
    Trace,
)
from agent.play.results import load as load_games
from agent.released import FORMAT, MOST_HEADER, located, released, require_sizes
from agent.settings import read as read_settings
from logic import House, HouseFileError, RequestError, load
from logic.errors import VitruviusError
from logic.files import HOUSE_FILES
from logic.geojson import GEOJSON, from_geojson
from logic.grammar import find, shipped
from logic.spelling import closest, unknown

MOST_BYTES = 1 << 28
"""What is read of a JSON file that holds no houses, unpacked."""

MOST_TEXT = 1 << 20
"""What is read of a run's ``config.json``, and of the end of its reports."""

HDF5, GZIP = b"\x89HDF\r\n\x1a\n", b"\x1f\x8b"
"""How these files begin."""

PAPER_HOUSE = "paper-house"
"""``sim.arguments.PAPER_HOUSE``, without Taichi."""


class UnknownFileError(VitruviusError):
    """A file or folder is absent, or is nothing that we know."""

    exit_code = 5


def things(name: str) -> list[Thing]:
    """All that a path or a name is: ``paper`` is a grammar, an agent and a preset.

    Raises ``UnknownFileError`` for what is nothing we know, and each kind's own error for what is damaged.
    """
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


def _named(name: str) -> Iterator[Thing]:
    """What comes with Vitruvius by this name."""
    if name in BANKS:
        yield _houses(name, load(benchmark_path(name)))
    if name == PAPER_HOUSE:
        file = Path(__file__).parents[1] / "sim" / "paper" / "house.json"
        yield _houses(name, load(file, whole_pixels=True))
    if name in shipped():
        yield _grammar(name, name)
    if name in released():
        yield _agent(name, located(name))
    if name in PRESETS:
        yield _settings(name, name, PRESETS[name])


def _folder(name: str, path: Path) -> Thing:
    """A run or a grammar."""
    if (path / "config.json").is_file():
        return _run(name, path)
    if any(path.glob("*.lp")) or any(path.glob("*.pl")):
        return _grammar(name, path)
    there = sorted(each.name for each in path.iterdir())
    known = [each for each in there if each.endswith((*HOUSE_FILES, ".safetensors", "training"))]
    hint = f"look at {path / known[0]}" if known else "it has " + (", ".join(there[:5]) or "nothing")
    raise UnknownFileError(
        f"{name}: a folder that is no run (no config.json) and no grammar (no .lp): {hint}"
    )


def _file(name: str, path: Path) -> Thing:
    """By how it begins; by its name where that says more."""
    try:
        if not path.is_file():
            raise UnknownFileError(f"{name}: is a device or a pipe, and no file")
        with path.open("rb") as file:
            start = file.read(16)
    except OSError as error:
        raise UnknownFileError(f"{name}: cannot be read: {error.strerror}") from None
    if start.startswith(HDF5):
        return _keras(name, path)
    if path.suffix == ".safetensors" or start[8:9] == b"{":
        return _agent(name, path)
    if path.suffix == ".toml":
        preset, config, _ = read_settings(path)
        return _settings(name, preset, config)
    if path.suffix in (".lp", ".pl"):
        raise UnknownFileError(f"{name}: a rule file: look at its grammar, vitruvius info {path.parent}")
    if start.startswith(GZIP) or start.lstrip()[:1] == b"{":
        return _json(name, path)
    raise _unknown(name)


def _json(name: str, path: Path) -> Thing:
    """A house file, or another of ours that is JSON, by the first line or by the whole."""
    content = _unpacked(path)
    first, _, _ = content.partition(b"\n")
    record: Any = None
    for text in (first, content):
        try:
            record = msgspec.json.decode(text)
            break
        except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
            continue
    if record is None and path.name.endswith(HOUSE_FILES):
        load(path)  # says where it is damaged
    if not isinstance(record, dict):
        raise _unknown(name)
    format_ = str(record.get("format"))
    if format_.startswith("vitruvius-game-"):
        return _games(name, path)
    if format_.startswith("vitruvius-trace-"):
        return _trace(name, record)
    if record.get("type") == GEOJSON:
        return _plan(name, record)
    if {"bank", "targets"} <= record.keys():
        return _scores(name, record)
    if {"preset", "algorithm", "config"} <= record.keys():
        return _run(str(path.parent), path.parent)
    if format_ in ("vitruvius-1", "vitruvius-2") or "roomNumber" in record:
        return _houses(name, load(path), _stopped(content))
    raise _unknown(name)


def _unknown(name: str) -> UnknownFileError:
    return UnknownFileError(
        f"{name}: nothing that Vitruvius writes or reads: no house file, GeoJSON, checkpoint, run, grammar, "
        "games, scores, trace, settings or weights of Keras"
    )


def _unpacked(path: Path) -> bytes:
    try:
        with gzip.open(path) if path.suffix == ".gz" else path.open("rb") as file:
            content = file.read(MOST_BYTES + 1)
    except (OSError, EOFError, zlib.error) as error:
        raise HouseFileError(f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}") from None
    if len(content) > MOST_BYTES:
        raise UnknownFileError(f"{path}: more than {MOST_BYTES >> 20} MiB: split it")
    return content


def _stopped(content: bytes) -> str | None:
    """Why a series of houses ended early: see ``logic.files.save``."""
    last = content.rstrip().rpartition(b"\n")[2]
    return json.loads(last)["stopped"] if last.startswith(b'{"stopped":') else None


def _counted(words: Iterable[str]) -> dict[str, int]:
    """How many there are of each, most first."""
    return dict(Counter(words).most_common())


def _houses(name: str, houses: Sequence[House], stopped: str | None = None) -> Houses:
    checksum = bank_hash(houses)
    origins = [house.provenance for house in houses if house.provenance]
    numbers = [len(house.counted) for house in houses]
    rooms = [room for house in houses for room in house.counted]
    return Houses(
        name=name,
        houses=len(houses),
        formats=_counted(house.format for house in houses),
        topologies=_counted(house.topology or "not named" for house in houses),
        rooms=(min(numbers), max(numbers)),
        types=_counted(room.type for room in rooms),
        pieces=_counted(piece.type for room in rooms for piece in room.pieces),
        grammars=_counted(f"{each.grammar} ({each.grammar_hash[:12]})" for each in origins),
        seeds=tuple(sorted({each.seed for each in origins})),
        versions=origins[0].versions if origins else {},
        checksum=checksum,
        bank=next((bank for bank, known in BANKS.items() if known.hash == checksum), None),
        stopped=stopped,
    )


def _plan(name: str, record: dict[str, Any]) -> Plan:
    try:
        rooms = list(from_geojson(record))
    except RequestError as error:
        raise UnknownFileError(f"{name}: GeoJSON, but no plan: {error}") from None
    size = max(room.box[2] for room in rooms), max(room.box[3] for room in rooms)
    return Plan(name=name, rooms=len(rooms), types=_counted(room.type or "any" for room in rooms), size=size)


def _agent(name: str, path: Path) -> Agent:
    """A checkpoint by its header alone."""
    try:
        require_sizes(path)
        with path.open("rb") as file:
            length = int.from_bytes(file.read(8), "little")
            header = json.loads(file.read(min(length, MOST_HEADER)))
        record, tensors = header.pop("__metadata__"), header
        shapes = [each["shape"] for each in tensors.values()]
        config = json.loads(record.get("config", "{}"))
        return Agent(
            name=name,
            agent=record["name"],
            format=record["format"],
            readable=record["format"] == FORMAT,
            algorithm=record["algorithm"],
            steps=int(record["steps"]),
            parameters=sum(map(prod, shapes)),
            targets=str(config.get("targets", "")),
            houses_checksum=record["houses"],
            command=record["command"],
            config=config,
        )
    except (KeyError, TypeError, ValueError, AttributeError, RecursionError):
        raise UnknownFileError(f"{name}: no checkpoint of ours. Make one with: vitruvius train") from None


def _run(name: str, path: Path) -> Run:
    try:
        with (path / "config.json").open("rb") as file:
            record = msgspec.json.decode(file.read(MOST_TEXT))
        config, houses = record["config"], record["houses"]
        last = _last_report(path / "metrics.jsonl")
        return Run(
            name=name,
            preset=record["preset"],
            algorithm=record["algorithm"],
            steps=last.get("steps", 0),
            of_steps=config["steps"],
            finished=last.get("fraction", 0) >= 1,
            seconds=last.get("seconds", 0.0),
            targets=last.get("targets"),
            houses=houses["number"],
            houses_checksum=houses["hash"],
            command=record["command"],
            versions={key: record[key] for key in ("python", "torch")},
            files=sorted(each.name for each in path.iterdir() if not each.name.startswith(".")),
        )
    except (OSError, KeyError, TypeError, ValueError, AttributeError, msgspec.DecodeError, RecursionError):
        raise UnknownFileError(
            f"{name}: its config.json is none of a run. Train one: vitruvius train --out {name}"
        ) from None


def _last_report(path: Path) -> dict[str, Any]:
    """The last whole line of a run's reports; empty before the first."""
    if not path.is_file():
        return {}
    with path.open("rb") as file:
        file.seek(-min(path.stat().st_size, MOST_TEXT), SEEK_END)
        lines = file.read().splitlines()
    for line in reversed(lines):
        try:
            return msgspec.json.decode(line, type=dict)
        except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
            continue  # a kill may tear the last line
    return {}


def _games(name: str, path: Path) -> Games:
    games = load_games(path)
    taken = sorted(game.taken for game in games)
    return Games(
        name=name,
        games=len(games),
        players=_counted(game.player for game in games),
        targets=_counted(game.targets for game in games),
        views=_counted(game.view for game in games),
        score=sum(game.score for game in games) / len(games),
        raced=sorted({agent for game in games for agent in game.raced}),
        houses=len({game.house for game in games}),
        taken=(taken[0], taken[-1]),
        versions=games[-1].versions,
    )


def _scores(name: str, record: dict[str, Any]) -> Scores:
    try:
        bank = record["bank"]
        ratios = {
            mode: {
                policy: round(scores["figures"]["ratio"]["value"], 3)
                for policy, scores in found["policies"].items()
                if "ratio" in scores.get("figures", {})
            }
            for mode, found in record["targets"].items()
        }
        return Scores(
            name=name,
            bank=bank["file"],
            houses=bank["houses"],
            checksum=bank["hash"],
            seed=record["seed"],
            backend=record["backend"],
            ratios=ratios,
        )
    except (KeyError, TypeError, AttributeError):
        raise UnknownFileError(
            f"{name}: no scores of this version. Write some by vitruvius evaluate --out"
        ) from None


def _trace(name: str, record: dict[str, Any]) -> Trace:
    try:
        words = {key: record[key] for key in ("format", "agent", "mode", "seed", "length")}
        return msgspec.convert(
            {"kind": "trace", "name": name, **words, "targets": len(record["targets"])}, Trace
        )
    except (KeyError, TypeError, msgspec.ValidationError):
        raise UnknownFileError(f"{name}: a trace of another version. Record the episode again") from None


def _grammar(name: str, folder: str | Path) -> Grammar:
    found = find(folder)
    files = sorted({*found.own, *found.prolog})
    inside = [file for file in files if file.parent == found.directory]
    return Grammar(
        name=name,
        folder=str(found.directory),
        topology=found.topology_name,
        checksum=found.hash,
        lines={file.name: len(file.read_bytes().splitlines()) for file in inside},
        shipped=found.directory.name in shipped() and found.directory == find(found.name).directory,
    )


def _keras(name: str, path: Path) -> Keras:
    import h5py

    try:
        with h5py.File(path) as file:
            shapes, versions = _weights(file)
    except (OSError, KeyError, TypeError, ValueError, RuntimeError) as error:
        reason = str(error).splitlines()[0]
        raise UnknownFileError(f"{name}: HDF5, but no weights of Keras: {reason}") from None
    layers = {
        layer: ", ".join(" x ".join(map(str, shape)) for shape in arrays) for layer, arrays in shapes.items()
    }
    parameters = sum(prod(shape) for arrays in shapes.values() for shape in arrays)
    return Keras(name=name, layers=layers, parameters=parameters, versions=versions)


def _weights(file: Any) -> tuple[dict[str, list[tuple[int, ...]]], dict[str, str]]:
    """The shapes of each layer's arrays, of those that have any, and the versions that wrote them."""
    group = file.get("model_weights", file)
    layers = {
        layer: [tuple(group[layer][_text(key)].shape) for key in group[layer].attrs["weight_names"]]
        for layer in map(_text, group.attrs["layer_names"])
    }
    kept = {"keras_version": "keras", "backend": "backend"}
    versions = {word: _text(group.attrs[key]) for key, word in kept.items() if key in group.attrs}
    return {layer: shapes for layer, shapes in layers.items() if shapes}, versions


def _settings(name: str, preset: str, config: TrainConfig) -> Settings:
    changed = {key: str(getattr(config, key)) for key in differences(config, PRESETS[preset])}
    return Settings(
        name=name,
        preset=preset,
        algorithm=config.algorithm,
        steps=config.steps,
        targets=config.targets,
        changed=changed,
    )


def _text(value: Any) -> str:
    return value.decode() if isinstance(value, bytes) else str(value)
