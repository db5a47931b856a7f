"""Position of a map in the house.

The map's axes lie along the walls. Its origin is the eye's place at the start of the episode. Its east is the
direction in which the body looked then, or the next axis clockwise if the body looked along a diagonal.
"""

import numpy as np

AXES = np.array([[[1, 0], [0, 1]], [[0, -1], [1, 0]], [[-1, 0], [0, -1]], [[0, 1], [-1, 0]]])
"""(4, 2, 2): a map's east and south in the house, whose y grows southwards, by its quarter turns."""


def quarters(heading: float) -> int:
    """Return the quarter turns, 0 to 3, of a map counter-clockwise; ``heading`` at the start, radians."""
    return round(float(heading) / (np.pi / 4)) // 2 % 4


def metres(pose: np.ndarray, places: np.ndarray, cell: float) -> np.ndarray:
    """Return places (..., 2) of a map as places (..., 2) in the house, metres.

    The places are cells of side ``cell``, metres, east and south of the start at ``pose`` (3,): x, y,
    heading.
    """
    return pose[:2] + cell * (places @ AXES[quarters(pose[2])])
