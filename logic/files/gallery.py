"""Lists of houses that a notebook shows as plans: ``Houses(generate(rooms=5, count=12))``."""

from __future__ import annotations

from typing import SupportsIndex, overload

from vitruvius.logic.house.house import House
from vitruvius.logic.spelling import numbered

MAX_SHOWN, PLAN_PX = 24, 260
"""Number of plans of a list that a notebook shows, and width of each, CSS pixels."""


class Houses(list[House]):
    """List of houses, as ``load`` returns it. A slice is such a list, too."""

    @overload
    def __getitem__(self, index: SupportsIndex) -> House: ...
    @overload
    def __getitem__(self, index: slice) -> Houses: ...
    def __getitem__(self, index: SupportsIndex | slice) -> House | Houses:
        """Return a house, or for a slice the list of its houses."""
        found = super().__getitem__(index)
        return Houses(found) if isinstance(found, list) else found

    def _repr_html_(self) -> str:
        """Return the plans of the first houses for notebooks, each with its index."""
        figure = '<figure style="margin:0"><figcaption style="font-size:small">{}</figcaption>{}</figure>'
        plans = [
            figure.format(index, house._repr_svg_(PLAN_PX)) for index, house in enumerate(self[:MAX_SHOWN])
        ]
        words = numbered(len(self), "house")
        if len(self) > MAX_SHOWN:
            words += f", the first {MAX_SHOWN} shown"
        # Plans are dark on white, even in dark notebooks.
        box = "display:flex;flex-wrap:wrap;gap:8px;align-items:flex-start;background:#fff;color:#333"
        return f'<p style="margin:0.3em 0">{words}</p><div style="{box}">{"".join(plans)}</div>'
