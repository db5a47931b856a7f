"""The whole path in one command: houses from rules, an agent that learns, a measurement, a report."""

ROOMS = range(2, 6)
"""Rooms of the houses."""

TRAINING, HELD_OUT = 32, 8
"""Houses of each number of rooms: to learn in, and to be measured in."""

SECONDS = 130
"""Wall-clock limit of the training: the schedules are compressed where the machine is slow."""

GOAL = 0.49
"""The ratio to the oracle that the agent must exceed: the paper's human reaches 0.48."""
