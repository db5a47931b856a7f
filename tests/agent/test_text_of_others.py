"""Text in files imports no code and is no markup: class names and tags in every field have no effect."""

import json
import shutil
import sys
from collections.abc import Callable, Iterator
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import msgspec
import pytest

from benchmarks import SECTIONS
from tests.agent.evaluation.cases import result, scores
from tests.agent.report.conftest import HOUSE, recorded, untrained
from tests.agent.report.test_report import LINE, metrics
from tests.benchmarks.reports import report as timed
from vitruvius.agent.algorithms.build import network_of
from vitruvius.agent.algorithms.map_completion.config import CompletionConfig
from vitruvius.agent.banks import bank_hash, benchmark, geometry_hash
from vitruvius.agent.evaluation.scores import ScoredBank, ScoreFile, modes_of
from vitruvius.agent.evaluation.tables import Table
from vitruvius.agent.play.game import replayed
from vitruvius.agent.play.results import PlayedGame, ResultsError
from vitruvius.agent.recording import trace
from vitruvius.agent.report.folder import report
from vitruvius.agent.runs import checkpoint
from vitruvius.cli import parse
from vitruvius.logic import House, save
from vitruvius.logic.drawing.draw import plan_svg
from vitruvius.logic.errors import RequestError, VitruviusError
from vitruvius.logic.files.gallery import Houses
from vitruvius.sim import allowed

TASKS = (
    "canary:Task",
    '{"task": "canary:Task", "command": "true"}',
    '{"task": "main", "terms": "canary:Terms"}',
    '{"task": "secondary", "terms": {"class": "canary:Terms"}}',
)
"""Tasks that name a class of a module, in each form."""


@pytest.fixture(scope="module")
def episode() -> trace.Trace:
    """Return an episode of an agent."""
    return recorded(untrained()).trace


@pytest.fixture
def canary(tmp_path, monkeypatch) -> Iterator[Path]:
    """Yield a path that exists only after the module ``canary`` was imported."""
    folder, sings = tmp_path / "canary", tmp_path / "sang"
    folder.mkdir()
    text = f"open({str(sings)!r}, 'w').close()\nTask = Terms = Backend = lambda **arguments: None\n"
    (folder / "canary.py").write_text(text)
    monkeypatch.syspath_prepend(folder)
    monkeypatch.setattr(allowed, "_ALLOWED", set())
    yield sings
    sys.modules.pop("canary", None)


def checkpoint_read(folder: Path, task: str) -> None:
    """Evaluate an agent in the task that its checkpoint names."""
    config = CompletionConfig(targets=task)
    checkpoint.save(checkpoint.Checkpoint(network_of(config), config, 0), folder / "agent.safetensors")
    save([HOUSE], folder / "houses.jsonl")
    parse(["evaluate", str(folder / "agent.safetensors"), "--houses", str(folder / "houses.jsonl")]).run()


def film_read(folder: Path, task: str) -> None:
    """Record the episode of an agent whose checkpoint names the task."""
    config = CompletionConfig(targets=task)
    checkpoint.save(checkpoint.Checkpoint(network_of(config), config, 0), folder / "agent.safetensors")
    save([HOUSE], folder / "houses.jsonl")
    out = ["--out", str(folder / "e.trace.json"), "--steps", "2"]
    parse(["record", str(folder / "agent.safetensors"), str(folder / "houses.jsonl"), *out]).run()


def settings_read(folder: Path, task: str) -> None:
    """Train with settings that name the task."""
    (folder / "train.toml").write_text(f"targets = {json.dumps(task)}\n")
    parse(["train", "--config", str(folder / "train.toml"), "--out", str(folder / "run")]).run()


def game_read(folder: Path, task: str) -> None:
    """Replay a game that names the task."""
    game = PlayedGame(
        player="x",
        house=geometry_hash(HOUSE),
        index=0,
        targets=task,
        seed=0,
        view="plan",
        seconds=1.0,
        actions="",
        score=0,
    )
    replayed(game, HOUSE, "games.jsonl:1")


REFUSED = (checkpoint_read, film_read, settings_read, game_read)
"""Readers of files whose task is played."""


@pytest.mark.parametrize("read", REFUSED)
@pytest.mark.parametrize("task", TASKS)
def test_a_task_that_a_file_names_imports_nothing_and_the_refusal_names_the_option(
    read: Callable[[Path, str], None], task: str, canary: Path, tmp_path: Path
) -> None:
    with pytest.raises((RequestError, ResultsError), match=r"canary:T.* is code, .*--allow canary:T"):
        read(tmp_path, task)
    assert not canary.exists()


def test_a_page_names_a_task_and_a_bank_of_a_file_and_imports_and_opens_nothing(
    canary, tmp_path, episode
) -> None:
    scored = ScoreFile(
        ScoredBank("abc", "../../secret.jsonl", 2),
        0,
        {task: modes_of([result(scores([5, 8]))])["secondary"] for task in TASKS},
        backend="canary:Backend",
        world="canary:World",
    )
    folder = tmp_path / "a" / "run"
    folder.mkdir(parents=True)
    (tmp_path / "secret.jsonl").write_text("no house")  # would be a HouseFileError
    (folder / "evaluation.json").write_bytes(scored.json())
    for number, task in enumerate(TASKS):
        trace.save(msgspec.structs.replace(episode, mode=task), folder / f"{number}.trace.json")
    assert b"terms terms" in report(folder, SECTIONS)
    assert not canary.exists()


def test_a_class_that_the_command_line_allows_is_imported(canary, tmp_path) -> None:
    (tmp_path / "train.toml").write_text(f"targets = {json.dumps(TASKS[2])}\n")
    command = parse(["train", "--config", str(tmp_path / "train.toml"), "--allow", "canary:Terms"])
    with pytest.raises(RequestError, match="is not a subclass of"):
        command.run()
    assert canary.exists()


# - markup ---------------------------------------------------------------------------------------

MARK = "\"'><meta http-equiv=refresh content=0><img src=x onerror=alert(1)></script></title>`[red]"
"""Text that would be tags wherever it is not escaped."""


class Tags(HTMLParser):
    """Tags of a page with the names of their attributes."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.found = set[tuple[str, tuple[str, ...]]]()
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.add((tag, tuple(sorted(name for name, _ in attrs))))


def marked(content: Any) -> Iterator[Any]:
    """Yield a JSON value again and again, each time with the mark in place of a different text."""
    for text in sorted(set(texts(content))):
        yield replaced(content, text)


def texts(value: Any) -> Iterator[str]:
    """Yield all texts and keys of a JSON value."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for key, each in value.items():
            yield from (key, *texts(each))
    elif isinstance(value, list | tuple):
        for each in value:
            yield from texts(each)


def replaced(value: Any, text: str) -> Any:
    """Return a JSON value with the mark in place of a text."""
    if isinstance(value, dict):
        return {replaced(key, text): replaced(each, text) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [replaced(each, text) for each in value]
    return MARK if value == text else value


def contents(episode: trace.Trace) -> dict[str, Any]:
    """Return the JSON of each file that a report reads, by name."""
    one = result(scores([5, 8]), others={"explorer": scores([6, 10])})
    config = {"preset": "pqn", "algorithm": "pqn", "config": {"steps": 2000}, "command": "x", "python": "3"}
    learnt_in: dict[str, int | None] = {"agent": None}
    bank = ScoredBank(bank_hash([HOUSE, HOUSE]), "b", 2)
    return {
        "evaluation.json": json.loads(ScoreFile(bank, 0, modes_of([one]), learnt_in=learnt_in).json()),
        "config.json": config | {"houses": {"number": 3, "hash": "abc"}, "torch": "2", "machine": "m"},
        "about.json": {"title": "A run", "words": ["It was **good**: `x`."]},
        "e.trace.json": msgspec.to_builtins(episode),
        "houses.jsonl": benchmark("home-test-v1")[0].to_dict(),
        "generator.json": timed(),
    }


def test_markup_in_any_field_of_any_file_of_a_report_is_text(tmp_path, episode) -> None:
    tried = 0
    for name, content in contents(episode).items():
        folder = tmp_path / name
        folder.mkdir()
        metrics(folder, json.dumps(LINE))
        (folder / name).write_text(json.dumps(content))
        # Classes of colours and of words differ; tags and attributes do not.
        known = Tags(report(folder, SECTIONS).decode()).found
        for other in marked(content):
            (folder / name).write_text(json.dumps(other))
            try:
                page = report(folder, SECTIONS).decode()
            except VitruviusError:
                continue
            strange = Tags(page).found - known
            assert not {tag for tag, _ in strange} & {"meta", "img", "script", "a"}, (name, strange)
            assert not [names for _, names in strange if "onerror" in names or "http-equiv" in names]
            tried += 1
        shutil.rmtree(folder)
    assert tried > 60


def test_markup_in_the_name_of_a_folder_is_text(tmp_path) -> None:
    folder = tmp_path / "<meta http-equiv=refresh><img src=x>"
    for inside in (folder, folder / "<img src=y>"):
        metrics(inside, json.dumps(LINE))
        (inside / "evaluation.json").write_bytes(
            ScoreFile(ScoredBank("a", "b", 2), 0, modes_of([result(scores([5, 8]))])).json()
        )
    tags = {tag for tag, _ in Tags(report(folder, SECTIONS).decode()).found}
    assert "img" not in tags


def test_markup_in_any_field_of_a_house_is_text_in_its_plan() -> None:
    home = benchmark("home-test-v1")[0]
    known = {each.tag for each in ElementTree.fromstring(plan_svg(home, 300)).iter()}
    tried = 0
    for content in marked(home.to_dict()):
        try:
            house = House.from_dict(content)
        except (VitruviusError, ValueError):
            continue
        assert {each.tag for each in ElementTree.fromstring(plan_svg(house, 300)).iter()} <= known
        assert not {tag for tag, _ in Tags(Houses([house])._repr_html_()).found} & {"meta", "img", "script"}
        tried += 1
    assert tried > 5


def test_markup_of_rich_and_markdown_in_a_name_is_text_in_tables() -> None:
    from io import StringIO

    from rich.console import Console

    table = Table("A [/title]", ("[red]policy", "x"), [("[/] a|b <img>", "1")])
    said = StringIO()
    Console(file=said, width=200).print(table.terminal())
    assert "[/] a|b <img>" in said.getvalue()
    assert "| [/] a\\|b &lt;img> | 1 |" in table.markdown()


def test_all_pages_escape_by_one_function() -> None:
    root = Path(__file__).parents[2]
    paths = [
        path
        for package in ("logic", "sim", "agent", "vitruvius", "benchmarks")
        for path in (root / package).rglob("*.py")
    ]
    users = [path.relative_to(root).as_posix() for path in paths if "from html import" in path.read_text()]
    assert users == ["logic/spelling.py"]
