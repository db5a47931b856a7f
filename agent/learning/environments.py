"""Factories of environments, and of the avoidance layers for their bodies."""

import shlex
from collections.abc import Sequence
from typing import cast

import gymnasium
import torch

from vitruvius.agent.avoidance import Free, Layer, PaperRule, Shield, air
from vitruvius.agent.learning.config import TrainConfig
from vitruvius.agent.learning.simulator import actions, require_task, simulator
from vitruvius.logic import House, HouseFileError, RequestError
from vitruvius.logic.spelling import keywords
from vitruvius.sim import HouseRotation, HouseVectorEnv
from vitruvius.sim.config import Config
from vitruvius.sim.environment.arguments import backend_class
from vitruvius.sim.tasks.tasks import Targets, suited, task


@keywords(config="preset", mode="targets", num_envs="number")
def make_envs(
    houses: Sequence[House] | HouseRotation,
    number: int,
    targets: Targets = "main",
    *,
    preset: str | Config = "default",
    backend: str = "continuous",
    device: str = "cpu",
) -> HouseVectorEnv:
    """Return ``number`` environments over a bank of houses, as ``gymnasium.make_vec`` does, without wrappers.

    ``targets`` and ``backend`` may come from a file: a ``module:Class`` in them must be allowed
    (``vitruvius.sim.allow``).

    Raises ``HouseFileError`` if one of the houses has no place for the body or for a target.
    """
    try:
        backend_class(backend)
        envs = gymnasium.make_vec(
            "Vitruvius/House-v0",
            num_envs=number,
            houses=houses,
            targets=task(targets),
            preset=preset,
            backend=backend,
            device=device,
        )
    except ValueError as error:
        raise HouseFileError(str(error)) from None
    return cast(HouseVectorEnv, envs.unwrapped)


def playable(
    houses: Sequence[House], targets: str, *, preset: str | Config = "default", backend: str = "continuous"
) -> list[House]:
    """Return the houses in which a task can be played, in their order.

    These are all houses, unless the task states which houses suit it: then they are the suitable ones that
    have a place for a target. If there are none, they are all houses again.
    """
    known = task(targets)
    if not hasattr(known, "suits"):
        return list(houses)

    def fits(house: House) -> bool:
        try:
            make_envs([house], 1, targets, preset=preset, backend=backend)
        except HouseFileError:
            return False
        return True

    return [house for house in suited(known, houses) if fits(house)] or list(houses)


def require_own_maps(config: TrainConfig, envs: HouseVectorEnv) -> None:
    """Raise ``RequestError`` for another task than a reader of maps was trained on, or another cell size."""
    name, body, learnt = (
        config.algorithm.replace("-", " "),
        max(envs.config.body),
        max(simulator(config).body),
    )
    if body != learnt:
        raise RequestError(
            f"{name} was trained on maps of a robot {learnt:.3f} m wide and cannot read those of one "
            f"{body:.3f} m wide"
        )
    require_task(config.targets)
    if task(config.targets) != envs.world.task:
        raise RequestError(
            f"{name} runs only the task that it was trained on: give --targets {shlex.quote(config.targets)}"
        )


def shield(envs: HouseVectorEnv) -> Shield:
    """Return the avoidance layer for the body and the rays of these environments."""
    config = envs.config
    config.require_lattice("the action mask shield")
    return Shield(
        config.ray_angles,
        config.range,
        config.body[0],
        config.step,
        margin=air(config),
        noise=config.most("noise"),
        distance=config.column("distance"),
        door=config.column("is door") if config.sees_doors else None,
        device=envs.device,
    )


def layer_of(config: TrainConfig, envs: HouseVectorEnv, generator: torch.Generator) -> Layer:
    """Return the config's avoidance layer, for the body and the rays of these environments.

    Raises ``RequestError`` if the environments have another kind of motion than those in training.
    """
    if envs.config.drives != (config.world == "drive"):
        raise RequestError(
            "an agent that drives runs only in the backend free"
            if config.world == "drive"
            else "the agent moves in grid steps, which the backend free does not have"
        )
    match config.avoidance:
        case "paper":
            return PaperRule(generator, distance=envs.config.column("distance"))
        case "none":
            return Free(actions(config))
    return shield(envs)
