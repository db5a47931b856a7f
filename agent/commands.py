"""``vitruvius train``, ``evaluate``, ``record`` and ``demo``: their options, and what they do.

Cheap to import: torch, taichi and all that needs them are imported when a command runs.
"""

import json
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal

import tyro

from agent.config import Config
from logic.errors import RequestError

Targets = Literal["main", "secondary", "mixed"]


@dataclass(frozen=True)
class Train:
    """Train an agent in houses and write a checkpoint and its learning curve."""

    houses: tyro.conf.Positional[Path]
    """House file to learn in: vitruvius generate makes one."""

    out: Path = Path("runs/train")
    """Folder for agent.pt and learning-curve.png."""

    config: Annotated[Config, tyro.conf.arg(name="")] = field(default_factory=Config)
    """How to learn."""

    def run(self) -> int:
        """Train to the end; a checkpoint is written every half minute on the way."""
        from agent.report import learning_curve
        from agent.runs import run
        from logic import load
        from logic.files import write_whole

        path = self.out / "agent.pt"
        _, history = run(load(self.houses), self.config, path)
        write_whole(self.out / "learning-curve.png", learning_curve(history))
        last = history[-1]
        _say(
            f"{path}: {last.steps / 1e6:.2f} M steps in {last.seconds:.0f} s "
            f"(simulator {last.simulator:,.0f}, learner {last.learner:,.0f} steps a second), "
            f"{last.targets:.1f} targets per 1500 steps while learning. "
            f"Next: vitruvius evaluate {path} HOUSES, with houses that it has not seen"
        )
        return 0


@dataclass(frozen=True)
class Evaluate:
    """Measure an agent beside random + avoidance and the shortest-path oracle, one episode a house."""

    agent: tyro.conf.Positional[Path]
    """Checkpoint: vitruvius train makes one."""

    houses: tyro.conf.Positional[Path]
    """House file to measure in, of houses that the agent has not seen."""

    targets: Targets = "main"
    """Where targets lie."""

    seed: int = 0
    """Draws starts and targets, the same for every player."""

    json: bool = False
    """Print the players' targets in each house as JSON."""

    def run(self) -> int:
        """Print the table, or the JSON."""
        from rich.console import Console

        from agent import checkpoint, report
        from agent.evaluate import evaluate
        from agent.progress import progress
        from agent.world import make_worlds
        from logic import load

        agent, houses = checkpoint.load(self.agent, shape=(40, 2)), load(self.houses)
        with progress("measuring") as tell:
            envs = make_worlds(houses, len(houses), self.targets)
            scores = evaluate(agent.network, envs, seed=self.seed, tell=tell)
        if self.json:
            print(json.dumps({score.player: score.targets.astype(int).tolist() for score in scores}))
        else:
            title = f"{self.houses}: houses {len(houses)}, targets {self.targets}"
            Console().print(report.table(report.rows(scores), title))
        return 0


@dataclass(frozen=True)
class Record:
    """Film an agent in a house: its rays, its trail and its targets."""

    agent: tyro.conf.Positional[Path]
    """Checkpoint: vitruvius train makes one."""

    houses: tyro.conf.Positional[Path]
    """House file."""

    house: int = 0
    """Which house of the file, from 0."""

    out: Path = Path("episode.gif")
    """The film."""

    steps: int = 1500
    """How many steps of the episode to film."""

    targets: Targets = "main"
    """Where targets lie."""

    seed: int = 0
    """Draws the start and the targets."""

    def run(self) -> int:
        """Write the film."""
        from agent import checkpoint
        from agent.progress import progress
        from agent.record import record
        from logic import load

        agent, houses = checkpoint.load(self.agent, shape=(40, 2)), load(self.houses)
        if not 0 <= self.house < len(houses):
            raise RequestError(f"--house {self.house}: {self.houses} has houses 0 to {len(houses) - 1}")
        if self.steps < 1:
            raise RequestError(f"--steps must be 1 or more, not {self.steps}")
        with progress("filming") as tell:
            record(
                agent.network,
                houses[self.house],
                self.out,
                targets=self.targets,
                seed=self.seed,
                steps=self.steps,
                tell=tell,
            )
        print(self.out)
        return 0


@dataclass(frozen=True)
class Demo:
    """Rules to houses to a trained agent and its report, in five minutes."""

    out: Path = Path("runs/demo")
    """Folder for the report and all that it shows."""

    seed: int = 0
    """Draws the houses, those to learn in and those to be measured in, and seeds the training."""

    def run(self) -> int:
        """Do it all; 1 if the agent does not clearly beat the human's ratio and the random walk."""
        from agent.demo import demo

        return demo(self.out, self.seed)


def _say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)
