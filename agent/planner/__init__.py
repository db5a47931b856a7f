"""Next-best-view planner: an occupancy map, viewpoints by information gain, and paths.

The planner reads only the agent's own rays and actions, and for each move whether it was blocked. It knows
neither its pose nor its house, target or reward. Headings are multiples of 45 degrees to walls that lie along
two axes, so odometry is exact. A body that drives knows its pose.

``docs/planner.md`` explains how the planner works and what it costs. Its folders import one way: ``core``
(numbers and arrays), ``mapping``, ``viewpoints``, and what bodies do, on a ``lattice`` or ``driving``.
"""

from vitruvius.agent.planner.core.config import TUNED, PlannerConfig
from vitruvius.agent.planner.planner import FREE, TAKEN, UNSEEN, Planner

__all__ = ["FREE", "TAKEN", "TUNED", "UNSEEN", "Planner", "PlannerConfig"]
