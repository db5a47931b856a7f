"""What ``vitruvius info`` knows, a type for each kind of thing; ``kind`` names it in JSON."""

from typing import Any

import msgspec


class Named(msgspec.Struct, frozen=True, tag_field="kind", kw_only=True):
    """What all kinds have."""

    name: str
    """As it was given."""


class Houses(Named, tag="houses", frozen=True):
    """A house file, or a frozen bank."""

    houses: int
    formats: dict[str, int]
    topologies: dict[str, int]
    rooms: tuple[int, int]
    """Fewest and most in a house, as requests count them."""
    types: dict[str, int]
    pieces: dict[str, int]
    grammars: dict[str, int]
    """Houses by grammar, each with the start of its hash."""
    seeds: tuple[int, ...]
    versions: dict[str, str]
    checksum: str
    """``agent.banks.bank_hash``."""
    bank: str | None = None
    """The frozen bank whose houses these are."""
    stopped: str | None = None
    """Why the series ended early."""


class Plan(Named, tag="plan", frozen=True):
    """GeoJSON or another program's plan, for ``generate --plan``."""

    format: str
    rooms: int
    types: dict[str, int]
    size: tuple[float, float]
    """Metres, east and south."""


class SetOfHouses(Named, tag="set", frozen=True):
    """A folder of ``generate --shard``."""

    splits: dict[str, int]
    """Houses that it is to hold."""
    whole: bool
    """Whether it has a manifest; without it some shards may be there."""
    shards: int
    there: int
    """Shards that are there."""
    limits: int | None
    """Rows without a house; None where the set is not whole."""
    bytes: int
    """Of the shards that are there."""
    grammars: dict[str, int]
    """Houses by grammar, with the start of its hash: one."""
    request: dict[str, Any]
    seed: int
    checksum: str | None
    """``logic.HouseSet.hash``."""
    versions: dict[str, str]


class Agent(Named, tag="agent", frozen=True):
    """A checkpoint."""

    agent: str
    format: str
    readable: bool
    """Whether this version plays it."""
    algorithm: str
    steps: int
    parameters: int
    targets: str
    houses_checksum: str
    """``bank_hash`` of those that it learnt in."""
    command: str
    config: dict[str, Any]


class Run(Named, tag="run", frozen=True):
    """A folder of ``train``."""

    preset: str
    algorithm: str
    steps: int
    of_steps: int
    finished: bool
    seconds: float
    targets: float | None
    """Picked up per 1500 steps at the last report."""
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
    """The first and the last."""
    versions: dict[str, str]


class Scores(Named, tag="scores", frozen=True):
    """Figures of ``evaluate``: the oracle ratio of each policy by where targets lay."""

    bank: str
    houses: int
    checksum: str
    seed: int
    backend: str
    ratios: dict[str, dict[str, float]]


class Trace(Named, tag="trace", frozen=True):
    """An episode, step by step."""

    format: str
    agent: str
    mode: str
    seed: int
    length: int
    targets: int
    """How many appeared."""


class Grammar(Named, tag="grammar", frozen=True):
    """A folder of rules."""

    folder: str
    topology: str
    checksum: str
    lines: dict[str, int]
    """Of each of its files, and of those that they include."""
    shipped: bool


class Settings(Named, tag="settings", frozen=True):
    """A TOML file for ``train --config``, or a preset."""

    preset: str
    algorithm: str
    steps: int
    targets: str
    changed: dict[str, str]
    """What is not as in the preset."""


Kind = Houses | SetOfHouses | Plan | Agent | Run | Games | Scores | Trace | Grammar | Settings
