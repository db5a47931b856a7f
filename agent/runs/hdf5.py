"""What lies in a file of HDF5 itself: its links may lead to other files, and are not followed."""

from typing import Any

import h5py


def at(group: Any, name: str) -> Any:
    """Return what a path names in a group. Raises ``ValueError`` for links, which may lead to other files."""
    for part in filter(None, name.split("/")):
        if not isinstance(group.get(part, getlink=True), h5py.HardLink):
            raise ValueError(f"{name} is not there, or a link")
        group = group[part]
    return group
