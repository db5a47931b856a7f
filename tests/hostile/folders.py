"""Run folders of other people that ``train --resume`` continues."""

import gzip
import io
import os
import shutil
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from tests.hostile.case import ACCEPTED, HARMLESS, REFUSED, Case, Yard
from tests.hostile.checkpoints import archived, pickled
from tests.hostile.houses import bomb
from tests.hostile.subjects import Answer
from vitruvius.logic.errors import VitruviusError
from vitruvius.sim.world.arrays import COUNTERS, FOUND

FILES = ("agent.safetensors", "config.json", "metrics.jsonl", "state.pt.gz", "tensorboard", ".lock")


def trained(folder: Path, resume: bool = False) -> Answer:
    """Train a short run in a folder."""
    from tests.sample_houses import random_house
    from vitruvius.agent.algorithms.pqn.config import PQNConfig
    from vitruvius.agent.runs.runs import run

    config = PQNConfig(num_envs=4, num_steps=8, steps=64, seed=2)
    if resume:
        config = replace(config, steps=96)
    made, history = run([random_house(0)], config, folder, resume=resume)
    return Answer(ACCEPTED, f"{made.steps} steps, {len(history)} reports")


def resumed(folder: Path) -> Answer:
    """Return the answer to ``--resume``; ``info`` answers, too."""
    from vitruvius.info.recognise import recognised

    with suppress(VitruviusError):
        recognised(str(folder))
    return trained(folder, resume=True)


def state(yard: Yard) -> dict[str, Any]:
    """Return the saved state of the run."""
    import torch

    content = gzip.decompress((yard.root.with_name("run") / "state.pt.gz").read_bytes())
    return torch.load(io.BytesIO(content), weights_only=True)[0]


def saved(value: Any) -> bytes:
    """Return a value as a run saves it."""
    import torch

    content = io.BytesIO()
    torch.save(value, content)
    return gzip.compress(content.getvalue(), 1)


def envs(**changes: Callable[[Any], Any]) -> Callable[[Yard], bytes]:
    """Return the state with changed arrays of the environments."""

    def content(yard: Yard) -> bytes:
        found = state(yard)
        for name, change in changes.items():
            found["envs"][name] = change(found["envs"][name])
        return saved([found])

    return content


def placed(array: Any, number: int, columns: slice = slice(COUNTERS, None)) -> Any:
    """Return an array with another number in some columns of the environments."""
    array[:, columns] = number
    return array


STATES: dict[str, Callable[[Yard], bytes]] = {
    "empty": lambda _: b"",
    "no gzip": lambda _: b"state",
    "cut short": lambda yard: saved([state(yard)])[:-50],
    "a gzip bomb": lambda _: bomb(1 << 28),
    "a zip bomb": lambda yard: gzip.compress(archived(pickled(yard), bytes(300_000_000)), 1),
    "a pickle": lambda yard: gzip.compress(pickled(yard)),
    "a pickle of protocol 0": lambda yard: gzip.compress(pickled(yard, 0)),
    "a torch file with a pickle": lambda yard: gzip.compress(archived(pickled(yard))),
    "a pickle that is not compressed": pickled,
    "a pickle of a large number": lambda _: gzip.compress(
        archived(b"\x80\x02\x8a\xff" + b"\xff" * 255 + b".")
    ),
    "a pickle of deep lists": lambda _: gzip.compress(
        archived(b"\x80\x02" + b"(" * 200_000 + b"l" * 200_000 + b".")
    ),
    "a pickle that remembers itself": lambda _: gzip.compress(archived(b"\x80\x02]q\x00h\x00a.")),
    "a tensor of 10 to the 12 zeros": lambda yard: saved(
        [{"x": __import__("torch").zeros(1).expand(10**12)}]
    ),
    "numbers": lambda _: saved(7),
    "no state": lambda _: saved([]),
    "two ranks": lambda yard: saved(2 * [state(yard)]),
    "an empty state": lambda _: saved([{}]),
    "an algorithm that is a module": lambda yard: saved([state(yard) | {"algorithm": "os.system"}]),
    "a config of another kind": lambda yard: saved([state(yard) | {"config": {"steps": []}}]),
    "other houses": lambda yard: saved([state(yard) | {"houses": "../../etc/passwd"}]),
    "a network without weights": lambda yard: saved([state(yard) | {"network": {}}]),
    "steps that are a word": lambda yard: saved([state(yard) | {"steps": "many"}]),
    "a clock of other hands": lambda yard: saved([state(yard) | {"clock": {"__class__": 1}}]),
    "recent reports of another kind": lambda yard: saved([state(yard) | {"recent": [1, 2]}]),
    "an optimizer of nothing": lambda yard: saved([state(yard) | {"optimizer": {}}]),
    "an attribute of its own": lambda yard: saved([state(yard) | {"last": {"__class__": 1}}]),
    "a method in place of an attribute": lambda yard: saved([state(yard) | {"last": {"collect": 1}}]),
    "environments of other shapes": envs(wholes=lambda array: array[:1]),
    "environments of other numbers": envs(wholes=lambda array: array.double()),
    "environments in houses beyond the bank": envs(wholes=lambda array: array * 0 + 2**31 - 1),
    "environments in houses before the bank": envs(wholes=lambda array: array * 0 - 2**31),
    "cells far away": envs(wholes=lambda array: placed(array, 2**31 - 1)),
    "cells before the first": envs(wholes=lambda array: placed(array, -(2**31))),
    "cells not so far away": envs(wholes=lambda array: placed(array, 60_000)),
    "headings that are none": envs(wholes=lambda array: placed(array, 99, slice(-1, None))),
    "very many targets found": envs(wholes=lambda array: placed(array, 2**31 - 1, slice(FOUND, FOUND + 1))),
    "bodies that are nowhere": envs(reals=lambda array: array * float("nan")),
    "bodies far away": envs(reals=lambda array: array * 0 + 3e38),
}
"""Contents that replace ``state.pt.gz``."""

METRICS: dict[str, Callable[[list[bytes]], bytes]] = {
    "empty": lambda _: b"",
    "zeros": lambda _: bytes(10_000_000),
    "no JSON": lambda _: b"steps\n",
    "other kinds": lambda _: b'{"steps": "many"}\n[]\nnull\n7\n"x"\n',
    "deep lists": lambda _: b"[" * 1_000_000,
    "NaN": lambda lines: lines[0].replace(b'"loss": ', b'"loss": NaN, "x": '),
    "steps below zero": lambda lines: lines[0].replace(b'"steps": ', b'"steps": -'),
    "steps of 400 digits": lambda lines: lines[0].replace(b'"steps": ', b'"steps": ' + b"9" * 400),
    "a line of 50 MB": lambda lines: b"x" * 50_000_000,
    "good lines among bad ones": lambda lines: b"\xff\n\0\n" + b"".join(lines) + b"[]\n{" * 9,
}
"""Contents that replace ``metrics.jsonl``, from the lines of the run."""


def _run(yard: Yard) -> Path:
    folder = yard.out / "run"
    shutil.copytree(yard.root.with_name("run"), folder)
    return folder


def _with_state(content: Callable[[Yard], bytes]) -> Callable[[Yard], Path]:
    def make(yard: Yard) -> Path:
        folder = _run(yard)
        (folder / "state.pt.gz").write_bytes(content(yard))
        return folder

    return make


def _with_metrics(content: Callable[[list[bytes]], bytes]) -> Callable[[Yard], Path]:
    def make(yard: Yard) -> Path:
        folder = _run(yard)
        file = folder / "metrics.jsonl"
        file.write_bytes(content(file.read_bytes().splitlines(keepends=True)))
        return folder

    return make


def _away(path: Path) -> None:
    if path.is_dir():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def _instead(name: str, put: Callable[[Path, Yard], object]) -> Callable[[Yard], Path]:
    def make(yard: Yard) -> Path:
        folder = _run(yard)
        _away(folder / name)
        put(folder / name, yard)
        return folder

    return make


def _linked(yard: Yard) -> Path:
    link = yard.out / "link"
    link.symlink_to(_run(yard))
    return link


INSTEAD: dict[str, Callable[[Path, Yard], None]] = {
    "a link to a secret": lambda path, yard: path.symlink_to(yard.secret),
    "a link to a new file": lambda path, yard: path.symlink_to(yard.trace),
    "a link to another folder": lambda path, yard: path.symlink_to(yard.trace.parent),
    "a link to zeros": lambda path, yard: path.symlink_to("/dev/zero"),
    "a pipe": lambda path, yard: os.mkfifo(path),
}
"""Objects that replace each of a run's files."""

CASES = [
    *(
        Case(
            "run folders: states",
            title,
            _with_state(make),
            HARMLESS if title.startswith(("bodies", "cells not", "very many")) else (REFUSED,),
        )
        for title, make in STATES.items()
    ),
    *(
        Case(
            "run folders: metrics",
            title,
            _with_metrics(make),
            (ACCEPTED,) if title in {"good lines among bad ones", "steps below zero"} else (REFUSED,),
        )
        for title, make in METRICS.items()
    ),
    *(
        Case("run folders: files", f"{title} for {name}", _instead(name, put), (REFUSED,))
        for title, put in INSTEAD.items()
        for name in FILES
    ),
    *(
        Case(
            "run folders: files",
            f"a folder for {name}",
            _instead(name, lambda path, _: path.mkdir()),
            (REFUSED,),
        )
        for name in FILES
        if name != "tensorboard"
    ),
    Case("run folders: files", "as it was", _run, (ACCEPTED,)),
    Case("run folders: files", "a link to the folder", _linked, HARMLESS),
    Case(
        "run folders: files",
        "a config of another kind",
        _instead("config.json", lambda path, _: path.write_text('{"config": {"__class__": 1}}')),
        (ACCEPTED,),
    ),
]
