"""How a map lies in the house: its axes are the walls', its origin is where the eye was as the episode began.

Its east is the way that the body looked then, or next to that clockwise where it looked along a diagonal.
"""

import numpy as np

AXES = np.array([[[1, 0], [0, 1]], [[0, -1], [1, 0]], [[-1, 0], [0, -1]], [[0, 1], [-1, 0]]])
"""(4, 2, 2): a map's east and south in the house, whose y grows southwards, by its quarters of a turn."""


def quarters(heading: float) -> int:
    """By how many quarters, 0 to 3, a map is turned counter-clockwise; ``heading`` at the start, radians."""
    return round(float(heading) / (np.pi / 4)) // 2 % 4


def metres(pose: np.ndarray, places: np.ndarray, cell: float) -> np.ndarray:
    """Where places (..., 2) of a map lie in the house (..., 2), metres. They are cells of side ``cell``,
    metres, east and south of the start at ``pose`` (3,): x, y, heading.
    """
    return pose[:2] + cell * (places @ AXES[quarters(pose[2])])
