"""Houses of a bank that agents were trained on: their scores there are not for unseen houses."""

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path

from vitruvius.agent.banks import bank_hash, house_key, kept
from vitruvius.agent.baselines.table import NO_AGENTS
from vitruvius.agent.evaluation.scores import ScoreFile
from vitruvius.agent.runs.checkpoint import Checkpoint
from vitruvius.logic import House


def learnt_in(agents: Mapping[str, Sequence[Checkpoint]], houses: Sequence[House]) -> dict[str, int | None]:
    """Return how many of the houses any run of each agent was trained on; 0 is left out, None is unknown.

    Training refuses the houses that are reserved for evaluation. So a checkpoint that does not name its
    houses has seen none of the reserved houses.
    """
    keys, whole = [house_key(house) for house in houses], bank_hash(houses)
    unseen: bool | None = None
    found: dict[str, int | None] = {}
    for name, runs in agents.items():
        if any(run.houses == whole for run in runs):
            found[name] = len(houses)
            continue
        seen = frozenset().union(*(run.learnt_in for run in runs))
        found[name] = sum(key in seen for key in keys)
        if not found[name] and not all(run.learnt_in for run in runs):
            unseen = all(kept(houses)) if unseen is None else unseen
            found[name] = 0 if unseen else None
    return {name: number for name, number in found.items() if number != 0}


def warnings(found: Mapping[str, int | None], houses: int) -> list[str]:
    """Return a warning for each agent, in a sentence."""
    return [
        f"{name}: its checkpoint does not name its training houses, so they may include these"
        if number is None
        else f"{name}: {_share(number, houses)} it was trained on: its score is not for unseen houses"
        for name, number in found.items()
    ]


def _share(number: int, houses: int) -> str:
    """Return words for how many of the houses an agent was trained on."""
    if houses == 1:
        return "the house here is one that"
    if number == houses:
        return f"all {houses} houses here are houses that"
    return f"{number} of the {houses} houses here {'is a house' if number == 1 else 'are houses'} that"


def with_others(
    ours: Mapping[str, int | None], agents: Collection[str], files: Mapping[Path, ScoreFile]
) -> dict[str, int | None]:
    """Return the counts, with those that files of scores state for their agents.

    An agent of a file gets another name if one of ours has its name.
    """
    theirs = {
        name if name not in agents else f"{name} ({path.stem})": number
        for path, file in files.items()
        for name, number in file.learnt_in.items()
        if name not in NO_AGENTS
    }
    return {**theirs, **ours}
