"""A set is read as a list, in constant memory, and any row of it can be generated again."""

import hashlib
import json
import shutil
import sys
from itertools import islice
from pathlib import Path
from typing import Any

import pytest
from msgspec import structs

from tests.logic.dataset.sets import command, restate
from tests.programs import finished
from vitruvius.logic import House, HouseFileError, Houses, HouseSet, check, generate, load
from vitruvius.logic.dataset.formats import GROUP, Files, written
from vitruvius.logic.dataset.rows import HOUSE, Row, limit_row
from vitruvius.logic.dataset.sets import (
    MANIFEST,
    SET,
    Held,
    Manifest,
    Shard,
    encoded,
    read_manifest,
    read_set,
)
from vitruvius.logic.dataset.shards import complete

ROWS = 79 * GROUP


def test_a_set_is_the_list_of_its_houses(of_format: Path) -> None:
    houses = load(of_format)
    made = [
        house
        for seed, count in ((0, 12), (10**9, 3), (2 * 10**9, 2))
        for house in generate(1, seed=seed, count=count)
    ]
    assert list(houses) == [house.converted() for house in made]
    assert len(houses) == 17
    assert [houses[place] for place in range(-17, 17)] == [*houses, *houses]
    assert isinstance(houses[3:9:2], Houses)
    assert houses[3:9:2] == list(houses)[3:9:2]
    assert list(HouseSet(of_format, "validation")) == list(houses)[12:15]
    assert not any(map(check, houses))
    with pytest.raises(IndexError):
        houses[17]


def test_rows_of_limits_are_passed_over(of_format: Path, tmp_path: Path) -> None:
    folder = shutil.copytree(of_format, tmp_path / "set")
    of = read_set(folder)
    assert of
    all_rows = list(HouseSet(folder).rows())
    for shard in of.divided():
        rows = all_rows[: len(shard.indices)]
        del all_rows[: len(shard.indices)]
        rewrite(folder, shard, of.files, [cut(row) if row["index"] % 3 == 1 else row for row in rows])
    assert complete(folder, of)
    kept = [house for house in HouseSet(of_format) if house.provenance and house.provenance.index % 3 != 1]
    houses = HouseSet(folder)
    assert len(houses) == len(kept) == 11
    assert list(houses) == [houses[place] for place in range(11)] == kept
    assert command("regenerate", folder, "--row", 1) == 1  # there is a house


def cut(row: Row) -> Row:
    source = {
        name: row[name] for name in ("id", "split", "seed", "index", "grammar", "grammar_hash", "request")
    }
    return limit_row(source, "house 1 reached its limit")


def rewrite(folder: Path, shard: Shard, files: Files, rows: list[Row]) -> None:
    with written(folder / shard.place, files) as write:
        write(rows)


def test_a_set_that_is_not_whole_or_lost_a_file_is_one_line(
    of_format: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = shutil.copytree(of_format, tmp_path / "set")
    [shard] = folder.glob("data/test-*")
    shard.unlink()
    assert command("check", folder) == 5
    (folder / MANIFEST).unlink()
    assert command("check", folder) == 5
    one, other = capsys.readouterr().err.splitlines()
    assert one.endswith("is missing: regenerate it with generate --shard")
    assert other.endswith("is an incomplete set: it has no manifest.json yet")
    with pytest.raises(HouseFileError, match="is a folder"):
        load(tmp_path)


def test_memory_is_flat_in_the_number_of_houses(of_format: Path, tmp_path: Path) -> None:
    """20,224 houses take less than 40 MB more than 1,024 houses; as a list they would take hundreds of MB."""
    folder = shutil.copytree(of_format, tmp_path / "set")
    of = read_set(folder)
    assert of
    row = next(HouseSet(folder).rows())
    peaks = []
    for rows in (4 * GROUP, ROWS):
        large = structs.replace(of, houses={"train": rows}, shards=1)
        [shard] = large.divided()
        with written(folder / shard.place, of.files) as write:
            for _ in range(0, rows, GROUP):
                write([row] * GROUP)
        rows_sha256 = hashlib.sha256(f"{row['sha256']}\n".encode() * rows).hexdigest()
        held = Held(shard.place.as_posix(), "train", rows, [], 0, "", rows_sha256)
        (folder / SET).write_bytes(encoded(large))
        restate(folder, structs.replace(manifest(of_format), houses=rows, shards=[held]))
        peaks.append(peak(folder, rows))
    assert peaks[1] - peaks[0] < 40_000, peaks


def manifest(folder: Path) -> Manifest:
    found = read_manifest(folder)
    assert found
    return found


def peak(folder: Path, rows: int) -> int:
    """Return the peak memory of a process that reads all houses, KiB."""
    program = (
        "import resource, sys; from vitruvius.logic import load; houses = load(sys.argv[1]); "
        "print(sum(1 for _ in houses), houses[len(houses) // 2].rooms[0].name, "
        "resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)"
    )
    ended = finished([sys.executable, "-c", program, str(folder)], cwd=Path(__file__).parents[3])
    number, _, most = ended.stdout.split()
    assert int(number) == rows
    return int(most)


def test_any_row_is_made_again_from_its_set_its_file_or_alone(
    of_format: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = list(HouseSet(of_format).rows())
    alone = tmp_path / "rows.jsonl"
    alone.write_text("".join(json.dumps(rows[place]) + "\n" for place in (16, 3)))
    [file] = of_format.glob("data/test-*")
    for words, places in (((of_format, "--row", 2, 14), (2, 14)), ((alone,), (16, 3)), ((file,), (15, 16))):
        assert command("regenerate", *words) == 0
        said = capsys.readouterr()
        found = [House.from_dict(json.loads(line)).converted() for line in said.out.splitlines()]
        assert found == [load(of_format)[place] for place in places]
        assert said.err == "2 rows regenerated: 2 identical, 0 different\n"


def test_a_row_that_is_another_house_is_named(tmp_path: Path, of_format: Path, capsys) -> None:
    row = next(row for row in HouseSet(of_format).rows() if row["verdict"] == HOUSE)
    other = tmp_path / "rows.jsonl"
    other.write_text(json.dumps(row | {"sha256": "0" * 64}) + "\n")
    assert command("regenerate", other) == 1
    assert f"{row['id']}: the house differs from that of the row (" in capsys.readouterr().err
    for wrong, words in (
        ({"grammar_hash": "0"}, "these are not the rules that made"),
        ({"grammar": "nobodys"}, "name the folder of its rules with --grammar"),
    ):
        other.write_text(json.dumps(row | wrong) + "\n")
        assert command("regenerate", other) == 5
        [line] = capsys.readouterr().err.splitlines()
        assert words in line
    assert command("regenerate", of_format, "--row", 17) == 5
    assert "has rows 0 to 16, not 17" in capsys.readouterr().err


ODD_ROWS: dict[str, dict[str, Any]] = {
    "no index": {"index": None},
    "an index below zero": {"index": -1},
    "an index of 400 digits": {"index": 10**400},
    "a seed beyond all": {"seed": 2**31},
    "a verdict of another row": {"verdict": "limit"},
    "a house that is a number": {"house": 7},
    "a request that is no JSON": {"request": "rooms"},
    "a request that is a list": {"request": "[1]"},
    "a deep request": {"request": "[" * 10_000},
    "very many rooms": {"request": '{"rooms": 1000000000}'},
    "a task": {"request": '{"rooms": 1, "task": "os:system"}'},
    "a brief in a file": {"request": '{"rooms": 1, "brief": "/etc/passwd"}'},
    "a tiny cell": {"request": '{"rooms": 1, "cell": 1e-9}'},
    "counts that are a list": {"request": '{"rooms": 1, "types": [1]}'},
    "a room to keep that is none": {"request": '{"rooms": 1, "keep": [7]}'},
    "a plan without rooms": {"request": '{"rooms": 1, "plan": {"rooms": []}}'},
    "a plan with a door of no room": {
        "request": '{"rooms": 1, "plan": {"rooms": [{"name": "a", "type": "", "x": 0, "y": 0, "width": 3, '
        '"height": 3}], "doors": [{"between": ["a", "b"], "x": 3, "y": 1, "width": 0, "height": 1}]}}'
    },
    "a plan of a size below zero": {
        "request": '{"rooms": 1, "plan": {"rooms": [{"name": "a", "type": "", "x": 0, "y": 0, "width": -3, '
        '"height": 3}]}}'
    },
    "a grammar that is a path": {"grammar": "../mine"},
}


@pytest.mark.parametrize("what", ODD_ROWS)
def test_a_row_that_no_set_has_is_refused_in_a_line(
    what: str, of_format: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = tmp_path / "rows.jsonl"
    rows.write_text(json.dumps(next(HouseSet(of_format).rows()) | ODD_ROWS[what]) + "\n")
    assert command("regenerate", rows) == 5
    [line] = capsys.readouterr().err.splitlines()
    assert "not a row of a set: " in line or "name the folder of its rules with --grammar" in line


def test_houses_of_a_set_are_read_one_group_at_a_time(of_format: Path) -> None:
    assert len(list(islice(HouseSet(of_format), 2))) == 2
