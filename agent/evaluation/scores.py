"""Scores as JSON: the files that ``vitruvius evaluate --out`` and the examples write, and their reader.

A file states the bank, the seed and the backend, and for each target mode the scores of each policy in each
house. So the same tables can show scores of external agents, from another library or another day.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, TypedDict

import msgspec
import numpy as np

from vitruvius.agent.banks import bank_hash
from vitruvius.agent.baselines.table import NO_AGENTS
from vitruvius.agent.evaluation.episodes import COVERAGE_STEPS, EpisodeScores
from vitruvius.agent.evaluation.result import DEFINITIONS, Result
from vitruvius.agent.evaluation.statistics import Estimate
from vitruvius.logic import House
from vitruvius.logic.errors import VitruviusError
from vitruvius.logic.opener import content_of, from_json

MAX_BYTES = 1 << 28
"""Largest size of an uncompressed file, in bytes."""


class Figure(TypedDict):
    """Value with its interval."""

    value: float
    low: float
    high: float


class ScoreError(VitruviusError):
    """Error for a file of scores that is absent, malformed, or of an evaluation that cannot be compared."""

    exit_code = 5


class ScoredBank(msgspec.Struct):
    """Houses of a bank, by their ``agent.banks.bank_hash``."""

    hash: str
    file: str = ""
    houses: int = 0


class RunScores(msgspec.Struct):
    """Scores of a training run, house by house: see ``EpisodeScores``; ``None`` without a target."""

    targets: list[int]
    first: list[int | None]
    coverage: list[list[float]]
    rooms: list[int]
    steps: Annotated[int, msgspec.Meta(gt=0)]
    blocked: int
    interventions: int


class PolicyScores(msgspec.Struct):
    """Training runs and figures of a policy."""

    runs: list[RunScores]
    figures: dict[str, Figure] = {}
    ratio_by_rooms: dict[int, Figure] = {}


class ModeScores(msgspec.Struct):
    """Scores of all policies in a target mode: a ``Result``."""

    policies: dict[str, PolicyScores]
    rooms: list[int] = []
    shortest: list[int | None] = []
    steps: int = 1500
    ends_on_pick_up: bool = False


class ScoreFile(msgspec.Struct):
    """File of scores. Fields with a default are written, but a file may omit them."""

    bank: ScoredBank
    seed: int
    targets: dict[str, ModeScores]
    backend: str = "continuous"
    world: str = "default"
    episodes: Annotated[int, msgspec.Meta(gt=0)] = 1
    agents: list[str] = []
    scores: list[str] = []
    learnt_in: dict[str, int | None] = {}
    """Number of the houses that each agent was trained on, null if its checkpoint does not say. Agents
    trained on none of them are left out: see ``agent.evaluation.learnt_in``."""
    training_steps: int | None = None
    definitions: dict[str, str] = msgspec.field(default_factory=lambda: DEFINITIONS)

    def json(self) -> bytes:
        """Return the file's content, on one line."""
        return msgspec.json.encode(self)


def modes_of(results: Iterable[Result]) -> dict[str, ModeScores]:
    """Return results as a file stores them, by target mode."""
    return {
        result.mode: ModeScores(
            {
                name: PolicyScores(
                    [_run(scores) for scores in runs],
                    {key: _figure(each) for key, each in result.figures(name).items()},
                    {rooms: _figure(each) for rooms, each in result.by_rooms(name).items()},
                )
                for name, runs in result.policies.items()
            },
            result.rooms.tolist(),
            _integers(result.shortest),
            result.steps,
            result.ends_on_pick_up,
        )
        for result in results
    }


def result_of(mode: ModeScores, name: str) -> Result:
    """Return the result that was written as the target mode of this name."""
    policies = {name: tuple(map(_scores, policy.runs)) for name, policy in mode.policies.items()}
    ways, how = _reals(mode.shortest), {"steps": mode.steps, "ends_on_pick_up": mode.ends_on_pick_up}
    return Result(name, np.array(mode.rooms), ways, policies, **how)


def load(path: Path) -> ScoreFile:
    """Read a file. Raises ``ScoreError`` if it is absent or malformed."""
    try:
        return from_json(content_of(path, MAX_BYTES), ScoreFile)
    except OSError as error:
        raise ScoreError(f"{path}: cannot be read: {error.strerror or error}") from None
    except ValueError as error:  # not JSON, or JSON of something else
        raise ScoreError(f"{path}: not scores: {error}. Write some: vitruvius evaluate --out") from None


def external(
    path: Path,
    houses: Sequence[House],
    modes: Sequence[str],
    seed: int = 0,
    backend: str = "continuous",
    world: str = "default",
    episodes: int = 1,
) -> dict[str, dict[str, tuple[EpisodeScores, ...]]]:
    """Return the scores of a file's external agents, by target mode and name.

    External agents are all policies but ``NO_AGENTS``. Raises ``ScoreError`` for a malformed file, and for a
    file of other houses, another seed, backend, world or number of episodes, or none of the modes: its
    figures could not be compared.
    """
    file = load(path)
    for name, theirs, ours in (
        ("houses of hash", file.bank.hash[:12], bank_hash(houses)[:12]),
        ("seed", file.seed, seed),
        ("backend", file.backend, backend),
        ("world", file.world, world),
        ("episodes", file.episodes, episodes),
    ):
        if theirs != ours:
            raise ScoreError(
                f"{path}: evaluated with {name} {theirs}, not {ours}: the scores are not comparable"
            )
    found = [mode for mode in modes if mode in file.targets]
    if not found:
        raise ScoreError(
            f"{path}: its targets are {', '.join(file.targets)}, not {', '.join(modes)}: the scores are not "
            "comparable. Choose targets by --targets"
        )
    from vitruvius.agent.learning.environments import playable  # here: it imports Taichi

    counts = {mode: len(playable(houses, mode, backend=backend)) * episodes for mode in found}
    return {
        mode: {
            name: tuple(_whole_scores(path, name, run, counts[mode]) for run in policy.runs)
            for name, policy in file.targets[mode].policies.items()
            if name not in NO_AGENTS and policy.runs
        }
        for mode in found
    }


def joined(result: Result, policies: Mapping[str, tuple[EpisodeScores, ...]], path: Path) -> Result:
    """Return a result with a file's policies above the references; taken names get the file's name added."""
    agents = {name: runs for name, runs in result.policies.items() if name not in NO_AGENTS}
    for policy, runs in policies.items():
        names = (policy, f"{policy} ({path.stem})", f"{policy} ({path})")
        agents[next(name for name in names if name not in agents)] = runs
    references = {name: runs for name, runs in result.policies.items() if name in NO_AGENTS}
    return replace(result, policies=agents | references)


def _whole_scores(path: Path, name: str, run: RunScores, episodes: int) -> EpisodeScores:
    """Return a run's scores. Raises ``ScoreError`` unless every episode has its value."""
    rows = (run.targets, run.first, run.rooms, *run.coverage)
    if len(run.coverage) != len(COVERAGE_STEPS) or any(len(row) != episodes for row in rows):
        raise ScoreError(f"{path}: not scores: {name} needs one value for each of {episodes} episodes")
    return _scores(run)


def _figure(estimate: Estimate) -> Figure:
    return Figure(value=estimate.value, low=estimate.low, high=estimate.high)


def _run(scores: EpisodeScores) -> RunScores:
    return RunScores(
        scores.targets.astype(int).tolist(),
        _integers(scores.first),
        scores.coverage.round(4).tolist(),
        scores.rooms.astype(int).tolist(),
        scores.steps,
        scores.blocked,
        scores.interventions,
    )


def _scores(run: RunScores) -> EpisodeScores:
    return EpisodeScores(
        np.array(run.targets, float),
        run.steps,
        run.blocked,
        run.interventions,
        _reals(run.first),
        np.array(run.coverage),
        np.array(run.rooms),
    )


def _integers(steps: np.ndarray) -> list[int | None]:
    return [int(step) if np.isfinite(step) else None for step in steps]


def _reals(steps: Sequence[int | None]) -> np.ndarray:
    return np.array([np.inf if step is None else step for step in steps])
