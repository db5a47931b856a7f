"""Options and work of ``vitruvius evaluate``.

Cheap to import: torch, Taichi and all that needs them are imported when a command runs.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Literal

import tyro

from vitruvius.agent import banks
from vitruvius.agent.learning.config import MAX_SEED, differences
from vitruvius.agent.runs.released import located
from vitruvius.commands.common import print_answer
from vitruvius.logic.cluster import engine
from vitruvius.logic.errors import RequestError
from vitruvius.logic.request.counts import whole
from vitruvius.logic.terminal import say
from vitruvius.options import Streamed

if TYPE_CHECKING:
    from vitruvius.agent.evaluation.result import Result
    from vitruvius.agent.evaluation.scores import ScoredBank, ScoreFile
    from vitruvius.agent.evaluation.tables import Table
    from vitruvius.agent.runs.checkpoint import Checkpoint
    from vitruvius.logic import House


@dataclass(frozen=True)
class Evaluate:
    """Evaluate agents in houses that they have not seen, and compare them with the baselines.

    The baselines are the paper's agent (by its authors' weights, and trained again), random + avoidance, a
    script, the explorer (the planner alone), a searcher that knows the house, and the shortest-path oracle.
    All meet the same starts and targets.
    """

    groups: ClassVar = {
        "houses": "Task and houses",
        "scores": "Beside others",
        "engine": "Work",
        "out": "Output",
    }

    agents: tyro.conf.Positional[tuple[Path, ...]] = ()
    """Checkpoints, or names of agents that come with the project (pqn, map-completion, search, paper,
    paper-original). Checkpoints that differ only in their training seed are runs of one agent. Without
    agents, the command evaluates the references alone."""

    houses: Streamed = Path(banks.NAME)
    """Houses to evaluate on: a held-out set of 256, test-v1 (family, 2 to 6 rooms), home-test-v1 (home, 4 to
    10 rooms), large-test-v1 or home-large-test-v1 (8 to 12), the paper's house, paper-house, or a house file.
    An object goal is played in the houses that have the furniture, with free floor next to it."""

    targets: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """Location of the targets: main, secondary, mixed (or all), habit, or another task as for train; in the
    paper's house also paper-main, paper-secondary and paper-mixed. By default main, secondary and mixed, one
    after the other."""

    seed: int = 0
    """Seed of starts and targets, the same for every policy."""

    backend: str = "continuous"
    """Backend of the simulator: continuous, grid (for houses made with --cell), free, or module:Class. free
    is for agents that drive (train --preset pqn-free). Its baselines are a random drive, a pursuit of visible
    targets, the explorer, and the true path, which knows house and target; figures are ratios to the true
    path's."""

    world: Literal["default", "long", "noisy", "paper"] = "default"
    """Preset of the simulator for all policies; each policy keeps its own rays. long: 3000 steps an episode.
    noisy: 2 cm of noise, 2 % of the rays lost and 1 % of the actions without effect, except for searcher,
    oracle and true path. paper: a collision ends the episode."""

    episodes: int = 1
    """Number of episodes in each house."""

    allow: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """Your own class, module:Class, that a file may name. Files may name no other class of yours. Vitruvius
    imports the module, which runs its code."""

    scores: tyro.conf.UseAppendAction[tuple[Path, ...]] = ()
    """Scores of external agents in the same houses, seed and targets, to show in the tables: the
    evaluation.json of --out, or the file of an example's --out."""

    beside: Path | None = None
    """Games that people played in these houses (vitruvius play), to compare with agents and baselines in the
    same episodes."""

    engine: Literal["ray"] | None = None
    """Play by Ray, on this machine or on a cluster (docs/scale.md). Each mode of targets is a task; a larger
    bank has one task for each 256 houses. The figures stay the same."""

    address: str | None = None
    """Address of Ray's cluster: HOST:PORT, or auto for the one of this machine. By default the command starts
    a cluster here and ends it."""

    out: Path | None = None
    """Folder for evaluation.json, evaluation.md, evaluation.png and report.html."""

    replace: bool = False
    """Overwrite another evaluation in the folder."""

    json: bool = False
    """Print one answer as JSON, for programs."""

    def run(self) -> int:
        """Evaluate, and print the tables or the JSON."""
        self._require_options()
        import torch

        from vitruvius.agent.evaluation.learnt_in import learnt_in, warnings, with_others
        from vitruvius.agent.evaluation.protocol import tasks_of
        from vitruvius.agent.evaluation.scores import ScoredBank, ScoreFile, external, joined, load, modes_of
        from vitruvius.agent.learning.simulator import require_task
        from vitruvius.agent.play.beside import people_tables, replayable
        from vitruvius.logic.files.writing import require_folder

        require_folder(self.out)
        if self.beside:
            replayable(self.beside)  # reports an invalid file before the evaluation starts
        torch.set_num_threads(1)  # batches are a few hundred: a second thread only costs
        agents = self._agents()
        houses = banks.named(self.houses)
        modes = self.targets or tasks_of(agents)
        for mode in modes:
            require_task(mode)
        bank = ScoredBank(banks.bank_hash(houses), str(self.houses), len(houses))
        self._require_folder(bank, modes)
        conditions = self.seed, self.backend, self.world, self.episodes
        others = {path: external(path, houses, modes, *conditions) for path in self.scores}
        known = with_others(learnt_in(agents, houses), agents, {path: load(path) for path in self.scores})
        warned = warnings(known, len(houses))
        for each in warned:
            say(f"warning: {each}")
        results = self._results(agents, houses, modes)
        for path, policies in others.items():
            results = [joined(result, policies.get(result.mode, {}), path) for result in results]
        content = ScoreFile(
            bank,
            self.seed,
            modes_of(results),
            self.backend,
            self.world,
            self.episodes,
            agents=[str(path) for path in self.agents],
            scores=[str(path) for path in self.scores],
            learnt_in=known,
        )
        people = [*people_tables(self.beside, houses, agents)] if self.beside else []
        self._show(content, results, warned, people)
        return 0

    def _require_options(self) -> None:
        """Raise an error for a wrong option, before torch is imported."""
        from vitruvius.agent.learning.simulator import allow_named, require_asked_task
        from vitruvius.sim.allowed import is_class_name

        for path in self.agents:
            located(path)
        allow_named([*self.allow, *filter(is_class_name, [self.backend])])
        for targets in self.targets:
            require_asked_task(targets)
            banks.require_places(targets, self.houses)
        whole("--seed", self.seed, 0, MAX_SEED)
        if self.backend == "free" and self.beside:
            raise RequestError("--beside: people played in grid steps: use --backend continuous")
        if self.episodes < 1:
            raise RequestError(f"--episodes must be 1 or more, not {self.episodes}")

    def _agents(self) -> dict[str, list["Checkpoint"]]:
        """Return the runs of each agent by name, the paper's agents included."""
        from vitruvius.agent.baselines.table import PAPERS
        from vitruvius.agent.evaluation.protocol import require_motion
        from vitruvius.agent.runs import checkpoint

        agents = by_name(self.agents)
        require_motion(agents, self.backend)
        for name in () if self.backend == "free" else PAPERS:
            agents.setdefault(name, [checkpoint.load(name)])
        return agents

    def _results(
        self, agents: dict[str, list["Checkpoint"]], houses: list["House"], modes: Sequence[str]
    ) -> list["Result"]:
        """Return the result of each mode."""
        from vitruvius.agent.evaluation.protocol import measure
        from vitruvius.agent.progress import progress

        with engine(self.engine, self.address) as cluster, progress("measuring") as report:
            how = {"backend": self.backend, "world": self.world, "episodes": self.episodes}
            return list(measure(agents, houses, modes, self.seed, report, **how, cluster=cluster))

    def _show(
        self, content: "ScoreFile", results: list["Result"], warned: list[str], people: list["Table"]
    ) -> None:
        """Print tables or JSON, and write the files of ``--out``."""
        from rich.console import Console

        from vitruvius.agent.evaluation.plots import ratio_plot
        from vitruvius.agent.evaluation.tables import DRIVING_NOTE, NOTE, print_tables, tables
        from vitruvius.agent.play.beside import BESIDE_NOTE
        from vitruvius.agent.report.folder import write_report
        from vitruvius.logic.files.writing import write_whole

        shown = [*(table for result in results for table in tables(result)), *people]
        notes = [
            *warned,
            DRIVING_NOTE if self.backend == "free" else NOTE,
            *[BESIDE_NOTE] * bool(self.beside),
        ]
        title = f"{content.bank.file}, hash {content.bank.hash[:12]}, seed {self.seed}"
        if self.json:
            print_answer("evaluate", content)
        else:
            console = Console(markup=False)
            print_tables(shown, console)
            console.print("\n\n".join([f"\n{title}", *notes]))
        if self.out:
            page = [
                f"# Evaluation\n\n{title}",
                *warned,
                f"![Ratios to the {results[0].yardstick}](evaluation.png)",
                *(table.markdown() for table in shown),
            ]
            write_whole(self.out / "evaluation.json", content.json())
            write_whole(self.out / "evaluation.png", ratio_plot(results))
            write_whole(self.out / "evaluation.md", "\n\n".join([*page, *notes, ""]).encode())
            write_report(self.out)
            say(f"{self.out}: report.html, evaluation.md, evaluation.png, evaluation.json")

    def _require_folder(self, bank: "ScoredBank", modes: Sequence[str]) -> None:
        """Raise an error if the folder of ``--out`` holds something else than this evaluation."""
        from vitruvius.agent.report.folder import require_report

        if self.out:
            require_report(self.out, self.replace)
        if self.out and not self.replace:
            self._require_same(self.out / "evaluation.json", bank, modes)

    def _require_same(self, file: Path, bank: "ScoredBank", modes: Sequence[str]) -> None:
        """Raise ``RequestError`` if a file holds another evaluation; the same one may be repeated."""
        from vitruvius.agent.evaluation.scores import ScoreError, load
        from vitruvius.logic.files.replacing import require_free

        if not file.exists():
            for ending in (".md", ".png"):
                require_free(file.with_suffix(ending), replace=False)
            return
        try:
            held = load(file)
        except ScoreError:
            what = "exists and is not scores: choose another folder, or add --replace to overwrite it"
            raise RequestError(f"--out {self.out}: {what}") from None
        theirs = held.bank.hash, held.seed, held.backend, held.world, held.episodes, set(held.targets)
        ours = bank.hash, self.seed, self.backend, self.world, self.episodes, set(modes)
        paths = [[str(path) for path in some] for some in (self.agents, self.scores)]
        if theirs != ours or [held.agents, held.scores] != paths:
            what = "holds another evaluation: choose another folder, or add --replace to overwrite it"
            raise RequestError(f"--out {self.out}: {what}")


def by_name(paths: Sequence[Path]) -> dict[str, list["Checkpoint"]]:
    """Return the checkpoints of each agent, by name.

    Runs of one agent differ only in their training seeds. If two configs share a name, the later agent's name
    includes its folder. Raises ``CheckpointError`` for a malformed file, ``RequestError`` if that name is
    taken, too.
    """
    from vitruvius.agent.runs import checkpoint

    agents: dict[str, list[Checkpoint]] = {}
    for path in paths:
        found = checkpoint.load(path)
        for runs in agents.values():
            if runs[0].name == found.name and set(differences(runs[0].config, found.config)) <= {"seed"}:
                runs.append(found)
                break
        else:
            name = found.name if found.name not in agents else f"{found.name} ({path.parent.name})"
            if name in agents:
                raise RequestError(
                    f"{path}: its config differs from that of {name}, another run of the "
                    "same agent: give runs of one config"
                )
            agents[name] = [found]
    return agents
