"""Other libraries' algorithms in our houses: each example learns, plays, and writes its scores."""

import importlib.util
import json
import re
import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import gymnasium
import jsonschema
import numpy as np
import pytest
import torch
from gymnasium.vector import AutoresetMode

from tests.agent.evaluation.cases import SHORT, short_episodes
from tests.sim.conformance.claims import check_vector_env
from vitruvius.agent.banks import benchmark
from vitruvius.agent.baselines.table import REFERENCES
from vitruvius.commands.evaluate import Evaluate
from vitruvius.logic import HouseFileError, generate, save

pytestmark = pytest.mark.second_part("agents of other libraries learn")

ROOT = Path(__file__).parents[1]
EXAMPLES = ROOT / "examples"
LIBRARIES = {
    "stable_baselines": "stable_baselines3",
    "free_motion": "stable_baselines3",
    "hindsight": "stable_baselines3",
    "torchrl_ppo": "torchrl",
    "one_file": "torch",
}
KNOWS = ("rays", "bump", "last_action")


@pytest.fixture(scope="module", autouse=True)
def short():
    with short_episodes():
        yield


@pytest.fixture(scope="module", autouse=True)
def path():
    """Make the examples' folder importable, as for scripts in it; set one thread, as batches are small."""
    torch.set_num_threads(1)
    sys.path.insert(0, str(EXAMPLES))
    yield
    sys.path.remove(str(EXAMPLES))


@pytest.fixture(scope="module")
def houses(tmp_path_factory):
    file = tmp_path_factory.mktemp("banks") / "houses.jsonl"
    save(generate(rooms=2, seed=0, count=2), file)
    return file


def example(name: str) -> ModuleType:
    """Return the script as a module; skip the test if the library that it needs is missing."""
    pytest.importorskip(LIBRARIES.get(name, "torch"))
    spec = importlib.util.spec_from_file_location(f"example_{name}", EXAMPLES / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("stable_baselines", {"algorithm": "dqn", "avoid": True, "observe": KNOWS, "stack": 4}),
        ("stable_baselines", {"algorithm": "ppo"}),
        ("torchrl_ppo", {"avoid": True}),
        ("one_file", {"avoid": True, "observe": KNOWS}),
    ],
)
def test_an_example_learns_plays_and_writes_its_score(name, options, houses, tmp_path, capsys):
    file = tmp_path / "score.json"
    run = example(name).Example(houses, held_out=houses, steps=256, environments=4, out=file, **options).run
    run()
    line = capsys.readouterr().out.splitlines()[-1]
    record: dict[str, Any] = json.loads(file.read_text())
    (agent,) = record["agents"]
    assert line.startswith(f"{agent}, 256 steps: ")
    assert agent.endswith(" + avoidance") == options.get("avoid", False)
    assert (record["bank"]["houses"], record["training_steps"]) == (2, 256)
    mode = record["targets"]["main"]
    assert set(mode["policies"]) == {agent, "oracle"}
    assert mode["policies"]["oracle"]["figures"]["ratio"]["value"] == 1
    (run,) = mode["policies"][agent]["runs"]
    assert run["steps"] == 2 * SHORT.steps
    if "avoid" in options:
        assert run["interventions"] > 0
        assert run["blocked"] < 100


def test_an_examples_scores_are_a_row_of_evaluates_tables(houses, tmp_path, capsys):
    """An agent that always turns left is compared with the references; the oracle did the same for both."""
    file, out = tmp_path / "score.json", tmp_path / "out"
    task = example("task").Task(houses, held_out=houses, out=file)
    task.score("dizzy", lambda seen: torch.tensor([1.0, 0.0, 0.0]).expand(len(seen), 3))
    capsys.readouterr()
    assert Evaluate(houses=houses, targets=("main",), scores=(file,), json=True, out=out).run() == 0
    found, schema = json.loads(capsys.readouterr().out), ROOT / "docs" / "answers.schema.json"
    jsonschema.validate(found, json.loads(schema.read_text()))
    ours, theirs = found["answer"], json.loads(file.read_text())
    assert ours["scores"] == [str(file)]
    ours, theirs = (each["targets"]["main"]["policies"] for each in (ours, theirs))
    assert list(ours) == ["dizzy", *REFERENCES]
    for name in ("dizzy", "oracle"):
        assert ours[name]["runs"] == theirs[name]["runs"]
        assert ours[name]["figures"]["ratio"] == theirs[name]["figures"]["ratio"]
    assert "| dizzy |" in (out / "evaluation.md").read_text()


def test_under_avoidance_worlds_keep_gymnasiums_promises_and_turn_before_they_bump(houses):
    task = example("task")
    free, avoiding = (task.Task(houses, environments=4, avoid=avoid).make_envs() for avoid in (False, True))
    assert avoiding.autoreset_mode is AutoresetMode.SAME_STEP
    # JSON has no Config, which states the observations.
    check_vector_env(avoiding, steps=SHORT.steps + 100, skip=["close", "spec"])
    bumps = []
    for envs in (free, avoiding):
        envs.reset(seed=0)
        bumps.append(sum(envs.step(np.full(4, 2))[-1]["blocked"].sum() for _ in range(300)))
    assert bumps[0] > 500
    assert bumps[1] < 10


def test_nobody_learns_in_the_benchmark_bank(tmp_path):
    file = tmp_path / "houses.jsonl"
    save(benchmark()[:1], file)
    with pytest.raises(HouseFileError, match="reserved for evaluation"):
        example("task").Task(file).make_envs()


@pytest.mark.parametrize("name", LIBRARIES)
def test_an_example_is_short(name):
    lines = (EXAMPLES / f"{name}.py").read_text().splitlines()
    assert len(lines) <= 80


def test_a_behaviour_layer_forbids_turns_where_the_way_ahead_is_free_and_an_agent_plays_under_it(
    houses, capsys
):
    module = example("own_behaviour")
    seen = torch.zeros(3, 40, 2)
    seen[0, :, 0] = seen[2, :, 0] = 0.5
    seen[2, 3, 1] = 1
    allowed = module.stride(seen, torch.zeros(3, dtype=torch.bool))
    assert allowed.tolist() == [[False, False, True], [True, True, True], [True, True, True]]
    module.main(houses)
    without, under = capsys.readouterr().out.splitlines()
    assert without.startswith("shield: ")
    assert under.startswith("shield, stride: ")
    assert int(under.split(", ")[-1].split()[0]) > int(without.split(", ")[-1].split()[0])


def test_the_page_of_use_shows_the_behaviour_layer_of_the_example() -> None:
    page = (EXAMPLES.parent / "docs" / "use.md").read_text()
    shown = re.findall(r"```python\n(def stride.*?)```", page, re.DOTALL)
    assert shown
    assert shown[0] in (EXAMPLES / "own_behaviour.py").read_text()


def test_the_example_of_continuous_control_learns_and_plays_beside_its_baselines(houses, capsys, monkeypatch):
    free: Any = example("free_motion")
    driving: Any = sys.modules["driving"]
    monkeypatch.setattr(driving, "CONFIG", replace(driving.CONFIG, steps=20))
    found = free.Example(houses, held_out=houses, steps=256, environments=4).run()
    assert list(found) == ["SB3 PPO", "pursuit", "random"]
    assert "random: " in capsys.readouterr().out


def test_a_stack_of_frames_is_that_of_stable_baselines():
    """The rows are those of the library's own wrapper, which learns from them, until an episode ends."""
    frames = pytest.importorskip("stable_baselines3.common.vec_env")
    from vitruvius.sim.adapters.stable_baselines import StableBaselinesVecEnv

    task = example("task")
    envs = gymnasium.make_vec(
        "Vitruvius/House-v0", 3, preset=task.Task(Path()).config, autoreset_mode="SameStep"
    )
    theirs, ours = frames.VecFrameStack(StableBaselinesVecEnv(envs), 4), task.Frames(4, 80)
    ours.begin(3)
    seen = theirs.reset()
    for _ in range(10):
        np.testing.assert_array_equal(ours(torch.from_numpy(seen[:, -80:])).numpy(), seen)
        seen = theirs.step(np.array([2, 1, 0]))[0]


def test_hindsight_learns_through_the_adapter(houses, monkeypatch, capsys):
    module = example("hindsight")
    monkeypatch.setattr(module, "CONFIG", replace(module.CONFIG, steps=12))
    assert 0 <= module.main(houses, steps=400, environments=4) <= 1
    assert capsys.readouterr().out.startswith("400 steps: ")
