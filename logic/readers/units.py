"""Units of lengths of plans, as people say them: ``--plan-unit``."""

from logic.errors import RequestError

UNITS = {"m": 1.0, "dm": 0.1, "cm": 0.01, "mm": 0.001, "ft": 0.3048, "in": 0.0254}
"""Metres to a unit."""

MOST = 1e8
"""Metres to a unit, at most."""


def metres_to(unit: str) -> float:
    """Metres to a unit of ``UNITS``, or as a number. Raises ``RequestError`` for another word."""
    if unit in UNITS:
        return UNITS[unit]
    try:
        metres = float(unit)
    except ValueError:
        metres = 0.0
    if not 0 < metres < MOST:
        raise RequestError(f"plan unit {unit}: one of {', '.join(UNITS)}, or metres to a unit, as in 0.02")
    return metres
