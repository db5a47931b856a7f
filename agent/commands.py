"""``vitruvius train``, ``evaluate``, ``record`` and ``demo``: their options, and what they do.

Cheap to import: torch, taichi and all that needs them are imported when a command runs.
"""

import json
import os
import shlex
import sys
from argparse import ArgumentParser
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Generic, Literal, TypeVar

import tyro

from agent.config import PRESETS, Config, PQNConfig, differences
from logic.errors import RequestError

if TYPE_CHECKING:
    from agent.checkpoint import Checkpoint

Targets = Literal["main", "secondary", "mixed"]
Preset = Literal["pqn", "pqn-map", "pqn-recurrent", "dqn", "paper"]
Kind = TypeVar("Kind", bound=Config)


@dataclass(frozen=True)
class Train(Generic[Kind]):
    """Train an agent in houses. Its checkpoint, learning curve and metrics lie in one folder.

    Several processes learn as one: python -m torch.distributed.run --nproc-per-node 2 -m agent.cli train ...
    """

    houses: tyro.conf.Positional[Path]
    """House file to learn in: vitruvius generate makes one."""

    out: Path = Path("runs/train")
    """Folder for agent.safetensors, config.json, metrics.jsonl, learning-curve.png and tensorboard/."""

    resume: bool = False
    """Go on with the run in the folder, if there is one: bit for bit on the CPU, or with more --steps."""

    preset: Preset = "pqn"
    """What all that is not said here is taken from: --help shows its values."""

    name: str | None = None
    """What to call the agent in tables; by default the preset's name."""

    config: Annotated[Kind, tyro.conf.arg(name="")] = field(default_factory=PQNConfig)  # pyright: ignore
    """How to learn."""

    @staticmethod
    def like(arguments: Sequence[str]) -> "Train[Config]":
        """The command with the defaults of the preset that the arguments name."""
        parser = ArgumentParser(add_help=False, allow_abbrev=False)
        parser.add_argument("--preset", default="pqn")
        preset = parser.parse_known_args(arguments)[0].preset
        # A name that is none is left for the real parser to tell.
        name: Preset = preset if preset in PRESETS else "pqn"
        return Train(tyro.MISSING, preset=name, config=PRESETS[name])

    def run(self) -> int:
        """Train to the end; what is learnt is kept every half minute on the way."""
        from agent.banks import require_training
        from agent.report import learning_curve
        from agent.runs import run
        from logic import load
        from logic.files import write_whole

        houses = load(self.houses)
        require_training(houses, self.houses)
        command = shlex.join(["vitruvius", *sys.argv[1:]])
        made, history = run(
            houses,
            self.config,
            self.out,
            name=self.name or self.preset,
            command=command,
            resume=self.resume,
        )
        if int(os.environ.get("RANK", "0")):  # the first rank tells
            return 0
        agent, last = self.out / "agent.safetensors", history[-1]
        write_whole(self.out / "learning-curve.png", learning_curve(history))
        _say(
            f"{agent}: {made.steps / 1e6:.2f} M steps in {last.seconds:.0f} s "
            f"(simulator {last.simulator:,.0f}, learner {last.learner:,.0f} steps a second), "
            f"{last.targets:.1f} targets per 1500 steps while learning. Next: vitruvius evaluate {agent}"
        )
        return 0


@dataclass(frozen=True)
class Evaluate:
    """Measure agents in houses that they have not seen, beside the paper's, random + avoidance, a script, an
    explorer with a map, a searcher that knows the house and the shortest-path oracle. One episode a house,
    the same targets for all.
    """

    agents: tyro.conf.Positional[tuple[Path, ...]] = ()
    """Checkpoints, or names of agents that come with the project (pqn-map, paper). Runs of one config by
    several seeds are one player. None: the others alone."""

    houses: Path | None = None
    """House file to measure in; by default the benchmark bank, 256 houses of 2 to 6 rooms."""

    targets: tyro.conf.UseAppendAction[tuple[Targets, ...]] = ()
    """Where targets lie. Repeat for several; by default main, secondary and mixed, one after the other."""

    seed: int = 0
    """Draws starts and targets, the same for every player."""

    backend: str = "continuous"
    """What simulates the houses: continuous, grid (for houses made with --cell), or module:Class."""

    beside: tyro.conf.UseAppendAction[tuple[Path, ...]] = ()
    """Scores of another agent, in JSON as --json or an example's --out writes it, for a row of its own in
    the tables: of the same houses, seed and targets. Repeat for several."""

    out: Path | None = None
    """Folder for evaluation.json, evaluation.md and evaluation.png."""

    json: bool = False
    """Print all figures, and each house's, as JSON."""

    def run(self) -> int:
        """Print the tables, or the JSON."""
        import torch
        from rich.console import Console

        from agent import beside, checkpoint, scoreboard
        from agent.banks import bank_hash, benchmark, benchmark_path
        from agent.progress import progress
        from agent.protocol import MODES, measure
        from logic import load
        from logic.files import write_whole

        torch.set_num_threads(1)  # batches of a few hundred: a second thread only costs
        agents = self._players()
        # The paper's own agent stands beside all others, as a baseline.
        agents.setdefault("paper", [checkpoint.load("paper")])
        houses = load(self.houses) if self.houses else benchmark()
        bank = {
            "file": str(self.houses or benchmark_path().name),
            "houses": len(houses),
            "hash": bank_hash(houses),
        }
        modes = self.targets or MODES
        others = {path: beside.read(path, houses, modes, self.seed, self.backend) for path in self.beside}
        with progress("measuring") as tell:
            results = list(measure(agents, houses, modes, self.seed, tell, backend=self.backend))
        for path, players in others.items():
            results = [beside.joined(each, players.get(each.targets, {}), path) for each in results]
        record = {
            "agents": [str(path) for path in self.agents],
            "beside": [str(path) for path in self.beside],
            "bank": bank,
            "seed": self.seed,
            "backend": self.backend,
        } | scoreboard.record(results)
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

    def _players(self) -> dict[str, list["Checkpoint"]]:
        """The agents by name: a player has runs that differ in nothing but their training seeds. One whose
        preset was changed is named for its folder too.
        """
        from agent import checkpoint

        players: dict[str, list[Checkpoint]] = {}
        for path in self.agents:
            found = checkpoint.load(path)
            for runs in players.values():
                if runs[0].name == found.name and _alike(runs[0].config, found.config):
                    runs.append(found)
                    break
            else:
                name = found.name if found.name not in players else f"{found.name} ({path.parent.name})"
                if name in players:
                    raise RequestError(f"{path}: another config than {name}'s, by the same name")
                players[name] = [found]
        return players


def _alike(one: Config, other: Config) -> bool:
    """Whether these are runs of one agent."""
    return set(differences(one, other)) <= {"seed"}


@dataclass(frozen=True)
class Export:
    """Write an agent's network as an ONNX file, its memory an input and an output: see agent/export.py."""

    agent: tyro.conf.Positional[Path]
    """Checkpoint (vitruvius train makes one), or the name of an agent that comes with the project."""

    out: Path = Path("agent.onnx")
    """The file."""

    def run(self) -> int:
        """Write the file."""
        from agent import checkpoint
        from agent.export import export

        export(checkpoint.load(self.agent).network, self.out)
        _say(f"{self.out}")
        return 0


@dataclass(frozen=True)
class Record:
    """Film an agent in a house: its rays, its trail and its targets."""

    agent: tyro.conf.Positional[Path]
    """Checkpoint (vitruvius train makes one), or the name of an agent that comes with the project."""

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

        agent, houses = checkpoint.load(self.agent), load(self.houses)
        if not 0 <= self.house < len(houses):
            raise RequestError(f"--house {self.house}: {self.houses} has houses 0 to {len(houses) - 1}")
        if self.steps < 1:
            raise RequestError(f"--steps must be 1 or more, not {self.steps}")
        with progress("filming") as tell:
            record(
                agent,
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
    """Rules to houses to a trained agent and its report, in a few minutes."""

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
