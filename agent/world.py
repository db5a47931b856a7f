"""Where an agent meets the simulator: make worlds, and read off the body that the shield guards."""

from collections.abc import Sequence
from typing import cast

import gymnasium

from agent.avoidance import Shield, air
from logic import House, HouseFileError
from sim import HouseVectorEnv
from sim.config import Config


def make_worlds(
    houses: Sequence[House],
    number: int,
    targets: str = "main",
    *,
    preset: str | Config = "default",
    backend: str = "continuous",
    device: str = "cpu",
) -> HouseVectorEnv:
    """So many environments over a bank of houses, as ``gymnasium.make_vec`` gives them, without wrappers.

    Raises ``HouseFileError`` where the body or a target has no place in one of the houses.
    """
    try:
        envs = gymnasium.make_vec(
            "sim:Vitruvius/House-v0",
            num_envs=number,
            houses=houses,
            targets=targets,
            preset=preset,
            backend=backend,
            device=device,
        )
    except ValueError as error:
        raise HouseFileError(str(error)) from None
    return cast(HouseVectorEnv, envs.unwrapped)


def shield(envs: HouseVectorEnv) -> Shield:
    """The avoidance layer for the body and the rays of these worlds."""
    world = envs.config
    return Shield(world.ray_angles, reach=world.range, body=world.body[0], step=world.step, margin=air(world))
