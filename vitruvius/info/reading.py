"""Reader of files that ``recognise`` knows, as one of ``kinds``. It runs no code from them."""

from codecs import BOM_UTF8
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from functools import cached_property
from math import prod
from os import SEEK_END
from pathlib import Path
from typing import Any

import msgspec

from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.agent.banks import BANKS, bank_hash
from vitruvius.agent.learning.config import TrainConfig, differences
from vitruvius.agent.play.results import load as load_games
from vitruvius.agent.runs.released import FORMAT, LEARNT_IN, MAX_BYTES, MAX_HEADER_BYTES, require_sizes
from vitruvius.info.descriptions import (
    Agent,
    Games,
    Grammar,
    Houses,
    Plan,
    Run,
    Scores,
    SetOfHouses,
    Settings,
    Trace,
)
from vitruvius.logic import House, HouseFileError, HouseSet, RequestError, load
from vitruvius.logic.dataset.sets import files_of_shards, read_manifest, read_set
from vitruvius.logic.errors import VitruviusError
from vitruvius.logic.files.house_files import HOUSE_FILES
from vitruvius.logic.files.house_files import MOST_BYTES as MOST_HOUSES
from vitruvius.logic.grammar import find, shipped
from vitruvius.logic.opener import PACKED, content_of, from_json, opened
from vitruvius.logic.readers import sketch
from vitruvius.logic.readers.combined import divided
from vitruvius.logic.readers.features import SEPARATOR, from_text, is_geojson
from vitruvius.logic.readers.regular import regular
from vitruvius.logic.request.geojson import from_geojson
from vitruvius.logic.request.given_plan import SNAP

MOST_TEXT, MAX_METRICS_BYTES = 1 << 20, 1 << 28
"""Bytes to read of ``config.json`` and of the end of a run's reports; largest size of the file of reports."""

MOST_JSON = 1 << 28
"""Largest size of an unpacked JSON file without houses that is read, in bytes."""


class UnknownFileError(VitruviusError):
    """Error for a file or folder that is absent, or of an unknown kind."""

    exit_code = 5


def content(name: str, path: Path, *, unpack: bool = True) -> bytes:
    """Return the content of a file. Raises ``HouseFileError`` if it cannot be read."""
    try:
        return content_of(path, MOST_JSON, unpack=unpack)
    except OSError as error:
        raise HouseFileError(f"{name}: cannot be read: {error.strerror}") from None


class Source:
    """A file or folder with what readers ask for, which is read once."""

    def __init__(self, name: str, path: Path) -> None:
        self.name, self.path, self.suffix = name, path, path.suffix.lower()

    def has(self, *patterns: str) -> bool:
        """Return True for a folder with a file of one of these patterns."""
        return any(each.is_file() for pattern in patterns for each in self.path.glob(pattern))

    @cached_property
    def start(self) -> bytes:
        """First bytes, packed or not."""
        try:
            with opened(self.path, MOST_HOUSES, unpack=False) as file:
                return file.read(16)
        except OSError as error:
            raise UnknownFileError(f"{self.name}: cannot be read: {error.strerror}") from None

    @cached_property
    def content(self) -> bytes:
        """Unpacked content."""
        return content(self.name, self.path).removeprefix(BOM_UTF8)

    @cached_property
    def record(self) -> dict[str, Any]:
        """JSON object in the first line, or else in the whole file; empty for a file that is none."""
        begins = self.start.removeprefix(BOM_UTF8).lstrip()[:1]
        if not self.start.startswith(PACKED) and begins not in (b"{", SEPARATOR):
            return {}
        record: Any = None
        for text in (self.content.partition(b"\n")[0], self.content):
            with suppress(ValueError):
                record = from_json(text, Any)
                break
        if record is None or is_geojson(record):
            try:
                record = from_text(self.content)  # GeoJSON with one feature per line
            except ValueError as error:
                if self.path.name.lower().endswith(HOUSE_FILES):
                    load(self.path)  # raises an error with the place of the damage
                raise UnknownFileError(f"{self.name}: is damaged: {error}") from None
        return record if isinstance(record, dict) else {}

    @cached_property
    def format(self) -> str:
        """Format that the JSON object names."""
        return str(self.record.get("format"))


def _counted(words: Iterable[str]) -> dict[str, int]:
    """Return the number of each word, most frequent first."""
    return dict(Counter(words).most_common())


def read_houses(name: str, houses: Sequence[House], stopped: str | None = None) -> Houses:
    """Return the description of a file's or bank's houses; ``stopped``: why the series ended early."""
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


def read_set_of_houses(it: Source) -> SetOfHouses:
    """Return the description of a set, from its own description and its manifest, without its rows."""
    of = read_set(it.path)
    assert of is not None, "it is known by its description"
    manifest = read_manifest(it.path)
    there = [path.stat().st_size for path in files_of_shards(it.path)]
    return SetOfHouses(
        name=it.name,
        splits=of.houses,
        whole=manifest is not None,
        shards=of.shards,
        there=len(there),
        limits=manifest.limits if manifest else None,
        bytes=sum(there),
        grammars={f"{of.grammar} ({of.grammar_hash[:12]})": sum(of.houses.values())},
        request={key: value for key, value in of.request.items() if value},
        seed=of.seed,
        checksum=HouseSet(it.path).hash if manifest else None,
        versions=of.versions,
    )


def read_plan(it: Source) -> Plan | Houses | None:
    """Return the description of a plan for ``generate``, or None for another file.

    A file that is no plan may hold houses that ``load`` reads.
    """
    try:
        if found := sketch(it.content, it.record or None):
            return _drawn(it.name, found.format, lambda: regular(divided(found)[0], None, SNAP).rooms)
        if is_geojson(it.record):
            return _drawn(it.name, "GeoJSON", lambda: from_geojson(it.record, snap=SNAP).drawn.rooms)
        return None
    except RequestError as error:
        with suppress(HouseFileError):
            return read_houses(it.name, load(it.path))
        raise UnknownFileError(f"{it.name}: {error}") from None


def _drawn(name: str, format_: str, read: Callable[[], Sequence[Any]]) -> Plan:
    """Return the description of a plan. Raises ``RequestError`` for a file that is no plan."""
    try:
        rooms = read()
    except RequestError as error:
        raise RequestError(f"{format_}, but not a plan: {error}") from None
    size = max(room.box[2] for room in rooms), max(room.box[3] for room in rooms)
    types = _counted(room.type or "any" for room in rooms)
    return Plan(name=name, format=format_, rooms=len(rooms), types=types, size=size)


def read_agent(it: Source) -> Agent:
    """Return the description of a checkpoint, from its header alone."""
    require_sizes(it.path)
    with opened(it.path, MAX_BYTES, unpack=False) as file:
        length = int.from_bytes(file.read(8), "little")
        header = from_json(file.read(min(length, MAX_HEADER_BYTES)))
    record, tensors = header.pop("__metadata__"), header
    tensors.pop(LEARNT_IN, None)
    shapes = [each["shape"] for each in tensors.values()]
    config = from_json(record.get("config", "{}").encode())
    return Agent(
        name=it.name,
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


def read_run(it: Source) -> Run:
    """Return the description of a training run."""
    record = from_json(content_of(it.path / "config.json", MOST_TEXT), Any)
    config, houses = record["config"], record["houses"]
    last = _last_report(it.path / "metrics.jsonl")
    return Run(
        name=it.name,
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
        files=sorted(each.name for each in it.path.iterdir() if not each.name.startswith(".")),
    )


def _last_report(path: Path) -> dict[str, Any]:
    """Return the last whole line of a run's reports; empty before the first."""
    if not path.is_file():
        return {}
    with opened(path, MAX_METRICS_BYTES, unpack=False) as file:
        file.seek(-min(path.stat().st_size, MOST_TEXT), SEEK_END)
        lines = file.read(MOST_TEXT).splitlines()
    for line in reversed(lines):
        with suppress(ValueError):  # a kill may tear the last line
            return from_json(line, dict[str, Any])
    return {}


def read_games(it: Source) -> Games:
    """Return the description of results of ``play``. Raises ``ResultsError`` if they are damaged."""
    games = load_games(it.path)
    taken = sorted(game.taken for game in games)
    return Games(
        name=it.name,
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


def read_scores(it: Source) -> Scores:
    """Return the description of scores."""
    bank = it.record["bank"]
    ratios = {
        mode: {
            policy: round(scores["figures"]["ratio"]["value"], 3)
            for policy, scores in found["policies"].items()
            if "ratio" in scores.get("figures", {})
        }
        for mode, found in it.record["targets"].items()
    }
    return Scores(
        name=it.name,
        bank=bank["file"],
        houses=bank["houses"],
        checksum=bank["hash"],
        seed=it.record["seed"],
        backend=it.record["backend"],
        ratios=ratios,
    )


def read_trace(it: Source) -> Trace:
    """Return the description of a trace, by its header."""
    words = {key: it.record[key] for key in ("format", "agent", "mode", "seed", "length")}
    return msgspec.convert(
        {"kind": "trace", "name": it.name, **words, "targets": len(it.record["targets"])}, Trace
    )


def read_grammar(name: str, folder: str | Path) -> Grammar:
    """Return the description of a shipped grammar or a folder of rules."""
    found = find(folder)
    files = sorted({*found.own, *found.prolog}, key=lambda file: (file.parent != found.directory, file))
    return Grammar(
        name=name,
        folder=str(found.directory),
        topology=found.topology_name,
        checksum=found.hash,
        lines={found.name_of(file): len(file.read_bytes().splitlines()) for file in files},
        shipped=found.directory.name in shipped() and found.directory == find(found.name).directory,
    )


def read_settings(name: str, preset: str, config: TrainConfig) -> Settings:
    """Return the description of a config, with its differences from the preset."""
    changed = {key: str(getattr(config, key)) for key in differences(config, PRESETS[preset])}
    return Settings(
        name=name,
        preset=preset,
        algorithm=config.algorithm,
        steps=config.steps,
        targets=config.targets,
        changed=changed,
    )
