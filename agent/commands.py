"""What ``vitruvius train``, ``evaluate``, ``record`` and ``demo`` do, as functions of one dataclass each.

Cheap to import: torch, taichi and the rest are imported where they are used.
"""

from dataclasses import dataclass, field
from pathlib import Path

from agent.config import Config


@dataclass(frozen=True)
class Train:
    """Train an agent in a file of houses and write a checkpoint."""

    houses: Path
    """House file to learn in: make one with vitruvius generate."""

    out: Path = Path("runs/train")
    """Folder for agent.pt and learning-curve.png."""

    config: Config = field(default_factory=Config)
    """How to learn."""


@dataclass(frozen=True)
class Evaluate:
    """Measure an agent beside random + avoidance and the shortest-path oracle, one episode a house."""

    agent: Path
    """Checkpoint of the agent: made by vitruvius train."""

    houses: Path
    """House file to measure in: houses that the agent was not trained on."""

    targets: str = "main"
    """Where targets lie: main, secondary or mixed."""

    seed: int = 0
    """Draws starts and targets, the same for every player."""

    json: bool = False
    """Print JSON for a program instead of a table."""


@dataclass(frozen=True)
class Record:
    """Film an agent in a house: rays, trail and targets."""

    agent: Path
    """Checkpoint of the agent: made by vitruvius train."""

    houses: Path
    """House file."""

    out: Path = Path("episode.gif")
    """Where the film goes."""

    house: int = 0
    """Which house of the file, from 0."""

    steps: int = 600
    """How many steps of the episode to film."""

    targets: str = "main"
    """Where targets lie: main, secondary or mixed."""

    seed: int = 0
    """Draws the start and the targets."""


@dataclass(frozen=True)
class Demo:
    """From rules to a trained agent in five minutes: houses, training, measurement, report."""

    out: Path = Path("runs/demo")
    """Folder for the report and all that it shows."""

    seed: int = 0
    """Draws the houses of both kinds and seeds the training."""
