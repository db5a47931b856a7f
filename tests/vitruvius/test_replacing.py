"""Claims about files in the place of a command's output: no other content is lost silently."""

import os
import pkgutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from benchmarks import STUDIES
from tests.logic.workers import in_process
from vitruvius.cli import COMMANDS, main
from vitruvius.logic import House, RequestError, load
from vitruvius.logic.files.replacing import MARK, alone_in, study_folder, unless_other
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.options import options_of

ROOT = Path(__file__).parents[2]
PLANS = ROOT / "tests" / "fixtures" / "plans.jsonl"
FOREIGN = b"years of my own work\n"

FOLDERS = (
    *(
        "agents",
        "bounds",
        "brief",
        "exploration",
        "explorers",
        "fuzz",
        "generator",
        "grammars",
        "kills",
        "mutants",
        "homes",
        "learning",
    ),
    *(
        "paper",
        "planted",
        "realism",
        "sampling",
        "shards",
        "simulator",
        "speed",
        "tasks",
        "transfer",
        "views",
    ),
)
"""Studies that write into a folder."""

IN_THE_WAY = {
    "generate --rooms 1 --out mine.jsonl": "mine.jsonl",
    "generate --rooms 1 --shard 0/1 --out mine": "mine/set.json",
    f"convert {PLANS} --out mine.jsonl": "mine.jsonl",
    f"convert {PLANS} --to geojson --out mine": "mine/house-1.geojson",
    f"convert {PLANS} --to ros --out mine": "mine/house-2.yaml",
    f"draw {PLANS} --out mine": "mine/house-0.svg",
    f"draw {PLANS} --format png --out mine": "mine/house-7.png",
    f"draw {PLANS} --format pdf --out mine": "mine/plans.pdf",
    f"draw {PLANS} --diff {PLANS} --out mine": "mine/diff-0.svg",
    f"draw {PLANS} --scale 1:100 --out mine": "mine/house-0.svg",
    "evaluate paper --out mine": "mine/report.html",
    "evaluate paper-original --out mine": "mine/evaluation.json",
    "evaluate pqn --out mine": "mine/evaluation.md",
    f"record pqn {PLANS} --out mine.gif": "mine.gif",
    f"record pqn {PLANS} --out mine.trace.json": "mine.trace.json",
    "report houses": "houses/report.html",
    "report houses --out mine.html": "mine.html",
    "train --out mine": "mine/report.html",
    "train --preset dqn --out mine": "mine/learning-curve.png",
    "play --out mine.jsonl": "mine.jsonl",
    "demo --out mine": "mine/report.md",
    "playground --out mine": "mine/index.html",
    "export paper --out mine.onnx": "mine.onnx",
    **{f"bench {name} --out mine": f"mine/{name}.md" for name in FOLDERS},
}
"""Commands, each with a file of other content in the place of its output."""

NO_REPLACE = {"train", "play", "demo", "playground"}
"""Commands without ``--replace``: they ask for another place."""


def run(words: str) -> int:
    with pytest.raises(SystemExit) as ended:
        main(words.split())
    assert isinstance(ended.value.code, int)
    return ended.value.code


@pytest.mark.parametrize("words", IN_THE_WAY, ids=lambda words: words.replace(str(ROOT), ""))
def test_what_is_in_the_way_is_named_and_stays(
    words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    file = Path(IN_THE_WAY[words])
    file.parent.mkdir(exist_ok=True)
    file.write_bytes(FOREIGN)
    # The work that takes seconds is no part of the claim.
    monkeypatch.setattr("vitruvius.agent.runs.export.export", lambda _, path: path.write_bytes(b"a network"))
    if words.startswith("report"):
        Path("houses").mkdir(exist_ok=True)
        Path("houses/plans.jsonl").write_bytes(PLANS.read_bytes())
    assert run(words) == 2
    said = capsys.readouterr().err
    assert "mine" in said or "houses/report.html" in said
    name = words.split(maxsplit=1)[0]
    assert ("--replace" in said) == (name not in NO_REPLACE), said
    assert file.read_bytes() == FOREIGN
    given = {"plans.jsonl", "weights.h5"}
    left = {path for path in tmp_path.rglob("*") if path.is_file() and path.name not in given}
    assert left <= {tmp_path / file, tmp_path / "mine/.lock"}


def test_the_table_has_every_command_that_writes_and_each_can_replace() -> None:
    writing = {}
    commands = {name: place for name, (place, _) in COMMANDS.items() if name != "bench"}
    for name, place in (commands | {f"bench {name}": place for name, (place, _) in STUDIES.items()}).items():
        flags = {option.name for option in options_of(pkgutil.resolve_name(place))}
        if "out" in flags:
            writing[name] = "replace" in flags
    assert {name for name, replaces in writing.items() if not replaces} == NO_REPLACE
    tried = (words.split() for words in IN_THE_WAY)
    assert {" ".join(words[: 2 if words[0] == "bench" else 1]) for words in tried} == set(writing)


@pytest.mark.parametrize(
    "words",
    [
        f"draw {PLANS} --out mine",
        f"draw {PLANS} --format png --out mine",
        f"draw {PLANS} --format pdf --out mine",
        f"draw {PLANS} --diff {PLANS} --out mine",
        f"convert {PLANS} --to geojson --out mine",
        f"convert {PLANS} --to usd --out mine",
        f"convert {PLANS} --to gltf --out mine",
        "report houses",
        "report houses --out mine.html",
    ],
    ids=lambda words: words.replace(str(ROOT), ""),
)
def test_the_same_command_again_is_no_loss(
    words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("houses").mkdir()
    Path("houses/plans.jsonl").write_bytes(PLANS.read_bytes())
    assert [run(words), run(words)] == [0, 0]


@pytest.mark.parametrize("replace", [False, True])
@pytest.mark.parametrize("interrupted", [False, True])
def test_houses_that_another_process_writes_meanwhile_stay(
    interrupted: bool, replace: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def writing(request: HouseRequest, *_: int) -> Iterator[House]:
        yield from in_process.generate(request.rooms)
        (tmp_path / "mine.jsonl").write_bytes(PLANS.read_bytes())
        if interrupted:
            raise KeyboardInterrupt

    monkeypatch.setattr("vitruvius.logic.workers.generate.houses_of", writing)
    command = f"generate --rooms 1 --out {tmp_path / 'mine.jsonl'}{' --replace' if replace else ''}"
    assert run(command) == ((130 if interrupted else 0) if replace else 2)
    assert (load(tmp_path / "mine.jsonl") == load(PLANS)) is not replace


def test_a_file_of_other_content_is_replaced_where_it_is_asked_for(tmp_path: Path) -> None:
    out = tmp_path / "agent.onnx"
    for content, replace in ((b"mine", False), (b"mine", False), (b"other", True)):
        with unless_other(out, replace) as made:
            made.write_bytes(content)
    with pytest.raises(RequestError, match="--replace"), unless_other(out, False) as made:
        made.write_bytes(b"mine")
    assert out.read_bytes() == b"other"
    assert os.listdir(tmp_path) == ["agent.onnx"]


def test_two_commands_never_draw_into_one_folder_at_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with alone_in(tmp_path / "plans"), pytest.raises(SystemExit, match="2"):
        main(["draw", str(PLANS), "--out", str(tmp_path / "plans")])
    assert ": another command is drawing to this" in capsys.readouterr().err
    assert not (tmp_path / "plans").exists()
    with pytest.raises(SystemExit, match="0"):
        main(["draw", str(PLANS), "--out", str(tmp_path / "plans")])


def test_a_study_goes_on_in_its_own_folder_and_is_told_to_write_to_another(tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    for _ in range(2):
        with study_folder(folder, replace=False):
            assert (folder / MARK).exists()  # so that a killed study resumes, too
            (folder / "study.md").write_bytes(b"figures")
    (folder / MARK).unlink()
    with (
        pytest.raises(RequestError, match="to keep them and add files"),
        study_folder(folder, replace=False),
    ):
        raise AssertionError
    with study_folder(folder, replace=True):
        assert (folder / "study.md").read_bytes() == b"figures"
    with pytest.raises(RequestError, match="wrong"), study_folder(tmp_path / "new", replace=False):
        raise RequestError("wrong")
    assert not (tmp_path / "new").exists()
