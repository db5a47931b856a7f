"""The study of agents as a page: a function of its records alone."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from agent.evaluate import Score
from agent.protocol import Result


@dataclass(frozen=True)
class Entry:
    """What is trained, by several seeds."""

    name: str
    preset: str
    options: tuple[str, ...]
    """What differs from the preset, as options of ``vitruvius train``."""
    steps: int
    """Environment steps of each run."""
    targets: str
    """Where targets lie while it learns."""
    shows: str
    """What it is there for, in words."""
    beside: str = ""
    """The entry that it is a change of, and is compared with."""


@dataclass(frozen=True)
class Run:
    """How an entry's training by one seed went."""

    entry: str
    seed: int
    finished: bool
    failed: str
    """Why it failed, if it did."""
    curve: tuple[tuple[int, float], ...]
    """Environment steps, and targets per 1500 steps while learning."""
    last: dict[str, Any] | None
    """The last report: ``agent.learner.Progress``."""


@dataclass(frozen=True)
class Study:
    """All that the page is made of."""

    share: float
    command: str
    days: str
    machine: str
    versions: dict[str, str]
    learnt_in: str
    measured_in: str
    entries: tuple[Entry, ...]
    runs: tuple[Run, ...]
    results: dict[str, Result]
    """By target mode."""


def result_of(record: dict[str, Any], targets: str) -> Result:
    """What ``agent.scoreboard.record`` wrote of a target mode, as it was."""
    players = {
        name: tuple(
            Score(
                name,
                np.array(run["targets"], float),
                run["steps"],
                run["blocked"],
                run["interventions"],
                _steps(run["first"]),
                np.array(run["coverage"]),
                np.array(run["rooms"]),
            )
            for run in player["runs"]
        )
        for name, player in record["players"].items()
    }
    return Result(targets, np.array(record["rooms"]), _steps(record["shortest"]), players)


def _steps(values: list[int | None]) -> np.ndarray:
    return np.array([np.inf if value is None else value for value in values])


def agents_page(study: Study, notes: str) -> str:
    return "# todo\n"


def pictures(study: Study) -> dict[str, bytes]:
    return {}
