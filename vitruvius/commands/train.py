"""``vitruvius train`` and ``export``: their options, and what they do.

Cheap to import: torch, taichi and all that needs them are imported when a command runs.
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

from agent.algorithms.pqn.config import PQNConfig
from agent.algorithms.table import PRESETS
from agent.learning.config import TrainConfig
from logic.errors import RequestError
from logic.request.request import whole
from logic.spelling import quoted, unknown
from vitruvius.commands.common import print_answer
from vitruvius.options import Streamed, options_of
from vitruvius.settings import read, written

if TYPE_CHECKING:
    Preset = str
else:
    Preset = Literal[tuple(PRESETS)]
Kind = TypeVar("Kind", bound=TrainConfig)

MOST_RUNS = 1000
"""Of a command, one after the other."""

HELD_OUT = 64
"""Houses of a set's split validation that an agent is evaluated in while it learns."""


@dataclass(frozen=True)
class Train(Generic[Kind]):
    """Train an agent in houses. Its checkpoint, learning curve and metrics lie in one folder.

    Several processes learn as one:
    python -m torch.distributed.run --nproc-per-node 2 -m vitruvius.cli train ...
    """

    groups: ClassVar = {"out": "The run", "evaluate_every": "Beside learning", "preset": "Settings"}

    houses: tyro.conf.Positional[Streamed | None] = None
    """House file to learn in: vitruvius generate makes one. Or the folder of a set, of whose split train 128
    houses are held at a time, for 3000 steps of each environment; or a grammar and how many rooms, as
    home:rooms=4..10, whose houses are made meanwhile. By default 32 houses that come with Vitruvius, for
    preset paper the paper's house, paper-house."""

    out: Path = Path("runs/train")
    """Folder for agent.safetensors, config.json, metrics.jsonl, report.html, learning-curve.png and
    tensorboard/, best.safetensors and checkpoints/."""

    resume: bool = False
    """Go on with the run in the folder, if there is one: bit for bit on the CPU, or with more --steps."""

    json: bool = False
    """Print one answer as JSON (docs/command-line.md): the last report of the run."""

    evaluate_every: int = 0
    """Environment steps between two evaluations in --held-out houses, an episode in each; the best agent is
    kept as best.safetensors. 0: none."""

    held_out: Streamed | None = None
    """House file of houses that the agent does not learn in, for --evaluate-every. Of a set by default the
    first 64 houses of its split validation."""

    keep_every: int = 0
    """Environment steps between two checkpoints that are kept in checkpoints/. 0: none."""

    seeds: int = 1
    """Runs, one after the other: with --seed and the seeds after it, each in a folder seed-N of --out."""

    hook: str | None = None
    """Function of your own, module:function, that is called with each report of the run
    (agent.learning.learner.Progress), as for a tracker of experiments."""

    preset: Preset = "pqn"
    """Where all settings that are not given come from: train --preset NAME --help shows its values."""

    config: Streamed | None = None
    """TOML file of settings, as --print-config prints it; what is given on the command line wins over it."""

    print_config: bool = False
    """Train nothing, but print all settings as TOML: for --config, which trains the same."""

    allow: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """Class of your own, module:Class, that the file of --config may name: its module is run.
    Files may name no other class."""

    name: str | None = None
    """What to call the agent in tables; by default the preset's name."""

    learning: Annotated[Kind, tyro.conf.arg(name="")] = field(default_factory=PQNConfig)  # pyright: ignore
    """How to learn."""

    @staticmethod
    def like(arguments: Sequence[str]) -> "Train[TrainConfig]":
        """The command with the defaults of the preset and of the file of settings that the arguments name."""
        # Classes on the command line are allowed; classes in a file of settings are not.
        flags = "--targets", "--module", "--hook"
        if stated := [text for flag in flags for text in _given(arguments, flag) if ":" in text]:
            from sim.allowed import allow, class_names

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
        # The command line adds fields of the simulator to these, and wins.
        ours = {text.partition("=")[0] for text in _given(arguments, "--sim")}
        kept = tuple(text for text in learning.sim if text.partition("=")[0] not in ours)
        houses = Path(beside["houses"]) if "houses" in beside else None
        return Train(houses, preset=preset, name=beside.get("name"), learning=replace(learning, sim=kept))

    def run(self) -> int:
        """Train to the end; the run is saved every half minute on the way."""
        if self.print_config:
            houses = str(self.houses) if self.houses else None
            beside = {"preset": self.preset, "name": self.name, "houses": houses}
            print(written(self.learning, options_of(self), **beside), end="")
            return 0
        from agent.learning.simulator import allow_named, require_task, simulator

        allow_named(self.allow)
        simulator(self.learning)
        require_task(self.learning.targets)
        from agent.algorithms.build import network_of
        from agent.report.folder import require_report
        from logic.house.files import require_folder

        network_of(self.learning)  # a module of a user's own that cannot be had is told at once
        require_folder(self.out)
        require_report(self.out, None)
        houses, watching = self._houses(), self._watching()
        first, several = self.learning.seed, whole("--seeds", self.seeds, 1, MOST_RUNS) > 1
        if several and self.json:
            raise RequestError("--json prints one answer: leave it out, or --seeds")
        for seed in range(first, first + self.seeds):
            out = self.out / f"seed-{seed}" if several else self.out
            self._train(houses, replace(self.learning, seed=seed), out, watching)
        return 0

    def _houses(self) -> Any:
        """What the agent learns in: houses, a set's or a stream's."""
        from agent.banks import require_training
        from logic import HouseSet, HouseStream
        from logic.dataset.sets import SET
        from sim.environment.arguments import BANK, house_list

        file = self.houses or self.learning.learnt_in or BANK
        # Seeds of sets and streams are none of those that are kept for measuring.
        if (Path(file) / SET).is_file():
            return HouseSet(file, "train")
        if stream := HouseStream.read(str(file)):
            return stream
        houses = house_list(file)
        require_training(houses, file)
        return houses

    def _watching(self) -> Any:
        """What is done beside learning. Raises ``RequestError`` for a hook that cannot be had."""
        from agent.runs.watching import Watching
        from logic import HouseSet, load
        from logic.dataset.sets import SET
        from sim.allowed import imported

        held_out, hook = list[Any](), None
        if self.held_out:
            held_out = list(load(self.held_out))
        elif self.evaluate_every and self.houses and (self.houses / SET).is_file():
            held_out = list(islice(HouseSet(self.houses, "validation"), HELD_OUT))
        if self.hook:
            try:
                hook = imported(self.hook)
            except (ImportError, AttributeError, ValueError) as error:
                raise RequestError(f"--hook {self.hook}: cannot be had: {error}") from None
            if not callable(hook):
                raise RequestError(f"--hook {self.hook}: is no function")
        return Watching(held_out, self.evaluate_every, self.keep_every, hook)

    def _train(self, houses: Any, learning: TrainConfig, out: Path, watching: Any) -> None:
        """Train with one seed, and tell how it went."""
        from agent.evaluation.plots import learning_curve
        from agent.report.folder import write_report
        from agent.runs.runs import run
        from logic.house.files import write_whole
        from vitruvius.answers.agents import Trained

        curve = out / "learning-curve.png"
        if curve.exists() and not self.resume:
            raise RequestError(f"{curve}: is there already, of another run: give another folder")
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
        known = f"{best:.1f} in an episode in held-out houses, at best (best.safetensors). " if best else ""
        _say(
            f"{agent}: {made.steps / 1e6:.2f} M steps in {last.seconds:.0f} s "
            f"(simulator {last.simulator:,.0f}, learner {last.learner:,.0f} steps a second), "
            f"{last.targets:.1f} targets per 1500 steps while learning. {known}"
            f"Next: vitruvius evaluate {quoted(agent)}{drives}"
        )


@dataclass(frozen=True)
class Export:
    """Write an agent's network as an ONNX file, its memory an input and an output: see export.py."""

    agent: tyro.conf.Positional[Path]
    """Checkpoint (vitruvius train makes one), or the name of an agent that comes with the project."""

    out: Path = Path("agent.onnx")
    """The file."""

    replace: bool = False
    """Lose what the file holds, if anything else."""

    json: bool = False
    """Print one answer as JSON: the file's name."""

    def run(self) -> int:
        """Write the file."""
        from agent.runs import checkpoint
        from agent.runs.export import export
        from logic.house.files import require_file
        from logic.house.replacing import unless_other
        from vitruvius.answers.houses import Written

        require_file(self.out, [".onnx"])
        with unless_other(self.out, self.replace) as file:
            export(checkpoint.load(self.agent).network, file)
        if self.json:
            print_answer("export", Written([str(self.out)]))
        _say(f"{self.out}")
        return 0


def _given(arguments: Sequence[str], flag: str) -> list[str]:
    """The values that arguments give an option."""
    found = list[str]()
    for argument, following in pairwise([*arguments, "--"]):
        if argument == flag and not following.startswith("--"):
            found.append(following)
        elif argument.startswith(f"{flag}="):
            found.append(argument.partition("=")[2])
    return found


def _say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)
