"""Entries of the study of agents: presets, changes of presets, and agents of other libraries."""

from typing import Any

from benchmarks.agents.records import External, TrainingEntry

BUDGET = 15 * 60
RATES = {"pqn": 46_000, "dqn": 12_000, "paper": 1_800, "pqn-recurrent": 20_000}
"""Whole budget of a run: as many steps as 15 minutes gave on one quiet core of the machine on which the study
began, from rates in steps per second. The budget is counted in steps, so it does not depend on the
machine."""


def _entry(name: str, preset: str, shows: str, beside: str = "", **changes: Any) -> TrainingEntry:
    """Return an entry with its preset's budget, and changes of the preset."""
    return TrainingEntry(name, preset, BUDGET * RATES[preset], shows, beside, changes)


ENTRIES = (
    _entry("pqn", "pqn", "rays and exponential moving averages of the past"),
    _entry("dqn", "dqn", "deep Q-learning from a replay memory"),
    _entry(
        "paper",
        "paper",
        "the paper's network, learnt by the paper's method in the paper's simulator, in many houses",
        targets="main",
        num_envs=8,
        episodes=None,
    ),
    _entry("pqn-recurrent", "pqn-recurrent", "a recurrent layer instead of the averages"),
    _entry("pqn-secondary", "pqn", "trained on targets in secondary rooms", "pqn", targets="secondary"),
    _entry("pqn-no-shield", "pqn", "no avoidance layer", "pqn", avoidance="none"),
)
"""Training entries of the study. An entry ``beside`` another is a change of it and is compared with it."""


EXTERNAL_STEPS = 1_000_000
"""Number of steps of each run of another library's agent, whatever the share."""


def _external(name: str, command: str, shows: str) -> External:
    return External(f"{name} + avoidance", f"examples/{command} --avoid", EXTERNAL_STEPS, "main", shows)


KNOWS = "--observe rays bump last_action"
"""Options for the observation of `pqn`."""

EXTERNALS = {
    "sb3-dqn": _external(
        "SB3 DQN",
        f"stable_baselines.py --algorithm dqn --stack 4 {KNOWS}",
        "deep Q-learning of Stable-Baselines3",
    ),
    "sb3-ppo": _external(
        "SB3 PPO", "stable_baselines.py --algorithm ppo", "policy gradients of Stable-Baselines3"
    ),
    "torchrl-ppo": _external("TorchRL PPO", "torchrl_ppo.py", "policy gradients of TorchRL"),
    "one-file": _external(
        "Recurrent PQN in one file",
        f"one_file.py {KNOWS}",
        "recurrent Q-learning in plain torch, as CleanRL does",
    ),
}
"""Agents of other libraries, by the folders of their runs. Each learns, plays and writes its own scores."""
