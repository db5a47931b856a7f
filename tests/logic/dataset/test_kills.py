"""A set that is generated under kills has the same bytes as an undisturbed one."""

import random
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.logic.dataset.sets import content
from tests.programs import PATIENCE
from vitruvius.logic.dataset.sets import read_manifest

pytestmark = pytest.mark.second_part("sets are made under kills")

ROOT = Path(__file__).parents[3]

SET = "generate --rooms 1 --count 200 --validation 20 --test 20 --shard all/12 --workers 2"

KILLS = 2


def start(folder: Path) -> subprocess.Popen[bytes]:
    """Start the command."""
    command = [sys.executable, "-m", "vitruvius.cli", *SET.split(), "--out", str(folder)]
    return subprocess.Popen(command, cwd=ROOT, stderr=subprocess.DEVNULL)


def test_a_set_that_is_killed_at_any_time_ends_in_the_same_bytes(tmp_path: Path) -> None:
    undisturbed, folder = tmp_path / "undisturbed", tmp_path / "killed"
    began = time.monotonic()
    assert start(undisturbed).wait(PATIENCE) == 0
    takes, chance, kills = time.monotonic() - began, random.Random(46), 0
    while kills < KILLS and read_manifest(folder) is None:
        process = start(folder)
        time.sleep(chance.uniform(0.1, 0.7) * takes)
        kills += process.poll() is None
        process.kill()
        process.wait()
    assert kills
    assert start(folder).wait(PATIENCE) == 0
    assert content(folder) == content(undisturbed)


def test_shards_that_begin_at_once_make_one_set(tmp_path: Path) -> None:
    """A Slurm array starts shards like this. No shard mistakes another's beginning for something else."""
    words = "generate --rooms 1 --count 6 --files jsonl --shard {}/6 --out {}"
    folder = tmp_path / "set"
    started = [
        subprocess.Popen(
            [sys.executable, "-m", "vitruvius.cli", *words.format(shard, folder).split()],
            cwd=ROOT,
            stderr=subprocess.PIPE,
            text=True,
        )
        for shard in range(6)
    ]
    said = [process.communicate(timeout=PATIENCE)[1] for process in started]
    assert [process.returncode for process in started] == [0] * 6, said
    assert read_manifest(folder) is not None
