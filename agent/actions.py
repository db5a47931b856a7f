"""The three actions."""

LEFT, RIGHT, FORWARD = range(3)
"""Turn left by 45 degrees, turn right, one step forward."""

ACTIONS = 3
"""How many there are."""
