"""A killed command leaves whole files or none; readers notice torn files."""

import subprocess
import sys
from pathlib import Path

import msgspec
import pytest

from benchmarks.reliability import kills
from tests.logic.workers import in_process
from vitruvius.logic import save
from vitruvius.logic.errors import RequestError

ROOT = Path(__file__).parents[2]


@pytest.mark.second_part("commands are killed at many times")
def test_no_kill_tears_a_file(tmp_path: Path) -> None:
    """Two processes of each command are killed: at a random moment, and as the first new file appears."""
    # A process of its own, as it forks and this one may have started Taichi.
    command = [sys.executable, "-P", "-m", "vitruvius.cli", "bench", "kills", "--kills", "2"]
    subprocess.run([*command, "--out", tmp_path / "kills"], cwd=ROOT, check=True, timeout=600)
    done = msgspec.json.decode(
        (tmp_path / "kills" / "kills.json").read_bytes(), type=dict[str, list[kills.Kill]]
    )
    assert set(done) == set(kills.COMMANDS)
    assert not all(each.ended for found in done.values() for each in found)


def test_a_command_that_the_study_does_not_have_is_refused() -> None:
    with pytest.raises(RequestError, match="--commands evaluat: unknown command: choose from convert, "):
        kills.Kills(commands=("evaluat",)).run()


@pytest.mark.parametrize("part", [0.1, 0.5, 0.99])
def test_a_file_that_is_cut_short_is_noticed(part: float, tmp_path: Path) -> None:
    for name in ("houses.jsonl", "houses.jsonl.gz"):
        save(in_process.generate(2, count=2), tmp_path / name)
    (tmp_path / "report.html").write_text("<html></html>")
    (tmp_path / ".report.html.0123abcd").write_text("<html>")
    found = dict(kills.read_back(tmp_path))
    assert set(found.values()) == {""}
    for path in found:
        content = path.read_bytes()
        path.write_bytes(content[: int(part * len(content))])
    assert all(why for _, why in kills.read_back(tmp_path))
