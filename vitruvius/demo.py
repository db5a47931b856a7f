"""The whole path in one command: houses from rules, an agent trained on them, its evaluation, a report."""

import io
import json
import shutil
import sys
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from time import perf_counter

import numpy as np
from rich.console import Console
from rich.markdown import Markdown

from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.agent.banks import bank_hash, geometry_hash
from vitruvius.agent.evaluation.plots import learning_curve
from vitruvius.agent.evaluation.protocol import measure
from vitruvius.agent.evaluation.result import HUMAN_RATIO, Result
from vitruvius.agent.evaluation.scores import ScoredBank, ScoreFile, modes_of
from vitruvius.agent.evaluation.statistics import paired_difference
from vitruvius.agent.evaluation.tables import SCORE_NOTE, print_tables, score_table
from vitruvius.agent.learning.environments import playable
from vitruvius.agent.learning.learner import Progress
from vitruvius.agent.progress import Report, progress
from vitruvius.agent.recording import trace
from vitruvius.agent.recording.film import record
from vitruvius.agent.recording.recorder import Recorder
from vitruvius.agent.report.folder import describe, write_report
from vitruvius.agent.runs.checkpoint import Checkpoint
from vitruvius.agent.runs.runs import run, torch_threads
from vitruvius.logic import House, RequestError, VitruviusError, check, generate, save
from vitruvius.logic.drawing.draw import contact_sheet
from vitruvius.logic.files.writing import write_whole
from vitruvius.logic.looks.looks import looks_of
from vitruvius.sim.tasks.furniture import pieces_in
from vitruvius.sim.tasks.words import in_words

SEARCH = "home"
"""Grammar of the houses in which an agent searches for furniture: flats and small houses."""

STAR = "family"
"""Grammar of the houses with targets in the main room: the paper's."""

ROOMS = {SEARCH: (4, 5, 6, 7), STAR: (2, 3, 4, 5)}
"""Numbers of rooms of the houses, in equal shares."""

TRAINING, HELD_OUT = {SEARCH: 256, STAR: 512}, {SEARCH: 64, STAR: 64}
"""Number of training houses, and number of held-out houses."""

STEPS, SECONDS = 2_000_000, 60.0
"""Length of the training. On a slow machine, the time limit binds and compresses the schedules."""

COMPLETION_SECONDS = 80.0
"""Time limit of the training of map completion, in seconds, on two cores."""

EPISODES = 4
"""Episodes in each held-out house, for the effect of map completion: with one episode, noise hides it."""

GOAL = 0.49
"""Ratio to the oracle that the agent must exceed: just above ``HUMAN_RATIO``."""

LINES = 5.0
"""Seconds between two lines of progress in a pipe."""

SHOWN = 12
"""Number of plans on the contact sheet."""

AGENT, FORESIGHT = "pqn", "foresight"
"""Names of the run's agents in all tables, plots and folders: an agent that learns to find targets in the
main room, and the explorer with map completion, which searches for furniture."""

BASELINES = ("random + avoidance", "script", "explorer", "oracle")
"""Baselines of the evaluation."""

FILES = (
    "homes.jsonl",
    "homes-held-out.jsonl",
    "stars.jsonl",
    "stars-held-out.jsonl",
    "homes.png",
    "learning-curve.png",
    "episode.gif",
    "episode-object.gif",
    "episode.trace.json",
    "episode-object.trace.json",
    "about.json",
    "report.html",
    "report.md",
)
"""Files that the demo writes, besides the folders of its ``RUNS``, which also have their agents' scores."""

RUNS = AGENT, FORESIGHT
"""Folders of the two training runs: see ``agent.runs.runs``."""

TITLE = "# An agent in houses that it has never seen"
"""First line of the report."""

MAIN_ROOM = (
    f"**Main room: learning.** In the paper's houses, rooms around a main room, the network of `{AGENT}` "
    "began this run with random weights. It has learned to go to targets that its rays hit; it has no map. "
    "The script and the explorer are hand-written and do not learn."
)


def object_goal(piece: str) -> str:
    """Return a description of the second part, for the kind of furniture that is sought."""
    return (
        f"**Find a {piece} in homes: a planner, and a network that predicts.** `explorer` is a "
        "next-best-view planner over an occupancy map, written by hand; it does not learn. `foresight` is "
        "the same planner with a map completion network that began this run with random weights. It has "
        f"learned to predict unseen floor, and where a {piece} stands, from the furniture types that its "
        "rays have hit. The paired difference is its gain."
    )


def demo(out: Path = Path("runs/demo"), seed: int = 0) -> int:
    """Run the demo and write FILES into ``out``; return 0 if the agent exceeds GOAL and random + avoidance.

    Otherwise returns 1. Raises ``RequestError`` for a folder with something else than an older demo,
    ``VitruviusError`` if a house fails the check or two houses are the same.
    """
    start = perf_counter()
    _clear(out)
    with progress("houses", LINES) as report:
        made = banks(seed, report)
    (homes, homes_held_out), (stars, stars_held_out) = made[SEARCH], made[STAR]
    for name, houses in zip(FILES, (homes, homes_held_out, stars, stars_held_out), strict=False):
        save(houses, out / name)
    write_whole(out / "homes.png", _plans(homes_held_out))

    config = replace(PRESETS["pqn"], steps=STEPS, seconds=SECONDS, seed=seed)
    agent, history = run(stars, config, out / AGENT, name=AGENT, every=LINES)

    piece, kinds = sought(homes)
    goal = json.dumps({"task": "object", "piece": piece})
    config = replace(
        PRESETS["map-completion"],
        targets=goal,
        sim=(f"kinds={json.dumps(kinds)}",),
        seconds=COMPLETION_SECONDS,
        seed=seed,
    )
    foresight, learnt = run(playable(homes, goal), config, out / FORESIGHT, name=FORESIGHT, every=LINES)

    film = out / "episode-object.gif"
    with torch_threads(1):
        main = _measured("main", AGENT, agent, stars_held_out, out / "episode.gif", seed)
        found = _measured(goal, FORESIGHT, foresight, playable(homes_held_out, goal), film, seed, EPISODES)
    for part, folder, name in ((main, AGENT, "stars"), (found, FORESIGHT, "homes")):
        bank = ScoredBank(bank_hash(part.houses), f"{name}-held-out.jsonl", len(part.houses))
        measured = ScoreFile(bank, seed, modes_of([part.result]), episodes=part.result.episodes)
        write_whole(out / folder / "evaluation.json", measured.json())
    write_whole(out / "learning-curve.png", learning_curve(history, main.result))
    last = history[-1], learnt[-1]
    words, added = object_goal(piece), f"{gain(found.result)}."
    page = _page(main, found, words, last, seed=seed, seconds=perf_counter() - start)
    write_whole(out / "report.md", page.encode())
    describe(
        out,
        TITLE.removeprefix("# "),
        words,
        added,
        MAIN_ROOM,
        _made(*last),
        f"Made by `vitruvius demo --seed {seed}`.",
    )
    write_report(out)

    console = Console()
    for part, what in ((found, words), (main, MAIN_ROOM)):
        console.print("", Markdown(what))
        print_tables([score_table(part.result)], console)
    console.print("", gain(found.result), "", SCORE_NOTE, "", sep="\n")
    print(*(out / name for name in (*FILES, *RUNS)), sep="\n")
    return _verdict(main.result)


def _clear(out: Path) -> None:
    """Remove an older demo, so that the folder never shows two.

    The new report marks the folder as a demo's.
    """
    report = out / "report.md"
    if out.exists() and any(out.iterdir()) and not (report.exists() and report.read_text().startswith(TITLE)):
        raise RequestError(f"--out {out}: exists and is not a demo: choose another folder")
    for name in FILES:
        (out / name).unlink(missing_ok=True)
    for name in RUNS:
        shutil.rmtree(out / name, ignore_errors=True)
    write_whole(report, f"{TITLE}\n\nThe demo is running: it writes this page when it ends.\n".encode())


def banks(seed: int, report: Report) -> dict[str, tuple[list[House], list[House]]]:
    """Return training houses and held-out houses of each grammar.

    They have different seeds and pass the check, and no two are the same.
    """
    whole, made = sum(TRAINING.values()) + sum(HELD_OUT.values()), list[House]()
    found: dict[str, tuple[list[House], list[House]]] = {}
    for grammar, sizes in ROOMS.items():
        halves: tuple[list[House], list[House]] = [], []
        for half, number in enumerate((TRAINING[grammar], HELD_OUT[grammar])):
            for rooms in sizes:
                request = {"grammar": grammar, "seed": 2 * seed + half, "count": number // len(sizes)}
                for house in generate(rooms, **request, workers=2):
                    if faults := check(house):
                        raise VitruviusError(f"a house of {grammar}, {rooms} rooms, {request}: {faults[0]}")
                    halves[half].append(house)
                    made.append(house)
                    report(len(made) / whole, f"{len(made)} generated and checked")
        found[grammar] = halves
    if len({geometry_hash(house) for house in made}) < len(made):
        raise VitruviusError(f"seed {seed} gave the same house twice. Try another --seed")
    return found


def sought(houses: list[House]) -> tuple[str, list[str]]:
    """Return the kind of furniture that most of the houses have, and all kinds."""
    having = Counter(kind for house in houses for kind in pieces_in(house))
    return max(sorted(having), key=lambda kind: having[kind]), sorted(having)


@dataclass(frozen=True)
class Part:
    """Results of an agent and the baselines with targets in one kind of room."""

    result: Result
    houses: list[House]
    agent: str
    filmed: int
    """Index of the film's episode."""

    def film(self) -> str:
        """Return a description of the film."""
        result, house = self.result, self.filmed % (len(self.result.rooms) // self.result.episodes)
        [agent], [oracle] = (result.policies[name] for name in (self.agent, "oracle"))
        shown = f"The film shows `{self.agent}` in held-out house {house}"
        if result.ends_on_pick_up:
            return (
                f"{shown}, where its SPL is the median of the houses with the most rooms. It finds the piece "
                f"after {agent.first[self.filmed]:.0f} steps, the shortest way is "
                f"{result.shortest[self.filmed]:.0f}."
            )
        return (
            f"{shown}, where its ratio is the median of the houses with the most rooms. It picks up "
            f"{agent.targets[self.filmed]:.0f} targets, the oracle {oracle.targets[self.filmed]:.0f}. "
            "Orange rays see the target."
        )


def gain(result: Result) -> str:
    """Return the effect of map completion on the planner, in one line."""
    own, base = (result.spl(name) for name in (FORESIGHT, "explorer"))
    gain = paired_difference(own, base).signed(3)
    return (
        f"SPL gain of {FORESIGHT} over explorer, paired by house, {result.episodes} episodes in each: {gain}"
    )


def _measured(
    mode: str,
    name: str,
    agent: Checkpoint,
    houses: list[House],
    film: Path,
    seed: int,
    episodes: int = 1,
) -> Part:
    """Evaluate an agent and the baselines, and film a typical episode; its trace is next to the film."""
    words = in_words(mode, looks_of(houses[0]).name)
    with progress(f"measuring, {words}", LINES) as report:
        how = {"baselines": BASELINES, "episodes": episodes}
        [result] = measure({name: [agent]}, houses, [mode], seed, report, **how)
    filmed = _typical(result, name)
    recorder = Recorder(name, mode, seed + filmed)
    with progress(f"filming, {words}", LINES) as report:
        how = {"targets": mode, "seed": seed + filmed, "watchers": [recorder]}
        record(agent, houses[filmed % len(houses)], film, report=report, **how)
    trace.save(recorder.trace, film.with_suffix(trace.ENDING))
    return Part(result, houses, name, filmed)


def _typical(result: Result, agent: str) -> int:
    """Return the median episode of the agent in the houses with the most rooms.

    The median is that of the ratio, or of the SPL among episodes in which the agent found its target.
    """
    [scores] = result.policies[agent]
    ratios = result.spl(agent)[0] if result.ends_on_pick_up else scores.targets / result.oracle.clip(1)
    found = scores.targets >= min(result.ends_on_pick_up, scores.targets.max())
    most = result.rooms == result.rooms[found].max()
    large = sorted(np.flatnonzero(most & found), key=lambda house: ratios[house])
    return int(large[len(large) // 2])


def _plans(houses: list[House]) -> bytes:
    """Return a contact sheet of some of the houses, as a PNG."""
    shown = [houses[len(houses) * place // SHOWN] for place in range(SHOWN)]
    picture = io.BytesIO()
    contact_sheet(shown, columns=4).save(picture, "PNG")
    return picture.getvalue()


def _verdict(result: Result) -> int:
    """Return 0 if the agent clearly exceeds GOAL and the random walk; else print the reason and return 1."""
    agent, walk = result.ratio(AGENT), result.ratio("random + avoidance")
    if agent.low > max(GOAL, walk.high):
        return 0
    print(
        f"the agent's ratio {agent.text()} does not clearly exceed {GOAL}, which is just above the paper's "
        f"human in another house ({HUMAN_RATIO}), and that of random + avoidance, {walk.text()}",
        file=sys.stderr,
    )
    return 1


def _made(last: Progress, learnt: Progress) -> str:
    """Return a description of the training houses and of the training."""
    return (
        f"From rules, {TRAINING[SEARCH]} homes (grammar `{SEARCH}`) and {TRAINING[STAR]} of the paper's "
        f"houses (`{STAR}`) were generated for training, and {HELD_OUT[SEARCH]} and {HELD_OUT[STAR]} from "
        "another seed for evaluation. All passed the independent check; no two are the same. The agent was "
        f"trained on {last.steps / 1e6:.1f} million steps in {last.seconds:.0f} s: {last.simulator:,.0f} "
        f"steps per second in the simulator, {last.learner:,.0f} in the learner. Map completion was trained "
        f"on the maps of {learnt.steps / 1e6:.1f} million steps of explorers in {learnt.seconds:.0f} s."
    )


def _page(
    main: Part, found: Part, words: str, last: tuple[Progress, Progress], *, seed: int, seconds: float
) -> str:
    """Return the report, in Markdown."""
    paragraphs = (
        TITLE,
        "Some of the held-out homes:",
        "![Plans of homes](homes.png)",
        words,
        f"{gain(found.result)}.",
        score_table(found.result).markdown(),
        found.film(),
        "Right: the part of the house that it has seen, and the predicted probability of the target; red: "
        "the true house.",
        "![An episode of the search](episode-object.gif)",
        MAIN_ROOM,
        score_table(main.result).markdown(),
        "![Learning curve](learning-curve.png)",
        main.film(),
        "![An episode](episode.gif)",
        f"{_made(*last)} All of it took {seconds:.0f} s.",
        SCORE_NOTE,
        "Files: [homes](homes.jsonl), [held-out homes](homes-held-out.jsonl), [the paper's "
        f"houses](stars.jsonl), [held-out ones](stars-held-out.jsonl), [{AGENT}]({AGENT}/agent.safetensors), "
        f"[{FORESIGHT}]({FORESIGHT}/agent.safetensors). Made by `vitruvius demo --seed {seed}`.",
    )
    return "\n\n".join(paragraphs) + "\n"
