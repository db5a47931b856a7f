"""Maps for tests."""

import numpy as np

from vitruvius.logic import House
from vitruvius.logic.house.occupancy import FREE, OCCUPIED, UNKNOWN


def random_map(seed: int, cell: float, rows: int = 25, columns: int = 30) -> House:
    """Return rooms with gaps in walls a cell thick, posts, and a strip that is unknown."""
    rng = np.random.default_rng(seed)
    cells = np.full((rows, columns), FREE)
    for line in range(0, rows, 6):
        cells[line] = OCCUPIED
        for door in rng.choice(columns - 4, 3, replace=False):
            cells[line, door + 1 : door + 4] = FREE
    for line in range(0, columns, 7):
        cells[:, line] = OCCUPIED
        for door in rng.choice(rows - 4, 2, replace=False):
            cells[door + 1 : door + 4, line] = FREE
    cells[rng.random(cells.shape) < 0.03] = OCCUPIED
    cells[[0, -1]], cells[:, 0], cells[:, -1] = OCCUPIED, OCCUPIED, UNKNOWN
    cells[:, -3:-1][cells[:, -3:-1] == FREE] = UNKNOWN
    return House.from_grid(cells, cell)
