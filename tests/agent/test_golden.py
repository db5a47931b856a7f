"""Every preset and the explorer do what they did when they were recorded: 1,500 steps of 8 environments.

``python -m tests.agent.test_golden`` prints the content of ``tests/golden/agent.json``: replace it only if
behaviour is meant to change. Actions are compared exactly. Weights are compared exactly only on the processor
and the torch release of the record, as others round sums of float32 differently. Losses are compared within a
tolerance everywhere.
"""

import hashlib
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import cpuinfo
import numpy as np
import pytest
import torch

from tests.agent.algorithms.cases import QUICK
from vitruvius.agent.algorithms.build import learner_of, network_of, policy_of
from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.agent.banks import benchmark
from vitruvius.agent.learning.environments import make_envs, shield
from vitruvius.agent.policies.policies import Explorer
from vitruvius.agent.runs import checkpoint
from vitruvius.agent.runs.released import released
from vitruvius.logic import generate
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.environment.arguments import PAPER_HOUSE, house_list
from vitruvius.sim.tasks.tasks import PAPER_TASKS

pytestmark = pytest.mark.second_part("each preset learns for a while")

FILE = Path(__file__).parents[1] / "golden" / "agent.json"
STEPS, ENVIRONMENTS = 1500, 8
RECORDED = [preset for preset, config in PRESETS.items() if not config.reads_maps]
"""Presets with a record. The choices of the other presets depend on the rounding of a processor."""

EXPLORERS = {
    "explorer, secondary": ("secondary", 0.0),
    "explorer, mixed": ("mixed", 0.0),
    "explorer, grid": ("secondary", 0.3),
}


def environments(
    targets: str, world: str = "default", cell: float = 0.0, backend: str = "continuous"
) -> HouseVectorEnv:
    houses = [*generate(4, cell=cell, count=ENVIRONMENTS)] if cell else benchmark()[:ENVIRONMENTS]
    if targets in PAPER_TASKS:  # tasks of one house
        houses = house_list(PAPER_HOUSE)
    where = "grid" if cell else backend
    return make_envs(houses, ENVIRONMENTS, targets, preset=world, backend=where)


def play(envs: HouseVectorEnv, policy: Any, look: Callable[[], tuple[torch.Tensor, ...]]) -> dict[str, Any]:
    """Return the digest of all actions, rewards and collisions, and of what ``look`` shows."""
    digest, shown, found = hashlib.sha256(), hashlib.sha256(), 0.0
    start = {"house": np.arange(ENVIRONMENTS)}
    observation = torch.as_tensor(envs.reset(seed=7, options=start)[0])
    blocked = torch.zeros(ENVIRONMENTS, dtype=torch.bool)
    policy.begin(ENVIRONMENTS)
    for _ in range(STEPS):
        actions = policy(observation, blocked)
        for part in look():
            shown.update(part.numpy().tobytes())
        observation, reward, *_, info = envs.step_torch(actions)
        blocked = info["blocked"]
        found += float(reward.sum())
        for part in (actions, reward, blocked):
            digest.update(part.numpy().tobytes())
    return {
        "found": found,
        "interventions": policy.interventions,
        "digest": digest.hexdigest(),
        "shown": {"machine": machine(), "digest": shown.hexdigest()},
    }


def played(preset: str) -> dict[str, Any]:
    """Return what a preset's policy does: that of its released agent, or of its first weights."""
    torch.set_num_threads(1)
    if preset in released():
        agent = checkpoint.load(preset)
        network, config = agent.network, agent.config
    else:
        config = PRESETS[preset]
        network = network_of(config).eval()
    envs = environments(config.targets, config.world, backend=config.backend)
    policy = policy_of(network, config, envs, seed=3)
    return play(envs, policy, lambda: ())


def explored(name: str) -> dict[str, Any]:
    """Return what the explorer does, with its advice and its planner's counts after each step."""
    targets, cell = EXPLORERS[name]
    envs = environments(targets, cell=cell)
    policy = Explorer(shield(envs), envs.config)

    def look() -> tuple[torch.Tensor, ...]:
        map = policy.tracker.planner
        return map.advice, *(map.read(name) for name in ("new", "path", "found"))

    return play(envs, policy, look)


def learnt(preset: str) -> dict[str, Any]:
    """Return what a preset learns in ``STEPS`` of each environment: losses and the digest of the weights."""
    torch.set_num_threads(1)
    config = PRESETS[preset]
    config = replace(config, num_envs=ENVIRONMENTS, steps=STEPS * ENVIRONMENTS, **QUICK[config.algorithm])
    envs = environments(config.targets, config.world, backend=config.backend)
    torch.set_float32_matmul_precision(config.precision)
    learner = learner_of(config, envs)
    reports = list(learner.train())
    torch.set_float32_matmul_precision("highest")
    weights = hashlib.sha256()
    for tensor in learner.network.state_dict().values():
        weights.update(tensor.numpy().tobytes())
    first = [report.loss for report in reports if report.loss][:4]
    return {"machine": machine(), "losses": first, "reports": len(reports), "weights": weights.hexdigest()}


def machine() -> str:
    """Return what the last bits of sums depend on."""
    cpu = cpuinfo.get_cpu_info()
    # Generations that round differently may have one name.
    processor = f"{cpu['brand_raw']}, family {cpu.get('family')}, model {cpu.get('model')}"
    return f"torch {torch.__version__}, {torch.backends.cpu.get_cpu_capability()}, {processor}"


GOLDEN = json.loads(FILE.read_text()) if FILE.exists() else {}


def record_of(name: str) -> dict[str, Any]:
    """Return the record; fail if there is none, as for a new preset."""
    assert name in GOLDEN, f"{FILE.name} has no {name!r}: ./run python -m tests.agent.test_golden prints it"
    return GOLDEN[name]


def same(found: dict[str, Any], golden: dict[str, Any]) -> None:
    """Assert that the actions are those recorded, and the shown values, too, on the same machine."""
    shown, recorded = found.pop("shown"), golden["shown"]
    assert found == {name: value for name, value in golden.items() if name != "shown"}
    if shown["machine"] == recorded["machine"]:
        assert shown == recorded


def test_all_that_is_recorded_is_compared() -> None:
    presets = {f"{preset}, {what}" for preset in RECORDED for what in ("played", "learnt")}
    assert set(GOLDEN) == {*EXPLORERS, *presets}


@pytest.mark.parametrize("name", EXPLORERS)
def test_the_explorer_does_what_it_did(name: str) -> None:
    same(explored(name), record_of(name))


@pytest.mark.parametrize("preset", RECORDED)
def test_a_presets_policy_does_what_it_did(preset: str) -> None:
    same(played(preset), record_of(f"{preset}, played"))


@pytest.mark.parametrize("preset", RECORDED)
def test_a_preset_learns_what_it_learnt(preset: str) -> None:
    recorded, found = record_of(f"{preset}, learnt"), learnt(preset)
    assert found["reports"] == recorded["reports"]
    assert found["losses"] == pytest.approx(recorded["losses"], rel=0.05, abs=1e-6)
    if found["machine"] == recorded["machine"]:
        assert found["weights"] == recorded["weights"]


if __name__ == "__main__":
    record = {name: explored(name) for name in EXPLORERS}
    record |= {f"{preset}, played": played(preset) for preset in RECORDED}
    record |= {f"{preset}, learnt": learnt(preset) for preset in RECORDED}
    print(json.dumps(record, indent=1))
