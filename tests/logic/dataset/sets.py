"""Small sets, made by the command."""

import hashlib
from pathlib import Path

import pytest

from vitruvius.cli import main

ASKED = ("generate", "--rooms", "1", "--count", "12", "--validation", "3", "--test", "2")


def command(*words: object) -> int:
    """A command of ``vitruvius`` in this process, and its exit code."""
    with pytest.raises(SystemExit) as ended:
        main([str(word) for word in words])
    assert isinstance(ended.value.code, int)
    return ended.value.code


def made(folder: Path, *words: object, shard: str = "all/5") -> int:
    """Make shards of a set of 17 houses of a room."""
    return command(*ASKED, "--shard", shard, "--out", folder, *words)


def content(folder: Path) -> dict[str, str]:
    """The hash of each file in a folder, hidden ones too."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }
