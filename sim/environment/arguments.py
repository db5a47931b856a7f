"""Arguments of environments, read and checked: houses, backend and configuration."""

import pkgutil
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from vitruvius.logic import House, load
from vitruvius.logic.spelling import unknown
from vitruvius.sim.allowed import allow, class_names, imported, is_class_name
from vitruvius.sim.backends.backend import METHODS, Backend
from vitruvius.sim.config import PRESETS, Config
from vitruvius.sim.drive import Drive
from vitruvius.sim.environment.observed import require_observed
from vitruvius.sim.environment.rotation import HouseRotation
from vitruvius.sim.fields import made
from vitruvius.sim.geometry import check_lengths
from vitruvius.sim.tasks.tasks import PAPER, AnyTask, Targets, task
from vitruvius.sim.tasks.terms import terms_of

Preset = str | Config | dict[str, Any]
"""Name of a preset, a configuration, or a dictionary of the fields that differ from the preset
``default``."""

Houses = str | Path | Sequence[House] | dict[str, Any] | HouseRotation

BANK = Path(__file__).with_name("houses.jsonl.gz")
"""File of 32 default houses, made by ``vitruvius generate --rooms 4 --count 32 --out`` this file."""

CELL_HOUSES = "cell-houses"
"""Name of 32 more houses in cells of 0.3 m, for the backend ``grid``, generated with ``--cell 0.3``."""

PAPER_HOUSE = "paper-house"
"""Name of the house of the paper's figures: 2019-2-15, in whole pixels."""

DEVICES = {"cpu": "cpu", "cuda": "cuda", "cuda:0": "cuda"}
"""Our names of devices by torch's names. Taichi has one GPU, the first that it can see."""

MOST_ENVIRONMENTS = 1 << 24
"""Largest number of environments. With more, Taichi's arrays have more elements than it can count."""

METADATA: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 30}
"""Metadata of one environment. For ``human``, Gymnasium shows the environment in a window."""

METADATA_OF_MANY: dict[str, Any] = METADATA | {"render_modes": ["human", "rgb_array"]}

BACKENDS = {
    "continuous": "vitruvius.sim.backends.continuous:Continuous",
    "free": "vitruvius.sim.backends.free:FreeMotion",
    "grid": "vitruvius.sim.backends.grid:Grid",
}


class Arguments(NamedTuple):
    """Arguments of environments, read and checked without Taichi."""

    config: Config
    backend: type[Backend]
    houses: list[House]
    rotation: HouseRotation | None
    task: AnyTask
    device: str


def read_arguments(
    houses: Houses,
    backend: str,
    targets: Targets,
    preset: Preset,
    max_episode_steps: int | None,
    render_mode: str | None,
    device: str,
    metadata: dict[str, Any] = METADATA,
) -> Arguments:
    """Read the arguments of ``HouseVectorEnv``. Raises ``ValueError`` that names the wrong argument.

    ``config`` is the backend's configuration for these houses. Packing checks later if the houses have places
    for the targets.
    """
    device = DEVICES.get(str(device), str(device))  # torch's names, too: torch.device("cuda:0")
    require("device", device, DEVICES)
    allow(*class_names(targets), *class_names(backend))
    wanted = task(targets)
    if max_episode_steps is None:
        max_episode_steps = terms_of(wanted).steps or None
    config = configuration(preset, max_episode_steps)
    if render_mode not in (None, *metadata["render_modes"]):
        raise ValueError(f"unknown render_mode {render_mode!r}: choose one of {metadata['render_modes']}")
    make = backend_class(backend)
    rotation = houses if isinstance(houses, HouseRotation) else None
    bank = house_list(houses)
    check_lengths(bank)
    config = make.fit(replace(config, drives=False, memory=terms_of(wanted).memory), bank)
    if not config.drives and config.drive != Drive():
        raise ValueError(f"preset has a drive, which backend {backend!r} does not use: use the backend free")
    require_observed(config, make)
    if config.varies("speed", "acceleration") and not config.drives:
        raise ValueError(
            "varied: robots of this backend do not drive: speed and acceleration need the backend free"
        )
    if config.varies("width") and not (hasattr(make, "move_with") or hasattr(make, "drive")):
        raise ValueError(
            "varied: robots of this backend have a fixed width: use the backend continuous or free"
        )
    if config.drives and terms_of(wanted).asks_distance:
        raise ValueError(
            f"backend {backend!r} does not provide the distance to the target, which the task's terms use"
        )
    return Arguments(config, make, bank, rotation, wanted, device)


def house_list(houses: Houses) -> list[House]:
    """Return the houses of a file, a request for ``vitruvius.generate``, a list or a rotation's first period.

    ``CELL_HOUSES`` and ``PAPER_HOUSE`` are names of built-in houses. Raises ``ValueError`` if there are no
    houses.
    """
    if isinstance(houses, HouseRotation):
        houses = list(houses.period(0))
    if isinstance(houses, dict):
        from vitruvius.logic import generate

        houses = list(generate(**houses))
    elif str(houses) == PAPER_HOUSE:
        houses = load(PAPER / "house.json", whole_pixels=True)
    elif str(houses) == CELL_HOUSES:
        houses = load(BANK.with_name("cells.jsonl.gz"))
    elif isinstance(houses, str | Path):
        houses = load(houses)
    if not isinstance(houses, Iterable):
        raise ValueError(f"houses must be a path, a request or a list of House, not {type(houses).__name__}")
    houses = [House.from_dict(each) if isinstance(each, dict) else each for each in houses]
    if not houses:
        raise ValueError("no house to simulate: the list of houses is empty")
    for strange in (each for each in houses if not isinstance(each, House)):
        raise ValueError(
            f"houses must be a path, a request or a list of House, not of {type(strange).__name__}"
        )
    return houses


def backend_class(name: str) -> type[Backend]:
    """Return the backend of a name or an allowed ``module:Class``. Raises ``ValueError`` if there is none."""
    if not isinstance(name, str):
        raise ValueError(
            f"backend must be a name, one of {', '.join(BACKENDS)} or module:Class, not {name!r}"
        )
    if name not in BACKENDS and not is_class_name(name):
        raise ValueError(f"{unknown('backend', name, BACKENDS)}, or module:Class")
    try:
        make = pkgutil.resolve_name(BACKENDS[name]) if name in BACKENDS else imported(name)
    except (ImportError, AttributeError, TypeError, ValueError) as error:
        raise ValueError(f"backend {name!r} cannot be used: {error}") from None
    if not isinstance(make, type):
        raise ValueError(f"backend {name!r} cannot be used: it is not a class")
    lacking = next((method for method in METHODS if not callable(getattr(make, method, None))), None)
    if lacking:
        raise ValueError(
            f"backend {name!r} cannot be used: it has no {lacking}(), "
            "see vitruvius.sim.backends.backend.Backend"
        )
    return make


def configuration(preset: Preset, max_episode_steps: int | None) -> Config:
    """Return the configuration of a preset. ``max_episode_steps`` replaces the length of its episodes."""
    if isinstance(preset, Mapping):
        preset = made(Config, preset, "field of preset")
    elif not isinstance(preset, Config):
        require("preset", preset, PRESETS)
        preset = PRESETS[preset]
    if max_episode_steps is not None:
        preset = replace(preset, steps=whole("max_episode_steps", max_episode_steps, 2**31 - 1))
    return preset


def whole(name: str, value: Any, most: int) -> int:
    """Return a number from 1 to ``most``. Raises ``ValueError`` for any other value."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise ValueError(f"{name} must be a whole number, not {value!r}")
    if not 1 <= value <= most:
        raise ValueError(f"{name} is {value}: it must be 1 to {most:,}")
    return int(value)


def require(name: str, value: Any, known: Any) -> None:
    """Raise ``ValueError`` unless the value is one of the known values."""
    if value not in list(known):  # compared by equality, because the value may have no hash
        raise ValueError(unknown(name, value, known))
