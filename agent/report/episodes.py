"""The section of episodes: a player for each trace, over the plan of its house."""

from collections.abc import Sequence
from pathlib import Path

import msgspec

from agent.recording.trace import AROUND, Trace, load
from agent.report.page import Section
from logic import House
from logic.drawing.canvas import Drawing, svg
from logic.drawing.frame import Frame, extent
from logic.drawing.labels import background
from logic.house.looks import looks_of
from logic.spelling import markup, numbered
from sim.tasks.words import in_words

SIZE = 640
"""CSS pixels of the longer side of a plan."""


def section(files: Sequence[Path], folder: Path) -> Section:
    """Of these traces. Raises ``TraceError`` for one of another version, or none."""
    traces = {path: load(path) for path in files}
    parts = [_player(path.relative_to(folder), trace) for path, trace in traces.items()]
    return Section("episodes", "Episodes", "\n".join(parts))


def _player(path: Path, trace: Trace) -> str:
    """A trace, and the plan that it is played on: the page's script makes the rest."""
    house = House.from_dict(trace.house)
    west, north, east, south = extent(house)
    scale = SIZE / (max(east - west, south - north) + 2 * AROUND)
    frame = Frame(scale, scale * (AROUND - west), scale * (AROUND - north))
    width, height = (round(scale * (side + 2 * AROUND)) for side in (east - west, south - north))
    plan = svg([((0, 0), Drawing(width, height, background(house, frame)))], width, height)
    found = int(trace.column("found")[-1])
    task = in_words(trace.mode, looks_of(house).name)
    title = f"{trace.agent}, {task}: {numbered(found, 'target')} in {numbered(trace.length, 'step')}"
    # No HTML in it can end the script: < is written as JavaScript writes it.
    content = msgspec.json.encode(trace).decode().replace("<", "\\u003c")
    return (
        f'<article class="episode" data-scale="{scale:.6f}" data-left="{frame.left:.4f}" '
        f'data-top="{frame.top:.4f}" data-file="{markup(path)}">\n<h3>{markup(title)}</h3>\n'
        f'<div class="stage">{plan}</div>\n'
        f'<script type="application/json">{content}</script>\n</article>'
    )
