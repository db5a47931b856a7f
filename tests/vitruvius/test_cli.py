"""Ends of the command: each has its exit code and one line of text."""

import contextlib
import errno
import io
import json
import os
import re
import signal
import subprocess
import sys
import tomllib
import warnings
from dataclasses import replace
from pathlib import Path

import msgspec
import pytest

from benchmarks import STUDIES
from tests.programs import PATIENCE, finished
from tests.sample_houses import changed_star
from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.cli import COMMANDS, main, parse
from vitruvius.commands.houses import Check, Draw
from vitruvius.commands.watch import Watch
from vitruvius.logic import House, Rect, Star, load, save
from vitruvius.logic.installation import EXTRAS, install_command

ROOT = Path(__file__).parents[2]


GENERATE = """
import signal
from vitruvius.cli import main
from vitruvius.commands import generate

def progress(*arguments):
    for number, house in enumerate(made(*arguments)):
        if number == 3:
            print("made", flush=True)
        yield house

made, generate.progress = generate.progress, progress
signal.signal(signal.SIGINT, signal.default_int_handler)
main()
"""
"""Program of the command, which prints a line after some houses. It restores Ctrl-C, as shells let background
programs ignore it, and tests may run in the background."""


def vitruvius(*arguments: object, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Run the command in this process, as if in its own."""
    command, out, err = list(map(str, arguments)), io.StringIO(), io.StringIO()
    with (
        contextlib.chdir(cwd or Path.cwd()),
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
        pytest.raises(SystemExit) as ended,
    ):
        main(command)
    return subprocess.CompletedProcess(command, int(ended.value.code or 0), out.getvalue(), err.getvalue())


def test_generate_check_and_draw(tmp_path: Path) -> None:
    file = tmp_path / "houses.jsonl"
    made = vitruvius("generate", "--rooms", 3, "--type", "bedroom=1", "--count", 4, "--out", file)
    assert made.returncode == 0
    assert [len(house.star.rooms) for house in load(file)] == [3] * 4
    assert vitruvius("check", file).returncode == 0
    assert (
        "there is no piece bedd: did you mean bed?"
        in vitruvius("check", file, "--clear-front", "bedd").stderr
    )
    drawn = vitruvius("draw", file, "--out", tmp_path / "plans", "--format", "svg")
    assert drawn.returncode == 0
    assert len(list((tmp_path / "plans").glob("*.svg"))) == 5
    assert "Traceback" not in drawn.stderr


def test_without_a_file_houses_go_to_the_standard_output() -> None:
    made = vitruvius("generate", "--rooms", 1, "--count", 2)
    assert [json.loads(line)["roomNumber"] for line in made.stdout.splitlines()] == [1, 1]


def test_check_says_no_by_house_and_draw_names_plans_alike_from_0(tmp_path: Path, capsys) -> None:
    house, file = House.of_star(Star(Rect(0, 0, 5, 5))), tmp_path / "houses.jsonl"
    save([house, changed_star(house, floor=Rect(0, 0, 2, 5))], file)
    assert Check(file).run() == 1
    words = "main room: is 5.00 by 2.00 m (at most 2 times as long as wide)"
    assert capsys.readouterr().out == f"{file}: house 1: {words}\n"
    assert Check(file, json=True).run() == 1
    answer = json.loads(capsys.readouterr().out)["answer"]
    assert answer["houses"] == [{"house": 0, "violations": []}, {"house": 1, "violations": [words]}]
    Draw(file, tmp_path / "plans").run()
    plans = sorted(path.name for path in (tmp_path / "plans").iterdir())
    assert plans == ["contact-sheet.svg", "house-0.svg", "house-1.svg"]


def test_a_line_of_an_error_has_a_bounded_length(tmp_path: Path, capsys) -> None:
    (tmp_path / "houses.json").write_text(json.dumps({"format": "x" * 1_000_000}))
    with pytest.raises(SystemExit):
        main(["check", str(tmp_path / "houses.json")])
    said = capsys.readouterr().err
    assert re.search(r"x\.\.\. \(998,\d\d\d more characters\)\n$", said)
    assert len(said) < 2100


def test_control_characters_in_names_are_escaped_on_the_terminal_and_in_pictures(tmp_path: Path) -> None:
    """Otherwise a file's names could move the cursor, change colours, or make an SVG that is no XML."""
    (house,) = load(ROOT / "tests" / "fixtures" / "example1.json")
    name = "a\x1b[31m\x07\x00\n\u202eb"
    room = msgspec.structs.replace(house.star.rooms[0], type=name, x=-9.0)
    file = tmp_path / "houses.jsonl"
    save([changed_star(house, rooms=(room, *house.star.rooms[1:]))], file)
    said = vitruvius("check", file)
    assert r"a\x1b[31m\x07\x00\n\u202eb" in said.stdout
    drawn = [
        vitruvius("draw", file, "--out", tmp_path / "plans", "--format", each) for each in ("svg", "png")
    ]
    assert [ended.returncode for ended in drawn] == [0, 0]
    pictures = [path.read_text() for path in (tmp_path / "plans").glob("*.svg")]
    assert any(r"a\x1b[31m" in picture for picture in pictures)
    for text in (said.stdout, said.stderr, *pictures):
        assert not set(text) & set(name) - set("ab[31m\n")


def test_on_a_terminal_houses_still_go_to_the_standard_output(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The standard output is a file, and the progress bar has the terminal."""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    with pytest.raises(SystemExit, match="0"):
        main(["generate", "--rooms", "1"])
    shown = capsys.readouterr()
    assert json.loads(shown.out)["roomNumber"] == 1
    assert "houses:   0%" in shown.err


@pytest.mark.parametrize(
    ("arguments", "code", "says"),
    [
        (["generate", "--rooms", "3", "--type", "bathroom=9"], 3, "9 of type bathroom"),
        (["generate", "--rooms", "3", "--type", "bathrom=1"], 2, "bathrom"),
        (["generate", "--rooms", "3", "--type", "bathroom"], 2, "bathroom=1..3"),
        (["generate", "--rooms", "many"], 2, "many"),
        (["generate", "--rooms", "4..6"], 2, "--shard"),
        (["generate", "--rooms", "6..4", "--shard", "all/2", "--out", "x"], 2, "smaller number comes first"),
        (["generate", "--rooms", "0"], 2, "rooms"),
        (["generate", "--rooms", "9", "--inferences", "1000"], 4, "1000 inferences"),
        (["generate", "--rooms", "3", "--grammar", "famly"], 5, "famly"),
        (["check", "absent.jsonl"], 5, "absent.jsonl"),
        (["check", "LICENSE"], 5, "LICENSE:1"),
        (["evaluate", "pyproject.toml"], 5, "pyproject.toml"),
        (["frobnicate"], 2, "frobnicate"),
        (["generate", "--rooms", "3", "--count", "2", "--out", "x.json"], 2, ".jsonl"),
        (["generate", "--rooms", "3", "--out", "tests"], 2, "folder"),
        (["generate", "--rooms", "3", "--seconds", "inf"], 2, "seconds"),
        (["generate", "--rooms", "3", "--inferences", "99999999999999999999"], 2, "inferences"),
        (["train", "absent.jsonl", "--steps", "0"], 2, "steps"),
    ],
)
def test_bad_input_is_one_clear_line_and_its_code(arguments: list[str], code: int, says: str) -> None:
    ended = vitruvius(*arguments, cwd=ROOT)
    assert ended.returncode == code, ended.stderr
    assert says in ended.stderr
    assert "Traceback" not in ended.stderr
    assert code in {2, 3} or len(ended.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    "words",
    [
        "generate --rooms 99 --count 999 --out {}.jsonl",
        "draw {houses} --out {}",
        "train {houses} --out {}",
        "evaluate paper --houses {houses} --out {}",
        "record paper {houses} --out {}.gif",
        "export paper --out {}.onnx",
        "demo --out {}",
    ],
)
@pytest.mark.parametrize("place", ["/proc/nowhere", "{folder}/file/below"])
def test_a_place_that_cannot_be_written_to_is_refused_before_any_work(
    tmp_path: Path, words: str, place: str
) -> None:
    """Even root can write nothing in ``/proc``, although its permissions say so; nobody can below a file."""
    houses = ROOT / "tests/fixtures/example1.json"
    (tmp_path / "file").touch()
    ended = vitruvius(*words.format(place.format(folder=tmp_path), houses=houses).split())
    assert ended.returncode == 2
    assert re.fullmatch(r"error: --out \S+: cannot write to \S+: .+\n", ended.stderr)
    assert list(tmp_path.iterdir()) == [tmp_path / "file"]


def test_a_warning_that_is_made_an_error_is_one_line(tmp_path: Path) -> None:
    room = {"type": "Polygon", "coordinates": [[[0, 0], [4, 0], [4, 3], [0, 3], [0, 0]]]}
    nowhere = {"type": "Feature", "properties": None, "geometry": None}
    features = [{"type": "Feature", "properties": None, "geometry": room}, nowhere]
    (tmp_path / "plan.geojson").write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        done = vitruvius("generate", "--plan", tmp_path / "plan.geojson", "--out", tmp_path / "a.jsonl")
    said = "plan: ignored beside the rooms: 1 feature without geometry"
    assert (done.returncode, done.stdout) == (5, "")
    assert done.stderr == f"error: {said}: PYTHONWARNINGS makes this warning an error\n"


def test_help_without_docstrings_says_what_a_command_does() -> None:
    code = "from vitruvius.cli import command_help; print(command_help(['check']))"
    done = subprocess.run([sys.executable, "-OO", "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split("\n")[2] == COMMANDS["check"][1]


def test_a_device_that_takes_nothing_is_named_and_stays() -> None:
    ended = vitruvius("generate", "--rooms", 1, "--out", "/dev/full")
    assert (ended.returncode, ended.stderr) == (5, "error: /dev/full: No space left on device\n")
    assert Path("/dev/full").is_char_device()


def test_the_installed_command_imports_nothing_from_the_current_folder(tmp_path: Path) -> None:
    """``python -m`` does import from it, before any line of ours runs."""
    for name in ("agent", "clingo", "json", "logic", "queue", "sim", "token", "types", "vitruvius"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('from the current folder')\n")
    command = [Path(sys.executable).with_name("vitruvius"), "generate", "--rooms", "1"]
    done = finished(command, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")


def test_a_missing_prolog_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SWI_HOME_DIR", "/nowhere")
    monkeypatch.setenv("LIBSWIPL_PATH", "/nowhere/libswipl.so")
    command = [sys.executable, "-m", "vitruvius.cli", "generate", "--rooms", "1"]
    ended = finished(command)
    assert ended.returncode == 69
    assert "SWI-Prolog" in ended.stderr
    assert len(ended.stderr.splitlines()) == 1


def test_a_limit_keeps_the_houses_before_it(tmp_path: Path) -> None:
    """Houses differ in their work: a bound between the least and the most ends the series on the way."""
    file = tmp_path / "houses.jsonl"
    ended = vitruvius(
        "generate", "--rooms", 8, "--start", 10, "--count", 60, "--inferences", 53_000, "--out", file
    )
    assert ended.returncode == 4
    kept = load(file)
    assert 0 < len(kept) < 60
    assert json.loads(file.read_text().splitlines()[-1])["stopped"].startswith(f"at house {10 + len(kept)}: ")


def stopped(file: Path, sent: signal.Signals) -> tuple[int, str]:
    """Return exit code and stderr of a command that gets a signal while it makes houses for the file."""
    command = [sys.executable, "-c", GENERATE, "generate", "--rooms", "9", "--count", "100000"]
    process = subprocess.Popen(
        [*command, "--out", str(file)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:
        assert process.stdout is not None
        assert process.stdout.readline() == "made\n"
        process.send_signal(sent)
        _, said = process.communicate(timeout=PATIENCE)
    finally:
        process.kill()  # no effect if it has ended as it should
    return process.returncode, said


def test_ctrl_c_keeps_the_houses_and_ends(tmp_path: Path) -> None:
    file = tmp_path / "houses.jsonl"
    code, said = stopped(file, signal.SIGINT)
    assert code == 130
    assert "Traceback" not in said
    last = json.loads(file.read_text().splitlines()[-1])
    assert last == {"stopped": f"at house {len(load(file))}: interrupted"}


def test_sigterm_keeps_the_houses_and_says_why(tmp_path: Path) -> None:
    file = tmp_path / "houses.jsonl"
    code, said = stopped(file, signal.SIGTERM)
    assert code == 128 + signal.SIGTERM
    assert said.endswith("\nterminated\n")
    last = json.loads(file.read_text().splitlines()[-1])
    assert last == {"stopped": f"at house {len(load(file))}: terminated"}


def test_a_full_disk_keeps_what_fits_and_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file, fsync = tmp_path / "houses.jsonl", os.fsync

    def full(number: int) -> None:
        if os.fstat(number).st_size > room:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        fsync(number)

    monkeypatch.setattr(os, "fsync", full)
    room = 30_000
    ended = vitruvius("generate", "--rooms", 6, "--count", 12, "--out", file)
    assert ended.returncode == 5
    assert ended.stderr.splitlines()[-1] == f"error: {file}: No space left on device"
    kept = len(load(file))
    assert 3 < kept < 12
    assert f"holds the first {kept} of 12 generated houses" in ended.stderr
    last = json.loads(file.read_text().splitlines()[-1])
    assert last == {"stopped": f"at house {kept}: No space left on device"}
    room = 0
    ended = vitruvius("generate", "--rooms", 1, "--out", tmp_path / "other.jsonl")
    assert ended.stderr == f"error: {tmp_path / 'other.jsonl'}: No space left on device\n"
    assert list(tmp_path.iterdir()) == [file]


def test_the_command_line_imports_no_library_of_a_command() -> None:
    libraries = {"torch", "taichi", "gymnasium", "clingo", "pyswip", "matplotlib", "pytest"}
    code = f"import sys, vitruvius.cli; print(sorted({libraries} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


def test_help_names_every_command_and_every_study() -> None:
    for arguments, table in ((["--help"], COMMANDS), (["bench", "--help"], STUDIES)):
        shown = vitruvius(*arguments).stdout
        assert all(name in shown and sentence.split()[0] in shown for name, (_, sentence) in table.items())


BASE_ALONE = """
import io
import json
import sys
from contextlib import redirect_stderr, redirect_stdout
from importlib.abc import MetaPathFinder

absent, *commands = json.loads(sys.argv[1])

class Absent(MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name.partition(".")[0] in absent:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Absent())
from vitruvius.cli import main
answers = []
for command in commands:
    said = io.StringIO()
    with redirect_stdout(io.StringIO()), redirect_stderr(said):
        try:
            main(command)
        except SystemExit as end:
            answers.append([end.code or 0, said.getvalue()])
print(json.dumps(answers))
"""
"""Program of one process for all commands: it imports none of the absent modules."""


def on_the_base(*commands: str) -> list[tuple[int, str]]:
    """Return the exit code and stderr of each command where none of the extras is installed."""
    absent = [module for modules in EXTRAS.values() for module in modules]
    asked = json.dumps([absent, *map(str.split, commands)])
    ended = finished([sys.executable, "-c", BASE_ALONE, asked])
    assert ended.returncode == 0, ended.stderr
    return [(code, said) for code, said in json.loads(ended.stdout)]


LACKS = {
    "train houses.jsonl": ("SIM", "agent"),
    "evaluate pqn": ("SIM", "agent"),
    "generate --rooms 1 --shard 0/1 --out S": ("pyarrow", "data"),
    "bench generator": ("scipy", "bench"),
    "bench transfer pqn": ("torch", "agent"),
}
"""Commands that lack an extra: the module that each names, and the extra. SIM: one of the simulator's."""


def test_a_command_that_lacks_an_extra_names_the_command_that_installs_it(tmp_path: Path) -> None:
    file = tmp_path / "houses.jsonl"
    save(load(ROOT / "tests/fixtures/houses.jsonl")[:1], file)
    lacks = LACKS | {
        f"draw {file} --out {tmp_path} --format pdf": ("matplotlib", "pdf"),
        f"convert {file} --to gltf --out {tmp_path}": ("trimesh", "export"),
    }
    for (code, said), words, (module, extra) in zip(on_the_base(*lacks), lacks, lacks.values(), strict=True):
        command = " ".join(words.split()[: 1 + words.startswith("bench")])
        needs = f"error: vitruvius {command} needs {module}: {install_command(extra)}\n"
        assert (code, re.sub("|".join(EXTRAS["sim"]), "SIM", said)) == (69, needs)


def test_the_extras_are_those_of_the_distribution() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    for extra, modules in EXTRAS.items():
        lines = project["optional-dependencies"][extra]
        listed = {re.split("[<>=]", line)[0] for line in lines if "python_version >=" not in line}
        found = {
            {"pxr": "usd-core", "pygame": "pygame-ce"}.get(module, module.replace("_", "-"))
            for module in modules
        }
        found -= {"cpuinfo"}  # part of pytest-benchmark
        assert found == {name for name in listed if not name.startswith("vitruvius")}


def test_a_preset_runs_by_name_and_what_is_said_beside_it_comes_first() -> None:
    said = ["houses.jsonl", "--preset", "dqn", "--targets", "mixed", "--seed", "3"]
    assert parse(["train", *said]).learning == replace(PRESETS["dqn"], targets="mixed", seed=3)
    assert parse(["train", *said[:1]]).learning == PRESETS["pqn"]
    replayed = parse(["train", "houses.jsonl", "--preset=paper", "--batch-size", "700", "--lr-decay", "0"])
    assert replayed.learning == replace(PRESETS["paper"], batch_size=700, lr_decay=0)


@pytest.mark.parametrize("seed", ["-1", "18446744073709551616"])
@pytest.mark.parametrize(
    "words",
    ["train", "evaluate", "record pqn test-v1", "play", "demo", "generate --rooms 1"],
)
def test_a_seed_that_nothing_has_is_wrong_usage(
    words: str, seed: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        main([*words.split(), f"--seed={seed}"])
    said = capsys.readouterr().err
    assert (ended.value.code, said.count("\n")) == (2, 1), said
    assert re.search(r"seed must be (a whole number, 0 or more|at most \d+), not ", said)


@pytest.mark.parametrize("page", ["docs/use.md", "docs/tutorials/first-house.md"])
def test_the_first_houses_that_a_reader_makes_are_homes(page: str) -> None:
    text = (ROOT / page).read_text()
    assert "--grammar home" in re.findall(r"^\./run generate .*$", text, re.MULTILINE)[0]


def test_watch_begins_with_homes() -> None:
    assert Watch().grammar == "home"
