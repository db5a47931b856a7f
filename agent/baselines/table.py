"""Table of the baselines: policies without training, which every evaluation compares with the agents.

| baseline | description |
|---|---|
| random + avoidance | the paper's random walk under the paper's avoidance rule (``RandomPolicy``) |
| script | goes to a target in sight, else looks around and walks (``Script``) |
| explorer | the planner without a network (``Explorer``) |
| searcher | knows the house, but not where the target is |
| oracle | knows the house and the target |

| baseline that drives | behaviour |
|---|---|
| random drive | draws a random speed and a random turn rate at each step |
| pursuit | drives to a visible target, or else along the longest rays, and turns in front of walls |
| explorer | plans paths, knows its pose, and follows its paths by a rule (``DrivingExplorer``) |
| true path | knows the house and the target, and follows the shortest path by a rule (``TruePath``) |

``KNOWS`` lists what the others know. Searcher, oracle and true path read the simulator's state, which no
agent may: they bound what an agent can reach. Scores in the backend ``free`` are shares of the true path's,
because the oracle counts steps on a lattice.
"""

from collections.abc import Callable

import torch

from vitruvius.agent.avoidance import PaperRule
from vitruvius.agent.baselines.driving.explorer import DrivingExplorer
from vitruvius.agent.baselines.driving.reactive import Pursuit, RandomDrive
from vitruvius.agent.baselines.driving.true_path import TruePath
from vitruvius.agent.baselines.privileged import Privileged
from vitruvius.agent.baselines.script import Script
from vitruvius.agent.baselines.searcher import Searcher
from vitruvius.agent.learning.environments import shield
from vitruvius.agent.policies.policies import Explorer, Policy, RandomPolicy
from vitruvius.logic import HouseFileError
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.oracle.oracle import Oracle

TRUE_PATH = "true path"
"""Name of the baseline that ratios divide by if bodies drive."""


def random_walk(envs: HouseVectorEnv, seed: int) -> Policy:
    """Return the policy random + avoidance, see above."""
    generator = torch.Generator().manual_seed(seed)
    return RandomPolicy(PaperRule(generator, distance=envs.config.column("distance")), generator)


def script(envs: HouseVectorEnv, seed: int) -> Policy:
    """Return a ``Script`` for the rays and the body of these environments."""
    return Script(envs.config.ray_angles, shield(envs), torch.Generator().manual_seed(seed))


def explorer(envs: HouseVectorEnv, seed: int) -> Policy:
    """Return the planner alone, under the shield."""
    return Explorer(shield(envs), envs.config)


def searcher(envs: HouseVectorEnv, seed: int) -> Policy:
    """Return the searcher, which knows the house, not the target."""
    searcher = Searcher(envs)
    return Privileged(searcher.act, searcher.begin)


def oracle(envs: HouseVectorEnv, seed: int) -> Policy:
    """Return the oracle, which takes a shortest path to each target."""
    return Privileged(Oracle(envs).act)


def true_path(envs: HouseVectorEnv, seed: int) -> Policy:
    """Return the policy of ``TruePath``. Raises ``HouseFileError`` for a house with too many corners."""
    try:
        return Privileged(TruePath(envs).act)
    except ValueError as error:
        raise HouseFileError(str(error)) from None


BASELINES: dict[str, Callable[[HouseVectorEnv, int], Policy]] = {
    "random + avoidance": random_walk,
    "script": script,
    "explorer": explorer,
    "searcher": searcher,
    "oracle": oracle,
}
"""Functions that make a baseline's policy from environments and a seed, by name. Every other score is divided
by the oracle's."""

DRIVING_BASELINES: dict[str, Callable[[HouseVectorEnv, int], Policy]] = {
    "random drive": lambda envs, seed: RandomDrive(envs.config, seed),
    "pursuit": lambda envs, seed: Pursuit(envs.config),
    "explorer": lambda envs, seed: DrivingExplorer(envs.config, lambda: envs.unwrapped.world.describe()[0]),
    TRUE_PATH: true_path,
}
"""The same for bodies that drive, in the backend ``free``. Every other score is divided by the score of the
true path."""


def baselines_of(backend: str) -> dict[str, Callable[[HouseVectorEnv, int], Policy]]:
    """Return the baselines that play in a backend."""
    return DRIVING_BASELINES if backend == "free" else BASELINES


KNOWS = {
    "random + avoidance": ("rays",),
    "script": ("rays", "bump", "last_action"),
    "explorer": ("rays", "bump", "last_action"),
    "random drive": (),
    "pursuit": ("rays",),
}
"""Signals that baselines without privileged knowledge act by, in the terms of
``vitruvius.sim.Config.observe``."""

PRIVILEGED = ("searcher", "oracle", TRUE_PATH)
"""Baselines that know where they are: noise and slips would only make their plans wrong."""

PAPERS = ("paper-original", "paper")
"""Agent of the paper: the weights that its authors released, and the same agent trained again here."""

REFERENCES = (*PAPERS, *BASELINES)
"""Policies that ``vitruvius evaluate`` shows with all agents."""

NO_AGENTS = (*REFERENCES, *DRIVING_BASELINES)
"""Names of all policies that are not agents."""
