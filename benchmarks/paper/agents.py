"""Scores of the original's weights, random walks, our baselines and the oracle at the paper's three tasks."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import torch

from benchmarks.common.pages import table_rows
from vitruvius.agent.avoidance import Free, PaperRule
from vitruvius.agent.baselines.table import explorer, oracle
from vitruvius.agent.evaluation.episodes import play
from vitruvius.agent.evaluation.result import HUMAN
from vitruvius.agent.learning.environments import make_envs
from vitruvius.agent.policies.policies import Policy, QPolicy
from vitruvius.agent.runs import checkpoint
from vitruvius.logic.files.writing import write_whole
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.config import DEFAULT, PAPER
from vitruvius.sim.environment.arguments import PAPER_HOUSE, house_list

TASKS = ("paper-main", "paper-secondary", "paper-mixed")

EPISODES, SEED = 100, 0
"""Number of episodes of each policy at each task, and their seed; all policies meet the same targets."""


def by_network(
    epsilon: float, homing: bool = True, avoids: bool = True
) -> Callable[[HouseVectorEnv], Policy]:
    """Return a function that makes a policy with the original's weights."""

    def make(envs: HouseVectorEnv) -> Policy:
        generator = torch.Generator().manual_seed(SEED)
        layer = PaperRule(generator) if avoids else Free()
        network = checkpoint.load("paper-original").network
        return QPolicy(network, layer, generator, epsilon, forward=0.92, homing=homing)

    return make


POLICIES: dict[str, Callable[[HouseVectorEnv], Policy]] = {
    "original weights, epsilon 0.025": by_network(0.025),
    "original weights, epsilon 0.025, no avoidance": by_network(0.025, avoids=False),
    "original weights, epsilon 0.19": by_network(0.19),
    "original weights, epsilon 0.5": by_network(0.5),
    "original weights, epsilon 0.5, no avoidance": by_network(0.5, avoids=False),
    "random walk, no homing": by_network(1.0, homing=False),
    "random walk with homing": by_network(1.0),
    "random walk with homing, no avoidance": by_network(1.0, avoids=False),
    "explorer": lambda envs: explorer(envs, SEED),
    "oracle": lambda envs: oracle(envs, SEED),
}
"""Policies by name. Only ``explorer`` does not play in the preset ``paper``: its collisions end no
episode."""


def measure(out: Path) -> dict[str, Any]:
    """Return the targets of each episode of each policy at each task, and the mean steps of an episode."""
    torch.set_num_threads(1)
    file = out / "paper-agents.json"
    data: dict[str, Any] = json.loads(file.read_text()) if file.exists() else {}
    for task in TASKS:
        done = data.setdefault(task, {})
        for name, make in POLICIES.items():
            if name not in done:
                world = DEFAULT if name == "explorer" else PAPER
                envs = make_envs(house_list(PAPER_HOUSE), EPISODES, task, preset=world)
                scores = play(envs, make(envs), SEED, np.zeros(EPISODES, np.int32))
                done[name] = {
                    "targets": scores.targets.astype(int).tolist(),
                    "steps": round(scores.steps / EPISODES, 1),
                }
                write_whole(file, json.dumps(data).encode())
    return {task: {name: data[task][name] for name in POLICIES} for task in TASKS}


def mean(targets: list[int]) -> str:
    """Return a mean with its standard error."""
    values = np.array(targets)
    return f"{values.mean():.2f} ± {values.std(ddof=1) / np.sqrt(values.size):.2f}"


def section(data: dict[str, Any]) -> str:
    """Return the table of all policies."""
    human = HUMAN["main"].targets
    rows = [["the paper's human", *(str(HUMAN[mode].targets) for mode in ("main", "secondary")), *"---"]]
    for name, main in data[TASKS[0]].items():
        more = np.mean(np.array(main["targets"]) > human)
        steps = " / ".join(f"{data[task][name]['steps']:.0f}" for task in TASKS)
        rows.append([name, *(mean(data[task][name]["targets"]) for task in TASKS), f"{more:.0%}", steps])
    return f"{HEAD.format(human=human)}\n{table_rows(rows)}"


HEAD = """| policy | main room | secondary rooms | all rooms | episodes above {human} in the main room | \
steps of an episode |
|---|---|---|---|---|---|"""
