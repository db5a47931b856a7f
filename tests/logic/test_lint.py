"""Mistakes in rule files that clingo and SWI-Prolog pass over: each is found, by file, line and column."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from logic import GrammarError, generate, lint
from logic.grammar import SHIPPED, shipped


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("room_gap(0.6).", "room_gab(0.6)."),
        ("W >= 2.4, W =< 3.7", "W >= 3.8, W =< 3.7"),
        ("room_size(bathroom,", "room_size(bathrom,"),
    ],
    ids=["as-written", "as-solved", "as-used"],
)
def test_generate_refuses_what_lint_calls_an_error(old: str, new: str, tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / "family", folder)
    text = (folder / "sizes.pl").read_text()
    assert text.count(old) == 1
    (folder / "sizes.pl").write_text(text.replace(old, new))
    with pytest.raises(GrammarError) as caught:
        next(generate(rooms=3, grammar=folder))
    assert caught.value.message == lint(folder)[0].text


@pytest.mark.parametrize("grammar", shipped())
def test_the_shipped_grammars_are_clean(grammar: str) -> None:
    assert lint(grammar) == []


def test_all_mistakes_are_listed_not_just_the_first(tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / "family", folder)
    with (folder / "furniture.lp").open("a") as rules:
        rules.write("may(attic,bed,1,1).\nmay(cellar,bed,1,1).\n")
    assert sum("no room type has this name" in finding.text for finding in lint(folder)) == 2


def test_nothing_of_a_refused_grammar_is_run(tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / "family", folder)
    with (folder / "sizes.pl").open("a") as rules:
        rules.write(f"\n:- open('{tmp_path}/trace', write, S), close(S).\n")
    assert [finding.severity for finding in lint(folder)] == ["error"]
    assert not (tmp_path / "trace").exists()


def test_the_lint_command_prints_each_finding_on_a_line(tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / "family", folder)
    (folder / "sizes.pl").write_text((folder / "sizes.pl").read_text().replace("room_gap", "room_gab"))
    command = [sys.executable, "-m", "agent.cli", "lint"]
    ended = subprocess.run([*command, folder], capture_output=True, text=True, check=False)
    assert ended.returncode == 1
    assert "sizes.pl:7:1: error: nothing uses room_gab/1: did you mean room_gap/1?" in ended.stdout
    ended = subprocess.run([*command, folder, "--json"], capture_output=True, text=True, check=False)
    assert json.loads(ended.stdout.splitlines()[0])["line"] == 7
    assert subprocess.run([*command, "clinic"], capture_output=True, check=False).returncode == 0
    assert subprocess.run([*command, "nowhere"], capture_output=True, check=False).returncode == 5
