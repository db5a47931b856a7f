"""User-defined classes that text may name as ``module:Class``: tasks, terms, backends and networks.

Importing a class runs its module. The text of a file (a checkpoint, settings, scores, a trace) may therefore
name a class only if the user of this process has named it, in Python or on the command line.
"""

import importlib
import json
from collections.abc import Iterator
from typing import Any

_ALLOWED: set[str] = set()
"""Classes that this process may import by name."""


def allow(*names: str) -> None:
    """Allow text in this process to name these classes, each ``module:Class``, without importing them yet."""
    for name in names:
        if not is_class_name(name):
            raise ValueError(f"allow: give module:Class, not {name!r}")
    _ALLOWED.update(names)


def allowed() -> tuple[str, ...]:
    """Return the classes that text may name, sorted."""
    return tuple(sorted(_ALLOWED))


def imported(name: str) -> Any:
    """Return the object that an allowed ``module:Class`` names.

    Raises ``ValueError`` for a name that is not allowed, and ``ImportError`` or ``AttributeError`` for an
    object that does not exist.
    """
    if name not in _ALLOWED:
        raise ValueError(
            f"{name} is code, and a file may not name code by itself. If you trust it, add --allow {name}, "
            f'or in Python call vitruvius.sim.allow("{name}")'
        )
    module, _, attribute = name.partition(":")
    return getattr(importlib.import_module(module), attribute)


def class_name(kind: type) -> str:
    """Return the ``module:Class`` of a class. The name of a class in a function contains ``<locals>``."""
    return f"{kind.__module__}:{kind.__qualname__}"


def is_class_name(name: Any) -> bool:
    """Return True for text of the form ``module:Class``."""
    return isinstance(name, str) and ":" in name and not name.startswith("{")


def class_names(targets: Any) -> Iterator[str]:
    """Yield each ``module:Class`` of a task, which is a name, a JSON text or a dictionary."""
    if isinstance(targets, str) and targets.startswith("{"):
        try:
            targets = json.loads(targets)
        except (ValueError, RecursionError):
            return
    if isinstance(targets, dict):
        terms = targets.get("terms")
        given = [targets.get("task"), terms.get("class") if isinstance(terms, dict) else terms]
    else:
        given = [targets]
    yield from filter(is_class_name, given)
