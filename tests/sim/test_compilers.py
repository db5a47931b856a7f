"""Taichi and Quadrants, its maintained fork: the same bits from both, and an error for another name."""

import json
import os
import sys

import pytest

from tests.programs import finished
from vitruvius.sim.tracing import COMPILERS, VARIABLE

pytestmark = pytest.mark.second_part("every kernel is compiled by both compilers")

PLAYED = """
import hashlib
import json

import numpy as np
import torch

from vitruvius.agent.avoidance import Free
from vitruvius.agent.policies.policies import Explorer
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.tracing import compiler
from tests import sample_houses

E, STEPS = 16, 60
plan = np.random.default_rng(3).choice(3, p=[0.15, 0.15, 0.7], size=(STEPS, E))
driven = np.random.default_rng(3).uniform([0, -3], [0.7, 3], (STEPS, E, 2)).astype(np.float32)
house = sample_houses.drawn("aa+aa.bbb\\n......+bb\\n......bbb", cell=1.2)
found = {}
for backend in ("continuous", "grid", "free"):
    envs = HouseVectorEnv([house], num_envs=E, backend=backend, targets="mixed", max_episode_steps=40)
    seen = [envs.reset(seed=5)[0]]
    for actions in driven if backend == "free" else plan:
        observation, reward, *ends, info = envs.step(actions)
        seen += [observation, reward, *ends, info["pose"], info["target"]]
    found[backend] = seen
envs = HouseVectorEnv([house], num_envs=E, targets="mixed", max_episode_steps=40)
explorer = Explorer(Free())
explorer.begin(E)
observation, found["explorer"] = envs.reset(seed=5)[0], []
blocked = torch.zeros(E, dtype=torch.bool)
for _ in range(STEPS):
    actions = explorer(torch.from_numpy(observation), blocked)
    observation, *_, info = envs.step(actions.numpy())
    blocked = torch.from_numpy(info["blocked"])
    found["explorer"] += [actions.numpy(), observation]
hashes = {
    name: hashlib.sha256(b"".join(np.ascontiguousarray(each).tobytes() for each in arrays)).hexdigest()
    for name, arrays in found.items()
}
print(json.dumps([compiler.NAME, hashes]))
"""


def test_simulator_and_planner_go_the_same_way_on_taichi_and_on_its_fork() -> None:
    """All backends agree, and so does the explorer, whose map consists of kernels, too."""
    played = {}
    for name in COMPILERS:
        done = finished([sys.executable, "-c", PLAYED], env=os.environ | {VARIABLE: name})
        assert done.returncode == 0, done.stderr
        ran, played[name] = json.loads(done.stdout)
        assert ran.lower() == name
    assert played["taichi"] == played["quadrants"]
    assert len({*played["taichi"].values()}) == len(played["taichi"]) == 4


def test_another_compiler_is_an_error_by_its_name() -> None:
    said = "VITRUVIUS_RUNTIME: there is no 'numba': use one of taichi, quadrants"
    other = os.environ | {VARIABLE: "numba"}
    done = finished([sys.executable, "-c", "import vitruvius.sim"], env=other)
    assert done.stderr.splitlines()[-1] == f"vitruvius.logic.errors.RequestError: {said}"
    done = finished([sys.executable, "-m", "vitruvius.cli", "train", "houses.jsonl"], env=other)
    assert (done.returncode, done.stderr) == (2, f"error: {said}\n")
