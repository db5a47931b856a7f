"""The actions of a body, as environments number them."""

LEFT, RIGHT, FORWARD = range(3)
"""Turn left by 45 degrees, turn right, one step forward."""

ACTION_NAMES = "turn left", "turn right", "forward"
"""In words."""

ACTIONS = len(ACTION_NAMES)
"""How many there are."""

HEADINGS = ((1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1), (0, 1), (1, 1))
"""Steps east and south that ``forward`` makes at each of the eight headings."""
