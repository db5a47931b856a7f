"""The studies of a checkout: ``vitruvius bench NAME`` runs one of the table in ``benchmarks/__init__.py``.

An installed package has no studies, and nothing imports them before they are asked for.
"""

import pkgutil
from importlib.util import find_spec
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).resolve().parents[1] / "benchmarks"
"""Folder of the studies in a checkout."""


def study_table(name: str = "STUDIES") -> Any:
    """Return the studies by name, or another table of ``benchmarks``.

    Raises ``MissingProgram`` if there is no checkout, or another package hides its studies.
    """
    from vitruvius.logic.errors import MissingProgram

    spec = find_spec(FOLDER.name)
    if not (FOLDER / "__init__.py").is_file():
        raise MissingProgram("vitruvius bench runs the studies of a checkout: call ./run bench in one")
    if not spec or Path(spec.origin or "").resolve().parent != FOLDER:
        raise MissingProgram(f"{spec and spec.origin}: hides the studies in {FOLDER}: call ./run bench there")
    return pkgutil.resolve_name(f"{FOLDER.name}:{name}")


def study_sections() -> tuple[Any, ...]:
    """Return what a report shows of the files of studies: nothing if there are no studies."""
    from vitruvius.logic.errors import MissingProgram

    try:
        return study_table("SECTIONS")
    except MissingProgram:
        return ()
