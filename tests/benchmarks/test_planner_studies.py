"""The planner's studies: players differ only by their configuration, and odds are those of houses."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from benchmarks.planner import explorers
from benchmarks.planner.explorers import Explorers, cuts, difference, sheets, variant
from benchmarks.planner.odds import BESIDE, ENTRIES, MapPlaces, TargetSpots, collect, odds, sheet, table
from benchmarks.planner.prior import ELSEWHERE, Informed
from benchmarks.planner.tasks import Tasks
from tests.sample_houses import random_house
from vitruvius.agent.baselines.coverage import origins_of
from vitruvius.agent.learning.environments import make_envs, shield
from vitruvius.agent.planner import TUNED
from vitruvius.agent.planner.core.config import CERTAIN
from vitruvius.agent.planner.core.state import NONE, SEARCH
from vitruvius.agent.planner.mapping.occupancy import FLAGS, OCCUPIED
from vitruvius.agent.planner.viewpoints.belief import BLOCKED, WALL
from vitruvius.agent.policies.policies import Explorer
from vitruvius.logic import save
from vitruvius.logic.errors import RequestError

pytestmark = pytest.mark.second_part("each study is run in small")

HOUSES = [random_house(seed) for seed in range(4)]


@pytest.fixture
def study(tmp_path: Path) -> Explorers:
    """Return a short study, in houses that were made before."""
    save(HOUSES, tmp_path / "houses-1.jsonl")
    return Explorers(
        ("main", "secondary"), ("replan_interval=32",), houses=1, episodes=2, steps=120, out=tmp_path
    )


def scores(study: Explorers) -> dict[str, bytes]:
    return {path.name: np.load(path)["targets"].tobytes() for path in study.out.glob("*.npz")}


# Variants.


def test_a_variant_that_changes_nothing_differs_by_nothing(
    study: Explorers, capsys: pytest.CaptureFixture
) -> None:
    study.run()
    page = capsys.readouterr().out
    assert page.strip() == (study.out / "explorers.md").read_text().strip()
    most, same, *_ = (
        line.split(" | ")
        for line in page.splitlines()
        if line.startswith(("| as it is", "| replan_interval=32"))
    )
    assert 0 < float(most[2]) < 1.5
    assert same[1:-1] == most[1:-1]
    compared = [line for line in page.splitlines() if "±" in line]
    assert len(compared) == 2
    for line in compared:
        assert set(line.removeprefix("| replan_interval=32 | ").removesuffix(" |").split(" | ")) == {
            "+0.000 ± 0.000"
        }


def test_a_study_that_was_killed_goes_on_where_it_was(
    study: Explorers, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    played, episode = [], explorers.episode

    def stopped(envs: Any, policy: Any, steps: int, houses: int) -> np.ndarray:
        played.append(policy)
        if len(played) == 4:
            raise KeyboardInterrupt
        return episode(envs, policy, steps, houses)

    monkeypatch.setattr(explorers, "episode", stopped)
    with pytest.raises(KeyboardInterrupt):
        study.run()
    assert len(scores(study)) == 3
    study.run()
    assert len(played) == 3 + 1 + 3  # the interrupted one is played again
    study.run()
    assert len(played) == 7
    assert not list(tmp_path.glob(".*"))  # no incomplete file is left


def test_episodes_of_a_house_are_averaged(study: Explorers, monkeypatch: pytest.MonkeyPatch) -> None:
    def by_house(envs: Any, policy: Any, steps: int, houses: int) -> np.ndarray:
        return np.tile(np.arange(houses), (3, envs.num_envs // houses))

    monkeypatch.setattr(explorers, "episode", by_house)
    study.play("oracle")
    kept = np.load(study.path("main", "oracle"))["targets"]
    assert kept.tolist() == [[0, 1, 2, 3]] * 3


def test_scores_are_kept_apart_by_what_made_them(study: Explorers, monkeypatch: pytest.MonkeyPatch) -> None:
    paths = {
        study.path("main", player)
        for player in ("oracle", "searcher", "as it is", "viewpoint_cost=5", "viewpoint_cost=6")
    }
    assert len(paths) == 5
    assert study.path("main", "near=7,gain_least=4") == study.path("main", "gain_least=4.0,near=7")
    before = study.path("main", "as it is"), study.path("main", "oracle")
    for changes in ({"steps": 30}, {"episodes": 3}):
        assert replace(study, **changes).path("main", "oracle") != before[1]
    monkeypatch.setattr(explorers.inspect, "getsource", lambda module: module.__name__ + "changed")
    assert study.path("main", "as it is") != before[0]


def test_a_variant_is_the_tuned_configuration_but_for_its_numbers() -> None:
    found = variant("replan_interval=48,viewpoint_cost=5")
    assert found == replace(TUNED, replan_interval=48, viewpoint_cost=5.0)
    assert isinstance(found.viewpoint_cost, float)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("replan_intervall=3", "is not a number of PlannerConfig. Did you mean replan_interval?"),
        ("replan_interval=48,Q=1", "Q is not a number"),
        ("", "nothing is not a number"),
        ("near=4.5", "near needs a number like its default, 8, not '4.5'"),
        ("near", "not ''"),
        ("floor_odds=3", "floor_odds is not a number"),
        ("viewpoint_pitch=5", "viewpoint_pitch must be a power of two, 4 or more, not 5"),
    ],
)
def test_an_unknown_name_is_one_line_before_anything_is_played(tmp_path: Path, text: str, says: str) -> None:
    with pytest.raises(RequestError) as caught:
        Explorers(set=(text,), out=tmp_path).run()
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)
    assert not list(tmp_path.iterdir())


def test_differences_are_of_the_same_houses() -> None:
    """Differences are computed by hand.

    Of 10 targets in each of four houses, one agent finds 4, 6, 4, 6. The other finds one more in two houses.
    """
    one = np.zeros((3, 4))
    one[0] = 4, 6, 4, 6
    other = one.copy()
    other[2, :2] += 1
    rooms, kept = np.array([2, 2, 3, 3]), {"as it is": one, "A=1": other}
    found = {name: {"targets": each, "microseconds": 3.0} for name, each in kept.items()}
    share, less = sheets("main", found, np.full(4, 10), rooms)
    assert share.rows[0] == ("as it is", "0.500", "0.500", "0.500", "0.500", "1.500", "0.000", "0.000", "3.0")
    error = "0.029"  # two of 0.1 and two of 0: their deviation 0.0577 over the root of 4
    none = "+0.000 ± 0.000"
    assert less.rows == [("A=1", f"+0.050 ± {error}", "+0.100 ± 0.000", none, none, none, "+0.150 ± 0.087")]
    assert list(cuts(one, rooms)) == ["mean", "2 rooms", "3 rooms", "first third", "second", "last"]
    assert difference(np.array([0.5])) == "+0.500 ± 0.000"


# Priors.


def places_of(envs: Any, house: int) -> np.ndarray:
    """Return the possible places of targets in a house (n, 2), metres."""
    world = envs.unwrapped.world
    return world.places[house].targets * world.config.step + origins_of(world).reshape(-1, 2)[house]


@pytest.mark.parametrize("what", ["floor", "rooms"])
def test_a_prior_has_the_ground_as_it_lies_in_the_house(what: str) -> None:
    envs, anywhere = (make_envs(HOUSES, len(HOUSES), targets) for targets in ("secondary", "mixed"))
    _, info = envs.reset(seed=0, options={"house": np.arange(len(HOUSES))})
    found = Informed(envs, what)
    found.begin(len(HOUSES))
    known = found.planner.arrays["prior"].numpy().reshape(-1, 128, 128)
    cell = found.planner.cell
    right, floor, counts = 0, 0, set()
    for e, (x, y, heading) in enumerate(info["pose"]):
        # Headings are counter-clockwise and y points south; a map's east is the body's first heading.
        quarter = round(heading / (np.pi / 4)) // 2
        east, south = [((1, 0), (0, 1)), ((0, -1), (1, 0)), ((-1, 0), (0, -1)), ((0, 1), (-1, 0))][quarter]
        for i, j in np.random.default_rng(e).integers(-30, 31, size=(200, 2)) * 2:
            at = np.array([x, y]) + cell * (i * np.array(east) + j * np.array(south))
            away = [np.linalg.norm(places_of(each, e) - at, axis=1).min() for each in (envs, anywhere)]
            theirs, some = (each < BESIDE for each in away)
            count = CERTAIN * some if what == "floor" else CERTAIN if theirs else ELSEWHERE * some
            # The prior knows about every fourth place: at the edge of floor it may know none.
            assert known[e, j % 256 // 2, i % 256 // 2] in (count, ELSEWHERE * some, 0)
            if away[what == "floor"] < BESIDE / 4:
                right, floor = right + (known[e, j % 256 // 2, i % 256 // 2] == count), floor + 1
            counts.add(count)
    assert right > 0.9 * floor > 20
    assert counts == ({0, CERTAIN} if what == "floor" else {0, ELSEWHERE, CERTAIN})


def test_each_planner_reads_its_own_prior() -> None:
    """Planners share a kernel, because a study plays in several modes by one process."""
    torch.set_num_threads(1)
    envs = make_envs(HOUSES, len(HOUSES), "secondary")
    kinds = []
    for what in (BLOCKED << WALL, CERTAIN):
        found = Informed(envs, "rooms")
        observation, _ = envs.reset(seed=0, options={"house": np.arange(len(HOUSES))})
        found.begin(len(HOUSES))
        found.planner.arrays["prior"].view()[:] = what
        found.look(torch.as_tensor(observation), torch.zeros(len(HOUSES), dtype=torch.bool))
        kinds.append(found.planner.read("kind").tolist())
    assert kinds == [[NONE] * len(HOUSES), [SEARCH] * len(HOUSES)]


def test_walls_are_known_and_nothing_counts_as_seen() -> None:
    torch.set_num_threads(1)
    envs = make_envs(HOUSES, len(HOUSES), "secondary")
    found = Informed(envs, "walls")
    policy = explorers.explorer(envs, found)
    explorers.episode(envs, policy, 150, len(HOUSES))
    once = found.planner.arrays["cells"].numpy()
    found.remember()
    explorers.episode(envs, policy, 1, len(HOUSES))
    again = found.planner.arrays["cells"].numpy()
    assert (again & OCCUPIED >= once & OCCUPIED).all()
    assert (once & OCCUPIED > 0).sum() > 500
    seen, before = ((cells & OCCUPIED - 1) >> FLAGS for cells in (again, once))
    assert set(np.unique(seen)) <= {0, 1}
    assert (seen > 0).sum() < (before > 0).sum() / 2


# Odds.


def explored(steps: int) -> tuple[Any, Explorer, TargetSpots]:
    """Return explorers after some steps, and the truth about their houses."""
    torch.set_num_threads(1)
    envs = make_envs(HOUSES, len(HOUSES), "mixed")
    observation, info = envs.reset(seed=0, options={"house": np.arange(len(HOUSES))})
    explorer = Explorer(shield(envs), envs.config)
    explorer.begin(len(HOUSES))
    truth = TargetSpots(envs, info["pose"], explorer.tracker.planner.cell)
    seen, blocked = torch.as_tensor(observation), torch.zeros(len(HOUSES), dtype=torch.bool)
    for _ in range(steps):
        seen, reward, _, _, info = envs.step_torch(explorer(seen, blocked))
        blocked = info["blocked"]
        truth.look(reward.numpy() > 0)
    explorer.tracker.look(seen, blocked)
    return envs, explorer, truth


def test_places_are_asked_by_the_beliefs_own_count_and_where_they_lie_in_the_house() -> None:
    envs, explorer, truth = explored(60)
    planner, pose = explorer.tracker.planner, envs.world.describe()[0]
    entries = MapPlaces(planner).ask()
    cells = planner.arrays["cells"].view().reshape(len(HOUSES), 256, 256)
    never = 0
    for e in range(len(HOUSES)):
        x, y, _ = planner.pose(e)
        assert truth.where(e, np.array([[x, y]]))[0] == pytest.approx(pose[e, :2], abs=1e-4)
        for j, i in np.argwhere(entries[e] >= 0):
            x, y = 2 * i, 2 * j
            if cells[e, y, x] >> FLAGS:
                assert entries[e, j, i] == CERTAIN
                continue
            never, met = never + 1, 8
            for dx, dy in [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)]:
                line = [
                    cells[e, (y + t * dy - (dy < 0)) % 256, (x + t * dx - (dx < 0)) % 256]
                    for t in range(1, TUNED.odds_range + 1)
                ]
                known = int(next((cell for cell in line if cell >> FLAGS), 0))
                met += -1 if known & OCCUPIED else int(known >> FLAGS > 0)
            assert entries[e, j, i] == met
    assert never > 50


def test_a_place_is_free_until_the_body_has_seen_it() -> None:
    _, _, truth = explored(0)
    floor = truth.trees[0].data - truth.starts[0, :2]
    heading = round(float(truth.starts[0, 2]) / (np.pi / 4)) // 2
    turn = np.array([[0, 1], [-1, 0]])  # clockwise, south being down
    nodes = floor @ np.linalg.matrix_power(turn.T, heading).T / truth.cell
    assert truth.where(0, nodes) == pytest.approx(truth.trees[0].data)
    seen = 1 - truth.free(0, nodes)
    assert 0 < seen.sum() < len(nodes)
    assert seen.sum() == truth.watch.share()[0] * len(nodes)
    truth.look(np.ones(len(HOUSES), bool))
    assert np.array_equal(1 - truth.free(0, nodes), seen)
    assert not truth.free(0, np.array([[1e4, 1e4]]))[0]


def test_places_are_counted_in_the_houses_that_they_are_of() -> None:
    free, asked = collect(HOUSES, 600)
    assert free.shape == asked.shape == (len(HOUSES), ENTRIES + 1)
    assert (free <= asked).all()
    assert asked.sum() > 50
    assert free[:, ENTRIES].sum() > 0.5 * asked[:, ENTRIES].sum() > 0  # most seen floor is free


def test_a_table_is_a_share_of_what_was_seen_before_whole_and_rising() -> None:
    asked = np.full(ENTRIES + 1, 100)
    free = np.array([0, 2, 2, 0, 3, 3, 3, 9, 20, 18, 40, 45, 45, 60, 80, 80, 90, 80])
    assert odds(free, asked)[10] == CERTAIN * 0.4 / 0.8
    assert table(free, asked) == (0, 0, 0, 0, 0, 0, 0, 11, 24, 24, 50, 56, 56, 75, 100, 100, 100)
    free[12] = asked[12] = 0  # no places of its kind: the entry equals the one before
    assert table(free, asked)[11:13] == (56, 56)


def test_an_error_is_that_of_houses_and_an_entry_without_places_is_left_open() -> None:
    """Half of the houses have a share of 0.6, half of 0.2: the mean's standard error is 0.2 / root 40."""
    asked = np.full((40, ENTRIES + 1), 100)
    free = np.tile(np.where(np.arange(40) % 2, 60, 20)[:, None], ENTRIES + 1)
    free[:, ENTRIES], asked[:, 3], free[:, 3] = 80, 0, 0
    rows = sheet(free, asked).rows
    value, _, error = rows[10][3].split()
    assert float(value) == 50
    assert float(error) == pytest.approx(CERTAIN * 0.2 / 40**0.5 / 0.8, rel=0.1)
    assert rows[3][:4] == ("-5", "0", "0", "-")
    assert [row[5] for row in rows[:-1]] == [str(entry) for entry in TUNED.floor_odds]


def test_a_searcher_that_knows_the_task_is_held_against_one_that_does_not(tmp_path: Path) -> None:
    save(HOUSES, tmp_path / "family-4.jsonl")
    study = Tasks(('{"task": "object", "piece": "table"}', "habit"), ("family",), 4, 1, tmp_path)
    study.run()
    page = (tmp_path / "tasks.md").read_text()
    assert page.count("| searcher, task |") == page.count("| explorer |") == 2
    assert page.count("| searcher, finds |") == 1  # an object goal has no shares to learn
    assert "| oracle | 1.00 |" in page
    kept = {path: path.stat().st_mtime_ns for path in tmp_path.glob("*.npz")}
    assert len(kept) == 9
    study.run()
    assert (tmp_path / "tasks.md").read_text() == page
    assert kept == {path: path.stat().st_mtime_ns for path in tmp_path.glob("*.npz")}


def test_a_task_that_is_none_is_refused_by_the_study(tmp_path: Path) -> None:
    save(HOUSES, tmp_path / "family-4.jsonl")
    with pytest.raises(RequestError, match="no task habits: did you mean habit"):
        Tasks(("habits",), ("family",), 4, 1, tmp_path).run()
