"""Small sets, made by the command."""

import hashlib
from pathlib import Path

import pytest
from msgspec import structs

from logic.dataset.sets import MANIFEST, SET, Held, Manifest, encoded
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


def restate(folder: Path, manifest: Manifest) -> None:
    """Write a manifest with the sizes and hashes that the files of a set have."""
    shards = list[Held]()
    for shard in manifest.shards:
        held = (folder / shard.file).read_bytes()
        shards.append(structs.replace(shard, bytes=len(held), sha256=hashlib.sha256(held).hexdigest()))
    digest = hashlib.sha256((folder / SET).read_bytes()).hexdigest()
    (folder / MANIFEST).write_bytes(encoded(structs.replace(manifest, set_sha256=digest, shards=shards)))


def content(folder: Path) -> dict[str, str]:
    """The hash of each file in a folder, hidden ones too."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }
