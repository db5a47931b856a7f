"""The table of algorithms: an algorithm is a folder with a config and a learner, and a line. 3 s."""

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from tests.agent.algorithms.cases import FOLDERS
from tests.sample_houses import random_house
from vitruvius.agent.algorithms.build import policy_of
from vitruvius.agent.algorithms.pqn.config import PQNConfig
from vitruvius.agent.algorithms.pqn.learner import PQN
from vitruvius.agent.algorithms.table import ALGORITHMS, Algorithm
from vitruvius.agent.evaluation.episodes import play
from vitruvius.agent.learning.environments import make_envs
from vitruvius.agent.runs import checkpoint
from vitruvius.agent.runs.runs import run

ROOT = Path(__file__).parents[3]


@dataclass(frozen=True)
class ForgetfulConfig(PQNConfig):
    """Parallel Q-learning without the ends of episodes."""

    forgets: bool = True
    """A field of its own."""

    algorithm: ClassVar[str] = "forgetful"


class Forgetful(PQN):
    """Its learner."""


def test_with_a_line_of_the_table_an_algorithm_trains_is_saved_and_plays(monkeypatch, tmp_path):
    line = Algorithm(ForgetfulConfig, f"{__name__}:{Forgetful.__name__}")
    monkeypatch.setitem(ALGORITHMS, line.config.algorithm, line)
    houses = [random_house(0)]
    config = ForgetfulConfig(num_envs=8, num_steps=16, steps=256, forgets=False)
    run(houses, config, tmp_path / "run")
    agent = checkpoint.load(tmp_path / "run" / "agent.safetensors")
    assert agent.config == config
    envs = make_envs(houses, 1, "main")
    assert play(envs, policy_of(agent.network, agent.config, envs), 0).steps > 0


def test_each_folder_of_algorithms_is_a_line_of_the_table_and_has_cases_here():
    folders = {path.parent.name for path in (ROOT / "agent" / "algorithms").glob("*/learner.py")}
    assert folders == {*FOLDERS.values()}
