"""The whole path in one command: houses from rules, an agent that learns in them, a measurement, a report."""

import io
import shutil
import sys
from dataclasses import dataclass, replace
from pathlib import Path
from time import perf_counter

from rich.console import Console

from agent import checkpoint, report
from agent.banks import geometry_hash
from agent.checkpoint import Checkpoint
from agent.config import PRESETS
from agent.evaluate import Scores, evaluate
from agent.learner import Progress
from agent.progress import Report, progress
from agent.record import record
from agent.runs import run
from agent.world import make_worlds
from logic import House, VitruviusError, check, generate, save
from logic.draw import contact_sheet
from logic.files import write_whole

ROOMS = (2, 3, 4, 5)
"""Rooms of the houses, in equal shares."""

TRAINING, HELD_OUT = 256, 64
"""Houses to learn in, and houses to be measured in."""

STEPS, SECONDS = 4_000_000, 130.0
"""Length of the training; where the machine is slow, the clock binds and compresses the schedules."""

GOAL = 0.49
"""The ratio to the oracle that the agent must exceed: the paper's human reaches 0.48."""

LINES = 5.0
"""Seconds between the lines of progress in a pipe."""

SHOWN = 12
"""Plans on the contact sheet."""

RELEASED = "pqn-map"
"""The agent that comes with the project, which shows what more learning, and a map, are good for."""

FILES = (
    "houses.jsonl",
    "houses-held-out.jsonl",
    "plans.png",
    "learning-curve.png",
    "episode.gif",
    "episode-secondary.gif",
    "report.md",
)
"""What the demo writes, beside the folder ``training``: see ``agent.runs``."""


def demo(out: Path = Path("runs/demo"), seed: int = 0) -> int:
    """Do it all and write FILES into ``out``; 0 if the agent beats GOAL and random + avoidance, else 1.

    Raises ``VitruviusError`` if a house fails the check or two houses are the same.
    """
    start = perf_counter()
    for name in FILES:  # so that the folder never shows two runs at once
        (out / name).unlink(missing_ok=True)
    shutil.rmtree(out / "training", ignore_errors=True)
    with progress("houses", LINES) as tell:
        houses, held_out = banks(seed, tell)
    save(houses, out / "houses.jsonl")
    save(held_out, out / "houses-held-out.jsonl")

    config = replace(PRESETS["pqn"], steps=STEPS, seconds=SECONDS, seed=seed)
    agent, history = run(houses, config, out / "training", name="pqn", every=LINES)

    main = _measured("main", agent, held_out, out / "episode.gif", seed)
    secondary = _measured(
        "secondary", checkpoint.load(RELEASED), held_out, out / "episode-secondary.gif", seed
    )
    write_whole(out / "plans.png", _plans(held_out))
    write_whole(out / "learning-curve.png", report.learning_curve(history, main.scores))
    page = _page(main, secondary, history[-1], seed=seed, seconds=perf_counter() - start)
    write_whole(out / "report.md", page.encode())

    never = f"of {HELD_OUT} houses never seen"
    titles = (f"Main room {never}: the agent of this run", f"Secondary rooms {never}: the agent {RELEASED}")
    for title, part in zip(titles, (main, secondary), strict=True):
        Console().print(report.table(part.lines, title))
    print(*(out / name for name in (*FILES, "training")), sep="\n")
    return _verdict(main.scores)


def banks(seed: int, tell: Report) -> tuple[list[House], list[House]]:
    """Houses to learn in and houses to be measured in, by different seeds, checked, no two the same."""
    drawn: list[House] = []
    for half, number in enumerate((TRAINING, HELD_OUT)):
        for rooms in ROOMS:
            for house in generate(rooms, seed=2 * seed + half, count=number // len(ROOMS), workers=2):
                if faults := check(house):
                    raise VitruviusError(f"a house of {rooms} rooms, seed {2 * seed + half}: {faults[0]}")
                drawn.append(house)
                tell(len(drawn) / (TRAINING + HELD_OUT), f"{len(drawn)} made and checked")
    if len({geometry_hash(house) for house in drawn}) < len(drawn):
        raise VitruviusError(f"seed {seed} gave the same house twice. Try another --seed")
    return drawn[:TRAINING], drawn[TRAINING:]


@dataclass(frozen=True)
class Part:
    """What an agent did where targets lay in one kind of room."""

    scores: Scores
    lines: list[tuple[str, ...]]
    filmed: int

    def film(self) -> str:
        """What the film shows, in words."""
        agent, oracle = (int(each.targets[self.filmed]) for each in (self.scores.agent, self.scores.oracle))
        return (
            f"Held-out house {self.filmed}: among those with the most rooms, the agent's ratio here is the "
            f"median. It picked up {agent} targets, the oracle {oracle}. Orange rays see the target."
        )


def _measured(targets: str, agent: Checkpoint, houses: list[House], film: Path, seed: int) -> Part:
    """Measure an agent, and film a typical episode."""
    with progress(f"measuring, {targets}", LINES) as tell:
        scores = evaluate(agent, make_worlds(houses, len(houses), targets), seed=seed, tell=tell)
    filmed = _typical(scores, houses)
    with progress(f"filming, {targets}", LINES) as tell:
        record(agent, houses[filmed], film, targets=targets, seed=seed + filmed, tell=tell)
    return Part(scores, report.rows(scores, targets), filmed)


def _typical(scores: Scores, houses: list[House]) -> int:
    """Of the houses with the most rooms, the one where the agent's ratio is the median."""
    most = max(len(house.rooms) for house in houses)
    large = [index for index, house in enumerate(houses) if len(house.rooms) == most]
    large.sort(key=lambda index: scores.agent.targets[index] / max(1, scores.oracle.targets[index]))
    return large[len(large) // 2]


def _plans(houses: list[House]) -> bytes:
    """A contact sheet of some of the houses, as a PNG."""
    shown = [houses[len(houses) * place // SHOWN] for place in range(SHOWN)]
    picture = io.BytesIO()
    contact_sheet(shown, columns=4).save(picture, "PNG")
    return picture.getvalue()


def _verdict(scores: Scores) -> int:
    """0 if the agent clearly exceeds the human's ratio and the random walk, else 1, said on stderr."""
    agent, walk = scores.agent.ratio(scores.oracle), scores.walk.ratio(scores.oracle)
    if agent.low > max(GOAL, walk.high):
        return 0
    print(f"the agent's ratio {agent.text()} does not clearly exceed {GOAL}", file=sys.stderr)
    return 1


def _page(main: Part, secondary: Part, last: Progress, *, seed: int, seconds: float) -> str:
    """The report, in Markdown."""
    paragraphs = (
        "# An agent in houses that it has never seen",
        f"From the rules of `family`, {TRAINING} houses of {ROOMS[0]} to {ROOMS[-1]} rooms were made to "
        f"learn in, and {HELD_OUT} by another seed to be measured in. "
        "All passed the independent check; no two are the same. "
        f"The agent lived {last.steps / 1e6:.1f} million steps in {last.seconds:.0f} s: "
        f"{last.simulator:,.0f} steps a second in the simulator, {last.learner:,.0f} in the learner. "
        f"All of it took {seconds:.0f} s.",
        "Targets lie in the main room:",
        report.markdown(main.lines),
        f"{report.NOTE} All players but the human met the same starts and targets. The oracle takes the "
        "shortest way on the true map, one target at a time. Random + avoidance is the paper's random walk "
        "under the paper's avoidance.",
        "![Learning curve](learning-curve.png)",
        main.film(),
        "![An episode](episode.gif)",
        f"Targets lie behind doors, in secondary rooms, for the agent `{RELEASED}`, which comes with the "
        "project. It has learnt for longer and keeps a map of what its rays have shown:",
        report.markdown(secondary.lines),
        secondary.film(),
        "![An episode in secondary rooms](episode-secondary.gif)",
        "Some of the held-out houses:",
        "![Plans](plans.png)",
        "Files: [houses](houses.jsonl), [held-out houses](houses-held-out.jsonl), "
        f"[agent](training/agent.safetensors). Made by `vitruvius demo --seed {seed}`.",
    )
    return "\n\n".join(paragraphs) + "\n"
