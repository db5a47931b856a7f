"""Every command that takes a file refuses odd files at once, with an error of one line, or takes them."""

import contextlib
import gzip
import os
import shutil
import signal
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.logic.workers import in_process
from vitruvius.cli import main
from vitruvius.logic import save

MAX_SECONDS = 20
"""Time limit for one file, in seconds, on a busy machine."""

CONTENTS = {
    "nothing": b"",
    "a list": b"[]",
    "an object": b"{}",
    "null": b"null",
    "a number": b"1e999",
    "deep lists": b"[" * 100_000,
    "deep objects": b'{"a":' * 100_000,
    "NaN": b'{"format": "vitruvius-2", "unit": "m", "rooms": [{"name": "R0", "type": "x", "x": NaN}]}',
    "400 digits": b'{"roomNumber": ' + b"9" * 400 + b', "rooms": ' + b"9" * 400 + b"}",
    "all bytes": bytes(range(256)) * 8,
    "gzip cut short": gzip.compress(os.urandom(5000))[:2000],
    "damaged gzip": b"\x1f\x8b\x08" + bytes(7) + b"\xff" * 99,
    "no UTF-8": b'{"a": "\xff\xfe"}',
    "half a letter": rb'{"a": "\ud800", "format": "\ud800"}',
    "zeros": bytes(4096),
    "words": b"hello world\n",
}

PLACES: dict[str, Callable[[Path], object]] = {
    "a folder": Path.mkdir,
    "a pipe": os.mkfifo,
    "zeros without an end": lambda path: path.symlink_to("/dev/zero"),
    "a link to nothing": lambda path: path.symlink_to("/nowhere"),
    "a link to itself": lambda path: path.symlink_to(path),
}

FILES = {
    "check {}": ".jsonl .json .jsonl.gz .yaml .geojson .pgm",
    "check {houses} --promises {}": ".json",
    "draw {} --out {out}": ".jsonl .json",
    "draw {houses} --diff {} --out {out}": ".jsonl",
    "draw {houses} --grammar {} --out {out}": ".json",
    "convert {} --out {out}/it.jsonl": ".jsonl .json",
    "info {}": ".jsonl .json .gz .yaml .toml .safetensors .h5 .lp .svg .dxf .ifc",
    "explain {} --why R0": ".jsonl",
    "explain --brief {}": ".json",
    "explain --plan {}": ".json .geojson",
    "lint {}": ".lp",
    "regenerate {}": ".jsonl .parquet .gz",
    "record {}": ".jsonl",
    "evaluate explorer --houses {}": ".jsonl",
    "evaluate --houses {houses} --scores {}": ".json",
    "evaluate --houses {houses} --beside {}": ".jsonl",
    "evaluate {} --houses {houses}": ".safetensors",
    "export {} --out {out}/it.onnx": ".safetensors",
    "play --replay {}": ".jsonl",
    "train {} --out {out}": ".jsonl .json",
}
"""Suffixes of the file in the place of ``{}``, by command."""

IN_FOLDERS = {
    "report {}": "evaluation.json metrics.jsonl config.json it.jsonl it.jsonl.gz it.trace.json run.json",
    "info {}": "config.json set.json",
    "check {}": "set.json",
    "regenerate {}": "set.json",
    "train {} --out {out}": "set.json",
}
"""Names of files in a folder in the place of ``{}``, by command."""

CASES = [
    *((words, f"odd{ending}", False) for words, endings in FILES.items() for ending in endings.split()),
    *((words, name, True) for words, names in IN_FOLDERS.items() for name in names.split()),
]


class Late(BaseException):
    """Error for a command that took too long."""


@contextlib.contextmanager
def limited() -> Iterator[None]:
    """Raise ``Late`` in a block that does not end."""

    def late(*_: object) -> None:
        raise Late

    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(MAX_SECONDS)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


@pytest.fixture(scope="module")
def houses(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("houses") / "houses.jsonl"
    save(in_process.generate(2), path)
    return path


@pytest.mark.parametrize(
    ("words", "name", "is_in_folder"), CASES, ids=[f"{words}-{name}" for words, name, _ in CASES]
)
def test_an_odd_file_is_refused_in_a_line_or_taken(
    words: str,
    name: str,
    is_in_folder: bool,
    houses: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    wrong = list[str]()
    for what in (*CONTENTS, *PLACES):
        here = tmp_path / "here"
        here.mkdir()
        place = here / name
        if what in PLACES:
            PLACES[what](place)
        else:
            place.write_bytes(CONTENTS[what])
        given = words.format(here if is_in_folder else place, houses=houses, out=tmp_path / "out")
        with limited(), pytest.raises(SystemExit) as ended:
            main(given.split())
        said = capsys.readouterr().err
        if ended.value.code not in (0, 1, 2, 4, 5) or (ended.value.code and len(said.splitlines()) != 1):
            wrong.append(f"{what}: {ended.value.code}: {said[-300:]}")
        shutil.rmtree(here)
    assert not wrong, "\n".join(wrong)
