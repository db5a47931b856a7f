"""Help explains the use of a script, and starts nothing."""

import runpy
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from unittest.mock import MagicMock

import pytest

from benchmarks import STUDIES
from vitruvius.cli import COMMANDS, main

pytestmark = pytest.mark.second_part("each study is run in small")

ROOT = Path(__file__).parents[2]
PEERS = ROOT / "benchmarks" / "simulator" / "peers"
ABSENT = "irsim", "jax", "jaxmarl", "minigrid", "navix", "vmas", "xminigrid"
"""Libraries of peers that are not installed here. A stub allows any import from them, and does nothing."""

SCRIPTS = [
    *(
        path
        for path in sorted((ROOT / "benchmarks").rglob("*.py"))
        if 'if __name__ == "__main__"' in path.read_text()
    ),
]


@pytest.fixture
def peers(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Install stubs for the libraries of peers, and allow imports from their scripts' folder."""
    known = set(sys.modules)
    lines = "\n".join(path.read_text() for path in PEERS.glob("*.py")).splitlines()
    for name in {line.split()[1] for line in lines if line.startswith(("import ", "from "))}:
        if name.partition(".")[0] in ABSENT:
            parts = name.split(".")
            for end in range(1, len(parts) + 1):
                monkeypatch.setitem(
                    sys.modules, ".".join(parts[:end]), MagicMock(**{"make.return_value": (None, None)})
                )
    monkeypatch.syspath_prepend(str(PEERS))
    yield
    for name in {"house", "rounds"} - known:
        sys.modules.pop(name, None)


@pytest.mark.usefixtures("peers")
@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_the_help_of_a_script_starts_nothing(
    script: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", [str(script), "--help"])
    began = time.process_time()
    with pytest.raises(SystemExit) as done:
        runpy.run_path(str(script), run_name="__main__")
    assert not done.value.code
    assert time.process_time() - began < 10  # some import torch first
    assert capsys.readouterr().out.startswith("usage: ")


@pytest.mark.parametrize(
    "words", [*([name] for name in COMMANDS), *(["bench", name] for name in STUDIES)], ids=" ".join
)
def test_the_help_of_a_command_starts_nothing(
    words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    began = time.process_time()
    with pytest.raises(SystemExit) as done:
        main([*words, "--help"])
    assert not done.value.code
    assert f"usage: vitruvius {' '.join(words)}" in capsys.readouterr().out
    assert time.process_time() - began < 10
    assert not list(tmp_path.iterdir())
