"""Game: an episode that a person or an agent plays, apart from how it is shown."""

import numpy as np
import torch

from vitruvius.agent.algorithms.build import policy_of
from vitruvius.agent.evaluation.episodes import reset
from vitruvius.agent.learning.environments import make_envs
from vitruvius.agent.learning.simulator import sensor
from vitruvius.agent.play.results import PlayedGame, ResultsError, require_house
from vitruvius.agent.policies.episodes import moments
from vitruvius.agent.runs.checkpoint import Checkpoint
from vitruvius.logic import House, HouseFileError, RequestError
from vitruvius.logic.spelling import numbered
from vitruvius.sim.actions import FORWARD, LEFT, RIGHT
from vitruvius.sim.config import DEFAULT, Config
from vitruvius.sim.film import Scene

LETTERS = {LEFT: "L", RIGHT: "R", FORWARD: "F"}
"""Letters of actions in a file of results."""


class Game:
    """Episode in a house; with seed + i it is that of an evaluation with ``seed`` in its house i."""

    def __init__(self, house: House, targets: str, seed: int, config: Config = DEFAULT) -> None:
        """Begin the episode. Raises ``HouseFileError`` if the task cannot be played in the house."""
        self.envs = make_envs([house], 1, targets, preset=config)
        self.actions: list[str] = []
        self.ended = False
        reset(self.envs, seed)
        self.scene = self.envs.scene(0)

    @property
    def score(self) -> int:
        """Number of targets picked up."""
        return self.scene.found

    def act(self, action: int) -> None:
        """Make one step; do nothing after the last step."""
        if self.ended:
            return
        _, _, terminated, truncated, _ = self.envs.step_torch(torch.tensor([action]))
        self.actions.append(LETTERS[action])
        self.ended = bool(terminated[0] | truncated[0])
        self.scene = self.envs.scene(0)


def replayed(played: PlayedGame, house: House, where: str) -> tuple[Game, list[Scene]]:
    """Return a replayed game, by its actions, and its scenes.

    Raises ``ResultsError`` if the game was played in another house, or if the replay differs from its record.
    """
    require_house(played, house, where)
    try:
        game = Game(house, played.targets, played.seed)
    except HouseFileError as error:
        raise ResultsError(f"{where}: {error}") from None
    scenes, actions = [game.scene], {letter: action for action, letter in LETTERS.items()}
    for letter in played.actions:
        game.act(actions[letter])
        scenes.append(game.scene)
    if (len(game.actions), game.score) != (len(played.actions), played.score):
        found = f"{numbered(game.score, 'target')} in {numbered(len(game.actions), 'step')}"
        said = f"{numbered(played.score, 'target')} in {numbered(len(played.actions), 'step')}"
        raise ResultsError(f"{where}: records {said}, but its actions give {found}")
    return game, scenes


def agents_scenes(agent: Checkpoint, house: House, targets: str, seed: int) -> list[Scene]:
    """Return the scenes of the episode that an agent plays from the same start with the same targets.

    Raises ``RequestError`` for an agent that drives, as its starts differ.
    """
    if agent.config.backend == "free":
        raise RequestError(f"{agent.name} drives, and people play in grid steps: choose another agent")
    envs = make_envs([house], 1, targets, preset=sensor(agent.config))
    observation = reset(envs, seed)
    policy = policy_of(agent.network, agent.config, envs, seed)
    return [envs.scene(0) for _ in moments(envs, policy, observation)]


def fan(scene: Scene) -> np.ndarray:
    """Return where the rays of a scene end (R, 2), metres."""
    x, y, heading = scene.pose
    angle = heading + scene.config.ray_angles
    return np.column_stack([x + np.cos(angle) * scene.distance, y - np.sin(angle) * scene.distance])
