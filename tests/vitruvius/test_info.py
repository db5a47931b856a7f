"""vitruvius info: it recognises each kind of thing by its content, and prints one line for anything else."""

import gzip
import json
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest

from tests.logic.readers.written import WRITERS
from tests.sample_houses import FIXTURES
from vitruvius.agent import banks
from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.agent.banks import BANKS, bank_hash
from vitruvius.agent.play.results import PlayedGame, append
from vitruvius.agent.runs.released import FORMAT, located, released
from vitruvius.cli import main
from vitruvius.commands.info import TITLES
from vitruvius.info import recognise
from vitruvius.info.reading import UnknownFileError
from vitruvius.info.recognise import recognised
from vitruvius.logic import HouseFileError, load, save
from vitruvius.logic.errors import VitruviusError
from vitruvius.logic.exports import export
from vitruvius.logic.grammar import SHIPPED, shipped
from vitruvius.sim.environment import arguments
from vitruvius.sim.environment.arguments import BANK


def told(path: Path | str) -> Any:
    """Return the one thing that a path is."""
    [found] = recognised(str(path))
    return found


def test_a_house_file_is_told_with_its_counts_its_seed_and_its_hash(tmp_path: Path) -> None:
    houses = load(BANK)
    found = told(BANK)
    assert (found.houses, found.formats, found.rooms, found.seeds) == (32, {"vitruvius-1": 32}, (4, 4), (0,))
    assert sum(found.types.values()) == 4 * 32
    assert sum(found.pieces.values()) == sum(len(room.pieces) for house in houses for room in house.secondary)
    assert (found.checksum, found.bank, found.versions.keys() >= {"clingo"}) == (
        bank_hash(houses),
        None,
        True,
    )
    save(houses[:3], tmp_path / "cut.jsonl", "at house 3: interrupted")
    assert told(tmp_path / "cut.jsonl").stopped == "at house 3: interrupted"


def test_house_files_of_every_format_are_told() -> None:
    assert told(FIXTURES / "example1.json").formats == {"original": 1}
    assert told(FIXTURES / "plans.jsonl").formats == {"vitruvius-2": 3}


def test_a_bank_is_told_by_its_name_and_by_its_houses_in_another_file(tmp_path: Path) -> None:
    found = told("test-v1")
    assert (found.bank, found.checksum, found.rooms) == ("test-v1", BANKS["test-v1"].hash, (2, 6))
    save(load(Path(__file__).parents[2] / "agent/houses/test-v1.jsonl.gz"), tmp_path / "mine.jsonl.gz")
    assert told(tmp_path / "mine.jsonl.gz").bank == "test-v1"


def test_a_name_of_several_kinds_is_recognised_as_each() -> None:
    assert [each.__struct_config__.tag for each in recognised("paper")] == ["grammar", "agent", "settings"]


def test_a_checkpoint_is_told_by_its_header(tmp_path: Path) -> None:
    found = told(located("pqn"))
    assert (found.agent, found.format, found.readable, found.algorithm) == ("pqn", FORMAT, True, "pqn")
    assert (found.steps, found.targets, found.config["num_envs"]) == (3004928, "main", 512)
    assert found.parameters > 10_000
    content = located("pqn").read_bytes().replace(FORMAT.encode(), b"vitruvius-agent-2")
    (tmp_path / "old.safetensors").write_bytes(content)
    assert not told(tmp_path / "old.safetensors").readable


def test_a_run_is_told_with_how_far_it_is(tmp_path: Path) -> None:
    record = {"preset": "pqn", "algorithm": "pqn", "config": {"steps": 900}, "command": "vitruvius train"}
    record |= {"houses": {"number": 4, "hash": "ab"}, "python": "3.11", "torch": "2.9"}
    (tmp_path / "config.json").write_text(json.dumps(record))
    assert (told(tmp_path).steps, told(tmp_path).finished) == (0, False)
    lines = [json.dumps({"steps": k, "fraction": k / 900, "seconds": k, "targets": 1.5}) for k in (300, 600)]
    (tmp_path / "metrics.jsonl").write_text("\n".join([*lines, '{"steps": 9']))
    found = told(tmp_path)
    assert (found.steps, found.of_steps, found.finished, found.targets) == (600, 900, False, 1.5)
    assert told(tmp_path / "config.json").files == ["config.json", "metrics.jsonl"]


def test_games_scores_traces_plans_grammars_settings_and_weights_are_told(tmp_path: Path) -> None:
    game = PlayedGame(
        player="ann", house="0" * 64, index=0, targets="main", seed=0, view="plan", seconds=15.0,
        actions="LRF", score=3, raced={"pqn": 5}, taken="2026-01-02T03:04:05+00:00",
    )  # fmt: skip
    append(tmp_path / "games.jsonl", [game, msgspec.structs.replace(game, player="bob", score=4)])
    games = told(tmp_path / "games.jsonl")
    expected = 2, {"ann": 1, "bob": 1}, 3.5, ["pqn"]
    assert (games.games, games.players, games.score, games.raced) == expected

    figures = {"figures": {"ratio": {"value": 0.5, "low": 0.4, "high": 0.6}}, "runs": []}
    scores = {"bank": {"hash": "ab", "file": "test-v1", "houses": 2}, "seed": 0, "backend": "grid"}
    scores["targets"] = {"main": {"policies": {"mine": figures}}}
    (tmp_path / "evaluation.json").write_text(json.dumps(scores))
    assert told(tmp_path / "evaluation.json").ratios == {"main": {"mine": 0.5}}

    trace = {"format": "vitruvius-trace-1", "agent": "mine", "mode": "main", "seed": 4, "length": 9}
    (tmp_path / "trace.json").write_text(json.dumps(trace | {"targets": [[1, 2]], "columns": {}}))
    found = told(tmp_path / "trace.json")
    assert (found.agent, found.seed, found.length, found.targets) == ("mine", 4, 9, 1)

    assert told(FIXTURES / "plan.geojson").rooms == 5
    [file] = export(load(FIXTURES / "plans.jsonl")[:1], tmp_path / "map", "geojson")
    assert told(file).rooms == len(load(FIXTURES / "plans.jsonl")[0].rooms)

    grammar = told(SHIPPED / "home")
    assert (grammar.topology, grammar.shipped, told("home").checksum) == ("ring", True, grammar.checksum)
    assert grammar.lines.keys() >= {"rooms.lp", "sizes.pl"}

    (tmp_path / "f.toml").write_text('preset = "dqn"\nseed = 3\n')
    settings = told(tmp_path / "f.toml")
    assert (settings.preset, settings.algorithm, settings.changed) == ("dqn", "dqn", {"seed": "3"})


@pytest.mark.parametrize(
    ("name", "content", "error", "says"),
    [
        ("notes.txt", b"some words", UnknownFileError, "does not know this kind of file"),
        ("empty.json", b"", UnknownFileError, "is empty"),
        ("list.json", b"[1, 2]", UnknownFileError, "does not know this kind of file"),
        ("other.json", b'{"a": 1}', UnknownFileError, "does not know this kind of file"),
        ("cut.jsonl", b'{"format": "vitruvius-1", "roomN', HouseFileError, "cut.jsonl:1: not a house"),
        ("zip.jsonl.gz", gzip.compress(b"{}", mtime=0)[:-9], HouseFileError, "zip.jsonl.gz: cannot be read"),
        ("bad.safetensors", b"\x09\0\0\0\0\0\0\0{}", UnknownFileError, "not a checkpoint of Vitruvius. Make"),
        ("rooms.lp", b"a.", UnknownFileError, "a rule file: look at its grammar"),
        ("plan.geojson", b'{"type": "FeatureCollection"}', UnknownFileError, "GeoJSON, but not a plan"),
        (
            "scores.json",
            b'{"bank": 1, "targets": 2}',
            UnknownFileError,
            "not scores of this version. Write some",
        ),
        ("trace.json", b'{"format": "vitruvius-trace-0"}', UnknownFileError, "a trace of another version"),
        ("f.toml", b"steps = 'x'", VitruviusError, "f.toml:1: steps: expected"),
        ("game.jsonl", b'{"format": "vitruvius-game-1"}', VitruviusError, "game.jsonl:1: no game"),
    ],
)
def test_what_is_none_or_damaged_gets_one_line(
    name: str, content: bytes, error: type[VitruviusError], says: str, tmp_path: Path
) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(error, match=says) as raised:
        recognised(str(tmp_path / name))
    assert raised.value.exit_code == 5
    assert "\n" not in str(raised.value)


def test_folders_and_names_that_are_nothing_say_what_there_is(tmp_path: Path) -> None:
    with pytest.raises(UnknownFileError, match=r"a run .* or a grammar .*: it has nothing"):
        recognised(str(tmp_path))
    (tmp_path / "houses.jsonl").touch()
    with pytest.raises(UnknownFileError, match=f"look at {tmp_path}/houses.jsonl"):
        recognised(str(tmp_path))
    with pytest.raises(UnknownFileError, match=r"did you mean .*/houses\.jsonl\?"):
        recognised(str(tmp_path / "hoses.jsonl"))
    with pytest.raises(UnknownFileError, match=r"agent or set of houses test-v2: did you mean test-v1\?"):
        recognised("test-v2")
    (tmp_path / "config.json").write_text("{}")
    with pytest.raises(UnknownFileError, match=r"its config.json is not that of a run. Train"):
        recognised(str(tmp_path))
    (tmp_path / "pipe").symlink_to("/dev/null")
    with pytest.raises(UnknownFileError, match="is a device or a pipe"):
        recognised(str(tmp_path / "pipe"))


def test_people_read_a_thing_at_80_columns(capsys: pytest.CaptureFixture[str], monkeypatch: Any) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    for name in ("test-v1", "paper", str(FIXTURES / "plan.geojson")):
        with pytest.raises(SystemExit):
            main(["info", name])
        lines = capsys.readouterr().out.splitlines()
        assert max(map(len, lines[1:])) <= 80
        assert lines[0].partition(": ")[2] in TITLES.values()


def test_the_papers_house_has_the_simulators_name() -> None:
    assert recognise.PAPER_HOUSE == arguments.PAPER_HOUSE


def test_all_that_comes_with_it_is_told_by_its_name() -> None:
    for name in (*BANKS, banks.PAPER_HOUSE, *shipped(), *released(), *PRESETS):
        assert {kind.name for kind in recognised(name)} == {name}


def test_plans_of_other_programs_are_told(tmp_path: Path) -> None:
    home = load(FIXTURES / "plans.jsonl")[0]
    for format_, write in WRITERS.items():
        (tmp_path / "plan").write_bytes(write(home, np.random.default_rng(0), 0.0))
        found = told(tmp_path / "plan")
        assert format_ in found.format.casefold()
        assert found.rooms >= len(home.rooms)
    (tmp_path / "plan").write_bytes(b'{"verts": [], "room_category": {}}')
    with pytest.raises(UnknownFileError, match="at least four corners"):
        told(tmp_path / "plan")
