"""Mistakes in rule files that clingo and SWI-Prolog pass over: each is found, by file, line and column."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from logic import GrammarError, generate, lint
from logic.grammar import SHIPPED, shipped

BATHROOM = "room_size(bathroom, W, D) :- { W >= 2.4, W =< 3.7, D >= 2.4, D =< 3.7 }."
# What is edited, what it becomes, and what lint says: severity, words. The place is that of the edited line.
MISTAKES = {
    "a type without size": (
        "rooms.lp",
        "kitchen; hall)",
        "kitchen; hall; attic). may(attic,bed,1,1)",
        "error",
        "room_size/3 has no clause for attic",
    ),
    "a size without type": (
        "sizes.pl",
        BATHROOM,
        BATHROOM + " room_size(attic, 3, 3).",
        "error",
        "attic is no room type",
    ),
    "a piece size without piece": (
        "sizes.pl",
        BATHROOM,
        BATHROOM + " piece_size(lamp, 0.3, 0.3, _).",
        "error",
        "lamp is no piece in any room",
    ),
    "a syntax error in Prolog": (
        "sizes.pl",
        "D >= 2.4, D =< 3.7",
        "D >= 2.4 D =< 3.7",
        "error",
        "operator_expected",
    ),
    "an undefined predicate in Prolog": (
        "sizes.pl",
        BATHROOM,
        "room_size(bathroom, W, D) :- squre(W, D).",
        "error",
        "there is no predicate squre/2",
    ),
    "an unused predicate in Prolog": (
        "sizes.pl",
        "room_gap(0.6).",
        "room_gab(0.6).",
        "error",
        "nothing uses room_gab/1: did you mean room_gap/1?",
    ),
    "a directive": (
        "sizes.pl",
        "passage(0.42).",
        ":- initialization(halt). passage(0.42).",
        "error",
        "a directive runs code",
    ),
    "code in a clause": (
        "sizes.pl",
        BATHROOM,
        "room_size(bathroom, 3.0, 3.0) :- shell(ls).",
        "error",
        "shell/1 runs code",
    ),
    "an expansion": (
        "sizes.pl",
        BATHROOM,
        "term_expansion(a, b). " + BATHROOM,
        "error",
        "nothing uses term_expansion/2",
    ),
    "a choice point": (
        "sizes.pl",
        BATHROOM,
        BATHROOM + " room_size(bathroom, 3.0, 3.0).",
        "error",
        "more than one solution",
    ),
    "a nonlinear constraint": (
        "sizes.pl",
        BATHROOM,
        "room_size(bathroom, W, D) :- { W >= 2.4, W =< 3.7, D = W*W }.",
        "error",
        "nonlinear",
    ),
    "no bound": (
        "sizes.pl",
        BATHROOM,
        "room_size(bathroom, W, D) :- { W >= 2.4, D = W }.",
        "error",
        "not bounded",
    ),
    "a size below zero": (
        "sizes.pl",
        BATHROOM,
        "room_size(bathroom, W, D) :- { W >= -2.4, W =< 3.7, D = 3 }.",
        "error",
        "not positive",
    ),
    "a singleton variable": (
        "sizes.pl",
        BATHROOM,
        "room_size(bathroom, W, D) :- { W >= 2.4, W =< 3.7, D = 3, X >= 1 }.",
        "error",
        "ingleton",
    ),
}


@pytest.mark.parametrize("mistake", MISTAKES, ids=lambda name: name.replace(" ", "-"))
def test_a_mistake_is_found_at_its_place(mistake: str, tmp_path: Path) -> None:
    file, old, new, severity, words = MISTAKES[mistake]
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / "family", folder)
    text = (folder / file).read_text()
    assert old in text
    (folder / file).write_text(text.replace(old, new, 1))
    findings = lint(folder)
    found = [finding for finding in findings if words in finding.text]
    assert found, findings
    assert found[0].severity == severity
    if "has no clause" not in words:  # That is nowhere.
        line = text[: text.index(old)].count("\n") + 1
        assert Path(found[0].file).name == file
        assert line <= found[0].line <= line + new.count("\n")
        assert found[0].column >= 1
    if severity == "error":
        with pytest.raises(GrammarError) as caught:
            next(generate(rooms=3, grammar=folder))
        assert caught.value.message in {finding.text for finding in findings}


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
