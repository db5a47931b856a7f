"""Scores from elsewhere: what other agents did in the same houses, read from the JSON that they left.

The file is what ``vitruvius evaluate --json`` prints and what the examples write by ``--out``: it says in
which bank, with which seed, and for each target mode what each player did in each house.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import msgspec
import numpy as np

from agent.banks import bank_hash
from agent.evaluate import MARKS, Score
from agent.protocol import Result
from logic import House
from logic.errors import VitruviusError

OURS = ("paper", "random + avoidance", "script", "explorer", "searcher", "oracle")
"""Players that a file may hold too, and that are measured anew: they would be the same."""


class ScoreError(VitruviusError):
    """A file of scores is absent, is none, or is of another measurement than the one that it shall join."""

    exit_code = 5


class Bank(msgspec.Struct):
    """The houses, by what names their shapes."""

    hash: str


class Run(msgspec.Struct):
    """What a training run did, house by house: see ``agent.evaluate.Score``."""

    targets: list[int]
    first: list[int | None]
    coverage: list[list[float]]
    rooms: list[int]
    steps: Annotated[int, msgspec.Meta(gt=0)]
    blocked: int
    interventions: int


class Player(msgspec.Struct):
    """A player's training runs."""

    runs: list[Run]


class Mode(msgspec.Struct):
    """What all players did in a target mode."""

    players: dict[str, Player]


class File(msgspec.Struct):
    """What is asked of a file; all else in it is left alone."""

    bank: Bank
    seed: int
    targets: dict[str, Mode]
    backend: str = "continuous"


def read(
    path: Path, houses: Sequence[House], modes: Sequence[str], seed: int = 0, backend: str = "continuous"
) -> dict[str, dict[str, tuple[Score, ...]]]:
    """By target mode and player's name, the scores of its training runs, of those modes that are asked for.

    Raises ``ScoreError`` for a file that is none, or of other houses, another seed, another backend, or none
    of the modes: its figures would not be comparable.
    """
    try:
        file = msgspec.json.decode(path.read_bytes(), type=File)
    except OSError as error:
        raise ScoreError(f"{path}: cannot be read: {error.strerror or error}") from None
    except msgspec.DecodeError as error:  # of what is no JSON, and of JSON that is something else
        raise ScoreError(f"{path}: no scores: {error}. Write some by vitruvius evaluate --json") from None
    for name, theirs, ours in (
        ("houses of hash", file.bank.hash[:12], bank_hash(houses)[:12]),
        ("seed", file.seed, seed),
        ("backend", file.backend, backend),
    ):
        if theirs != ours:
            raise ScoreError(f"{path}: measured with {name} {theirs}, here it is {ours}: not comparable")
    found = [mode for mode in modes if mode in file.targets]
    if not found:
        raise ScoreError(
            f"{path}: targets in {', '.join(file.targets)}, here in {', '.join(modes)}: not comparable. "
            "Choose by --targets"
        )
    return {
        mode: {
            name: tuple(_score(path, name, run, len(houses)) for run in player.runs)
            for name, player in file.targets[mode].players.items()
            if name not in OURS and player.runs
        }
        for mode in found
    }


def joined(result: Result, players: Mapping[str, tuple[Score, ...]], path: Path) -> Result:
    """A result with a file's players above the baselines; where a name is taken, the file's is added."""
    agents = {name: runs for name, runs in result.players.items() if name not in OURS}
    for player, runs in players.items():
        names = (player, f"{player} ({path.stem})", f"{player} ({path})")
        agents[next(name for name in names if name not in agents)] = runs
    return replace(result, players=agents | {name: result.players[name] for name in OURS})


def _score(path: Path, name: str, run: Run, houses: int) -> Score:
    """A run's score; every house must have its value."""
    rows = (run.targets, run.first, run.rooms, *run.coverage)
    if len(run.coverage) != len(MARKS) or any(len(row) != houses for row in rows):
        raise ScoreError(f"{path}: no scores: {name} has not one value for each of {houses} houses")
    return Score(
        name,
        np.array(run.targets, float),
        run.steps,
        run.blocked,
        run.interventions,
        first=np.array([np.inf if step is None else step for step in run.first]),
        coverage=np.array(run.coverage),
        rooms=np.array(run.rooms),
    )
