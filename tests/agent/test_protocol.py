"""The protocol's figures on cases small enough to be worked out by hand, and its players."""

import io
import json
import math
from pathlib import Path

import numpy as np
import pytest
import torch
from PIL import Image
from rich.console import Console

from agent import checkpoint, scoreboard
from agent.avoidance import FORWARD, LEFT, RIGHT
from agent.baselines import AROUND, Script, baselines
from agent.build import network_of
from agent.checkpoint import Checkpoint
from agent.commands import Evaluate
from agent.config import PRESETS, PQNConfig
from agent.evaluate import Score, play
from agent.protocol import EYES, MODES, Result, Stage, measure
from agent.world import make_worlds
from logic import save
from sim.lookout import Lookout
from tests.worlds import drawn, random_house


def score(targets, first, player="agent", **more):
    zeros = np.zeros(len(targets))
    more = {"steps": 1500 * len(targets), "coverage": np.zeros((2, len(targets))), "rooms": zeros} | more
    return Score(player, np.array(targets, float), first=np.array(first, float), **more)


def result(*runs, oracle=(10, 20), mode="secondary", rooms=(2, 4), shortest=(100, 200)):
    best = score(oracle, shortest, "oracle")
    return Result(mode, np.array(rooms), np.array(shortest, float), {"agent": runs, "oracle": (best,)})


def test_the_ratio_is_to_the_oracle_in_the_same_house():
    assert result(score([5, 5], [1, 1])).figures("agent")["ratio"].value == pytest.approx((0.5 + 0.25) / 2)


def test_a_house_where_the_oracle_finds_nothing_does_not_count():
    assert result(score([5, 0], [1, 1]), oracle=(10, 0)).ratio("agent").value == 0.5


def test_a_success_is_a_first_target_within_300_steps():
    figures = result(score([1, 1], [300, 301])).figures("agent")
    assert figures["success"].value == 0.5


def test_spl_weighs_a_success_by_the_shortest_way_over_the_way_taken():
    """100 of 200 steps; 200 of 800, which is no success; nothing; the shortest way itself."""
    one = result(score([1, 1, 0, 1], [200, 800, np.inf, 50]), oracle=(9,) * 4, rooms=(2,) * 4,
                 shortest=(100, 200, 100, 50))  # fmt: skip
    assert one.figures("agent")["spl"].value == pytest.approx((0.5 + 0 + 0 + 1) / 4)


def test_rooms_are_a_share_of_the_houses_own():
    figures = result(score([1, 1], [1, 1], rooms=np.array([2, 1]))).figures("agent")
    assert figures["rooms"].value == pytest.approx((1 + 0.25) / 2)


def test_collisions_and_interventions_are_per_1000_steps():
    figures = result(score([1, 1], [1, 1], blocked=3, interventions=30)).figures("agent")
    assert (figures["blocked"].value, figures["interventions"].value) == pytest.approx((1, 10))


@pytest.mark.parametrize(("mode", "share"), [("main", 0.5), ("secondary", 1.0)])
def test_the_human_is_beaten_by_more_targets_than_27_or_10(mode, share):
    assert result(score([27, 28], [1, 1]), mode=mode).figures("agent")["human"].value == share


def test_in_mixed_mode_there_is_no_human():
    assert "human" not in result(score([27, 28], [1, 1]), mode="mixed").figures("agent")


def test_training_runs_count_alike_and_widen_the_interval():
    one = result(score([5, 10], [1, 1])).ratio("agent")
    two = result(score([5, 10], [1, 1]), score([10, 20], [1, 1])).ratio("agent")
    assert (one.value, one.low, one.high) == (0.5, 0.5, 0.5)
    assert two.value == 0.75
    assert (two.low, two.high) == (0.5, 1.0)


def test_by_rooms_each_house_counts_where_it_belongs():
    by_rooms = result(score([5, 5], [1, 1])).by_rooms("agent")
    assert {rooms: each.value for rooms, each in by_rooms.items()} == {2: 0.5, 4: 0.25}


class Straight:
    """Always forward."""

    interventions = 0

    def begin(self, environments):
        pass

    def __call__(self, observation, blocked):
        return torch.full((len(observation),), FORWARD)


def test_an_episode_notes_coverage_and_rooms_at_its_marks():
    envs = make_worlds([drawn("aaa\naaa\na+a\n...\n...\nb+b\nbbb")], 4, "mixed")
    watch = Lookout(envs)
    noted = play("straight", envs, Straight(), seed=0, houses=np.zeros(4, int), watch=watch)
    assert noted.coverage.shape == (2, 4)
    assert (noted.coverage[0] > 0.05).all()
    assert (noted.coverage[1] == noted.coverage[0]).all()  # it has stood before a wall for long
    assert (noted.coverage[1] == watch.share()).all()
    assert (noted.rooms == watch.rooms()).all()


def seen(aside):
    """An observation (1, 40, 2) of a target so many rays from the middle, to the right."""
    observation = torch.ones(1, 40, 2)
    observation[..., 1] = 0
    observation[0, round(19.5 + aside), 1] = 1
    return observation


def script(forward=True):
    angles = np.deg2rad(58.5 - 3 * np.arange(40))
    allowed = torch.tensor([[True, True, forward]])
    player = Script(angles, lambda observation, blocked: allowed, torch.Generator().manual_seed(0))
    player.begin(1)
    return player


@pytest.mark.parametrize(
    ("aside", "action"), [(0, FORWARD), (7, FORWARD), (-7, FORWARD), (9, RIGHT), (-9, LEFT)]
)
def test_the_script_turns_to_the_target_and_goes(aside, action):
    assert script()(seen(aside), torch.zeros(1).bool()).item() == action


def test_without_a_target_the_script_looks_all_around_and_then_walks():
    player, nothing = script(), torch.ones(1, 40, 2) * torch.tensor([1.0, 0.0])
    actions = [player(nothing, torch.zeros(1).bool()).item() for _ in range(30)]
    assert actions[:AROUND] == [LEFT] * AROUND
    assert actions.count(FORWARD) > 15


def test_a_script_that_something_stops_walks_around_it():
    player = script(forward=False)
    actions = {player(seen(0), torch.zeros(1).bool()).item() for _ in range(12)}
    assert actions == {LEFT, RIGHT}


HOUSES = [random_house(seed) for seed in range(4)]
BASELINES = ["random + avoidance", "script", "explorer", "searcher", "oracle"]


@pytest.fixture(scope="module")
def measured():
    """The baselines alone, in four small houses."""
    return list(measure({}, HOUSES, ("secondary",), seed=3))


def test_the_players_are_ranked_as_what_they_know(measured):
    counts = {name: runs[0].targets.sum() for name, runs in measured[0].players.items()}
    assert list(counts) == BASELINES
    assert counts["random + avoidance"] <= counts["searcher"] <= counts["oracle"]
    assert counts["script"] < counts["searcher"]


def test_the_oracles_first_target_is_as_near_as_the_shortest_way(measured):
    [oracle] = measured[0].players["oracle"]
    assert oracle.first.tolist() == measured[0].shortest.tolist()
    assert measured[0].ratio("oracle").value == 1


def test_the_same_seed_gives_the_same_figures(measured):
    again = next(measure({}, HOUSES, ("secondary",), seed=3))
    for name, runs in measured[0].players.items():
        assert again.players[name][0].targets.tolist() == runs[0].targets.tolist()


def test_the_record_is_json_and_holds_every_house(measured):
    record = json.loads(json.dumps(scoreboard.record(measured)))
    players = record["targets"]["secondary"]["players"]
    assert set(players["script"]["figures"]) <= set(record["definitions"])
    assert all(len(run["targets"]) == 4 for each in players.values() for run in each["runs"])
    assert all(math.isfinite(figure["value"]) for figure in players["searcher"]["figures"].values())


def test_the_tables_fit_a_terminal_of_80_columns(measured):
    wide = {"agent": (score([98] * 4, [200] * 4),) * 3} | measured[0].players
    one = Result("secondary", measured[0].rooms, measured[0].shortest, wide)
    console = Console(width=80, file=io.StringIO())
    console.print(*(sheet.table() for sheet in scoreboard.sheets(one)))
    shown = console.file.getvalue()  # pyright: ignore[reportAttributeAccessIssue]
    assert "…" not in shown
    assert "agent, 3 runs" in shown
    assert "human of the paper" in shown


def test_the_picture_shows_modes_side_by_side(measured):
    widths = []
    for results in (measured, measured * 3):
        with Image.open(io.BytesIO(scoreboard.picture(results))) as image:
            widths.append(image.width)
    assert widths[1] > 2 * widths[0]


def test_evaluate_without_an_agent_measures_the_baselines(tmp_path, capsys):
    save(HOUSES[:2], tmp_path / "houses.jsonl")
    assert (
        Evaluate(houses=tmp_path / "houses.jsonl", targets=("main",), out=tmp_path / "out", json=True).run()
        == 0
    )
    record = json.loads(capsys.readouterr().out)
    assert list(record["targets"]) == ["main"]
    assert len(record["bank"]["hash"]) == 64
    assert json.loads((tmp_path / "out/evaluation.json").read_text()) == record
    assert "| searcher |" in (tmp_path / "out/evaluation.md").read_text()
    with Image.open(tmp_path / "out/evaluation.png") as image:
        image.verify()


def written(folder, config, name="pqn") -> Path:
    """A checkpoint of a network that has learnt nothing."""
    path = folder / f"{config.seed}-{config.steps}" / "agent.safetensors"
    checkpoint.save(Checkpoint(network_of(config), config, 0, name), path)
    return path


def test_runs_of_one_config_are_one_player_and_others_bear_their_folders_names(tmp_path):
    same = [written(tmp_path, PQNConfig(seed=seed)) for seed in (0, 1)]
    other = written(tmp_path, PQNConfig(steps=7))
    players = Evaluate((*same, other))._players()
    assert {name: len(runs) for name, runs in players.items()} == {"pqn": 2, "pqn (0-7)": 1}


def test_agents_of_all_presets_play_in_one_table(tmp_path):
    agents = {name: [checkpoint.load(written(tmp_path, config, name))] for name, config in PRESETS.items()}
    result = next(measure(agents, HOUSES[:2], ("main",), seed=1))
    assert list(result.players)[: len(PRESETS)] == list(PRESETS)
    for name in PRESETS:
        [each] = result.players[name]
        assert (each.targets <= result.oracle).all()
        assert each.steps == 2 * 1500


def test_an_agent_of_the_papers_world_sees_by_its_rays_in_the_others_world():
    default, paper = (Stage(HOUSES[:1], "main", EYES[name], "continuous").envs for name in EYES)
    for envs in (default, paper):
        envs.reset(seed=5)
    assert paper.single_observation_space.shape == (40, 3)
    assert np.array_equal(default.targets(9), paper.targets(9))
    assert np.array_equal(default.state["wholes"], paper.state["wholes"])


def test_baselines_and_modes_have_these_names():
    envs = make_worlds(HOUSES[:1], 1)
    assert list(baselines(envs, 0)) == BASELINES
    assert MODES == ("main", "secondary", "mixed")
    assert len(envs.config.ray_angles) == 40
