"""Results of games that people played: a JSON Lines file, a game a line, with every action."""

import secrets
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from agent.banks import geometry_hash
from logic import House
from logic.errors import RequestError, VitruviusError
from logic.house.files import write_whole
from logic.opener import content_of, from_json
from logic.spelling import quoted

ENDINGS = (".jsonl",)
"""How names of files of results end."""

MAX_BYTES, MOST_GAMES = 1 << 28, 1 << 20
"""Size of an uncompressed file, in bytes and in lines."""

MAX_ACTIONS = 1 << 16
"""Number of actions in a game; an episode of the default preset has 1500."""


class ResultsError(VitruviusError):
    """A file of games is absent or none, or its game does not come out when its actions are made again."""

    exit_code = 5


class PlayedGame(msgspec.Struct, frozen=True, kw_only=True):
    """A game that was played to its end."""

    format: Literal["vitruvius-game-1"] = "vitruvius-game-1"
    player: str
    """The name that the player gave, or a random one of the session."""
    house: Annotated[str, Meta(pattern="^[0-9a-f]{64}$")]
    """``agent.banks.geometry_hash`` of the house."""
    index: Annotated[int, Meta(ge=0)]
    """Which house of the file it was, from 0."""
    targets: str
    """Where targets lay, as for ``evaluate --targets``."""
    seed: Annotated[int, Meta(ge=0, le=2**63 - 1)]
    """Of the episode: an evaluation with ``--seed 0`` plays house i with i."""
    view: Literal["plan", "seen"]
    """What the player saw: the whole plan with the target, or what the robot's rays had reached."""
    seconds: Annotated[float, Meta(gt=0)]
    """For how long it could last."""
    actions: Annotated[str, Meta(pattern="^[LRF]*$", max_length=MAX_ACTIONS)]
    """Each step: a turn left, right, or a step forward."""
    score: Annotated[int, Meta(ge=0)]
    """Targets picked up."""
    raced: dict[str, int] = {}
    """The agent that was raced, if any, and its score."""
    taken: str = ""
    """When it was played: a date and a time, UTC."""
    versions: dict[str, str] = {}


def load(path: Path) -> list[PlayedGame]:
    """The games of a file. Raises ``ResultsError``, with the line, where it is absent, empty or none."""
    try:
        lines = content_of(path, MAX_BYTES).splitlines()
    except OSError as error:
        raise ResultsError(f"{path}: cannot be read: {error.strerror or error}") from None
    if len(lines) > MOST_GAMES:
        raise ResultsError(f"{path}: holds more than {MOST_GAMES:,} games")
    games = []
    for number, line in enumerate(lines, start=1):
        try:
            games.append(from_json(line, PlayedGame))
        except ValueError as error:
            raise ResultsError(f"{path}:{number}: no game: {error}") from None
    if not games:
        raise ResultsError(f"{path}: holds no game. Play some: vitruvius play HOUSES --out {quoted(path)}")
    return games


def require_games(path: Path) -> None:
    """Raise ``RequestError`` where a file that games are to be added to holds something else."""
    try:
        if path.is_file() and path.stat().st_size:
            load(path)
    except ResultsError:
        raise RequestError(f"--out {path}: holds something else than games: name another file") from None


def append(path: Path, games: Iterable[PlayedGame]) -> None:
    """Add games to a file, which a kill leaves as it was or with all of them."""
    before = path.read_bytes() if path.exists() else b""
    write_whole(path, before + b"".join(msgspec.json.encode(game) + b"\n" for game in games))


def require_house(game: PlayedGame, house: House, where: str) -> None:
    """Raise ``ResultsError`` where a game was played in another house."""
    found = geometry_hash(house)
    if game.house != found:
        raise ResultsError(f"{where}: played in a house of hash {game.house[:12]}, not {found[:12]}")


def nobody() -> str:
    """A name for a player who gave none."""
    return f"player-{secrets.token_hex(3)}"
