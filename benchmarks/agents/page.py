"""Page of the study of agents, as a function of its records only."""

from collections.abc import Iterator
from statistics import median
from typing import Any

import numpy as np

from benchmarks.agents.records import Difference, Study, TrainingEntry, by_seed, difference
from benchmarks.common.pages import table_rows
from vitruvius.agent.evaluation.result import HUMAN_RATIO, SUCCESS_STEPS, Result
from vitruvius.agent.evaluation.tables import LABELS, WHERE

UNMEASURED = "-"


def agents_page(study: Study) -> str:
    """Return the page, with tables and links to the pictures of ``benchmarks.agents.pictures``."""
    bases = [entry for entry in study.presets() if study.changes(entry.name)]
    return PAGE.format(
        command=study.command,
        days=study.days,
        machine=study.machine,
        versions=study.versions,
        share=f"{study.share:.3g}",
        minutes=f"{15 * study.share:.2g}",
        learnt_in=study.learnt_in,
        measured_in=study.measured_in,
        human=HUMAN_RATIO,
        soon=SUCCESS_STEPS,
        entries=table_rows(_entry(study, entry) for entry in study.entries),
        externals=_externals(study),
        unfinished=_unfinished(study),
        modes=" | ".join(f"ratio, {WHERE[mode]}" for mode in study.results),
        dashes="---|" * len(study.results),
        order=" / ".join(study.results),
        policies=table_rows(_policies(study)),
        rooms=_by_rooms(study),
        parts="\n\n".join(_parts(study, base) for base in bases) or "No change was measured.",
        time=table_rows(_time(study, entry) for entry in study.entries if _lasts(study, entry)),
    )


def _entry(study: Study, entry: TrainingEntry) -> list[str]:
    """Return the row of an entry: description, options, and the ratio of each of its runs."""
    result, seeds = study.results[entry.targets], study.seeds(entry.name)
    each = ", ".join(f"{value:.2f}" for value in by_seed(result, entry.name)) if seeds else UNMEASURED
    options = " ".join(("--preset", entry.preset, *entry.options))
    return [entry.name, entry.shows, f"`{options}`", entry.targets, f"{entry.steps / 1e6:.3g}", each]


def _externals(study: Study) -> str:
    """Return the section on agents of other libraries, with the ratio of each of their runs."""
    if not study.externals:
        return ""
    rows = []
    for agent in study.externals:
        result = study.results[agent.targets]
        each = ", ".join(f"{value:.2f}" for value in by_seed(result, agent.name))
        ratio = result.ratio(agent.name).text()
        rows.append([agent.name, agent.shows, f"`{agent.command}`", agent.targets, ratio, each])
    return EXTERNALS.format(steps=f"{study.externals[0].steps / 1e6:.3g}", rows=table_rows(rows))


def _unfinished(study: Study) -> str:
    """Return a list of the runs that are in no table, with the reasons."""
    lines = []
    for run in (*study.runs, *study.absent):
        if not run.finished:
            seen = f" (it came to {run.last['steps'] / 1e6:.2f} M steps)" if run.last else ""
            lines.append(f"- {run.entry}, seed {run.seed}: {run.failed or 'it was stopped'}{seen}")
    if not lines:
        return "All runs that were begun came to their end and are in the tables."
    return "Not in the tables, as these runs did not come to their end:\n\n" + "\n".join(lines)


def _policies(study: Study) -> Iterator[list[str]]:
    """Yield the row of each policy: its ratio, success and SPL in all modes that were evaluated."""
    names = {entry.name: f"**{entry.name}**" for entry in study.presets()}
    for name in [*names, *study.baselines()]:
        figures = [result.figures(name) for result in study.results.values()]
        means = (" / ".join(f"{each[key].value:.2f}" for each in figures) for key in ("success", "spl"))
        ratios = (each["ratio"].text() for each in figures)
        yield [names.get(name, LABELS.get(name, name)), *ratios, *means]


def _by_rooms(study: Study) -> str:
    """Return the table of ratios by number of rooms, for targets in secondary rooms."""
    result = study.results.get("secondary")
    if not result:
        return "Not measured."
    counts = [int(count) for count in np.unique(result.rooms)]
    names = [*(entry.name for entry in study.presets()), *study.baselines()]
    rows = (
        [name, *(result.ratio(name, count).text() for count in counts)] for name in names if name != "oracle"
    )
    head = " | ".join(f"{count} rooms" for count in counts)
    return f"| agent or baseline | {head} |\n|---|{'---|' * len(counts)}\n{table_rows(rows)}"


def _parts(study: Study, base: TrainingEntry) -> str:
    """Return a table of a preset and its changes."""
    result = study.results[base.targets]
    rows = [[f"**{base.name}**", "", *_conduct(result, base.name), "", ""]]
    for entry in study.changes(base.name):
        found = difference(study, entry)
        each = ", ".join(f"{value:+.2f}" for value in found.each)
        rows.append([entry.shows, _options(entry), *_conduct(result, entry.name), _signed(found), each])
    head = "| change | options | ratio | blocked | overruled | difference | by seed |"
    title = f"**Changes of {base.name}, targets in {WHERE[base.targets]}**"
    return f"{title}\n\n{head}\n|{'---|' * 7}\n{table_rows(rows)}"


def _options(entry: TrainingEntry) -> str:
    preset = () if entry.preset == entry.beside else ("--preset", entry.preset)
    return f"`{' '.join((*preset, *entry.options))}`"


def _conduct(result: Result, policy: str) -> list[str]:
    """Return ratio, blocked moves and overruled actions."""
    figures = result.figures(policy)
    return [figures["ratio"].text(), *(f"{figures[key].value:.1f}" for key in ("blocked", "interventions"))]


def _signed(found: Difference) -> str:
    """Return a difference with its interval, in bold if it is clear."""
    value, low, high = (f"{number:+.2f}" for number in found.all)
    return f"{f'**{value}**' if found.clear else value} [{low}, {high}]"


def _lasts(study: Study, entry: TrainingEntry) -> list[dict[str, Any]]:
    """Return the last reports of an entry's finished runs."""
    return [run.last for run in study.runs if run.entry == entry.name and run.finished and run.last]


def _time(study: Study, entry: TrainingEntry) -> list[str]:
    """Return the median steps per second of whole runs and of their parts, and the parts' time shares."""
    lasts = _lasts(study, entry)
    whole = median(last["steps"] / last["seconds"] for last in lasts)
    cells = [f"{whole:,.0f}"]
    for part in ("simulator", "learner"):
        rate = median(last[part] for last in lasts)
        cells.append(f"{rate:,.0f} ({whole / rate:.0%})")
    return [entry.name, *cells, f"{median(last['seconds'] for last in lasts) / 60:.1f}"]


EXTERNALS = """
## External agents
These agents of other libraries are the examples that come with the project. They use our houses, rays and
avoidance layer, and keep their own way to learn and to explore, in the evaluation too. Their networks have
two layers of 128 as well, or one layer and a recurrent one. Their commands state what they see: by default
the current rays. They are trained for {steps} M steps in any share, far fewer than ours, so no table has
them together. Each is evaluated on the targets of its training.

| agent | what it is | command | trained on targets in | ratio there | run by run |
|---|---|---|---|---|---|
{rows}
"""

PAGE = """# Agents

`{command}`, {days}. {machine}. {versions}.

Each agent is trained in some houses. It then plays one episode of 1500 steps in each of many houses that it
has never seen. Whenever the agent reaches a target, a new one appears. The **ratio** is the agent's number
of targets divided by the oracle's. The oracle knows the house and the target and takes the shortest path,
so 1 is perfect. The human of the paper scored {human}, in another house and with the whole plan in sight.

These agents have no map. In secondary rooms, where targets are out of sight, compare them with `explorer`. It
follows a planner and learns nothing ([The planner](planner.md)).

**Share of the budget: {share}.** The full budget is the number of steps that 15 minutes gave on one quiet
core of the study's first machine; this share is the work of {minutes} minutes. No run was chosen or left
out by its score.

- Trained on: {learnt_in}.
- Evaluated on: {measured_in}. No agent is trained on them.

![Ratio to the oracle of all agents and baselines](agent-scores.png)

## Scores
| agent or baseline | {modes} | success, {order} | SPL, {order} |
|---|{dashes}---|---|
{policies}

Ratios are interquartile means over houses and training runs. Their 95 % intervals are from a stratified
bootstrap over both. The bootstrap resamples runs separately in each house, so the intervals understate the
variation between whole runs; see the ticks in the picture and the table of every run. Success is the share
of episodes whose first target was reached within {soon} steps. SPL is success weighted by the length of the
shortest path over the length of the path taken. Each agent is trained on one kind of target and evaluated
on all three. The last rows are baselines, which learn nothing. The searcher knows the house, but not the
position of the target.

## Ratio by number of rooms
Targets in secondary rooms, ratio to the oracle:

{rooms}

![Ratio by number of rooms](agent-rooms.png)

## Ablations
Each row changes one part of an agent and trains it from scratch with the same time budget. The difference
is to the unchanged agent, with a 95 % interval from a paired bootstrap (the same seed in the same house). A
difference is clear (in bold) if its interval excludes 0 and all seeds have the same sign. Collisions, and
actions that the avoidance layer masked, are per 1000 steps.

![Differences of the ratio by what was changed](agent-parts.png)

{parts}

## Every run
The curves show targets per 1500 steps while the agent still explores, so they stay below the later
evaluation. Each panel has all runs of an entry, including bad ones.

![Learning curves of every run](agent-curves.png)

| entry | what it is | options | trained on targets in | M steps | ratio there, run by run |
|---|---|---|---|---|---|
{entries}

{unfinished}
{externals}
## Training time
Steps per second of a whole training run on one core, then of each part alone, with its share of the time in
brackets. The learner is everything except the simulator: acting, avoidance, returns, updates. The figures are
medians over the runs; other runs shared the machine.

| entry | steps per second | simulator | learner | minutes |
|---|---|---|---|---|
{time}

## Reproduction
`{command}` resumes an interrupted study and repeats nothing.

Train one agent alone by `./run train runs/study/learn.jsonl --preset pqn --steps 1000000 --seed 0`, or with
the options and steps of its row. Evaluate it by `./run evaluate runs/train/agent.safetensors`. The figures
vary within their intervals for other houses, seeds or processors. The same seed on the same machine gives the
same run.
"""
