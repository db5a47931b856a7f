"""Options and work of ``vitruvius train`` and ``export``.

The commands import torch, taichi and the modules that need them only when they run, so that help is fast.
"""

import os
import shlex
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import islice, pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Generic, Literal, TypeVar

import tyro

from vitruvius.agent.algorithms.pqn.config import PQNConfig
from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.agent.learning.config import TrainConfig
from vitruvius.commands.common import print_answer
from vitruvius.logic.errors import RequestError
from vitruvius.logic.request.counts import whole
from vitruvius.logic.spelling import quoted, unknown
from vitruvius.options import Streamed, options_of
from vitruvius.settings import read, written

if TYPE_CHECKING:
    Preset = str
else:
    Preset = Literal[tuple(PRESETS)]
Kind = TypeVar("Kind", bound=TrainConfig)

MOST_RUNS = 1000
"""Largest number of runs of one command."""

HELD_OUT = 64
"""Default number of held-out houses, from the split validation of a set."""


@dataclass(frozen=True)
class Train(Generic[Kind]):
    """Train an agent in houses. Its checkpoint, learning curve and metrics are in one folder.

    Several processes can train together:

    ``python -m torch.distributed.run --nproc-per-node 2 -m vitruvius.cli train ...``
    """

    groups: ClassVar = {
        "out": "The run",
        "evaluate_every": "Evaluation and checkpoints",
        "preset": "Settings",
    }

    houses: tyro.conf.Positional[Streamed | None] = None
    """House file to train on (vitruvius generate makes one). Or the folder of a set: the run holds 128 houses
    of its split train at a time, for 3000 steps of each environment. Or a grammar and a number of rooms, such
    as home:rooms=4..10: the run generates the houses during training. By default 32 houses that come with
    Vitruvius; for preset paper the paper's house, paper-house."""

    out: Path = Path("runs/train")
    """Folder for agent.safetensors, config.json, metrics.jsonl, report.html, learning-curve.png and
    tensorboard/, best.safetensors and checkpoints/."""

    resume: bool = False
    """Continue the run in the folder, if any, bit for bit on the CPU. A larger --steps extends the run."""

    json: bool = False
    """Print one answer as JSON, for programs."""

    evaluate_every: int = 0
    """Environment steps between two evaluations: an episode in each --held-out house. The best agent is saved
    as best.safetensors. 0: no evaluation."""

    held_out: Streamed | None = None
    """House file for --evaluate-every; the agent must not learn in these houses. For a set, the default is
    the first 64 houses of its split validation."""

    keep_every: int = 0
    """Environment steps between two checkpoints in the folder checkpoints/. 0: no such checkpoints."""

    seeds: int = 1
    """Number of runs, one after the other. The first run has --seed, the next run the next seed; each run has
    a folder seed-N in --out."""

    hook: str | None = None
    """Your own function, module:function, for example for an experiment tracker. Vitruvius calls it with each
    report of the run (agent.learning.learner.Progress)."""

    preset: Preset = "pqn"
    """Preset with the values of all other settings: train --preset NAME --help shows them."""

    config: Streamed | None = None
    """TOML file of settings, as from --print-config. Options on the command line override the file."""

    print_config: bool = False
    """Print all settings as TOML, and train nothing. --config with this file trains the same agent."""

    allow: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """Your own class, module:Class, that a file may name. Files may name no other class of yours. Vitruvius
    imports the module, which runs its code."""

    name: str | None = None
    """Name of the agent in tables; by default the preset's name."""

    learning: Annotated[Kind, tyro.conf.arg(name="")] = field(default_factory=PQNConfig)  # pyright: ignore
    """Settings of the training."""

    @staticmethod
    def like(arguments: Sequence[str]) -> "Train[TrainConfig]":
        """Return the command, with defaults from the preset and the settings file that the arguments name."""
        # Classes on the command line are allowed; classes in a file of settings are not.
        flags = "--targets", "--module", "--hook"
        if stated := [text for flag in flags for text in _given(arguments, flag) if ":" in text]:
            from vitruvius.sim.allowed import allow, class_names

            allow(*(name for text in stated for name in class_names(text)))
        asked: Any = next(iter(_given(arguments, "--preset")[-1:]), None)
        if asked is not None and asked not in PRESETS:
            raise RequestError(f"--preset {asked}: {unknown('preset', asked, PRESETS)}")
        files = _given(arguments, "--config")
        if not files:
            preset = asked or "pqn"
            return Train(preset=preset, learning=PRESETS[preset])
        [option] = (each for each in options_of(Train()) if each.name == "config")
        option.require(files[-1])
        preset, learning, beside = read(Path(files[-1]), asked)
        # Simulator fields on the command line override those of the file.
        ours = {text.partition("=")[0] for text in _given(arguments, "--sim")}
        kept = tuple(text for text in learning.sim if text.partition("=")[0] not in ours)
        houses = Path(beside["houses"]) if "houses" in beside else None
        return Train(houses, preset=preset, name=beside.get("name"), learning=replace(learning, sim=kept))

    def run(self) -> int:
        """Train to the end; the run is saved every half minute."""
        if self.print_config:
            houses = str(self.houses) if self.houses else None
            beside = {"preset": self.preset, "name": self.name, "houses": houses}
            print(written(self.learning, options_of(self), **beside), end="")
            return 0
        from vitruvius.agent.learning.simulator import allow_named, require_task, simulator

        allow_named(self.allow)
        simulator(self.learning)
        require_task(self.learning.targets)
        from vitruvius.agent.algorithms.build import network_of
        from vitruvius.agent.report.folder import require_report
        from vitruvius.logic.files.writing import require_folder

        network_of(self.learning)  # reports a module that cannot be used before the run starts
        require_folder(self.out)
        require_report(self.out, None)
        houses, watching = self._houses(), self._watching()
        first, several = self.learning.seed, whole("--seeds", self.seeds, 1, MOST_RUNS) > 1
        if several and self.json:
            raise RequestError("--json prints one answer, and --seeds trains several agents: leave out one")
        for seed in range(first, first + self.seeds):
            out = self.out / f"seed-{seed}" if several else self.out
            self._train(houses, replace(self.learning, seed=seed), out, watching)
        return 0

    def _houses(self) -> Any:
        """Return the training houses: a list, a set or a stream."""
        from vitruvius.agent.banks import BANKS, require_training
        from vitruvius.logic import HouseSet, HouseStream
        from vitruvius.logic.dataset.sets import SET
        from vitruvius.sim.environment.arguments import BANK, house_list

        file = self.houses or self.learning.learnt_in or BANK
        # Sets and streams never contain the seeds that are reserved for benchmarks.
        if (Path(file) / SET).is_file():
            return HouseSet(file, "train")
        if stream := HouseStream.read(str(file)):
            return stream
        if str(file) in BANKS:
            raise RequestError(f"{file} is reserved for evaluation: train on houses of vitruvius generate")
        houses = house_list(file)
        require_training(houses, file)
        return houses

    def _watching(self) -> Any:
        """Return the options for evaluation, checkpoints and the hook.

        Raises ``RequestError`` for a hook that does not exist or is not a function.
        """
        from vitruvius.agent.runs.watching import Watching
        from vitruvius.logic import HouseSet, load
        from vitruvius.logic.dataset.sets import SET
        from vitruvius.sim.allowed import imported

        held_out, hook = list[Any](), None
        if self.held_out:
            held_out = list(load(self.held_out))
        elif self.evaluate_every and self.houses and (self.houses / SET).is_file():
            held_out = list(islice(HouseSet(self.houses, "validation"), HELD_OUT))
        if self.hook:
            try:
                hook = imported(self.hook)
            except (ImportError, AttributeError, ValueError) as error:
                raise RequestError(f"--hook {self.hook} cannot be used: {error}") from None
            if not callable(hook):
                raise RequestError(f"--hook {self.hook}: this is not a function")
        return Watching(held_out, self.evaluate_every, self.keep_every, hook)

    def _train(self, houses: Any, learning: TrainConfig, out: Path, watching: Any) -> None:
        """Train with one seed, and print the result."""
        from vitruvius.agent.evaluation.plots import learning_curve
        from vitruvius.agent.report.folder import write_report
        from vitruvius.agent.runs.runs import run
        from vitruvius.answers.agents import Trained
        from vitruvius.logic.files.writing import write_whole

        curve = out / "learning-curve.png"
        if curve.exists() and not self.resume:
            raise RequestError(
                f"{curve} already exists from another run: choose another --out folder, or continue with "
                "--resume"
            )
        command, name = shlex.join(["vitruvius", *sys.argv[1:]]), self.name or self.preset
        made, history = run(
            houses, learning, out, name=name, command=command, resume=self.resume, watching=watching
        )
        if int(os.environ.get("RANK", "0")):  # the first rank alone reports
            return
        agent, last = out / "agent.safetensors", history[-1]
        write_whole(curve, learning_curve(history))
        write_report(out)
        best = max((now.held_out for now in history if now.held_out is not None), default=None)
        if self.json:
            speeds = last.simulator, last.learner
            answer = Trained(str(agent), made.steps, last.seconds, last.targets, *speeds, held_out=best)
            print_answer("train", answer)
        drives = " --backend free" if learning.backend == "free" else ""
        known = (
            f"Best evaluation: {best:.1f} targets per episode in held-out houses (best.safetensors). "
            if best
            else ""
        )
        _say(
            f"{agent}: {made.steps / 1e6:.2f} M steps in {last.seconds:.0f} s (simulator "
            f"{last.simulator:,.0f}, learner {last.learner:,.0f} steps per second), {last.targets:.1f} "
            f"targets per 1500 steps during training. {known}Next: vitruvius evaluate "
            f"{quoted(agent)}{drives}"
        )


@dataclass(frozen=True)
class Export:
    """Write an agent's network as an ONNX file, with the memory as an input and an output: see export.py."""

    agent: tyro.conf.Positional[Path]
    """Checkpoint (vitruvius train makes one), or the name of an agent that comes with the project."""

    out: Path = Path("agent.onnx")
    """ONNX file to write."""

    replace: bool = False
    """Overwrite a file that has other content."""

    json: bool = False
    """Print one answer as JSON, for programs."""

    def run(self) -> int:
        """Write the file."""
        from vitruvius.agent.runs import checkpoint
        from vitruvius.agent.runs.export import export
        from vitruvius.answers.houses import Written
        from vitruvius.logic.files.replacing import unless_other
        from vitruvius.logic.files.writing import require_file

        require_file(self.out, [".onnx"])
        with unless_other(self.out, self.replace) as file:
            export(checkpoint.load(self.agent).network, file)
        if self.json:
            print_answer("export", Written([str(self.out)]))
        _say(f"{self.out}")
        return 0


def _given(arguments: Sequence[str], flag: str) -> list[str]:
    """Return the values of an option in the arguments."""
    found = list[str]()
    for argument, following in pairwise([*arguments, "--"]):
        if argument == flag and not following.startswith("--"):
            found.append(following)
        elif argument.startswith(f"{flag}="):
            found.append(argument.partition("=")[2])
    return found


def _say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)
