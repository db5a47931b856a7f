"""Command line for people, shells and programs: help, completion, answers as JSON, progress."""

import contextlib
import io
import json
import os
import pkgutil
import re
import shlex
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import tyro

from benchmarks import GROUPS as STUDY_GROUPS
from benchmarks import STUDIES
from benchmarks.page import page as studies_page
from tests.programs import finished
from vitruvius import page, studies
from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.agent.progress import progress as agent_progress
from vitruvius.answers.agents import ANSWERS
from vitruvius.cli import COMMANDS, GROUPS, command_help, main
from vitruvius.commands.train import Train
from vitruvius.help import grouped
from vitruvius.logic import generate, save
from vitruvius.logic.terminal import progress
from vitruvius.options import options_of

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
Answered = Callable[[str], dict[str, Any]]
WORDS = [*([name] for name in COMMANDS if name != "bench"), *(["bench", name] for name in STUDIES)]


def classes() -> Iterator[tuple[list[str], Any]]:
    """Yield all commands, with their classes; train once for each preset."""
    for words in WORDS:
        kind = pkgutil.resolve_name((STUDIES if len(words) > 1 else COMMANDS)[words[-1]][0])
        if words == ["train"]:
            yield from (([*words, "--preset", preset], kind.like(["--preset", preset])) for preset in PRESETS)
        else:
            yield words, kind


def test_options_of_help_are_those_that_tyro_takes() -> None:
    for words, command in classes():
        is_train, shown = words[0] == "train", io.StringIO()
        kind: Any = Train[type(command.learning)] if is_train else command
        with contextlib.redirect_stdout(shown), pytest.raises(SystemExit):
            tyro.cli(kind, args=["--help"], default=command if is_train else tyro.MISSING)
        listed = re.findall(r"^  (--[\w-]+)", shown.getvalue(), re.MULTILINE)
        ours = {option.flag for option in options_of(command) if not option.positional}
        assert ours == set(listed), words


def test_help_lists_each_command_in_one_group_and_each_option_with_its_sentence() -> None:
    for table, groups in ((COMMANDS, GROUPS), (STUDIES, STUDY_GROUPS)):
        members = grouped(table, groups)
        assert [name for names in members.values() for name in names] == list(table)
        assert list(members) == list(groups.values())
    for words, command in classes():
        text = command_help(words[:1] if words[0] == "train" else words, words[1:])
        joined = " ".join(text.split())
        for option in options_of(command):
            assert (option.metavar.strip("[]") if option.positional else option.flag[2:]) in joined
            assert option.help.strip(), (words, option.name)
            assert option.help in joined
        assert max(map(len, text.splitlines())) <= 80, words


def test_the_page_of_the_command_line_is_of_today() -> None:
    assert (DOCS / "command-line.md").read_text() == page.page(), (
        "./run python -m vitruvius.page > docs/command-line.md"
    )
    assert (DOCS / "studies.md").read_text() == studies_page(), (
        "./run python -m benchmarks.page > docs/studies.md"
    )


@pytest.mark.parametrize("words", ["bench", "bench --help", "bench homes --out mine"])
def test_without_a_checkout_there_are_no_studies(words: str, tmp_path: Path, monkeypatch, capsys) -> None:
    """Nor where another package of their name is found first."""
    folder = studies.FOLDER
    for place, said in ((tmp_path / "benchmarks", "checkout"), (folder, f"hides the studies in {folder}")):
        monkeypatch.setattr(studies, "FOLDER", place)
        with pytest.raises(SystemExit) as ended:
            main(words.split())
        assert ended.value.code == 69
        [line] = capsys.readouterr().err.splitlines()
        assert said in line
        monkeypatch.setattr(studies, "find_spec", lambda _: None)


# - answers for programs ---------------------------------------------------------------------------


@pytest.fixture(scope="module")
def validator() -> Any:
    return jsonschema.Draft202012Validator(json.loads((DOCS / "answers.schema.json").read_text()))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("houses")
    save(generate(rooms=2, count=2), made / "houses.jsonl")
    return made


@pytest.fixture
def answered(
    validator: Any, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Answered:
    """Return a function that runs a command with --json, checks the answer's form, and returns it."""

    def run(words: str) -> dict[str, Any]:
        monkeypatch.chdir(folder)
        with pytest.raises(SystemExit) as ended:
            main([*shlex.split(words), "--json"])
        [line] = capsys.readouterr().out.splitlines()
        found = json.loads(line)
        validator.validate(found)
        assert list(found) == ["format", "command", "exit_code", "answer", "error"]
        assert found["exit_code"] == (ended.value.code or 0)
        assert (found["answer"] is None) != (found["error"] is None)
        return found

    return run


def test_the_published_schema_of_answers_is_that_of_their_types(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["schema", "--answers"])
    published = (DOCS / "answers.schema.json").read_text()
    assert published == capsys.readouterr().out, "./run schema --answers > docs/answers.schema.json"


@pytest.mark.parametrize(
    ("words", "code"),
    [
        ("generate --rooms 2 --count 2", 0),
        ("generate --rooms 2 --out made.jsonl", 0),
        ("generate --rooms 1 --count-layouts --seconds 0.2", 4),
        ("check houses.jsonl", 0),
        ("draw houses.jsonl --out plans", 0),
        ("convert houses.jsonl --out new.jsonl", 0),
        ("convert houses.jsonl --out maps --to geojson", 0),
        ("lint family", 0),
        ("explain --rooms 3 --type kitchen=0", 0),
        ("explain --rooms 3", 1),
        ("info houses.jsonl", 0),
        ("info paper", 0),
        ("info test-v1", 0),
    ],
)
def test_each_answer_is_as_the_schema_says(answered: Answered, words: str, code: int) -> None:
    found = answered(words)
    assert (found["command"], found["exit_code"], found["error"]) == (words.split(maxsplit=1)[0], code, None)


def test_the_schema_s_answers_are_told_apart_by_their_command(validator: Any, answered: Any) -> None:
    found = answered("check houses.jsonl")
    for change in (
        {"command": "lint"},
        {"answer": None},
        {"exit_code": "0"},
        {"format": "vitruvius-answer-0"},
    ):
        assert not validator.is_valid(found | change), change
    del found["answer"]["nonconforming"]
    assert not validator.is_valid(found)


@pytest.mark.parametrize(
    ("words", "code", "kind"),
    [
        ("check absent.jsonl", 5, "HouseFileError"),
        ("check", 2, "RequestError"),
        ("chekc houses.jsonl", 2, "RequestError"),
        ("generate --rooms many", 2, "RequestError"),
        ("generate --rooms 3 --type kitchen=0", 3, "Unsatisfiable"),
        ("generate --rooms 9 --inferences 1000", 4, "LimitReached"),
        ("lint clinc", 5, "GrammarError"),
        ("info nothing", 5, "UnknownFileError"),
        ("evaluate pqnmap", 5, "CheckpointError"),
        ("train --steps 0", 2, "RequestError"),
    ],
)
def test_an_error_is_an_answer_too(answered: Answered, words: str, code: int, kind: str) -> None:
    found = answered(words)
    assert (found["exit_code"], found["error"]["kind"], found["answer"]) == (code, kind, None)
    assert found["error"]["message"]
    if kind == "Unsatisfiable":
        assert [reason["line"] for reason in found["error"]["reasons"]] == [None, 4, 10, None]


def test_every_command_with_json_has_a_documented_answer() -> None:
    with_json = {
        words[0] for words, command in classes() for option in options_of(command) if option.name == "json"
    }
    assert with_json == set(ANSWERS)


# - completion -------------------------------------------------------------------------------------

COMPLETED = {
    "vitruvius gen": "generate",
    "vitruvius generate --gram": "--grammar",
    "vitruvius train --preset pqn": "pqn pqn-free pqn-recurrent",
    "vitruvius convert houses.jsonl --to gl": "gltf",
}
"""Lines up to the cursor, and the words that may follow."""

BASH = """
source /dev/stdin <<< "$SCRIPT"
while IFS= read -r line; do
    read -ra COMP_WORDS <<< "$line"
    COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
    _tyro_vitruvius
    echo "${COMPREPLY[*]}"
done <<< "$LINES_TO_COMPLETE"
"""


def script(shell: str, capsys: pytest.CaptureFixture[str]) -> str:
    with pytest.raises(SystemExit):
        main(["completion", shell])
    return capsys.readouterr().out


def completed(shell: str, code: str, script: str, cwd: Path) -> list[str]:
    """Return what a shell that has the script prints; code is in the shell's language."""
    known = {"SCRIPT": script, "LINES_TO_COMPLETE": "\n".join(COMPLETED), "PATH": os.environ["PATH"]}
    done = finished([shell, *code.split("\0")], cwd=cwd, env=known | {"HOME": str(cwd)})
    assert done.stderr == ""
    return done.stdout.splitlines()


def test_bash_completes_commands_options_and_values(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = completed("bash", f"--norc\0-c\0{BASH}", script("bash", capsys), folder)
    assert dict(zip(COMPLETED, found, strict=True)) == COMPLETED


if shutil.which("zsh"):

    def test_zsh_reads_its_script(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
        (folder / "_vitruvius").write_text(script("zsh", capsys))
        code = "fpath=(. $fpath); autoload -U compinit; compinit -u -D; echo $_comps[vitruvius]"
        assert completed("zsh", f"-f\0-c\0{code}", "", folder) == ["_vitruvius"]


@pytest.mark.parametrize("words", ["--help", "completion bash", "bench --help", "info pqn"])
def test_help_completion_and_info_import_neither_torch_nor_taichi(words: str) -> None:
    code = (
        "import sys; from vitruvius.cli import main\ntry: main(sys.argv[1:])\nexcept SystemExit: pass\n"
        "print('imported', *({'torch', 'taichi', 'gymnasium', 'scipy'} & set(sys.modules)))"
    )
    command = [sys.executable, "-c", code, *words.split()]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "imported"


# - the terminal -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "code", "shown"),
    [
        ([], 0, "usage: vitruvius COMMAND"),
        (["help"], 0, "usage: vitruvius COMMAND"),
        (["bench"], 0, "usage: vitruvius bench COMMAND"),
        (["help", "check"], 0, "usage: vitruvius check FILE"),
        (["help", "help"], 0, "usage: vitruvius COMMAND"),
        (["bench", "help"], 0, "usage: vitruvius bench COMMAND"),
        (["bench", "help", "homes"], 0, "usage: vitruvius bench homes"),
        (["train", "--preset", "dqn", "-h"], 0, "--buffer-size"),
        (["--version"], 0, "vitruvius "),
    ],
)
def test_help_and_version_come_by_any_of_their_names(
    words: list[str], code: int, shown: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        main(words)
    assert (ended.value.code or 0) == code
    assert shown in capsys.readouterr().out


def test_headings_are_bold_on_a_terminal_alone_and_not_where_no_colour_is_wanted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert "\x1b" not in command_help(["check"])
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv("NO_COLOR", raising=False)
    assert "\x1b[1mOptions\x1b[0m" in command_help(["check"])
    monkeypatch.setenv("NO_COLOR", "1")
    assert "\x1b" not in command_help(["check"])


def test_on_a_terminal_work_shows_its_rate_and_the_time_that_is_left(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    assert len(list(progress((time.sleep(0.15) for _ in range(4)), 4, "houses"))) == 4
    assert re.search(r"houses: +75%.*00:00, +\d\.\d\d houses/s", capsys.readouterr().err)
    monkeypatch.setenv("TTY_COMPATIBLE", "1")
    with agent_progress("training") as report:
        report(0.5, "0.10 M steps")
    assert re.search(r"training.*50%.*left.*0.10 M steps", capsys.readouterr().err)
    monkeypatch.setattr(sys.stderr, "isatty", lambda: False)
    monkeypatch.setenv("FORCE_COLOR", "1")  # as in notebooks and on CI servers
    with agent_progress("training") as report:
        report(0.5, "0.10 M steps")
    assert (list(progress([1], 1, "houses")), capsys.readouterr().err) == ([1], "")
