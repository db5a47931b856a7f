"""Cases of each algorithm of the table: its folder here states them in ``cases.py``.

``SMALL`` has configs of runs of seconds, by name. ``WRONG`` has values that no run can have: a field with its
value, or the field that is named with several values. ``QUICK`` has the changes with which a preset learns
something in the record of agents; without it there are none.
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
