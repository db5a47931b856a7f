"""Actions of a body, by their numbers in environments."""

LEFT, RIGHT, FORWARD = range(3)
"""Turn left by 45 degrees, turn right by 45 degrees, and one step forward."""

ACTION_NAMES = "turn left", "turn right", "forward"
"""Names of the actions."""

ACTIONS = len(ACTION_NAMES)
"""Number of actions."""

HEADINGS = ((1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1), (0, 1), (1, 1))
"""Steps east and south of ``forward``, for each of the eight headings."""
