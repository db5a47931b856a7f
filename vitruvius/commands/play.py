"""Options and work of ``vitruvius play``. Cheap to import, as the other commands are."""

import os
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Literal

import tyro

from vitruvius.agent import banks
from vitruvius.agent.learning.config import MAX_SEED
from vitruvius.agent.runs.released import located
from vitruvius.logic import House
from vitruvius.logic.errors import MissingProgram, RequestError
from vitruvius.logic.request.counts import whole
from vitruvius.logic.terminal import say
from vitruvius.options import Streamed

if TYPE_CHECKING:
    from vitruvius.agent.play.window import GameWindow


@dataclass(frozen=True)
class Play:
    """Drive the robot through houses by the keyboard, and race an agent to the targets.

    Arrow keys or W, A, D; the first key starts the clock. Enter: the next house. Esc: the end.
    """

    groups: ClassVar = {"house": "The game", "player": "Results"}

    houses: tyro.conf.Positional[Streamed] = Path(banks.NAME)
    """House file; or a held-out set, such as test-v1; or paper-house, the house of the paper."""

    house: int | None = None
    """Index of the house in the file, from 0; by default all houses, one after the other."""

    targets: str = "main"
    """Location of the targets: main, secondary, mixed, or another task, as for evaluate; paper-main and so on
    in the paper's house."""

    allow: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """Your own class, module:Class, that a file may name. Files may name no other class of yours. Vitruvius
    imports the module, which runs its code."""

    seed: int = 0
    """Seed: house i has the start and the targets of seed + i, as in evaluate."""

    view: Literal["plan", "seen"] = "plan"
    """View of the player: the whole plan with the target, or only what the robot's rays have reached."""

    race: Path | None = None
    """Agent to race, next to you in the same house to the same targets: a checkpoint or a released agent."""

    seconds: float = 15.0
    """Duration of a game in seconds. Its 1500 steps are spread over it: 100 a second in the paper's 15
    seconds."""

    player: str = ""
    """Name of the player in the results."""

    out: Path = Path("games.jsonl")
    """File of results, to which each game is added at its end."""

    replay: Path | None = None
    """File of results whose games to show, instead of a new game."""

    def run(self) -> int:
        """Play the houses, or replay games."""
        from vitruvius.agent.learning.simulator import allow_named, require_asked_task
        from vitruvius.agent.play.results import ENDINGS, load, require_games
        from vitruvius.logic.files.writing import require_file

        if not 1 <= self.seconds <= 3600:
            raise RequestError(f"--seconds {self.seconds:g}: a game lasts from 1 to 3600 seconds")
        whole("--seed", self.seed, 0, MAX_SEED)
        if self.race:
            located(self.race)
        allow_named(self.allow)
        require_asked_task(self.targets)
        banks.require_places(self.targets, self.houses)
        require_file(self.out, ENDINGS)
        require_games(self.out)
        games = load(self.replay) if self.replay else []
        houses = banks.named(self.houses)
        if self.house is not None and not 0 <= self.house < len(houses):
            raise RequestError(f"--house {self.house}: {self.houses} has houses 0 to {len(houses) - 1}")
        window = opened()
        try:
            if not games:
                return self._play(window, houses)
            for number, game in enumerate(games, start=1):
                if not window.replay(game, houses, f"{self.replay}:{number}"):
                    break
            return 0
        finally:
            window.close()

    def _play(self, window: "GameWindow", houses: list[House]) -> int:
        """Play the houses."""
        from datetime import UTC, datetime
        from importlib.metadata import version

        import torch

        from vitruvius.agent.play.game import Game, agents_scenes
        from vitruvius.agent.play.results import PlayedGame, append, nobody
        from vitruvius.agent.runs import checkpoint

        torch.set_num_threads(1)
        agent = checkpoint.load(self.race) if self.race else None
        player = self.player or nobody()
        for index in range(len(houses)) if self.house is None else [self.house]:
            house, seed = houses[index], self.seed + index
            game = Game(house, self.targets, seed)
            race = (agent.name, agents_scenes(agent, house, self.targets, seed)) if agent else None
            if not window.play(game, self.seconds, self.view, race):
                break
            raced = {race[0]: race[1][-1].found} if race else {}
            played = PlayedGame(
                player=player,
                house=banks.geometry_hash(house),
                index=index,
                targets=self.targets,
                seed=seed,
                view=self.view,
                seconds=self.seconds,
                actions="".join(game.actions),
                score=game.score,
                raced=raced,
                taken=datetime.now(UTC).isoformat(timespec="seconds"),
                versions={"vitruvius": version("vitruvius")},
            )
            append(self.out, [played])
            theirs = "".join(f", {name} {score}" for name, score in raced.items())
            say(f"house {index}: {player} {game.score}{theirs}: {self.out}")
            more = self.house is None and index + 1 < len(houses)
            keys = "Enter: next house   Esc: quit" if more else "Enter or Esc: quit"
            scores = [f"{name}: {score}" for name, score in [("you", game.score), *raced.items()]]
            if not window.show([*scores, keys]) or not more:
                break
        return 0


DISPLAYS = {"x11": "DISPLAY", "wayland": "WAYLAND_DISPLAY"}
"""Drivers of SDL on Linux, and the variables that name their displays."""


def opened() -> "GameWindow":
    """Return the window. Raises ``MissingProgram`` without a display."""
    import pygame

    from vitruvius.agent.play.window import GameWindow

    if sys.platform == "linux" and not os.environ.get("SDL_VIDEODRIVER"):
        # By default SDL may choose a driver without a visible display, and the game waits for ever.
        drivers = [driver for driver, variable in DISPLAYS.items() if os.environ.get(variable)]
        if not drivers:
            raise _no_display(f"neither {' nor '.join(DISPLAYS.values())} is set")
        os.environ["SDL_VIDEODRIVER"] = ",".join(drivers)
    try:
        return GameWindow()
    except pygame.error as error:
        raise _no_display(str(error)) from None


def _no_display(reason: str) -> MissingProgram:
    return MissingProgram(f"play needs a display: {reason}. On a machine without one: xvfb-run, or ssh -X")
