"""Section of evaluations: each policy's figures with their intervals, as plots and tables."""

from collections.abc import Callable, Collection, Iterable, Sequence
from pathlib import Path

import numpy as np

from vitruvius.agent.banks import BANKS, benchmark
from vitruvius.agent.baselines.table import KNOWS, NO_AGENTS
from vitruvius.agent.evaluation import scores
from vitruvius.agent.evaluation.learnt_in import warnings
from vitruvius.agent.evaluation.result import HUMAN, HUMAN_RATIO, yardstick
from vitruvius.agent.evaluation.scores import Figure, ModeScores, PolicyScores, ScoredBank
from vitruvius.agent.evaluation.statistics import Estimate, interquartile_mean
from vitruvius.agent.evaluation.tables import DRIVING_NOTE, LABELS, SCORE_NOTE, capital, human_name
from vitruvius.agent.report.html import Cell, Section, details, inline, table
from vitruvius.agent.report.plots import Axis, DataSeries, interval_plot, line_plot, slots
from vitruvius.logic import load
from vitruvius.logic.looks.looks import looks_of, spaced
from vitruvius.logic.spelling import markup, numbered
from vitruvius.sim.tasks.words import in_words

COLUMNS = {
    "targets": ("targets", 1),
    "ratio": ("ratio", 2),
    "success": ("success", 2),
    "spl": ("SPL", 2),
    "coverage_500": ("seen by 500", 2),
    "coverage_1500": ("seen by 1500", 2),
    "rooms": ("rooms", 2),
    "blocked": ("blocked", 1),
    "interventions": ("overruled", 1),
    "human": ("> human", 2),
}
"""Heading and number of digits of each figure."""


def lead(files: Sequence[Path]) -> str:
    """Return one sentence on the best agent of the first evaluation with agents.

    Its warnings follow. The result is empty if no evaluation has agents.
    """
    for path in files:
        file = scores.load(path)
        for name, mode in file.targets.items():
            figures = {policy: _figures(each) for policy, each in mode.policies.items()}
            figures = {policy: each for policy, each in figures.items() if "targets" in each}
            agents = figures.keys() - {*NO_AGENTS}
            if agents:
                words = in_words(name, _naming(path, file.bank))
                said = f"In {numbered(file.bank.houses, 'house')}, {_sentence(words, mode, figures, agents)}."
                known = {policy: n for policy, n in file.learnt_in.items() if policy in agents}
                return " ".join([said, *(f"{each}." for each in warnings(known, file.bank.houses))])
    return ""


def _naming(path: Path, bank: ScoredBank) -> Callable[[str], str]:
    """Return a function that maps each type in a bank to its name.

    If the bank's file exists, the names come from its first house. The bank's name comes from a file, so the
    search covers only the folder of the run and the folder above it.
    """
    inside = bank.file and not Path(bank.file).is_absolute() and ".." not in Path(bank.file).parts
    beside = [folder / bank.file for folder in (path.parent, path.parent.parent)] if inside else []
    file = next((each for each in beside if each.is_file()), None)
    if file is None and bank.file not in BANKS:
        return spaced
    houses = load(file) if file else benchmark(bank.file)
    return looks_of(houses[0]).name


def _sentence(
    words: str, mode: ModeScores, figures: dict[str, dict[str, Estimate]], agents: Collection[str]
) -> str:
    """Return a sentence that compares the best agent with the best baseline of ``KNOWS``."""
    finds = mode.ends_on_pick_up and all({"success", "spl"} <= {*each} for each in figures.values())
    key, digits = ("spl", 2) if finds else ("targets", 1)

    def best(names: Iterable[str]) -> str:
        return max((name for name in figures if name in names), key=lambda name: figures[name][key].value)

    agent = best(agents)
    value = f"{figures[agent][key].value:.{digits}f}"
    if finds:
        verb, what = words.split(" ", 1)
        verbs = {"find": "finds", "reach": "reaches"}
        does = f"{verbs[verb]} {what}" if verb in verbs else f"does its task ({words})"
        said = (
            f"{agent} {does} in {figures[agent]['success'].value:.0%} of its episodes, at an SPL of {value}"
        )
        said += ", where 1 means the shortest path in every episode"
    else:
        said = f"{agent} collects {value} {words} per episode"
    if figures.keys() & KNOWS.keys():
        rival = best(KNOWS)
        value = f"{figures[rival][key].value:.{digits}f}"
        said += (
            f"; the best baseline with no more information, {rival}, "
            f"{'reaches' if finds else 'collects'} {value}"
        )
    if "oracle" in figures and not finds:  # Its SPL is 1.
        said += (
            f"; the oracle, which knows the house and the target, {figures['oracle'][key].value:.{digits}f}"
        )
    return said


def section(files: Sequence[Path], folder: Path) -> Section:
    """Return the section of ``evaluation.json`` files. Raises ``ScoreError`` for a malformed file."""
    parts, notes = [], dict[str, None]()
    for path in files:
        file = scores.load(path)
        bank = file.bank
        notes[DRIVING_NOTE if file.backend == "free" else SCORE_NOTE] = None
        houses = f"{bank.houses} houses" + (f" of {bank.file}" if bank.file else "")
        words = f"{path.relative_to(folder)}: {houses}, hash {bank.hash[:12]}, seed {file.seed}."
        parts.append(f"<p>{markup(words)}</p>")
        told = warnings(file.learnt_in, bank.houses)
        parts += [f"<p><strong>{markup(each)}.</strong></p>" for each in told]
        named = _naming(path, bank)
        parts += [
            _mode(name, in_words(name, named), mode, file.definitions) for name, mode in file.targets.items()
        ]
    parts += [f"<p>{inline(note)}</p>" for note in notes]
    return Section("evaluation", "Evaluation results", "\n".join(parts))


def _mode(name: str, words: str, mode: ModeScores, definitions: dict[str, str]) -> str:
    """Return the part of a target mode: the figures of all policies."""
    figures = {policy: _figures(each) for policy, each in mode.policies.items()}
    labels = {policy: _label(policy, each) for policy, each in mode.policies.items()}
    colours = slots(figures)
    best = yardstick(figures)
    human = HUMAN.get(name) if best == "oracle" else None
    ratios = [
        (labels[policy], found["ratio"], colours[policy])
        for policy, found in figures.items()
        if "ratio" in found
    ]
    parts = [f"<h3>{markup(capital(words))}</h3>", '<div class="figures-row">']
    if ratios:
        mark = (HUMAN_RATIO, human_name(name)) if human else None
        parts.append(interval_plot(f"Ratio to the {best}, {words}", f"ratio to the {best}", ratios, mark))
    parts += [_by_rooms(mode, words, labels, colours), "</div>"]
    columns = [key for key in COLUMNS if any(key in found for found in figures.values())]
    rows = [
        [Cell(labels[policy]), *(_cell(found.get(key), COLUMNS[key][1]) for key in columns)]
        for policy, found in figures.items()
    ]
    headings = ["policy", *(COLUMNS[key][0] for key in columns)]
    parts.append(table(f"{capital(words)}: figures with 95 % intervals", headings, rows))
    if human:
        parts.append(
            f"<p>The paper's human ({human_name(name)}) picked up {human.targets} targets, its oracle "
            f"{human.oracle}: a ratio of {HUMAN_RATIO}.</p>"
        )
    meanings = "".join(
        f"<dt>{COLUMNS[key][0]}</dt><dd>{inline(definitions.get(key, ''))}</dd>" for key in columns
    )
    return "\n".join([*parts, details("Column definitions", f"<dl>{meanings}</dl>")])


def _by_rooms(mode: ModeScores, words: str, labels: dict[str, str], colours: dict[str, int]) -> str:
    """Return a plot of the ratio by number of rooms, or nothing if all houses have the same number."""
    found, best = [], yardstick(mode.policies)
    for policy, each in mode.policies.items():
        points = sorted((rooms, estimate(figure)) for rooms, figure in each.ratio_by_rooms.items())
        if len(points) > 1 and policy != best:
            rooms, figures = [rooms for rooms, _ in points], [each for _, each in points]
            value, low, high = ([getattr(each, end) for each in figures] for end in ("value", "low", "high"))
            found.append(DataSeries(labels[policy], rooms, value, low, high, colours[policy]))
    if not found:
        return ""
    ticks = sorted({rooms for each in found for rooms in each.x})
    x = Axis("rooms of the house", ticks=ticks)
    y = Axis(f"ratio to the {best}", least=0.0, most=1.0)
    return line_plot(f"Ratio by number of rooms, {words}", x, y, found)


def estimate(figure: Figure) -> Estimate:
    """Return the estimate that a file's figure states."""
    return Estimate(figure["value"], figure["low"], figure["high"])


def _figures(policy: PolicyScores) -> dict[str, Estimate]:
    """Return a policy's figures; its targets are computed from its runs if the file does not state them."""
    figures = {key: estimate(figure) for key, figure in policy.figures.items() if key in COLUMNS}
    runs = [run.targets for run in policy.runs if run.targets]
    if "targets" not in figures and runs and len({len(run) for run in runs}) == 1:
        figures["targets"] = interquartile_mean(np.array(runs, float))
    return figures


def _label(name: str, policy: PolicyScores) -> str:
    runs = len(policy.runs)
    return LABELS.get(name, name) + (f", {runs} runs" if runs > 1 else "")


def _cell(found: Estimate | None, digits: int) -> Cell:
    if found is None:
        return Cell("–")
    value, low, high = (f"{each:.{digits}f}" for each in (found.value, found.low, found.high))
    return Cell(value, "" if low == high else f"{low} to {high}", found.value)
