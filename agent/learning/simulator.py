"""Simulator that an agent is trained in, by its config; without torch, so that errors appear at once."""

from collections.abc import Iterable
from dataclasses import fields, replace

import msgspec

from vitruvius.agent.learning.config import TrainConfig
from vitruvius.logic import RequestError
from vitruvius.logic.spelling import unknown
from vitruvius.sim.actions import ACTIONS, FORWARD
from vitruvius.sim.allowed import allow, class_names
from vitruvius.sim.config import DEFAULT, PRESETS, SENSOR, Config
from vitruvius.sim.fields import stated
from vitruvius.sim.tasks.tasks import task

SENSED = tuple(each.name for each in fields(Config) if SENSOR in each.metadata)
"""Fields of a simulator's configuration that define what an agent observes."""

DISTURBED = "noise", "dropout"
"""Fields among these that define the error of an observation."""


def simulator(config: TrainConfig) -> Config:
    """Return the simulator that an agent is trained in: the preset, with the fields of ``sim``.

    Raises ``RequestError`` for an unknown field or an invalid value.
    """
    known = [field.name for field in fields(Config)]
    values = stated(PRESETS[config.world])
    given = set[str]()
    for text in config.sim:
        name, _, value = text.partition("=")
        if name in given:
            raise RequestError(f"--sim {text}: give each field once")
        given.add(name)
        if name not in known:
            raise RequestError(f"--sim {text}: {unknown('field', name, known)}")
        if not value:
            raise RequestError(f"--sim {text}: give a field and its value, as in --sim noise=0.05")
        try:
            values[name] = msgspec.json.decode(value)
        except msgspec.DecodeError:
            values[name] = value
        try:
            made = msgspec.convert(values, Config)
            if config.world != "drive":
                made.require_few_directions()
        except ValueError as error:
            raise RequestError(f"--sim {text}: {error}") from None
    made = msgspec.convert(values, Config)
    if made.observe != DEFAULT.observe or made.flat:
        raise RequestError(
            "--sim observe: the project's agents choose their own observations: leave it out. It is for "
            "environments of your own agents"
        )
    return made


def sensor(config: TrainConfig, world: str = "default") -> Config:
    """Return the simulator for an agent's evaluation: a preset's body and episodes, the agent's sensor."""
    learnt_in = simulator(config)
    measured_in = with_sensor(PRESETS[world], learnt_in)
    return replace(measured_in, drive=learnt_in.drive) if config.world == "drive" else measured_in


def actions(config: TrainConfig) -> int:
    """Return the number of actions of an agent: those of a lattice, or the commands of a body that drives.

    Raises ``RequestError`` if there are too few commands, or if the third does not go forward.
    """
    if config.world != "drive":
        return ACTIONS
    commands = simulator(config).drive.commands
    if len(commands) <= FORWARD or commands[FORWARD][0] <= 0:
        raise RequestError(
            f"world drive: {len(commands)} commands: give at least three, the third of them forward"
        )
    return len(commands)


def with_sensor(world: Config, seeing: Config = DEFAULT) -> Config:
    """Return a simulator with the observations of another; a world that has noise keeps its own noise."""
    kept = DISTURBED if world.noise or world.dropout else ()
    return replace(world, **{name: getattr(seeing, name) for name in SENSED if name not in kept})


def undisturbed(world: Config) -> Config:
    """Return a simulator without noise, drop-outs and slips."""
    return replace(world, noise=0.0, dropout=0.0, slip=0.0)


def require_task(targets: str) -> None:
    """Raise ``RequestError`` for a task that does not exist or that names a class that is not allowed."""
    try:
        task(targets)
    except ValueError as error:
        raise RequestError(str(error)) from None


def require_asked_task(targets: str) -> None:
    """Allow the class of a task that the command line states.

    Raises ``RequestError`` if there is no such task.
    """
    allow(*class_names(targets))
    require_task(targets)


def allow_named(names: Iterable[str]) -> None:
    """Allow files to name the classes of ``--allow``.

    Raises ``RequestError`` for a name that is not of the form module:Class.
    """
    try:
        allow(*names)
    except ValueError as error:
        raise RequestError(f"--{error}") from None
