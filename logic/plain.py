"""Conversion of numbers of other libraries, such as NumPy, to Python's numbers."""

from collections.abc import Mapping
from typing import Any


def plain(value: Any) -> Any:
    """Return a value with another library's numbers, texts and lists replaced by Python's, at any depth.

    Tuples become lists, as in JSON; all other values stay as they are.
    """
    if isinstance(value, Mapping):
        return {plain(key): plain(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [plain(each) for each in value]
    return value.tolist() if hasattr(value, "tolist") else value
