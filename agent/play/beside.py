"""Comparison of people's games with agents and baselines in the same episodes: ``evaluate --beside``."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from pathlib import Path

import numpy as np

from vitruvius.agent.algorithms.build import policy_of
from vitruvius.agent.baselines.table import BASELINES
from vitruvius.agent.evaluation.episodes import play
from vitruvius.agent.evaluation.statistics import interquartile_mean, paired_difference
from vitruvius.agent.evaluation.tables import Table
from vitruvius.agent.learning.environments import make_envs
from vitruvius.agent.learning.simulator import sensor
from vitruvius.agent.play.game import replayed
from vitruvius.agent.play.results import PlayedGame, ResultsError, load
from vitruvius.agent.runs.checkpoint import Checkpoint
from vitruvius.logic import House
from vitruvius.logic.looks.looks import looks_of
from vitruvius.logic.spelling import numbered
from vitruvius.sim.config import DEFAULT
from vitruvius.sim.tasks.tasks import task
from vitruvius.sim.tasks.terms import terms_of
from vitruvius.sim.tasks.words import in_words

BESIDE = "explorer", "searcher", "oracle"
"""Baselines that are shown, the oracle last."""

SEES = {"plan": "who saw the whole plan and the target", "seen": "who saw what the robot's rays had reached"}

MAX_GAMES, MAX_STEPS, MAX_TABLES = 1 << 10, 1 << 20, 16
"""Bounds of a file of games: number of games, total steps of their episodes, and number of kinds of games."""

BESIDE_NOTE = (
    "People, agents and baselines play the same episodes: house, start and targets. Each game was replayed "
    "from its actions, with the recorded result. Interquartile means with 95 % intervals over games; ahead: "
    "paired difference, by game, of the policy's ratio and the people's."
)


def replayable(path: Path) -> list[PlayedGame]:
    """Return the games of a file. Raise ``ResultsError`` if there are too many games to play again."""
    games = load(path)
    _require_at_most(MAX_GAMES, len(games), path, "games")
    kinds = set(map(_kind, games))
    _require_at_most(MAX_TABLES, len(kinds), path, "kinds of games")
    try:
        steps = {targets: terms_of(task(targets)).steps or DEFAULT.steps for targets, _, _ in kinds}
    except ValueError as error:
        raise ResultsError(f"{path}: {error}") from None
    _require_at_most(MAX_STEPS, sum(steps[game.targets] for game in games), path, "steps of all episodes")
    return games


def _require_at_most(most: int, count: int, path: Path, what: str) -> None:
    if count > most:
        raise ResultsError(f"{path}: {count:,} {what} exceed the limit of {most:,}: give fewer games")


def people_tables(
    path: Path, houses: Sequence[House], agents: Mapping[str, Sequence[Checkpoint]]
) -> Iterator[Table]:
    """Yield a table for each kind of game in a file, by target location, player's view and duration.

    Raises ``ResultsError`` for a game of a house that does not exist, or one whose replay differs from its
    record.
    """
    games = replayable(path)
    for number, game in enumerate(games, start=1):
        if game.index >= len(houses):
            raise ResultsError(
                f"{path}:{number}: the game was played in house {game.index}, and there are "
                f"{len(houses)} houses"
            )
        replayed(game, houses[game.index], f"{path}:{number}")

    for (targets, view, seconds), group in groupby(sorted(games, key=_kind), key=_kind):
        played = list(group)
        sought = in_words(targets, looks_of(houses[played[0].index]).name)
        scores = _scores(played, houses, targets, agents)
        oracle = scores["oracle"][0]
        reachable = oracle > 0
        if not reachable.any():
            raise ResultsError(f"{path}: {sought}: no game has a reachable target")
        ratios = {name: runs[:, reachable] / oracle[reachable] for name, runs in scores.items()}
        rows = []
        for name, runs in scores.items():
            people = np.broadcast_to(ratios["people"], ratios[name].shape)
            ahead = "" if name == "people" else paired_difference(ratios[name], people).signed(2)
            counts, ratio = interquartile_mean(runs).text(1), interquartile_mean(ratios[name]).text(2)
            rows.append((name, counts, ratio, ahead))
        players, places = len({game.player for game in played}), len({game.index for game in played})
        title = (
            f"People, {SEES[view]}: {numbered(len(played), 'game')} of {numbered(players, 'player')} in "
            f"{numbered(places, 'house')}, {seconds:g} s, {sought}"
        )
        yield Table(title, ("policy", "targets", "ratio", "ahead"), rows)


def _kind(game: PlayedGame) -> tuple[str, str, float]:
    return game.targets, game.view, game.seconds


def _scores(
    played: Sequence[PlayedGame],
    houses: Sequence[House],
    targets: str,
    agents: Mapping[str, Sequence[Checkpoint]],
) -> dict[str, np.ndarray]:
    """Return the targets (S, G) of each policy's S training runs in the episodes of G games."""
    bank = [houses[game.index] for game in played]
    seeds, numbers = [game.seed for game in played], np.arange(len(played))
    scores = {"people": np.array([[game.score for game in played]], float)}
    for name, runs in agents.items():
        targets_found = []
        for run in runs:
            envs = make_envs(bank, len(bank), targets, preset=sensor(run.config))
            policy = policy_of(run.network, run.config, envs, played[0].seed)
            targets_found.append(play(envs, policy, seeds, numbers).targets)
        scores[name] = np.stack(targets_found)
    envs = make_envs(bank, len(bank), targets, preset=DEFAULT)
    for name in BESIDE:
        policy = BASELINES[name](envs, played[0].seed)
        scores[name] = play(envs, policy, seeds, numbers).targets[None]
    return scores
