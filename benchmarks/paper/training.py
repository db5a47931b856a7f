"""Repeated training of the paper's agent, in the paper's house and with one change at a time.

Each group of parallel runs is a process (``benchmarks.paper.side_by_side``), which continues where it was
stopped. Its data are the curve of each run, and the scores of its weights during training and at the end.
"""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np
import torch

from benchmarks.common.pages import png, table_rows
from benchmarks.paper.agents import TASKS
from benchmarks.paper.side_by_side import Actors, Layers, Runs
from vitruvius.agent.algorithms.paper.config import PaperConfig
from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.agent.evaluation.result import HUMAN
from vitruvius.agent.learning.environments import make_envs
from vitruvius.agent.progress import progress
from vitruvius.logic import generate
from vitruvius.logic.files.writing import write_whole
from vitruvius.sim.environment.arguments import PAPER_HOUSE, house_list

PRESET = cast(PaperConfig, PRESETS["paper"])

KEPT_EVERY, SAVED_EVERY = 100, 25
"""Episodes between two sets of weights that are kept, and between two states to continue from."""

ON_THE_WAY, AT_THE_END = 20, 40
"""Number of episodes that evaluate weights, during training and at the end."""

EPSILONS = (PRESET.final_epsilon, 0.5)

SATURATED = 1e-3
"""Largest spread of values between states at which a network counts as saturated."""


@dataclass(frozen=True)
class PaperEntry:
    """A kind of run: its differences from the preset, and its seeds."""

    name: str
    seeds: tuple[int, ...]
    options: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Group:
    """Parallel runs in one process."""

    entries: tuple[PaperEntry, ...]
    episodes: int = cast(int, PRESET.episodes)
    houses: str | dict[str, Any] = PAPER_HOUSE

    def configs(self) -> Iterator[tuple[str, PaperConfig]]:
        """Yield each run's entry and config."""
        for entry in self.entries:
            for seed in entry.seeds:
                yield entry.name, replace(PRESET, seed=seed, **entry.options)


AS_IT_IS, TORCH, NO_HOMING, FREE = "preset `paper`", "torch's first weights", "no homing", "no avoidance"
OPTIONS = {TORCH: {"initialisation": "torch"}, NO_HOMING: {"homing": False}, FREE: {"avoidance": "none"}}


def _entries(**seeds: tuple[int, ...]) -> tuple[PaperEntry, ...]:
    names = {"as_it_is": AS_IT_IS, "torch": TORCH, "no_homing": NO_HOMING, "free": FREE}
    return tuple(PaperEntry(names[key], some, OPTIONS.get(names[key], {})) for key, some in seeds.items())


GROUPS = {
    "first": Group(_entries(as_it_is=(0, 1, 2, 3), torch=(0, 1), no_homing=(0, 1), free=(0, 1)), 200),
    "short": Group(
        _entries(as_it_is=(4, 5, 6, 7, 8, 9), torch=(2, 3, 4, 5), no_homing=(2, 3, 4, 5), free=(2, 3)), 50
    ),
    "eight": Group((PaperEntry("8 environments", (0, 1, 2, 3), {"num_envs": 8}),), 48),
    "houses": Group(
        (
            PaperEntry(
                "32 houses of `family`, targets anywhere in the main room", (0, 1, 2), {"targets": "main"}
            ),
        ),
        50,
        {"rooms": 4, "grammar": "family", "seed": 100, "count": 32},
    ),
}
"""Groups by name; each changes one thing. Weights that learn nothing show it early."""


def measure(out: Path, groups: Sequence[str] = tuple(GROUPS)) -> dict[str, Any]:
    """Train these groups and evaluate them. Return the data of all groups that are finished in the folder."""
    file = out / "paper-training.json"
    data: dict[str, Any] = json.loads(file.read_text()) if file.exists() else {}
    torch.set_num_threads(1)
    for name in groups:
        if name not in data:
            done = train(name, out / f"{name}.pt")
            data[name] = {
                "runs": [{"entry": entry, "seed": config.seed} for entry, config in GROUPS[name].configs()],
                "targets": np.concatenate(done["targets"], 1).tolist(),
                "steps": np.concatenate(done["steps"], 1).tolist(),
                "spread": done["spread"],
                "tests": tests(GROUPS[name], done["weights"]),
            }
            write_whole(file, json.dumps(data).encode())
    return data


def train(name: str, file: Path) -> dict[str, Any]:
    """Train a group to its end, or continue from its file.

    Return targets and steps of each episode, a list of (runs, environments); and the weights and the spread
    of their values, by the number of episodes before.
    """
    group = GROUPS[name]
    configs = [config for _, config in group.configs()]
    houses = list(generate(**group.houses)) if isinstance(group.houses, dict) else house_list(group.houses)
    config, end = configs[0], group.episodes
    envs = make_envs(houses, len(configs) * config.num_envs, config.targets, preset=config.world)
    runs, done = Runs(configs, envs), {"targets": [], "steps": [], "weights": {}, "spread": {}}
    if file.exists():
        kept = torch.load(file, weights_only=False)  # our own file
        runs.restore(kept["runs"])
        done = kept["done"]
    with progress(f"training {name}", every=30.0) as tell:
        while runs.episodes < end:
            for what, values in runs.episode().items():
                done[what].append(values)
            count, weights = runs.episodes, done["weights"]
            tell(min(1.0, count / end), f"{count} episodes")
            if count // KEPT_EVERY > max(weights, default=0) // KEPT_EVERY or count >= end:
                weights[count] = [tuple(part.detach().clone() for part in layer) for layer in runs.layers]
                done["spread"][str(count)] = runs.spread()
            if len(done["steps"]) % SAVED_EVERY == 0 or count >= end:
                part = file.with_suffix(".part")
                torch.save({"runs": runs.state(), "done": done}, part)
                part.replace(file)
    return done


def tests(group: Group, weights: dict[int, Layers]) -> dict[str, Any]:
    """Return targets of each run (N, episodes): during training, and at the end by task and epsilon.

    During training the task is the main room.
    """
    configs = [replace(config, homing=True, num_envs=1) for _, config in group.configs()]

    def found(layers: Layers, task: str, epsilon: float, episodes: int) -> list[list[int]]:
        envs = make_envs(house_list(PAPER_HOUSE), len(configs) * episodes, task, preset=PRESET.world)
        actors = Actors(configs, layers, envs, seed=0)
        rewards = actors.play(envs.reset(seed=[*range(episodes)] * len(configs))[0], epsilon)["r"]
        return rewards.sum(0).reshape(len(configs), episodes).astype(int).tolist()

    last = weights[max(weights)]
    return {
        "on the way": {
            str(count): found(layers, TASKS[0], EPSILONS[0], ON_THE_WAY) for count, layers in weights.items()
        },
        "at the end": {
            f"{task}, {epsilon}": found(last, task, epsilon, AT_THE_END)
            for task in TASKS
            for epsilon in EPSILONS
        },
    }


class PaperRun(NamedTuple):
    """One run of the data."""

    entry: str
    seed: int
    curve: list[int]
    """Targets of each episode during training."""
    spread: float
    """Spread of its values between states, at the end."""
    way: list[list[int]]
    """Targets in the main room of its weights during training."""
    end: dict[str, list[int]]
    """Targets of its last weights, by task and epsilon."""

    def found(self, epsilon: float) -> float:
        """Return the run's mean in the main room."""
        return float(np.mean(self.end[f"{TASKS[0]}, {epsilon}"]))


def runs_of(data: dict[str, Any]) -> list[PaperRun]:
    """Return all runs, by entry and seed."""
    found = [
        PaperRun(
            made["entry"],
            made["seed"],
            group["targets"][run],
            list(group["spread"].values())[-1][run],
            [some[run] for some in group["tests"]["on the way"].values()],
            {name: some[run] for name, some in group["tests"]["at the end"].items()},
        )
        for group in data.values()
        for run, made in enumerate(group["runs"])
    ]
    entries = list(dict.fromkeys(run.entry for run in found))
    return sorted(found, key=lambda run: (entries.index(run.entry), run.seed))


def section(data: dict[str, Any]) -> str:
    """Return the results of all runs at the end, and the verdict on the claim."""
    runs, human = runs_of(data), HUMAN["main"].targets
    by_entry: dict[str, list[PaperRun]] = {}
    for run in runs:
        by_entry.setdefault(run.entry, []).append(run)
    kinds = [
        [
            *(entry, str(len(some)), str(sum(run.spread < SATURATED for run in some))),
            *(", ".join(f"{run.found(epsilon):.1f}" for run in some) for epsilon in EPSILONS),
        ]
        for entry, some in by_entry.items()
    ]
    least, half = EPSILONS
    best, busiest = (max(runs, key=lambda run: run.found(epsilon)) for epsilon in EPSILONS)
    like = [run for run in runs if run.entry == AS_IT_IS]
    return TEXT.format(
        kinds=table_rows(kinds),
        rooms=max(np.mean(run.end[f"{TASKS[1]}, {epsilon}"]) for run in runs for epsilon in EPSILONS),
        human=human,
        runs=len(runs),
        more=sum(run.found(least) > human for run in runs),
        more_half=sum(run.found(half) > human for run in runs),
        like=len(like),
        like_more=sum(run.found(least) > human for run in like),
        like_saturated=sum(run.spread < SATURATED for run in like),
        best=f"{best.found(least):.1f} ({best.entry}, seed {best.seed})",
        busiest=f"{busiest.found(half):.1f} ({busiest.entry}, seed {busiest.seed})",
    )


TEXT = """| what | runs | saturated | main room, epsilon 0.025, run by run | epsilon 0.5, run by run |
|---|---|---|---|---|
{kinds}

At epsilon 0.025, {like_more} of {like} runs of the preset and {more} of all {runs} find more targets than
the human's {human}. The best has {best}. At epsilon 0.5 it is {more_half} of {runs}; the best has {busiest}.

Of the {like} runs of the preset, {like_saturated} are saturated: the softmax gives one action the value 1 in
all states. Its gradient is then 0, so learning stops.

![Targets of an episode while learning](paper-training.png)

In secondary rooms no run finds more than {rooms:.2f} targets, at either epsilon. The figures of every run
and task are in [the data](paper-training.json)."""


def picture(data: dict[str, Any]) -> bytes:
    """Draw the curves of all runs, a panel for each entry: targets of an episode, means of 25 episodes."""
    from matplotlib.figure import Figure

    curves: dict[str, list[np.ndarray]] = {}
    for run in runs_of(data):
        curves.setdefault(run.entry, []).append(np.array(run.curve, float))
    figure = Figure(figsize=(3.2 * len(curves), 3.0), dpi=120, layout="constrained")
    for axes, (name, runs) in zip(
        np.ravel(figure.subplots(1, len(curves), sharex=True, sharey=True, squeeze=False)),
        curves.items(),
        strict=True,
    ):
        for run in runs:
            axes.plot(np.arange(25, len(run) + 1), np.convolve(run, np.ones(25) / 25, "valid"), lw=1)
        axes.axhline(HUMAN["main"].targets, color="0.5", ls="--", lw=1)
        axes.set_title(name.replace("`", "").partition(",")[0], size=9)
        axes.set(xlabel="episode", ylim=(0, None))
    figure.axes[0].set_ylabel("targets of an episode")
    return png(figure)
