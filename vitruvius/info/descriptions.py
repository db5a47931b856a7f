"""Descriptions of ``vitruvius info``, a type for each kind of thing; ``kind`` names it in JSON."""

from typing import Any

import msgspec


class Named(msgspec.Struct, frozen=True, tag_field="kind", kw_only=True):
    """Fields of all kinds."""

    name: str
    """Name or path as the user gave it."""


class Houses(Named, tag="houses", frozen=True):
    """House file, or a frozen bank."""

    houses: int
    formats: dict[str, int]
    topologies: dict[str, int]
    rooms: tuple[int, int]
    """Fewest and most rooms in a house, as requests count them."""
    types: dict[str, int]
    pieces: dict[str, int]
    grammars: dict[str, int]
    """Number of houses by grammar, each with the start of its hash."""
    seeds: tuple[int, ...]
    versions: dict[str, str]
    checksum: str
    """``agent.banks.bank_hash``."""
    bank: str | None = None
    """Frozen bank with the same houses."""
    stopped: str | None = None
    """Reason why the series ended early."""


class Plan(Named, tag="plan", frozen=True):
    """Plan for ``generate --plan``: GeoJSON, or a plan of another program."""

    format: str
    rooms: int
    types: dict[str, int]
    size: tuple[float, float]
    """Size in metres, east and south."""


class SetOfHouses(Named, tag="set", frozen=True):
    """Set of houses: a folder of ``generate --shard``."""

    splits: dict[str, int]
    """Number of houses of the complete set, by split."""
    whole: bool
    """True if the set has a manifest; without it some shards may exist."""
    shards: int
    there: int
    """Number of shards that exist."""
    limits: int | None
    """Number of rows without a house; None if the set is not complete."""
    bytes: int
    """Size of the existing shards, in bytes."""
    grammars: dict[str, int]
    """Number of houses by grammar, with the start of its hash; there is one grammar."""
    request: dict[str, Any]
    seed: int
    checksum: str | None
    """``vitruvius.HouseSet.hash``."""
    versions: dict[str, str]


class Agent(Named, tag="agent", frozen=True):
    """Checkpoint of an agent."""

    agent: str
    format: str
    readable: bool
    """True if this version can play the agent."""
    algorithm: str
    steps: int
    parameters: int
    targets: str
    houses_checksum: str
    """``bank_hash`` of the training houses."""
    command: str
    config: dict[str, Any]


class Run(Named, tag="run", frozen=True):
    """Training run: a folder of ``train``."""

    preset: str
    algorithm: str
    steps: int
    of_steps: int
    finished: bool
    seconds: float
    targets: float | None
    """Targets picked up per 1500 steps at the last report."""
    houses: int
    houses_checksum: str
    command: str
    versions: dict[str, str]
    files: list[str]


class Games(Named, tag="games", frozen=True):
    """Results of ``play``."""

    games: int
    players: dict[str, int]
    targets: dict[str, int]
    views: dict[str, int]
    score: float
    """Mean number of targets."""
    raced: list[str]
    houses: int
    taken: tuple[str, str]
    """Times of the first and the last game."""
    versions: dict[str, str]


class Scores(Named, tag="scores", frozen=True):
    """Figures of ``evaluate``: the oracle ratio of each policy by location of the targets."""

    bank: str
    houses: int
    checksum: str
    seed: int
    backend: str
    ratios: dict[str, dict[str, float]]


class Trace(Named, tag="trace", frozen=True):
    """Trace of an episode, step by step."""

    format: str
    agent: str
    mode: str
    seed: int
    length: int
    targets: int
    """Number of targets that appeared."""


class Grammar(Named, tag="grammar", frozen=True):
    """Grammar: a folder of rules."""

    folder: str
    topology: str
    checksum: str
    lines: dict[str, int]
    """Number of lines of each of its files, and of the files that they include."""
    shipped: bool


class Settings(Named, tag="settings", frozen=True):
    """Settings: a TOML file for ``train --config``, or a preset."""

    preset: str
    algorithm: str
    steps: int
    targets: str
    changed: dict[str, str]
    """Settings that differ from the preset."""


Kind = Houses | SetOfHouses | Plan | Agent | Run | Games | Scores | Trace | Grammar | Settings
