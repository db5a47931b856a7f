"""Streams of commands besides their answers: ``-``, folders, and files that exist already."""

import gzip
import json
import os
import shlex
import sys
import warnings
from collections.abc import Callable
from pathlib import Path

import pytest

from vitruvius.cli import main
from vitruvius.logic import House, load, save
from vitruvius.logic.exports import FORMATS

FIXTURES = Path(__file__).parents[2] / "fixtures"
PLANS = FIXTURES / "plans.jsonl"
Command = Callable[..., tuple[int, str, str]]

pytestmark = pytest.mark.usefixtures("solved_here")


@pytest.fixture
def command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Command:
    """Return a function that runs a command in a folder of its own.

    It returns the exit code and the printed text. ``given`` is the command's standard input.
    """
    monkeypatch.chdir(tmp_path)

    def run(*words: str, given: bytes = b"") -> tuple[int, str, str]:
        (tmp_path / ".given").write_bytes(given)
        with (tmp_path / ".given").open() as file:
            monkeypatch.setattr(sys, "stdin", file)
            # Python shows a warning once, but each command must show its own.
            with warnings.catch_warnings(), pytest.raises(SystemExit) as ended:
                main(list(words))
        assert isinstance(ended.value.code, int)
        printed = capsys.readouterr()
        return ended.value.code, printed.out, printed.err

    return run


@pytest.mark.parametrize("packed", [False, True], ids=["plain", "gzip"])
@pytest.mark.parametrize(
    "words",
    ["check -", "draw - --out plans", "convert - --out new.jsonl", "info -", "draw - --diff FILE --out d"],
)
def test_a_dash_is_the_standard_input(words: str, packed: bool, command: Command) -> None:
    content = PLANS.read_bytes()
    given = gzip.compress(content) if packed else content
    code, out, err = command(*words.replace("FILE", str(PLANS)).split(), given=given)
    assert code == 0, err
    assert any(words in out + err for words in ("3 checked", "3 plans", "3 converted", "3\n", "diff-2"))


@pytest.mark.parametrize("packed", [False, True], ids=["plain", "gzip"])
@pytest.mark.parametrize("plan", ["GeoJSON", "a house"])
def test_a_plan_comes_by_the_standard_input_too(plan: str, packed: bool, command: Command) -> None:
    """Answers equal those for the same plan in a file. Typical sizes of homes give way to the house's."""
    content = (
        (FIXTURES / "plan.geojson").read_bytes()
        if plan == "GeoJSON"
        else json.dumps(load(PLANS)[0].to_dict()).encode()
    )
    given = gzip.compress(content) if packed else content
    words = ["generate", "--grammar", "home", "--out", "-"]
    code, out, err = command(*words, "--plan", "-", given=given)
    Path("plan.json").write_bytes(content)
    assert (code, out, err) == command(*words, "--plan", "plan.json")
    assert code == 0
    assert ("a typical rule gives way to the plan" in err) == (plan == "a house")


def test_a_dash_is_the_standard_output(command: Command) -> None:
    code, out, _ = command("generate", "--rooms", "1", "--out", "-")
    assert code == 0
    assert House.from_dict(json.loads(out)).counted
    assert not Path("-").exists()


def test_an_empty_standard_input_holds_no_house(command: Command) -> None:
    code, _, err = command("check", "-")
    assert (code, "-: holds no house" in err) == (5, True)


def test_a_packed_file_is_read_whatever_its_name(tmp_path: Path) -> None:
    (tmp_path / "mine.jsonl").write_bytes(gzip.compress(PLANS.read_bytes()))
    assert load(tmp_path / "mine.jsonl") == load(PLANS)


@pytest.mark.parametrize("words", ["check mine", "draw mine", "convert mine --out a.jsonl", "draw home"])
def test_a_grammar_in_the_place_of_a_house_file_is_named_with_the_command_that_makes_houses(
    words: str, command: Command
) -> None:
    Path("mine").mkdir()
    Path("mine/rooms.lp").write_text("type(a).")
    code, _, err = command(*words.split())
    name = words.split()[1]
    assert code == 5
    assert f"{name}: is a grammar" in err
    assert f"vitruvius generate --grammar {name} --rooms 6 --out houses.jsonl" in err


NAMED = "a b/it's mine.jsonl"

HINTS = {
    "generate --rooms 1 --out FILE": "vitruvius draw FILE",
    "check FILE": "vitruvius generate --rooms 4 --out FILE",
    "check FILE.json": "vitruvius generate --rooms 4 --count 100 --out FILE.json",
    "draw FILE/rules": "vitruvius generate --grammar FILE/rules --rooms 6 --out houses.jsonl",
}


@pytest.mark.parametrize("words", HINTS)
def test_a_command_that_is_advised_can_be_typed_as_it_stands(words: str, command: Command) -> None:
    """The command is parsed as a shell reads it."""
    if words == "check FILE":
        Path("a b").mkdir()
        Path(NAMED).write_text('{"stopped": "before the first"}\n')
    elif words.endswith("rules"):
        Path(NAMED, "rules").mkdir(parents=True)
        Path(NAMED, "rules", "rooms.lp").write_text("type(a).")
    _, _, err = command(*(word.replace("FILE", NAMED) for word in words.split()))
    advised = shlex.split(err[err.index("vitruvius ") :])
    assert advised == [word.replace("FILE", NAMED) for word in HINTS[words].split()]


@pytest.mark.parametrize("out", [".", "film.avi", "film"])
def test_a_film_says_how_its_name_ends(out: str, command: Command) -> None:
    code, _, err = command("record", "pqn", str(PLANS), "--out", out)
    assert (code, err.count("use film.gif, or .trace.json for an episode to play\n")) == (2, 1)


def test_a_folder_names_the_house_file_in_it(command: Command) -> None:
    Path("runs").mkdir()
    save(load(PLANS), "runs/houses.jsonl")
    code, _, err = command("check", "runs")
    assert (code, "did you mean runs/houses.jsonl?" in err) == (5, True)


GENERATE = ["generate", "--rooms", "1", "--out", "houses.jsonl"]


@pytest.mark.parametrize(
    "other", [["--seed", "1"], ["--start", "2"], ["--piece", "bed=1"], ["--grammar", "paper"]], ids=" ".join
)
def test_other_houses_are_not_replaced_unless_it_is_said(other: list[str], command: Command) -> None:
    assert command(*GENERATE)[0] == 0
    before = Path("houses.jsonl").read_bytes()
    code, _, err = command(*GENERATE, *other)
    assert code == 2
    assert "houses.jsonl: holds other houses" in err
    assert "--replace" in err
    assert Path("houses.jsonl").read_bytes() == before
    assert command(*GENERATE, *other, "--replace")[0] == 0
    assert Path("houses.jsonl").read_bytes() != before


def test_a_series_is_made_again_and_continued_but_not_cut_short(command: Command) -> None:
    lines = []
    for count in ("2", "2", "3"):
        assert command(*GENERATE, "--count", count)[0] == 0
        lines.append(Path("houses.jsonl").read_bytes().splitlines())
    assert lines[0] == lines[1] == lines[2][:2]
    assert command(*GENERATE, "--count", "2")[0] == 2
    assert Path("houses.jsonl").read_bytes().splitlines() == lines[2]


def test_a_file_of_something_else_is_not_replaced(command: Command) -> None:
    Path("houses.jsonl").write_text('{"my": "notes"}\n')
    code, _, err = command(*GENERATE)
    assert (code, "holds content that is not houses" in err) == (2, True)


def test_a_converted_file_replaces_the_same_houses_alone(command: Command) -> None:
    one, other = f"convert {PLANS} --out a.jsonl".split(), ["convert", "b.jsonl", "--out", "a.jsonl"]
    save(load(PLANS)[:1], "b.jsonl")
    assert [command(*one)[0], command(*one)[0], command(*other)[0]] == [0, 0, 2]
    assert load("a.jsonl") == load(PLANS)
    assert command(*other, "--replace")[0] == 0
    assert load("a.jsonl") == load("b.jsonl")
    assert command("convert", "a.jsonl", "--out", "a.jsonl")[0] == 0


@pytest.mark.parametrize("how", ["draw", "draw --scale 1:100", "convert --to ros"])
def test_no_file_of_an_earlier_run_stays_beside_the_new(how: str, command: Command) -> None:
    save([*load(PLANS)] * 4, "twelve.jsonl")
    name, *options = how.split()
    for file in ("twelve.jsonl", str(PLANS)):
        Path("out").mkdir(exist_ok=True)
        for own in ("house-9.txt", "my house-9.svg", "notes.svg"):
            Path("out", own).touch()
        assert command(name, file, *options, "--out", "out")[0] == 0
    endings = FORMATS["ros"].endings if name == "convert" else [".svg"]
    made = {f"house-{number}{ending}" for number in range(3) for ending in endings}
    left = set(os.listdir("out")) - {"house-9.txt", "my house-9.svg", "notes.svg"}
    assert left - {f"contact-sheet{ending}" for ending in endings} == made


def test_plans_of_another_format_stay(command: Command) -> None:
    for options in ("--format png", "--format svg"):
        assert command("draw", str(PLANS), "--out", "out", *options.split())[0] == 0
    assert len(os.listdir("out")) == 8
