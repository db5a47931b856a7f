"""The simulator that an agent learns in, by its config. Without torch, so that a mistake is told at once."""

from collections.abc import Iterable
from dataclasses import fields, replace

import msgspec

from agent.learning.config import TrainConfig
from logic import RequestError
from logic.spelling import unknown
from sim.actions import ACTIONS, FORWARD
from sim.allowed import allow, class_names
from sim.config import DEFAULT, PRESETS, SENSOR, Config
from sim.fields import stated
from sim.tasks.tasks import task

SENSED = tuple(each.name for each in fields(Config) if SENSOR in each.metadata)
"""The fields of a simulator's configuration that say what an agent observes."""

DISTURBED = "noise", "dropout"
"""Those of them that say how wrong it is."""


def simulator(config: TrainConfig) -> Config:
    """The simulator that an agent learns in: the preset, with the fields of ``sim``.

    Raises ``RequestError`` for a field, or a value of one, that cannot be.
    """
    known = [field.name for field in fields(Config)]
    values = stated(PRESETS[config.world])
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
            made = msgspec.convert(values, Config)
            if config.world != "drive":
                made.require_few_directions()
        except ValueError as error:
            raise RequestError(f"--sim {text}: {error}") from None
    made = msgspec.convert(values, Config)
    if made.observe != DEFAULT.observe or made.flat:
        raise RequestError(
            "--sim observe: agents that come with the project read rays, bumps and their own actions by "
            "themselves: leave it out, and give it to the environments of an agent of your own"
        )
    return made


def sensor(config: TrainConfig, world: str = "default") -> Config:
    """The simulator that an agent is measured in: a preset's body and episodes, with the agent's sensor."""
    learnt_in = simulator(config)
    measured_in = with_sensor(PRESETS[world], learnt_in)
    return replace(measured_in, drive=learnt_in.drive) if config.world == "drive" else measured_in


def actions(config: TrainConfig) -> int:
    """How many actions an agent chooses from: a body's on a lattice, or the commands of one that drives.

    Raises ``RequestError`` where that has too few, or the third one does not go forward.
    """
    if config.world != "drive":
        return ACTIONS
    commands = simulator(config).drive.commands
    if len(commands) <= FORWARD or commands[FORWARD][0] <= 0:
        raise RequestError(f"world drive: {len(commands)} commands: three at least, the third one forward")
    return len(commands)


def with_sensor(world: Config, seeing: Config = DEFAULT) -> Config:
    """A simulator with what another one's body observes, but for the noise of a world that has its own."""
    kept = DISTURBED if world.noise or world.dropout else ()
    return replace(world, **{name: getattr(seeing, name) for name in SENSED if name not in kept})


def undisturbed(world: Config) -> Config:
    """A simulator without noise, drop-outs and slips."""
    return replace(world, noise=0.0, dropout=0.0, slip=0.0)


def require_task(targets: str) -> None:
    """Raise ``RequestError`` for a task that does not exist or that names a class that is not allowed."""
    try:
        task(targets)
    except ValueError as error:
        raise RequestError(str(error)) from None


def require_asked_task(targets: str) -> None:
    """Allow the class of a task that the command line states.

    Raises ``RequestError`` where there is no such task.
    """
    allow(*class_names(targets))
    require_task(targets)


def allow_named(names: Iterable[str]) -> None:
    """Allow files to name the classes of ``--allow``. Raises ``RequestError`` for a name not of the form
    module:Class.
    """
    try:
        allow(*names)
    except ValueError as error:
        raise RequestError(f"--{error}") from None
