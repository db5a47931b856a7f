"""Section of a report about homes: their cost, by number of rooms."""

from collections.abc import Sequence
from pathlib import Path

import msgspec
import numpy as np

from vitruvius.agent.report.html import ReportError, Section, table
from vitruvius.agent.report.plots import Axis, DataSeries, line_plot


class Times(msgspec.Struct):
    """A line of ``homes.json``: CPU seconds of the plans without furniture, and of the houses."""

    rooms: int
    unfurnished: list[float]
    whole: list[float]


def homes(files: Sequence[Path], folder: Path) -> Section:
    """Return the section of ``homes.json`` files. Raises ``ReportError`` for any other file."""
    try:
        sizes = [size for path in files for size in msgspec.json.decode(path.read_bytes(), type=list[Times])]
    except msgspec.DecodeError as error:
        raise ReportError(f"{files[0]}: not a file of bench homes: {error}") from None
    parts = {
        "with furniture": [size.whole for size in sizes],
        "plan alone": [size.unfurnished for size in sizes],
    }
    rooms = [size.rooms for size in sizes]
    lines = []
    for slot, (name, times) in enumerate(parts.items()):
        low, median, high = (
            [1e3 * float(np.percentile(each, share)) for each in times] for share in (25, 50, 75)
        )
        lines.append(DataSeries(name, rooms, median, low, high, slot))
    x, y = Axis("rooms", ticks=rooms), Axis("CPU milliseconds a house", least=0.0)
    plot = line_plot("Time of a home: medians and quartiles", x, y, lines)
    rows = [[str(size.rooms), str(len(size.whole))] for size in sizes]
    return Section("homes", "What homes cost", plot + table("Homes that were made", ("rooms", "homes"), rows))
