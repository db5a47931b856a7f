"""Signals that agents and baselines act by, in words: the column *knows* of README and docs/results.md."""

from collections.abc import Iterable

from vitruvius.agent.baselines.table import KNOWS
from vitruvius.agent.learning.config import TrainConfig

WORDS = {
    "rays": "its rays",
    "heading": "its heading",
    "bump": "bumps",
    "last_action": "own actions",
    "speed": "its speeds",
    "odometry": "where it is, by its own account",
    "goal": "the way to the target",
    "geodesic": "the distance to the target",
}
"""Words for the names of ``sim.Config.observe``; ``heading`` is for rays with compass directions."""

PLANS = "in training, plans of other houses"
"""Further knowledge of agents that are trained on maps of houses."""


def in_words(knows: Iterable[str]) -> str:
    """Return names of ``sim.Config.observe`` as a list of words."""
    return ", ".join(WORDS[name] for name in knows) or "nothing"


def known(agent: TrainConfig | str) -> str:
    """Return the signals that agents of a config, or a baseline by its name, act by."""
    if isinstance(agent, str):
        return in_words(KNOWS[agent])
    return "; ".join([in_words(agent.knows), *([PLANS] if agent.reads_maps else [])])
