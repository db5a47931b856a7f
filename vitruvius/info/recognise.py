"""Recognition of a path or a name by tables of readers, which are tried in turn. No code of a file runs."""

import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from vitruvius import settings
from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.agent.banks import BANKS, PAPER_HOUSE, benchmark_path
from vitruvius.agent.runs.released import located, released
from vitruvius.info.descriptions import Kind
from vitruvius.info.reading import (
    Source,
    UnknownFileError,
    content,
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
from vitruvius.logic import load
from vitruvius.logic.dataset.sets import SET
from vitruvius.logic.files.house_files import DESCRIPTIONS, HOUSE_FILES, PICTURES, stopped_by
from vitruvius.logic.grammar import shipped
from vitruvius.logic.opener import STANDARD
from vitruvius.logic.spelling import closest, quoted, unknown


def recognised(name: str) -> list[Kind]:
    """Return all that a path or a name stands for: ``paper`` is a grammar, an agent and a preset.

    Raises ``UnknownFileError`` for an unknown kind, and each kind's own error for a damaged file.
    """
    if Path(name) == STANDARD:
        with tempfile.NamedTemporaryFile() as copy:
            copy.write(content(name, STANDARD, unpack=False))
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
        raise UnknownFileError(
            f"{name}: there is no such file, and {unknown('grammar, agent or set of houses', name, names)}"
        )
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
        yield read_agent(Source(name, located(name)))
    if name in PRESETS:
        yield read_settings(name, name, PRESETS[name])


Reader = tuple[Callable[[Source], bool], Callable[[Source], Kind | None], str]
"""Test of a file or folder, its description, and the message for one that is damaged or of another version. A
description is None for another kind after all.
"""

DAMAGED = (OSError, KeyError, TypeError, ValueError, AttributeError)
"""Errors of a description that lacks what it needs."""

RUNS: tuple[Reader, ...] = (
    (
        lambda it: it.has("config.json"),
        read_run,
        "its config.json is not that of a run. Train one: vitruvius train --out {name}",
    ),
)

FOLDERS: tuple[Reader, ...] = (
    (lambda it: it.has(SET), read_set_of_houses, ""),
    *RUNS,
    (lambda it: it.has("*.lp", "*.pl"), lambda it: read_grammar(it.name, it.path), ""),
)
"""Readers of folders, which are tried in turn."""

FILES: tuple[Reader, ...] = (
    (
        lambda it: it.suffix == ".safetensors" or it.start[8:9] == b"{",
        read_agent,
        "not a checkpoint of Vitruvius. Make one with: vitruvius train",
    ),
    (lambda it: it.suffix == ".toml", lambda it: read_settings(it.name, *settings.read(it.path)[:2]), ""),
    (lambda it: it.suffix in DESCRIPTIONS, lambda it: read_houses(it.name, load(it.path)), ""),
    (lambda it: it.format.startswith("vitruvius-game-"), read_games, ""),
    (
        lambda it: it.format.startswith("vitruvius-trace-"),
        read_trace,
        "a trace of another version. Record the episode again",
    ),
    (lambda _: True, read_plan, ""),
    (
        lambda it: {"bank", "targets"} <= it.record.keys(),
        read_scores,
        "not scores of this version. Write some: vitruvius evaluate --out",
    ),
    (
        lambda it: {"preset", "algorithm", "config"} <= it.record.keys(),
        lambda it: _described(RUNS, Source(str(it.path.parent), it.path.parent)),
        "",
    ),
    (
        lambda it: it.format in ("vitruvius-1", "vitruvius-2") or "roomNumber" in it.record,
        lambda it: read_houses(it.name, load(it.path), stopped_by(it.content.rstrip().rpartition(b"\n")[2])),
        "",
    ),
)
"""Readers of files, which are tried in turn."""

UNREAD = {
    **dict.fromkeys(PICTURES, "this is a picture: for a map, give its .yaml file"),
    **dict.fromkeys((".lp", ".pl"), "a rule file: look at its grammar, vitruvius info {parent}"),
}
"""Messages for files that are never read, by suffix."""


def _described(readers: Sequence[Reader], source: Source) -> Kind | None:
    """Return the description by the first reader that has one; None if none has."""
    for recognises, read, damaged in readers:
        if not recognises(source):
            continue
        try:
            if found := read(source):
                return found
        except DAMAGED:
            if not damaged:
                raise
            words = damaged.format(name=quoted(source.name))
            raise UnknownFileError(f"{source.name}: {words}") from None
    return None


def _folder(name: str, path: Path) -> Kind:
    """Return the description of a set, a run or a grammar."""
    if found := _described(FOLDERS, Source(name, path)):
        return found
    there = sorted(each.name for each in path.iterdir())
    known = [each for each in there if each.endswith((*HOUSE_FILES, ".safetensors", "training"))]
    hint = f"look at {path / known[0]}" if known else "it has " + (", ".join(there[:5]) or "nothing")
    raise UnknownFileError(
        f"{name}: this folder is not a set ({SET}), a run (config.json) or a grammar (.lp): {hint}"
    )


def _file(name: str, path: Path) -> Kind:
    """Return the description of a file."""
    source = Source(name, path)
    if not source.start:
        raise UnknownFileError(f"{name}: is empty")
    if words := UNREAD.get(source.suffix):
        raise UnknownFileError(f"{name}: {words.format(parent=quoted(path.parent))}")
    if found := _described(FILES, source):
        return found
    raise UnknownFileError(
        f"{name}: Vitruvius does not know this kind of file: give a house file, plan, checkpoint, run, "
        "grammar, games, scores, trace or settings"
    )
