"""Cases of each algorithm of the table: its folder here states them in ``cases.py``.

``SMALL`` has configs of runs that take seconds, by name. ``WRONG`` has invalid values: the name of the field
that the error names, and its value or a mapping of several fields to values. ``QUICK``, if there is one, has
the changes of a preset for the golden record of agents, in which it must learn something.
"""

from importlib import import_module
from typing import Any

from vitruvius.agent.algorithms.table import TABLE
from vitruvius.agent.learning.config import TrainConfig

FOLDERS = {each.config.algorithm: each.learner.split(".")[-2] for each in TABLE}
"""Folder of each algorithm, here and in ``agent/algorithms``."""

CASES = {name: import_module(f"tests.agent.algorithms.{folder}.cases") for name, folder in FOLDERS.items()}

SMALL: dict[str, TrainConfig] = {
    name: config for each in CASES.values() for name, config in each.SMALL.items()
}

WRONG: list[tuple[type[TrainConfig], str, Any]] = [
    (each.config, *wrong) for each in TABLE for wrong in CASES[each.config.algorithm].WRONG
]

QUICK = {name: getattr(each, "QUICK", {}) for name, each in CASES.items()}
