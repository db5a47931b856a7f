"""Section of episodes: a player for each trace, over the plan of its house."""

from collections.abc import Sequence
from pathlib import Path

import msgspec

from vitruvius.agent.recording.trace import MARGIN_M, Trace, load
from vitruvius.agent.report.html import Section
from vitruvius.logic import House
from vitruvius.logic.drawing.canvas import Drawing, svg
from vitruvius.logic.drawing.frame import Frame, extent
from vitruvius.logic.drawing.labels import background
from vitruvius.logic.looks.looks import looks_of
from vitruvius.logic.spelling import markup, numbered
from vitruvius.sim.tasks.words import in_words

SIZE = 640
"""Length of a plan's longer side, in CSS pixels."""


def section(files: Sequence[Path], folder: Path) -> Section:
    """Return the section of these traces. Raises ``TraceError`` for another version, or no trace."""
    traces = {path: load(path) for path in files}
    parts = [_player(path.relative_to(folder), trace) for path, trace in traces.items()]
    return Section("episodes", "Episodes", "\n".join(parts))


def _player(path: Path, trace: Trace) -> str:
    """Return a trace, and the plan that it is played on; the page's script does the rest."""
    house = House.from_dict(trace.house)
    west, north, east, south = extent(house)
    scale = SIZE / (max(east - west, south - north) + 2 * MARGIN_M)
    frame = Frame(scale, scale * (MARGIN_M - west), scale * (MARGIN_M - north))
    width, height = (round(scale * (side + 2 * MARGIN_M)) for side in (east - west, south - north))
    plan = svg([((0, 0), Drawing(width, height, background(house, frame)))], width, height)
    found = int(trace.column("found")[-1])
    task = in_words(trace.mode, looks_of(house).name)
    title = f"{trace.agent}, {task}: {numbered(found, 'target')} in {numbered(trace.length, 'step')}"
    # HTML in it cannot end the script: < is written as in JavaScript.
    content = msgspec.json.encode(trace).decode().replace("<", "\\u003c")
    return (
        f'<article class="episode" data-scale="{scale:.6f}" data-left="{frame.left:.4f}" '
        f'data-top="{frame.top:.4f}" data-file="{markup(path)}">\n<h3>{markup(title)}</h3>\n'
        f'<div class="stage">{plan}</div>\n'
        f'<script type="application/json">{content}</script>\n</article>'
    )
