"""``vitruvius train``, ``evaluate``, ``record`` and ``demo``: their options, and what they do.

Cheap to import: torch, taichi and all that needs them are imported when a command runs.
"""

import json
import sys
from argparse import ArgumentParser
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import tyro

from agent.config import PRESETS, Config
from logic.errors import RequestError

if TYPE_CHECKING:
    from agent.network import QNetwork

Targets = Literal["main", "secondary", "mixed"]


@dataclass(frozen=True)
class Train:
    """Train an agent in houses and write a checkpoint and its learning curve."""

    houses: tyro.conf.Positional[Path]
    """House file to learn in: vitruvius generate makes one."""

    out: Path = Path("runs/train")
    """Folder for agent.pt and learning-curve.png."""

    preset: Literal["pqn", "pqn-map"] = "pqn"
    """What all that is not said here is taken from: --help shows its values."""

    config: Annotated[Config, tyro.conf.arg(name="")] = field(default_factory=Config)
    """How to learn."""

    @classmethod
    def like(cls, arguments: Sequence[str]) -> "Train":
        """The command's defaults: those of the preset that the arguments name."""
        parser = ArgumentParser(add_help=False, allow_abbrev=False)
        parser.add_argument("--preset", default="pqn")
        preset = parser.parse_known_args(arguments)[0].preset
        # A name that is none is left for the real parser to tell.
        config = PRESETS.get(preset, Config())
        return cls(tyro.MISSING, preset=preset if preset in PRESETS else "pqn", config=config)

    def run(self) -> int:
        """Train to the end; a checkpoint is written every half minute on the way."""
        from agent.banks import require_training
        from agent.report import learning_curve
        from agent.runs import run
        from logic import load
        from logic.files import write_whole

        path, houses = self.out / "agent.pt", load(self.houses)
        require_training(houses, self.houses)
        _, history = run(houses, self.config, path)
        write_whole(self.out / "learning-curve.png", learning_curve(history))
        last = history[-1]
        _say(
            f"{path}: {last.steps / 1e6:.2f} M steps in {last.seconds:.0f} s "
            f"(simulator {last.simulator:,.0f}, learner {last.learner:,.0f} steps a second), "
            f"{last.targets:.1f} targets per 1500 steps while learning. "
            f"Next: vitruvius evaluate {path}"
        )
        return 0


@dataclass(frozen=True)
class Evaluate:
    """Measure an agent in houses that it has not seen, beside random + avoidance, a script, a searcher that
    knows the house and the shortest-path oracle. One episode a house, the same targets for all.
    """

    agents: tyro.conf.Positional[tuple[Path, ...]] = ()
    """Checkpoints: training runs of one config, by several seeds. None: the baselines alone."""

    houses: Path | None = None
    """House file to measure in; by default the benchmark bank, 256 houses of 2 to 6 rooms."""

    targets: tyro.conf.UseAppendAction[tuple[Targets, ...]] = ()
    """Where targets lie. Repeat for several; by default main, secondary and mixed, one after the other."""

    seed: int = 0
    """Draws starts and targets, the same for every player."""

    out: Path | None = None
    """Folder for evaluation.json, evaluation.md and evaluation.png."""

    json: bool = False
    """Print all figures, and each house's, as JSON."""

    def run(self) -> int:
        """Print the tables, or the JSON."""
        import torch
        from rich.console import Console

        from agent import scoreboard
        from agent.banks import bank_hash, benchmark, benchmark_path
        from agent.progress import progress
        from agent.protocol import MODES, measure
        from logic import load
        from logic.files import write_whole

        torch.set_num_threads(1)  # batches of a few hundred: a second thread only costs
        networks = self._networks()
        houses = load(self.houses) if self.houses else benchmark()
        bank = {
            "file": str(self.houses or benchmark_path().name),
            "houses": len(houses),
            "hash": bank_hash(houses),
        }
        results = []
        with progress("measuring") as tell:
            results += measure(networks, houses, self.targets or MODES, self.seed, tell)
        agents = [str(path) for path in self.agents]
        record = {"agents": agents, "bank": bank, "seed": self.seed} | scoreboard.record(results)
        sheets = [sheet for result in results for sheet in scoreboard.sheets(result)]
        title = f"{bank['file']}, hash {bank['hash'][:12]}, seed {self.seed}"
        if self.json:
            print(json.dumps(record))
        else:
            Console().print(*(sheet.table() for sheet in sheets), f"\n{title}\n\n{scoreboard.NOTE}")
        if self.out:
            page = [f"# Evaluation\n\n{title}", "![Ratios to the oracle](evaluation.png)"]
            page += [sheet.markdown() for sheet in sheets]
            write_whole(self.out / "evaluation.json", json.dumps(record).encode())
            write_whole(self.out / "evaluation.png", scoreboard.picture(results))
            write_whole(self.out / "evaluation.md", "\n\n".join([*page, scoreboard.NOTE, ""]).encode())
            _say(f"{self.out}: evaluation.md, evaluation.png, evaluation.json")
        return 0

    def _networks(self) -> list["QNetwork"]:
        """The agents' networks, which must differ in nothing but their training seeds."""
        from agent import checkpoint

        found = [checkpoint.load(path, shape=(40, 2)) for path in self.agents]
        for path, each in zip(self.agents, found, strict=True):
            if replace(each.config, seed=0) != replace(found[0].config, seed=0):
                raise RequestError(
                    f"{path}: not of the config of {self.agents[0]}, so no other run of that agent. "
                    "Evaluate them one after the other"
                )
        return [each.network for each in found]


@dataclass(frozen=True)
class Export:
    """Write an agent's network as an ONNX file, its memory an input and an output: see agent/export.py."""

    agent: tyro.conf.Positional[Path]
    """Checkpoint: vitruvius train makes one."""

    out: Path = Path("agent.onnx")
    """The file."""

    def run(self) -> int:
        """Write the file."""
        from agent import checkpoint
        from agent.export import export

        export(checkpoint.load(self.agent, shape=(40, 2)).network, self.out)
        _say(f"{self.out}")
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
