"""Shards are a function of the request; existing ones are verified; no other file is lost."""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.logic.dataset.sets import command, content, made
from tests.programs import PATIENCE, finished
from vitruvius.info.descriptions import SetOfHouses
from vitruvius.info.recognise import recognised
from vitruvius.logic import House, HouseSet, LimitReached, generate
from vitruvius.logic.dataset import shards
from vitruvius.logic.dataset.formats import read
from vitruvius.logic.dataset.rows import house_sha256
from vitruvius.logic.dataset.sets import Manifest, read_manifest, read_set
from vitruvius.logic.errors import Killed
from vitruvius.logic.grammar import SHIPPED
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.workers.pool import outcomes


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("set") / "whole"
    assert made(folder) == 0
    return folder


@pytest.fixture
def copy(whole: Path, tmp_path: Path) -> Path:
    return shutil.copytree(whole, tmp_path / "copy")


def manifest(folder: Path) -> Manifest:
    found = read_manifest(folder)
    assert found
    return found


def rows(folder: Path, split: str) -> list[dict[str, Any]]:
    return [
        row for shard in manifest(folder).shards if shard.split == split for row in read(folder / shard.file)
    ]


def test_a_set_has_the_houses_that_generate_makes(whole: Path) -> None:
    for split, seed, count in (("train", 0, 12), ("validation", 10**9, 3), ("test", 2 * 10**9, 2)):
        made = list(generate(rooms=1, seed=seed, count=count))
        found = rows(whole, split)
        assert [row["sha256"] for row in found] == [house_sha256(house) for house in made]
        assert {(row["seed"], row["split"]) for row in found} == {(seed, split)}
    assert (manifest(whole).houses, manifest(whole).limits) == (17, 0)
    [rules] = (whole / "grammar").iterdir()
    assert {file.name for file in rules.iterdir()} >= {
        file.name for file in (SHIPPED / "family").glob("*.[lp]*")
    }


def test_houses_of_a_range_of_rooms_have_each_number_in_turn(tmp_path: Path) -> None:
    folder = tmp_path / "set"
    for shard in ("1/2", "0/2"):
        asked = ("--rooms", "1..3", "--count", 5, "--test", 4, "--shard", shard, "--out", folder)
        assert command("generate", *asked) == 0
    for split, seed, numbers in (("train", 0, [1, 2, 3, 1, 2]), ("test", 2 * 10**9, [1, 2, 3, 1])):
        found = rows(folder, split)
        assert [row["rooms"] for row in found] == numbers
        made = [next(generate(number, seed=seed, start=index)) for index, number in enumerate(numbers)]
        assert [row["sha256"] for row in found] == [house_sha256(house) for house in made]
    assert [len(house.counted) for house in HouseSet(folder, "train")] == [1, 2, 3, 1, 2]
    assert command("regenerate", folder) == 0


def test_houses_of_a_range_that_promise_different_things_are_no_set(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mine, folder = shutil.copytree(SHIPPED / "home", tmp_path / "mine"), tmp_path / "set"
    with (mine / "rooms.lp").open("a") as rules:
        rules.write("opens(kitchen,bathroom) :- rooms > 4.\n")
    asked = ("--grammar", mine, "--count", 2, "--shard", "all/1", "--out", folder)
    assert command("generate", "--rooms", "4..5", *asked) == 2
    assert "houses of mine of 4 to 5 rooms make different promises: give" in capsys.readouterr().err
    assert not folder.exists()


def test_info_tells_a_set_by_its_description_whole_or_not(whole: Path, copy: Path) -> None:
    [found] = recognised(str(whole))
    assert isinstance(found, SetOfHouses)
    of = read_set(whole)
    assert of is not None
    assert (found.whole, found.there, found.splits) == (True, found.shards, of.houses)
    assert found.checksum == HouseSet(whole).hash
    assert found.bytes == sum(path.stat().st_size for path in (whole / "data").iterdir())
    (copy / "manifest.json").unlink()
    next((copy / "data").iterdir()).unlink()
    [found] = recognised(str(copy))
    assert isinstance(found, SetOfHouses)
    assert (found.whole, found.there, found.limits, found.checksum) == (False, found.shards - 1, None, None)


def test_shards_by_themselves_in_any_order_are_the_set(whole: Path, tmp_path: Path) -> None:
    for number in (3, 0, 4, 1, 2):
        assert read_manifest(tmp_path / "set") is None
        assert made(tmp_path / "set", "--workers", 2, shard=f"{number}/5") == 0
    assert content(tmp_path / "set") == content(whole)


def test_files_of_both_formats_hold_the_same_rows(whole: Path, tmp_path: Path) -> None:
    assert made(tmp_path / "set", "--files", "jsonl") == 0
    digests = [[each.rows_sha256 for each in manifest(folder).shards] for folder in (whole, tmp_path / "set")]
    assert digests[0] == digests[1]
    assert rows(whole, "train") == rows(tmp_path / "set", "train")


def test_a_shard_that_verifies_is_skipped_and_one_that_is_gone_is_made_again(
    copy: Path, whole: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = {path: path.stat().st_mtime_ns for path in copy.rglob("*") if path.is_file()}
    assert made(copy) == 0
    assert "0 shards of 5 generated" in capsys.readouterr().err
    assert before == {path: path.stat().st_mtime_ns for path in copy.rglob("*") if path.is_file()}
    (copy / "data" / "train-00001-of-00003.parquet").unlink()
    (copy / "manifest.json").unlink()
    (copy / "data" / ".train-00001-of-00003.parquet.0123abcd").write_bytes(b"what a kill has left")
    assert made(copy) == 0
    assert content(copy) == content(whole)


@pytest.mark.parametrize("part", [b"", b"years of my own work\n"])
def test_a_shard_that_is_something_else_is_refused_and_stays(
    part: bytes, copy: Path, whole: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shard = copy / "data" / "train-00001-of-00003.parquet"
    shard.write_bytes(part or shard.read_bytes()[:-9])
    torn = content(copy)
    assert made(copy) == 2
    [line] = capsys.readouterr().err.splitlines()
    assert "train-00001-of-00003.parquet is not the shard of this set" in line
    assert content(copy) == torn
    assert made(copy, "--replace") == 0
    assert content(copy) == content(whole)


def test_a_row_that_was_changed_is_found(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert made(tmp_path, "--files", "jsonl") == 0
    shard = tmp_path / "data" / "train-00000-of-00003.jsonl"
    for column, value in (("area", 3.0), ("sha256", "0" * 64), ("seed", 1), ("verdict", "limit")):
        kept = shard.read_text()
        first, *others = kept.splitlines()
        shard.write_text("\n".join([json.dumps(json.loads(first) | {column: value}), *others]) + "\n")
        capsys.readouterr()
        assert made(tmp_path, "--files", "jsonl", shard="4/5") == 5
        assert (
            "train-00000-of-00003.jsonl: is not a shard of the set: row 0 is not the row of"
            in capsys.readouterr().err
        )
        shard.write_text(kept)


WRONG = {
    "--shard 5/5": "--shard 5/5: shards count from 0: the last one is 4/5",
    "--shard five": "--shard five: give a shard and their number, counted from 0, as in --shard 3/8 or all/8",
    "--shard 0/50": "--shard: 3 splits and 17 houses cannot be divided into 50 shards",
    "--shard 0/2": "--shard: 3 splits and 17 houses cannot be divided into 2 shards",
    "--shard 0/5 --seed 147483648": "seed must be at most 147483647, not 147483648",
    "--shard 0/5 --rooms 2": "holds a set of another request",
    "--shard 0/5 --grammar plain --rooms 4": "holds a set of another grammar (family, not plain)",
    "--shard 0/5 --seed 1": "holds a set of another seed (0, not 1)",
    "--shard 0/6": "holds a set of another shards (5, not 6)",
    "--shard 0/5 --count 13": "holds a set of another houses",
    "--shard 0/5 --nearest": "--shard: a set has one request: leave out --nearest",
    "--shard 0/5 --out -": "--shard: a set is a folder: name it with --out",
}


@pytest.mark.parametrize("words", WRONG)
def test_what_is_no_shard_of_the_set_is_one_line_and_nothing_is_lost(
    words: str, copy: Path, whole: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert made(copy, *words.split()) == 2
    [line] = capsys.readouterr().err.splitlines()
    assert WRONG[words] in line
    assert content(copy) == content(whole)


def test_a_house_that_ends_in_a_limit_is_a_row_that_says_so(
    tmp_path: Path, whole: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every third house reaches a limit; at the fifth a solver process is killed, twice."""
    kills = [0, 0]

    def disturbed(
        request: HouseRequest, seed: int, indices: range, workers: int = 1
    ) -> Iterator[House | LimitReached]:
        for index, outcome in zip(indices, outcomes(request, seed, indices, workers), strict=True):
            if index == 4 and kills:
                kills.pop()
                yield Killed("another process killed a solver process")
            elif index % 3 == 2:
                yield LimitReached(
                    f"house {index} reached its limit of 9 inferences: say so. The last step was 7."
                )
            else:
                yield outcome

    monkeypatch.setattr(shards, "outcomes", disturbed)
    assert made(tmp_path) == 0
    assert not kills
    assert (manifest(tmp_path).houses, manifest(tmp_path).limits) == (12, 5)
    plain = rows(whole, "train")
    for place, row in enumerate(rows(tmp_path, "train")):
        if place % 3 == 2:
            why = f"house {place} reached its limit of 9 inferences: say so"
            empty = dict.fromkeys(("types", "area", "sha256", "house"))
            assert row == plain[place] | empty | {"verdict": "limit", "why": why}
        else:
            assert row == plain[place]
    assert made(tmp_path) == 0


def test_limits_are_those_that_are_stated(tmp_path: Path) -> None:
    assert made(tmp_path, "--inferences", 1, "--workers", 2, shard="4/5") == 0
    found = list(read(tmp_path / "data" / "test-00000-of-00001.parquet"))
    assert [(row["verdict"], row["why"]) for row in found] == [
        ("limit", f"house {index} reached its limit of 1 inferences: raise it with --inferences")
        for index in range(2)
    ]


def test_a_solver_that_is_killed_each_time_ends_the_shard_and_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(
        shards, "outcomes", lambda *_: iter([Killed("another process killed a solver process")])
    )
    assert made(tmp_path) == 4
    assert capsys.readouterr().err == "error: another process killed a solver process\n"
    assert not list((tmp_path / "data").iterdir())


@pytest.mark.parametrize("files", ["parquet", "jsonl"])
def test_a_full_disk_ends_it_in_one_line_and_leaves_no_half_of_a_shard(files: str, tmp_path: Path) -> None:
    """The limit on the size of files is below the size of the shard."""
    words = ("generate --rooms 9 --grammar family --count 12 --shard all/2 --out set --files", files)
    program = f'ulimit -f {16 if files == "parquet" else 32}; exec "$@"'
    ended = finished(
        ["bash", "-c", program, "bash", sys.executable, "-m", "vitruvius.cli", *" ".join(words).split()],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(Path(__file__).parents[3])},
    )
    [line] = ended.stderr.splitlines()
    assert ended.returncode == 5
    assert line.startswith("error: ")
    assert line.endswith(f"train-00000-of-00002.{files}: File too large")
    assert not list((tmp_path / "set" / "data").iterdir())


def test_the_rules_of_a_user_travel_with_the_set(tmp_path: Path) -> None:
    mine = shutil.copytree(SHIPPED / "family", tmp_path / "mine")
    (mine / "sizes.pl").write_text(
        (mine / "sizes.pl").read_text().replace("passage(0.42).", "passage(0.43).")
    )
    assert made(tmp_path / "set", "--grammar", mine, shard="4/5") == 0
    of = read_set(tmp_path / "set")
    assert of
    shutil.rmtree(mine)
    assert of.rules(tmp_path / "set").directory == tmp_path / "set" / "grammar" / "mine"


@pytest.mark.second_part("several processes")
def test_shards_that_begin_at_once_make_one_set(tmp_path: Path) -> None:
    """A Slurm array starts shards like this. No shard mistakes another's beginning for something else."""
    words = "generate --rooms 1 --count 3 --files jsonl --shard {}/3 --out {}"
    folder = tmp_path / "set"
    started = [
        subprocess.Popen(
            [sys.executable, "-m", "vitruvius.cli", *words.format(shard, folder).split()],
            cwd=Path(__file__).parents[3],
            stderr=subprocess.PIPE,
            text=True,
        )
        for shard in range(3)
    ]
    said = [process.communicate(timeout=PATIENCE)[1] for process in started]
    assert [process.returncode for process in started] == [0] * 3, said
    assert read_manifest(folder) is not None
