"""Planners of bodies that drive: the map, views and paths of ``agent.planner``, from any pose."""

from vitruvius.agent.planner.driving.planner import DrivingPlanner

__all__ = ["DrivingPlanner"]
