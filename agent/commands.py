"""``vitruvius train``, ``export`` and ``import-keras``: their options, and what they do.

Cheap to import: torch, taichi and all that needs them are imported when a command runs.
"""

import os
import shlex
import sys
from argparse import ArgumentParser
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Generic, Literal, TypeVar

import tyro

from agent.config import LEARNT_IN, PRESETS, PQNConfig, TrainConfig
from logic.errors import RequestError
from logic.spelling import unknown

Preset = Literal["pqn", "pqn-map", "pqn-recurrent", "dqn", "paper"]
Kind = TypeVar("Kind", bound=TrainConfig)


@dataclass(frozen=True)
class Train(Generic[Kind]):
    """Train an agent in houses. Its checkpoint, learning curve and metrics lie in one folder.

    Several processes learn as one: python -m torch.distributed.run --nproc-per-node 2 -m agent.cli train ...
    """

    houses: tyro.conf.Positional[Path | None] = None
    """House file to learn in: vitruvius generate makes one. By default 32 houses that come with Vitruvius,
    for preset paper the paper's house, paper-house."""

    out: Path = Path("runs/train")
    """Folder for agent.safetensors, config.json, metrics.jsonl, report.html, learning-curve.png and
    tensorboard/."""

    resume: bool = False
    """Go on with the run in the folder, if there is one: bit for bit on the CPU, or with more --steps."""

    preset: Preset = "pqn"
    """Where all options that are not given come from: --help shows its values."""

    name: str | None = None
    """What to call the agent in tables; by default the preset's name."""

    config: Annotated[Kind, tyro.conf.arg(name="")] = field(default_factory=PQNConfig)  # pyright: ignore
    """How to learn."""

    @staticmethod
    def like(arguments: Sequence[str]) -> "Train[TrainConfig]":
        """The command with the defaults of the preset that the arguments name."""
        parser = ArgumentParser(add_help=False, allow_abbrev=False)
        parser.add_argument("--preset", default="pqn")
        preset: Preset = parser.parse_known_args(arguments)[0].preset
        if preset not in PRESETS:
            raise RequestError(f"--preset {preset}: {unknown('preset', preset, PRESETS)}")
        return Train(preset=preset, config=PRESETS[preset])

    def run(self) -> int:
        """Train to the end; the run is saved every half minute on the way."""
        from agent.simulator import require_task, simulator

        simulator(self.config)
        require_task(self.config.targets)
        from agent.banks import require_training
        from agent.evaluation.plots import learning_curve
        from agent.report.folder import write_report
        from agent.runs import run
        from logic.files import require_folder, write_whole
        from sim.arguments import BANK, house_list

        require_folder(self.out)
        file = self.houses or LEARNT_IN.get(self.preset, BANK)
        houses = house_list(file)
        require_training(houses, file)
        command = shlex.join(["vitruvius", *sys.argv[1:]])
        made, history = run(
            houses,
            self.config,
            self.out,
            name=self.name or self.preset,
            command=command,
            resume=self.resume,
        )
        if int(os.environ.get("RANK", "0")):  # the first rank alone reports
            return 0
        agent, last = self.out / "agent.safetensors", history[-1]
        write_whole(self.out / "learning-curve.png", learning_curve(history))
        write_report(self.out)
        _say(
            f"{agent}: {made.steps / 1e6:.2f} M steps in {last.seconds:.0f} s "
            f"(simulator {last.simulator:,.0f}, learner {last.learner:,.0f} steps a second), "
            f"{last.targets:.1f} targets per 1500 steps while learning. Next: vitruvius evaluate {agent}"
        )
        return 0


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
        from logic.files import require_file

        require_file(self.out, [".onnx"])
        export(checkpoint.load(self.agent).network, self.out)
        _say(f"{self.out}")
        return 0


@dataclass(frozen=True)
class ImportKeras:
    """Take weights that the paper's original program trained, from the HDF5 file that Keras wrote."""

    file: tyro.conf.Positional[Path]
    """The HDF5 file, with the layers of the paper's network."""

    out: Path = Path("original.safetensors")
    """The checkpoint: vitruvius evaluate and record take it."""

    name: str = "original weights"
    """What to call the agent in tables."""

    def run(self) -> int:
        """Read the weights, write the checkpoint."""
        from agent import checkpoint
        from agent.keras import import_keras
        from logic.files import require_file

        require_file(self.out, [".safetensors"])
        made = import_keras(self.file, self.name, shlex.join(["vitruvius", *sys.argv[1:]]))
        checkpoint.save(made, self.out)
        _say(f"{self.out}. Next: vitruvius evaluate {self.out}")
        return 0


def _say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)
