"""Planners of bodies that drive: the map, views and paths of ``agent.planner``, from any pose."""

from agent.planner.driving.planner import DrivingPlanner

__all__ = ["DrivingPlanner"]
