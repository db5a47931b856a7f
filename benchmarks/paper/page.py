"""docs/paper.md, as a function of the parts' data only."""

from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.paper import agents, complexity, training
from benchmarks.paper.agents import TASKS, mean
from vitruvius.agent.evaluation.result import HUMAN

PARTS: dict[str, Any] = {"agents": agents, "training": training, "complexity": complexity}
"""Parts of the study by name: modules with ``measure(out)``, the data, and ``section(data)``, its
Markdown."""

TEMPLATE = Path(__file__).with_name("template.md")
"""Text of the page around the parts."""

UNMEASURED = "Not measured."


def paper_page(data: dict[str, Any]) -> str:
    """Return the page with the data of the parts that are measured."""
    sections = {
        name: part.section(data[name]) if name in data else UNMEASURED for name, part in PARTS.items()
    }
    return TEMPLATE.read_text().format(**sections, **_claims(data.get("agents")))


def _claims(played: dict[str, Any] | None) -> dict[str, str]:
    """Return the figures for the comparison with the claims."""
    human = {f"human_{mode}": str(each.targets) for mode, each in HUMAN.items()}
    if played is None:
        return human | dict.fromkeys(("main", "secondary", "mixed", "half", "above", "off", "on"), UNMEASURED)
    last, half = "original weights, epsilon 0.025", "original weights, epsilon 0.5"
    found = {task: played[task][last]["targets"] for task in TASKS}
    above = np.mean(np.array(found[TASKS[0]]) > HUMAN["main"].targets)
    return human | {
        **{task.removeprefix("paper-"): mean(values) for task, values in found.items()},
        "half": mean(played[TASKS[0]][half]["targets"]),
        "above": f"{above:.0%}",
        "on": f"{played[TASKS[0]][half]['steps']:.0f}",
        "off": f"{played[TASKS[0]][f'{half}, no avoidance']['steps']:.0f}",
    }
