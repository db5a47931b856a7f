"""Access to the content of one HDF5 file: links may lead to other files, so they are not followed."""

from typing import Any

import h5py


def at(group: Any, name: str) -> Any:
    """Return the object at a path in a group. Raises ``ValueError`` for a link, which may leave the file."""
    for part in filter(None, name.split("/")):
        if not isinstance(group.get(part, getlink=True), h5py.HardLink):
            raise ValueError(f"{name} is missing, or a link")
        group = group[part]
    return group
