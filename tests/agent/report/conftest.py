"""Runs small enough for frequent reports."""

import pytest

from tests import sample_houses
from vitruvius.agent.algorithms.build import network_of
from vitruvius.agent.algorithms.map_completion.config import CompletionConfig
from vitruvius.agent.algorithms.pqn.config import PQNConfig
from vitruvius.agent.recording import trace
from vitruvius.agent.recording.film import watch
from vitruvius.agent.recording.recorder import Recorder
from vitruvius.agent.runs.checkpoint import Checkpoint

HOUSE = sample_houses.drawn(sample_houses.ONE_ROOM, cell=1.0)
STEPS = 60


def untrained() -> Checkpoint:
    """Return an untrained agent without a map, so that the avoidance layer forbids many actions."""
    config = PQNConfig()
    return Checkpoint(network_of(config), config, 0, "untrained", "")


def with_planner() -> Checkpoint:
    """Return an untrained agent that keeps a map."""
    config = CompletionConfig()
    return Checkpoint(network_of(config), config, 0, "with planner", "")


def recorded(agent: Checkpoint) -> Recorder:
    """Record the first steps of an agent's episode in the house."""
    recorder = Recorder(agent.name, "main", 3)
    watch(agent, HOUSE, [recorder], seed=3, steps=STEPS)
    return recorder


@pytest.fixture(scope="session")
def mapped() -> trace.Trace:
    """Return an episode of an agent that keeps a map."""
    return recorded(with_planner()).trace
