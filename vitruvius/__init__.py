"""Command line: commands, options, help, answers for programs. It imports all packages; none imports it."""

from importlib.util import find_spec
from pathlib import Path

for _name in ("logic", "sim", "agent"):
    _spec = find_spec(_name)
    if _spec and Path(_spec.origin or "").resolve().parent.parent != Path(__file__).resolve().parent.parent:
        raise ImportError(f"{_spec.origin}: hides the package {_name} of Vitruvius: give it another name")
