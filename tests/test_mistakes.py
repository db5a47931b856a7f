"""Wrong requests, calls and commands get an immediate answer that states the mistake and what to do."""

import shlex
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.logic.language.mistakes import calls, requests
from tests.logic.language.mistakes.calls import Call
from tests.logic.language.mistakes.requests import Command
from vitruvius.cli import main
from vitruvius.logic import generate, save


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder in which the commands run."""
    made = tmp_path_factory.mktemp("mistakes")
    save(generate(rooms=2), made / "houses.jsonl")
    (made / "runs/mine").mkdir(parents=True)
    (made / "runs/mine/agent.safetensors").touch()
    return made


@contextmanager
def within_two_seconds() -> Iterator[None]:
    """Fail if the block takes two seconds of this process's CPU time or more."""
    began = time.process_time()
    yield
    assert time.process_time() - began < 2


@pytest.mark.parametrize("mistake", requests.MISTAKES, ids=lambda mistake: mistake.words)
def test_a_wrong_command_says_what_is_wrong_and_what_to_do(
    mistake: Command, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(folder)
    before = sorted(folder.rglob("*"))
    with within_two_seconds(), pytest.raises(SystemExit) as ended:
        main(shlex.split(mistake.words, posix="'" not in mistake.words and '"' not in mistake.words))
    said = capsys.readouterr().err
    assert ended.value.code == mistake.code, said
    assert said.startswith("error: ")
    assert len(said.splitlines()) == 1
    assert all(words in said for words in mistake.says), said
    assert sorted(folder.rglob("*")) == before


@pytest.mark.parametrize(
    "mistake", calls.MISTAKES, ids=lambda mistake: f"{mistake.call.__name__} {' '.join(mistake.given)}"
)
def test_a_wrong_call_says_what_is_wrong_and_what_to_do(
    mistake: Call, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(folder)
    with within_two_seconds(), pytest.raises(mistake.error) as error:
        mistake.call(**mistake.given)
    assert all(words in str(error.value) for words in mistake.says), str(error.value)
