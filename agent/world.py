"""Where an agent meets the simulator: make environments, and the avoidance layers for their bodies."""

from collections.abc import Sequence
from dataclasses import asdict, fields, replace
from typing import cast

import gymnasium
import msgspec
import torch

from agent.avoidance import Free, Layer, PaperRule, Shield, air
from agent.config import TrainConfig
from logic import House, HouseFileError, RequestError
from logic.spelling import keywords, unknown
from sim import HouseVectorEnv
from sim.config import DEFAULT, PRESETS, Config
from sim.tasks import task

SENSOR = "rays", "first_ray", "ray_spacing", "range", "sees_angle", "sees_kind", "noise", "dropout"
"""The fields of a simulator's configuration that say what an agent observes."""


def simulator(config: TrainConfig) -> Config:
    """The simulator that an agent learns in: the preset, with the fields of ``sim``.

    Raises ``RequestError`` for a field, or a value of one, that cannot be.
    """
    known = [field.name for field in fields(Config)]
    values = asdict(PRESETS[config.world])
    given = set[str]()
    for text in config.sim:
        name, _, value = text.partition("=")
        if name in given:
            raise RequestError(f"--sim {text}: give each field once")
        given.add(name)
        if name not in known or not value:
            wrong = "" if name in known else f": {unknown('field', name, known)}"
            raise RequestError(f"--sim {text}: give a field and its value, as in --sim noise=0.05{wrong}")
        try:
            values[name] = msgspec.json.decode(value)
        except msgspec.DecodeError:
            values[name] = value
        try:
            msgspec.convert(values, Config)
        except ValueError as error:
            raise RequestError(f"--sim {text}: {error}") from None
    return msgspec.convert(values, Config)


def sensor(config: TrainConfig) -> Config:
    """The simulator that an agent is measured in: the default body and episodes, with the agent's sensor."""
    learnt_in = simulator(config)
    return replace(DEFAULT, **{name: getattr(learnt_in, name) for name in SENSOR})


def require_task(targets: str) -> None:
    """Raise ``RequestError`` where there is no such task."""
    try:
        task(targets)
    except ValueError as error:
        raise RequestError(str(error)) from None


@keywords(config="preset", mode="targets", num_envs="number")
def make_envs(
    houses: Sequence[House],
    number: int,
    targets: str = "main",
    *,
    preset: str | Config = "default",
    backend: str = "continuous",
    device: str = "cpu",
) -> HouseVectorEnv:
    """That many environments over a bank of houses, as ``gymnasium.make_vec`` gives them, without wrappers.

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
    """The avoidance layer for the body and the rays of these environments."""
    config = envs.config
    return Shield(
        config.ray_angles, reach=config.range, body=config.body[0], step=config.step, margin=air(config)
    )


def layer_of(config: TrainConfig, envs: HouseVectorEnv, generator: torch.Generator) -> Layer:
    """The config's avoidance layer, for the body and the rays of these environments."""
    match config.avoidance:
        case "paper":
            return PaperRule(generator)
        case "none":
            return Free()
    return shield(envs)
