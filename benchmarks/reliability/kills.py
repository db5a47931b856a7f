"""``vitruvius bench kills``: commands are killed at random moments, and all files that they left are read."""

import contextlib
import gzip
import io
import json
import os
import random
import re
import runpy
import shutil
import signal
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from xml.etree import ElementTree

import msgspec
from PIL import Image

from vitruvius.logic import load
from vitruvius.logic.dataset.sets import BESIDE
from vitruvius.logic.errors import RequestError, VitruviusError
from vitruvius.logic.files.writing import write_whole
from vitruvius.logic.terminal import say

COMMANDS = {
    "convert": "convert houses.jsonl --out OUT/houses.jsonl.gz",
    "convert to GeoJSON": "convert houses.jsonl --out OUT/plans --to geojson",
    "draw": "draw houses.jsonl --out OUT/plans --format png",
    "report": "report run --out OUT/report.html",
    "evaluate": "evaluate run/agent.safetensors --houses house.jsonl --targets main --out OUT/scores",
    "train": "train houses.jsonl --steps 2000 --num-envs 4 --out OUT/run",
}
"""Arguments of each command, by its name."""

NEAR_SECONDS = 0.02
"""Longest time in seconds from a new file to every second kill."""

POLL_SECONDS = 0.001
"""Time in seconds between two looks at a command."""

EPISODE_STEPS = 300
"""Steps of an episode of the command evaluate: the study judges the files that follow."""

STREAMS = re.compile(r"metrics\.jsonl|events\.out\.tfevents\..*")
"""Files to which lines are added: a kill may truncate the last line, and readers skip it."""


@dataclass(frozen=True)
class Kills:
    """Kill convert, draw, report, evaluate and train at random moments, and read every file that they left.

    Each file must be complete or absent.
    """

    commands: tuple[str, ...] = tuple(COMMANDS)
    """Commands to kill."""

    kills: int = 100
    """Number of kills of each command."""

    seed: int = 0
    """Seed of the moments."""

    out: Path = Path("runs/kills")
    """Folder for kills.md, kills.json and the files of the commands; recorded kills are not repeated."""

    replace: bool = False
    """Write into the folder even if it holds other files."""

    def run(self) -> int:
        """Write the figures, and return 1 if a file is truncated."""
        if unknown := [name for name in self.commands if name not in COMMANDS]:
            raise RequestError(f"--commands {unknown[0]}: unknown command: choose from {', '.join(COMMANDS)}")
        note = self.out / "kills.json"
        done: dict[str, list[Kill]] = {}
        if note.exists():
            done = msgspec.json.decode(note.read_bytes(), type=dict[str, list[Kill]])
        work = self.out / "work"
        work.mkdir(parents=True, exist_ok=True)
        with contextlib.chdir(work):
            _prepare()
        for name in self.commands:
            words, kills = COMMANDS[name], done.setdefault(name, [])
            with contextlib.chdir(work):
                takes = _undisturbed(words) if len(kills) < self.kills else 0.0
            while len(kills) < self.kills:
                with contextlib.chdir(work):
                    kills.append(_killed(words, takes, len(kills), f"{self.seed} {name} {len(kills)}"))
                write_whole(note, msgspec.json.encode(done))
            say(f"{name}: {len(kills)} kills, {sum(len(each.torn) for each in kills)} torn files")
        write_whole(self.out / "kills.md", _page(done).encode())
        print(self.out / "kills.md")
        return int(any(each.torn for kills in done.values() for each in kills))


class Kill(msgspec.Struct):
    """Result of a kill."""

    seconds: float
    """Seconds after which the command was killed."""
    ended: bool
    """True if the command had already ended."""
    whole: int
    """Number of files that their reader accepts."""
    beside: int
    """Number of temporary files that were being written."""
    torn: list[str]
    """Files that their reader refuses, with the reasons."""


def _prepare() -> None:
    """Make the houses, and a run to report and to evaluate."""
    if not Path("houses.jsonl").exists():
        _end(_started("generate --rooms 3 --count 6 --out houses.jsonl"))
    if not Path("house.jsonl").exists():
        write_whole("house.jsonl", Path("houses.jsonl").read_bytes().splitlines(keepends=True)[0])
    if not Path("run/agent.safetensors").exists():
        shutil.rmtree("run", ignore_errors=True)
        _end(_started("train houses.jsonl --steps 1000 --num-envs 4 --out run"))


def _started(words: str) -> int:
    """Start a command in its own process, forked from this one, which has imported what it needs."""
    import vitruvius.agent.evaluation.protocol
    import vitruvius.agent.report.folder
    import vitruvius.agent.runs.runs
    import vitruvius.logic.drawing.draw
    from vitruvius.sim.config import PRESETS

    if process := os.fork():
        return process
    try:
        os.setpgid(0, 0)
        nothing = os.open(os.devnull, os.O_RDWR)
        for stream in (0, 1, 2):
            os.dup2(nothing, stream)
        vitruvius.agent.runs.runs.SAVE_SECONDS = 0.0
        PRESETS["default"] = replace(PRESETS["default"], steps=EPISODE_STEPS)
        sys.argv = ["vitruvius", *words.split()]
        runpy.run_module("vitruvius.cli", run_name="__main__")
    except SystemExit as end:
        sys.modules["vitruvius.sim.runtime"].ti.reset()  # stores its kernels, which other processes find
        os._exit(end.code if isinstance(end.code, int) else 1)
    finally:
        os._exit(70)


def _end(process: int) -> None:
    """Wait for a command. Raises ``NotDone`` if the command fails."""
    if code := os.waitstatus_to_exitcode(os.waitpid(process, 0)[1]):
        raise NotDone(f"a command of the study ended with exit code {code}")


class NotDone(VitruviusError):
    """An undisturbed command ended in an error."""

    exit_code = 1


def _undisturbed(words: str) -> float:
    """Return the seconds that a command takes. Raises ``NotDone`` if its files cannot be read."""
    began = time.monotonic()
    shutil.rmtree("out", ignore_errors=True)
    _end(_started(words.replace("OUT", "out")))
    took = time.monotonic() - began
    if torn := [words for _, words in read_back(Path("out")) if words]:
        raise NotDone(torn[0])
    return took


def _killed(words: str, takes: float, number: int, seed: str) -> Kill:
    """Kill a command at a random moment, and read the files that it left.

    Every second kill happens when a new file appears. Training is killed after its first save.
    """
    chance, out = random.Random(seed), Path("out")
    shutil.rmtree(out, ignore_errors=True)
    began = time.monotonic()
    process = _started(words.replace("OUT", "out"))
    ended = False

    def lives() -> bool:
        nonlocal ended
        ended = ended or os.waitpid(process, os.WNOHANG)[0] != 0
        return not ended

    if words.startswith("train"):
        while lives() and not (out / "run" / "agent.safetensors").exists():
            time.sleep(POLL_SECONDS)
        until = time.monotonic() + chance.uniform(0, 0.5 * takes)
    else:
        until = began + chance.uniform(0, takes)
    if number % 2:
        files = _files(out)
        while lives() and _files(out) == files:
            time.sleep(POLL_SECONDS)
        until = time.monotonic() + chance.uniform(0, NEAR_SECONDS)
    while lives() and time.monotonic() < until:
        time.sleep(POLL_SECONDS)
    if lives():
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process, signal.SIGKILL)
        os.waitpid(process, 0)
    seconds = round(time.monotonic() - began, 3)
    found = list(read_back(out))
    torn = [why for path, why in found if why]
    beside = sum(BESIDE.fullmatch(path.name) is not None for path in out.rglob("*"))
    return Kill(seconds, ended, len(found) - len(torn), beside, torn)


def _files(folder: Path) -> list[str]:
    """Return the names of the files below a folder, while another process writes there."""
    return sorted(os.path.join(place, name) for place, _, names in os.walk(folder) for name in names)


def read_back(folder: Path) -> Iterator[tuple[Path, str]]:
    """Yield each file of a folder, except temporary files, with the reason if its reader refuses the file."""
    for path in sorted(folder.rglob("*")):
        if path.is_file() and not BESIDE.fullmatch(path.name) and not STREAMS.fullmatch(path.name):
            try:
                reader = next(read for ending, read in READERS.items() if path.name.endswith(ending))
                reader(path)
            except StopIteration:
                yield path, f"{path}: no reader is known"
            except Exception as error:  # each reader has its own
                yield path, f"{path}: {type(error).__name__}: {error}"
            else:
                yield path, ""


def _picture(path: Path) -> None:
    with Image.open(path) as picture:
        picture.load()


def _page_of_html(path: Path) -> None:
    if not path.read_bytes().rstrip().endswith(b"</html>"):
        raise ValueError("the page has no end")


def _words(path: Path) -> None:
    if not path.read_text("utf-8").endswith("\n"):
        raise ValueError("the last line has no end")


def _checkpoint(path: Path) -> None:
    from vitruvius.agent.runs import checkpoint

    checkpoint.load(path)


def _state(path: Path) -> None:
    import torch

    torch.load(io.BytesIO(gzip.decompress(path.read_bytes())), weights_only=True)


READERS: dict[str, Callable[[Path], object]] = {
    ".jsonl": load,
    ".jsonl.gz": load,
    ".geojson": lambda path: json.loads(path.read_bytes()),
    ".json": lambda path: json.loads(path.read_bytes()),
    ".svg": ElementTree.parse,
    ".png": _picture,
    ".html": _page_of_html,
    ".md": _words,
    ".safetensors": _checkpoint,
    ".pt.gz": _state,
    ".lock": Path.read_bytes,
}
"""Readers by file name ending; a reader raises an exception for a truncated file."""


def _page(done: dict[str, list[Kill]]) -> str:
    """Return the page of the figures."""
    rows = [
        f"| `{name}` | {len(kills)} | {sum(not each.ended for each in kills)} "
        f"| {sum(each.whole for each in kills)} | {sum(each.beside for each in kills)} "
        f"| {sum(len(each.torn) for each in kills)} |"
        for name, kills in done.items()
    ]
    torn = [f"- {why}" for kills in done.values() for each in kills for why in each.torn]
    head = "| command | started | killed at work | whole files | files beside their place | torn files |"
    return "\n".join(["# Commands under kills", "", head, "|---|---|---|---|---|---|", *rows, "", *torn, ""])
