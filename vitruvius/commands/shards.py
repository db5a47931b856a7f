"""Shards of a set of houses: the work of ``vitruvius generate --shard K/N``."""

import re
import time
from functools import partial
from pathlib import Path
from typing import Any

from vitruvius.logic.cluster import Cluster, engine
from vitruvius.logic.dataset.formats import schema
from vitruvius.logic.dataset.sets import MAX_SHARDS, Set, Shard, begin
from vitruvius.logic.dataset.shards import Mapper, complete, make, make_on_node, missing
from vitruvius.logic.dataset.splits import SPLITS
from vitruvius.logic.errors import RequestError
from vitruvius.logic.files.writing import require_folder
from vitruvius.logic.request.counts import whole
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.spelling import numbered
from vitruvius.logic.terminal import counting, say
from vitruvius.logic.workers.pool import described


def make_shards(command: Any, asked: str) -> int:
    """Make the requested shards that do not exist, and after the last one the manifest."""
    began = time.monotonic()
    folder, parts = _require(command, asked)
    request = command.request()
    of, shards = _set(command, request, parts)
    if not asked.startswith("all"):
        shards = [shards[int(asked.partition("/")[0])]]
    with engine(command.engine, command.address, command.workers) as cluster:
        begin(folder, of, request.rules, command.replace)
        made = _made(folder, of, shards, command, cluster)
        last = _completed(folder, of, cluster.map if cluster else map)
    there = "" if made == len(shards) else f" of {len(shards)} generated, the others existed"
    say(f"{folder}: {numbered(made, 'shard')}{there or ' made'}. {last}")
    if command.json:
        made = sum(len(shard.indices) for shard in shards)
        command.answer(request, time.monotonic() - began, made=made)
    return 0


def _require(command: Any, asked: str) -> tuple[Path, int]:
    """Return the set's folder, and its number of shards. Raises ``RequestError`` for invalid options."""
    found = re.fullmatch(r"(all|\d+)/(\d+)", asked)
    if not found:
        raise RequestError(
            f"--shard {asked}: give a shard and their number, counted from 0, as in --shard 3/8 or all/8"
        )
    parts = whole("the number of shards", int(found[2]), 1, MAX_SHARDS)
    if found[1] != "all" and int(found[1]) >= parts:
        raise RequestError(f"--shard {asked}: shards count from 0: the last one is {parts - 1}/{parts}")
    if command.out is None or str(command.out) == "-":
        raise RequestError("--shard: a set is a folder: name it with --out")
    if command.nearest:
        raise RequestError("--shard: a set has one request: leave out --nearest")
    require_folder(command.out)
    if command.workers is not None:
        whole("workers", command.workers, 1)
    if command.files == "parquet":
        schema()  # an error before the work if pyarrow is missing
    return command.out.resolve() if command.engine else command.out, parts


def _set(command: Any, request: HouseRequest, parts: int) -> tuple[Set, list[Shard]]:
    """Return the set's description, and its shards. Raises ``RequestError`` for invalid options."""
    sizes = {"train": command.count, "validation": command.validation, "test": command.test}
    houses = {split: whole(split, number, 0) for split, number in sizes.items() if number}
    whole(
        "the index of the last house", whole("start", command.start, 0) + max(houses.values(), default=0), 0
    )
    if not sum(houses.values()) >= parts >= len(houses) > 0:
        least = f"{numbered(len(houses), 'split')} and {numbered(sum(houses.values()), 'house')}"
        raise RequestError(f"--shard: {least} cannot be divided into {numbered(parts, 'shard')}")
    whole("seed", command.seed, 0, min(len(SPLITS[split]) for split in houses) - 1)
    versions, promises = described(request)
    of = Set(
        "vitruvius-set-1",
        request.rules.name,
        request.rules.hash,
        request.to_dict(),
        command.seed,
        command.start,
        houses,
        parts,
        command.files,
        request.inferences,
        request.seconds,
        versions,
        promises,
    )
    return of, of.divided()


def _made(folder: Path, of: Set, shards: list[Shard], command: Any, cluster: Cluster | None) -> int:
    """Make shards that do not exist, one after the other or as tasks; return their number."""
    number = 0
    with counting(sum(len(shard.indices) for shard in shards), "houses") as advance:
        if cluster:
            task = partial(make_on_node, folder, of, command.replace)
            for place, new in cluster.each(task, shards):
                number += new
                advance(len(shards[place].indices))
            return number
        request, workers = of.request_in(folder), 1 if command.workers is None else command.workers
        for shard in shards:
            new = make(folder, of, shard, request, workers, command.replace, advance)
            number += new
            if not new:
                advance(len(shard.indices))
    return number


def _completed(folder: Path, of: Set, each: Mapper) -> str:
    """Complete the set if all its shards exist; return its state in words."""
    if (left := len(missing(folder, of))) or (manifest := complete(folder, of, each)) is None:
        return f"{numbered(left, 'shard')} of the set {'is' if left == 1 else 'are'} still missing."
    return f"The set is complete: {numbered(manifest.houses, 'house')}, {numbered(manifest.limits, 'limit')}."
