"""A set matches its manifest, or is refused at once, in one line that names the file."""

import contextlib
import json
import os
import random
import re
import shutil
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import msgspec
import pytest
from msgspec import structs

from tests.logic.dataset.sets import command, made, restate
from tests.programs import finished
from vitruvius.logic import HouseFileError, HouseSet
from vitruvius.logic.dataset.formats import read, schema
from vitruvius.logic.dataset.parquet import MAX_GROUP_BYTES, Thrift
from vitruvius.logic.dataset.sets import MANIFEST, SET, Manifest, read_manifest, read_set

ROOT = Path(__file__).parents[3]

pa = pytest.importorskip("pyarrow")
pytest.importorskip("pyarrow.parquet")


@pytest.fixture(scope="module")
def made_set(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("made") / "set"
    assert made(folder, "--files", "jsonl") == 0
    return folder


@pytest.fixture
def copy(made_set: Path, tmp_path: Path) -> Path:
    return shutil.copytree(made_set, tmp_path / "set")


def shard(folder: Path) -> Path:
    """Return the first file of training rows."""
    return sorted((folder / "data").glob("train-*"))[0]


def manifest(folder: Path) -> Manifest:
    found = read_manifest(folder)
    assert found
    return found


def refused(capsys: pytest.CaptureFixture[str], *words: object) -> str:
    """Return the one line of a command that refuses a file."""
    assert command(*words) == 5
    [line] = capsys.readouterr().err.splitlines()
    return line


def test_check_counts_what_it_read(of_format: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert command("check", of_format, "--json") == 0
    said = capsys.readouterr()
    assert said.err.startswith(
        f"{of_format}: 5 shards, 17 rows: 17 houses, 0 limits, as manifest.json states\n"
    )
    assert json.loads(said.out)["answer"]["set"] == {"shards": 5, "rows": 17, "houses": 17, "limits": 0}


def halved(path: Path) -> None:
    """Remove half of the rows of a file and leave the file itself valid."""
    rows = list(read(path))
    if path.suffix == ".jsonl":
        path.write_bytes(b"".join(msgspec.json.encode(row) + b"\n" for row in rows[::2]))
    else:
        pa.parquet.write_table(pa.Table.from_pylist(rows[::2], schema()), path)


def instead(put: Callable[[Path], object]) -> Callable[[Path], None]:
    def change(path: Path) -> None:
        path.unlink()
        put(path)

    return change


def moved_out(path: Path) -> None:
    """Move a file elsewhere, and put a link to it in its place."""
    path.symlink_to(shutil.move(path, path.parents[2] / path.name))


SHARDS: dict[str, tuple[Callable[[Path], object], str]] = {
    "half of its rows": (halved, "bytes, but manifest.json states"),
    "another last byte": (lambda path: path.write_bytes(path.read_bytes()[:-1] + b" "), "SHA-256 differs"),
    "a pipe": (instead(os.mkfifo), "is a device or a pipe"),
    "zeros without an end": (instead(lambda path: path.symlink_to("/dev/zero")), "is a link out of"),
    "a link out of the folder": (moved_out, "is a link out of"),
    "a folder": (instead(Path.mkdir), "Is a directory"),
}  # fmt: skip


@pytest.mark.parametrize("what", SHARDS)
def test_a_shard_that_is_not_that_of_the_manifest_is_refused_by_name(
    what: str, of_format: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    copy = shutil.copytree(of_format, tmp_path / "set")
    change, words = SHARDS[what]
    change(shard(copy))
    said = refused(capsys, "check", copy)
    assert str(shard(copy)) in said
    assert words in said
    with pytest.raises(HouseFileError, match=shard(copy).name):
        HouseSet(copy)[0]


@pytest.mark.parametrize("what", ["fewer rows", "another house", "a wrong hash", "a wrong type"])
def test_rows_that_are_not_those_of_the_manifest_are_refused_though_their_file_is(
    what: str, copy: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = shard(copy)
    rows = [json.loads(line) for line in path.read_text().splitlines()]
    match what:
        case "fewer rows":
            del rows[-1]
        case "another house":
            rows[1]["house"] = rows[0]["house"]
        case "a wrong hash":
            rows[1]["sha256"] = rows[0]["sha256"]
        case _:
            rows[1]["house"]["rooms"] = 7
    path.write_text("".join(json.dumps(row) + "\n" for row in rows))
    restate(copy, manifest(copy))
    assert "row" in refused(capsys, "check", copy)


DEEP = "[" * 100_000

MANIFESTS: dict[str, Callable[[dict[str, Any]], Any]] = {
    "10^15 rows": lambda found: found["shards"][0].update(rows=10**15),
    "fewer rows": lambda found: found["shards"][0].update(rows=1),
    "a shard above the folder": lambda found: found["shards"][0].update(file="../data/x.jsonl"),
    "a shard of the system": lambda found: found["shards"][0].update(file="/etc/passwd"),
    "a shard less": lambda found: found["shards"].pop(),
    "a limit beyond its rows": lambda found: found["shards"][0].update(limits=[10**15]),
    "a limit twice": lambda found: found["shards"][0].update(limits=[1, 1]),
    "other numbers": lambda found: found.update(houses=10**15),
    "bytes of another type": lambda found: found["shards"][0].update(bytes="many"),
    "another set": lambda found: found.update(set_sha256="0"),
    "deep lists": lambda _: DEEP,
    "a number of 400 digits": lambda _: f'{{"houses": {"9" * 400}}}',
    "a list": lambda _: "[]",
    "nothing": lambda _: "",
}  # fmt: skip


@pytest.mark.parametrize("what", MANIFESTS)
def test_a_manifest_that_no_set_has_is_refused_at_once(
    what: str, copy: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = json.loads((copy / MANIFEST).read_text())
    made = MANIFESTS[what](found)
    (copy / MANIFEST).write_text(made if isinstance(made, str) else json.dumps(found))
    assert f"{copy / MANIFEST}: " in refused(capsys, "check", copy)


SETS: dict[str, dict[str, Any]] = {
    "very many shards": {"shards": 10**15},
    "very many houses": {"houses": {"train": 10**15}},
    "houses of no split": {"houses": {"../train": 12}},
    "no house": {"houses": {}},
    "a seed of another split": {"seed": 10**9},
    "a grammar that is a path": {"grammar": "../../../etc"},
    "a grammar that is a folder above": {"grammar": ".."},
    "an empty request": {"request": {}},
    "a request of no rooms": {"request": {"rooms": -1}},
    "a request for a file": {"request": {"rooms": 1, "brief": "/etc/passwd"}},
    "a request with more": {"request": {"rooms": 1, "task": "os:system"}},
    "no seconds": {"seconds": 0.0},
    "inferences below zero": {"inferences": -1},
    "another format": {"format": "vitruvius-set-9"},
    "houses as a list": {"houses": [12]},
}


@pytest.mark.parametrize("what", SETS)
def test_a_description_of_no_set_is_refused_at_once(
    what: str, copy: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (copy / SET).write_text(json.dumps(json.loads((copy / SET).read_text()) | SETS[what]))
    for words in (("check", copy), ("info", copy), ("regenerate", copy, "--row", 0)):
        assert f"{copy / SET}: is not a valid file of a set: " in refused(capsys, *words)


def test_rules_that_a_link_leads_out_to_are_not_read(copy: Path, capsys: pytest.CaptureFixture[str]) -> None:
    of = read_set(copy)
    assert of
    [rules] = (copy / "grammar").iterdir()
    rules.rename(rules.with_name("mine"))
    rules.with_name("mine").rename(copy.parent / "elsewhere")
    rules.with_name("mine").symlink_to(copy.parent / "elsewhere")
    with pytest.raises(HouseFileError, match="is a link out of the set's folder"):
        structs.replace(of, grammar="mine").rules(copy)


def dictionary(text: str, rows: int) -> Any:
    """Return a column of one text."""
    return pa.DictionaryArray.from_arrays(pa.array([0] * rows, pa.int32()), pa.array([text]))


def table(rows: int, **columns: Any) -> Any:
    """Return a table of null values except in some columns."""
    made = {field.name: columns.get(field.name, pa.nulls(rows, field.type)) for field in schema()}
    return pa.table(made)


def bomb_of_texts() -> Any:
    """Return a table with a text of a megabyte in each of 4,000 rows: 4 GB."""
    return table(4000, why=dictionary("x" * (1 << 20), 4000))


def bomb_of_lists() -> Any:
    """Return a table with a text of a megabyte 100,000 times in the types of each row: 100 GB."""
    number = 100_000
    types = pa.ListArray.from_arrays(pa.array([0, number], pa.int32()), dictionary("x" * (1 << 20), number))
    return table(1, types=types)


BOMBS: dict[str, tuple[Callable[[], Any], dict[str, Any]]] = {
    "a text in a dictionary": (bomb_of_texts, {}),
    "a text in lists": (bomb_of_lists, {}),
    "one large row group": (lambda: table(1 << 18), {}),
    "one huge text": (
        lambda: table(1, why=dictionary("x" * MAX_GROUP_BYTES, 1)),
        {"write_statistics": False},
    ),
    "texts that begin alike": (
        lambda: table(9, why=pa.array(["x" * 99] * 9)),
        {"use_dictionary": False, "column_encoding": {"why": "DELTA_BYTE_ARRAY"}},
    ),
}  # fmt: skip

READING = """
import sys
from pathlib import Path
from vitruvius.logic.dataset.formats import read
for path in sys.argv[1:]:
    try:
        print(sum(1 for _ in read(Path(path))))
    except ValueError as error:
        print(error)
print(Path("/proc/self/status").read_text().partition("VmHWM:")[2].split()[0])
"""


def test_parquet_that_unpacks_to_gigabytes_is_refused_before_it_does(tmp_path: Path) -> None:
    for number, (make, options) in enumerate(BOMBS.values()):
        how: dict[str, Any] = {"compression": "zstd", "dictionary_pagesize_limit": 1 << 30} | options
        pa.parquet.write_table(make(), tmp_path / f"{number}.parquet", store_schema=False, **how)
    files = sorted(tmp_path.iterdir())
    assert sum(path.stat().st_size for path in files) < 1 << 18
    ended = finished([sys.executable, "-c", READING, *map(str, files)], cwd=ROOT)
    *said, most = ended.stdout.splitlines()
    assert len(said) == len(BOMBS)
    assert all(
        "a row group holds more" in line or "a page has the unsupported encoding" in line for line in said
    ), said
    assert int(most) < 400_000  # KiB


def changed(content: bytes) -> Iterator[tuple[int, int]]:
    """Yield places of Parquet and other bytes for them: anywhere, and in each list of numbers in the footer.

    pyarrow ends the process if the histogram of a column has another number of values than its levels.
    """
    chance = random.Random(12)
    for _ in range(99):
        place = chance.randrange(len(content))
        yield place, content[place] ^ chance.randrange(1, 256)
    footer = len(content) - 8 - int.from_bytes(content[-8:-4], "little")
    for found in re.finditer(rb"[\x19\x29][\x16\x26\x36]", content[footer:]):
        yield footer + found.start() + 1, 0xAA


@pytest.mark.parametrize("of_format", ["parquet"], indirect=True)
def test_parquet_that_is_damaged_anywhere_is_refused_or_read(of_format: Path, tmp_path: Path) -> None:
    content, path = shard(of_format).read_bytes(), tmp_path / "it.parquet"
    for place, byte in changed(content):
        path.write_bytes(content[:place] + bytes([byte]) + content[place + 1 :])
        with contextlib.suppress(ValueError, OSError):
            list(read(path))


@pytest.mark.parametrize("kind", [0xF3, 0xF6, 0xF7, 0xF8, 0xF9, 0xFC])
def test_a_list_of_thrift_that_is_longer_than_its_text_ends_at_once(kind: int) -> None:
    numbers = b"\xff" * 8 + b"\x0f"
    for text in (numbers + bytes(99), b"\xff" * 1_000_000):
        with pytest.raises((IndexError, TypeError)):
            Thrift(bytes([0x19, kind]) + text).struct()
