"""The actions of a body, as environments number them."""

LEFT, RIGHT, FORWARD = range(3)
"""Turn left by 45 degrees, turn right, one step forward."""

ACTION_NAMES = "turn left", "turn right", "forward"
"""In words."""

ACTIONS = len(ACTION_NAMES)
"""How many there are."""
