"""Numbers of other libraries, such as NumPy's, in the place of which ours hold Python's."""

from collections.abc import Mapping
from typing import Any


def plain(value: Any) -> Any:
    """Return a value as JSON has it, with Python's numbers, texts and lists in the place of another library's
    at any depth; what is none of these stays as it is.
    """
    if isinstance(value, Mapping):
        return {plain(key): plain(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [plain(each) for each in value]
    return value.tolist() if hasattr(value, "tolist") else value
