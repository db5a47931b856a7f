"""Reader of files that ``recognise`` knows, as one of ``kinds``. It runs no code from them."""

from collections import Counter
from collections.abc import Iterable, Sequence
from contextlib import suppress
from math import prod
from os import SEEK_END
from pathlib import Path
from typing import Any

import msgspec

from agent.algorithms.table import PRESETS
from agent.banks import BANKS, bank_hash
from agent.learning.config import TrainConfig, differences
from agent.play.results import load as load_games
from agent.runs.released import FORMAT, LEARNT_IN, MOST_BYTES, MOST_HEADER, require_sizes
from logic import House, HouseSet, RequestError
from logic.dataset.sets import files_of_shards, read_manifest, read_set
from logic.errors import VitruviusError
from logic.grammar import find, shipped
from logic.opener import content_of, from_json, opened
from logic.readers.combined import divided
from logic.readers.regular import regular
from logic.readers.sketch import Sketch
from logic.request.geojson import from_geojson
from logic.request.given_plan import SNAP
from logic.spelling import quoted
from vitruvius.info.kinds import (
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

MOST_TEXT, MAX_METRICS_BYTES = 1 << 20, 1 << 28
"""Bytes to read of ``config.json`` and of the end of a run's reports; largest size of the file of reports."""


class UnknownFileError(VitruviusError):
    """Error for a file or folder that is absent, or of an unknown kind."""

    exit_code = 5


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


def read_set_of_houses(name: str, folder: Path) -> SetOfHouses:
    """Return the description of a set, from its own description and its manifest, without its rows."""
    of = read_set(folder)
    assert of is not None, "it is known by its description"
    manifest = read_manifest(folder)
    there = [path.stat().st_size for path in files_of_shards(folder)]
    return SetOfHouses(
        name=name,
        splits=of.houses,
        whole=manifest is not None,
        shards=of.shards,
        there=len(there),
        limits=manifest.limits if manifest else None,
        bytes=sum(there),
        grammars={f"{of.grammar} ({of.grammar_hash[:12]})": sum(of.houses.values())},
        request={key: value for key, value in of.request.items() if value},
        seed=of.seed,
        checksum=HouseSet(folder).hash if manifest else None,
        versions=of.versions,
    )


def read_plan(name: str, found: Sketch | dict[str, Any]) -> Plan:
    """Return the description of a plan. Raises ``UnknownFileError`` for a file that is no plan."""
    format_ = found.format if isinstance(found, Sketch) else "GeoJSON"
    try:
        rooms = (
            regular(divided(found)[0], None, SNAP).rooms
            if isinstance(found, Sketch)
            else from_geojson(found, snap=SNAP).drawn.rooms
        )
    except RequestError as error:
        raise UnknownFileError(f"{name}: {format_}, but no plan: {error}") from None
    size = max(room.box[2] for room in rooms), max(room.box[3] for room in rooms)
    types = _counted(room.type or "any" for room in rooms)
    return Plan(name=name, format=format_, rooms=len(rooms), types=types, size=size)


def read_agent(name: str, path: Path) -> Agent:
    """Return the description of a checkpoint, from its header alone."""
    try:
        require_sizes(path)
        with opened(path, MOST_BYTES, unpack=False) as file:
            length = int.from_bytes(file.read(8), "little")
            header = from_json(file.read(min(length, MOST_HEADER)))
        record, tensors = header.pop("__metadata__"), header
        tensors.pop(LEARNT_IN, None)
        shapes = [each["shape"] for each in tensors.values()]
        config = from_json(record.get("config", "{}").encode())
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
    except (OSError, KeyError, TypeError, ValueError, AttributeError):
        raise UnknownFileError(f"{name}: no checkpoint of ours. Make one with: vitruvius train") from None


def read_run(name: str, path: Path) -> Run:
    """Return the description of a training run. Raises ``UnknownFileError`` for another ``config.json``."""
    try:
        record = from_json(content_of(path / "config.json", MOST_TEXT), Any)
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
    except (OSError, KeyError, TypeError, ValueError, AttributeError):
        raise UnknownFileError(
            f"{name}: its config.json is none of a run. Train one: vitruvius train --out {quoted(name)}"
        ) from None


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


def read_games(name: str, path: Path) -> Games:
    """Return the description of results of ``play``. Raises ``ResultsError`` if they are damaged."""
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


def read_scores(name: str, record: dict[str, Any]) -> Scores:
    """Return the description of scores. Raises ``UnknownFileError`` for those of another version."""
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


def read_trace(name: str, record: dict[str, Any]) -> Trace:
    """Return the description of a trace, by its header. Raises ``UnknownFileError`` for another version."""
    try:
        words = {key: record[key] for key in ("format", "agent", "mode", "seed", "length")}
        return msgspec.convert(
            {"kind": "trace", "name": name, **words, "targets": len(record["targets"])}, Trace
        )
    except (KeyError, TypeError, msgspec.ValidationError):
        raise UnknownFileError(f"{name}: a trace of another version. Record the episode again") from None


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
