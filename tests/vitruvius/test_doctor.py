"""Commands on a machine without SWI-Prolog, and ``vitruvius doctor`` there and here."""

import json
from pathlib import Path

import pytest

from vitruvius.cli import main
from vitruvius.logic.installation import prolog_command
from vitruvius.logic.workers import pool

ROOT = Path(__file__).parents[2]
HOUSES = ROOT / "tests/fixtures/houses.jsonl"


def ended(words: str, capsys: pytest.CaptureFixture[str]) -> tuple[int, str, str]:
    """Return the exit code of a command, its output and its errors."""
    with pytest.raises(SystemExit) as end:
        main(words.split())
    out, err = capsys.readouterr()
    return int(end.value.code or 0), out, err


@pytest.fixture
def no_prolog(monkeypatch: pytest.MonkeyPatch) -> None:
    """Hide SWI-Prolog from solver processes: pyswip takes these paths unseen."""
    monkeypatch.setenv("LIBSWIPL_PATH", "/nowhere/libswipl.so")
    monkeypatch.setenv("SWI_HOME_DIR", "/nowhere")
    monkeypatch.setattr(pool, "_idle", pool.Idle())  # solver processes of earlier tests have SWI-Prolog


@pytest.mark.usefixtures("no_prolog")
def test_without_prolog_commands_that_need_none_work_and_the_others_print_its_command(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for command in ("check FILE", "draw FILE", "info FILE", "convert FILE --to ros --out maps"):
        words = command.replace("FILE", str(HOUSES))
        assert ended(words, capsys)[0] == 0, words
    for words in ("generate --rooms 1", "explain --rooms 1", "lint home", "watch home"):
        code, _, said = ended(words, capsys)
        assert (code, said.count("\n")) == (69, 1), (words, said)
        assert said.startswith("error: SWI-Prolog cannot be used (")
        assert said.endswith(f": {prolog_command()}\n")


@pytest.mark.usefixtures("no_prolog")
def test_the_doctor_names_the_missing_program_and_its_command(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = ended("doctor", capsys)
    [line] = [line for line in out.splitlines() if line.startswith("missing")]
    assert (code, line.endswith(prolog_command())) == (69, True)


def test_the_doctor_finds_all_that_generation_needs(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = ended("doctor --json", capsys)
    found = {each["part"]: each for each in json.loads(out)["answer"]["found"]}
    assert (code, found["swi-prolog"]["status"], found["clingo"]["status"]) == (0, "ok", "ok")
    assert found["swi-prolog"]["text"].startswith("9.")
