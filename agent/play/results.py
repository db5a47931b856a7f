"""Results of games that people played: a JSON Lines file, one game a line, with every action."""

import secrets
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from vitruvius.agent.banks import geometry_hash
from vitruvius.logic import House
from vitruvius.logic.errors import RequestError, VitruviusError
from vitruvius.logic.files.writing import write_whole
from vitruvius.logic.opener import content_of, from_json
from vitruvius.logic.spelling import quoted

ENDINGS = (".jsonl",)
"""Suffixes of files of results."""

MAX_BYTES, MAX_GAMES = 1 << 28, 1 << 20
"""Largest size of an uncompressed file, in bytes and in lines."""

MAX_ACTIONS = 1 << 16
"""Largest number of actions in a game; an episode of the default preset has 1500."""


class ResultsError(VitruviusError):
    """Error for a file of games that is absent or malformed, or for a game whose replay differs."""

    exit_code = 5


class PlayedGame(msgspec.Struct, frozen=True, kw_only=True):
    """Game that was played to its end."""

    format: Literal["vitruvius-game-1"] = "vitruvius-game-1"
    player: str
    """Name that the player gave, or a random one of the session."""
    house: Annotated[str, Meta(pattern="^[0-9a-f]{64}$")]
    """``agent.banks.geometry_hash`` of the house."""
    index: Annotated[int, Meta(ge=0)]
    """Index of the house in the file, from 0."""
    targets: str
    """Location of the targets, as for ``evaluate --targets``."""
    seed: Annotated[int, Meta(ge=0, le=2**63 - 1)]
    """Seed of the episode: an evaluation with ``--seed 0`` plays house i with i."""
    view: Literal["plan", "seen"]
    """View of the player: the whole plan with the target, or what the robot's rays had reached."""
    seconds: Annotated[float, Meta(gt=0)]
    """Time limit of the game, in seconds."""
    actions: Annotated[str, Meta(pattern="^[LRF]*$", max_length=MAX_ACTIONS)]
    """Letter of each step: a turn left or right, or a step forward."""
    score: Annotated[int, Meta(ge=0)]
    """Number of targets picked up."""
    raced: dict[str, int] = {}
    """Agent that was raced, if any, and its score."""
    taken: str = ""
    """Date and time of the game, UTC."""
    versions: dict[str, str] = {}


def load(path: Path) -> list[PlayedGame]:
    """Return the games of a file.

    Raises ``ResultsError``, with the line, if the file is absent, empty or malformed.
    """
    try:
        lines = content_of(path, MAX_BYTES).splitlines()
    except OSError as error:
        raise ResultsError(f"{path}: cannot be read: {error.strerror or error}") from None
    if len(lines) > MAX_GAMES:
        raise ResultsError(f"{path}: holds more than {MAX_GAMES:,} games")
    games = []
    for number, line in enumerate(lines, start=1):
        try:
            games.append(from_json(line, PlayedGame))
        except ValueError as error:
            raise ResultsError(f"{path}:{number}: no game: {error}") from None
    if not games:
        raise ResultsError(f"{path}: holds no game. Play one: vitruvius play HOUSES --out {quoted(path)}")
    return games


def require_games(path: Path) -> None:
    """Raise ``RequestError`` if a file to which games are to be added holds something else."""
    try:
        if path.is_file() and path.stat().st_size:
            load(path)
    except ResultsError:
        raise RequestError(f"--out {path}: exists and does not hold games: choose another file") from None


def append(path: Path, games: Iterable[PlayedGame]) -> None:
    """Add games to a file. A kill leaves the file as it was, or with all of them."""
    before = path.read_bytes() if path.exists() else b""
    write_whole(path, before + b"".join(msgspec.json.encode(game) + b"\n" for game in games))


def require_house(game: PlayedGame, house: House, where: str) -> None:
    """Raise ``ResultsError`` if a game was played in another house."""
    found = geometry_hash(house)
    if game.house != found:
        raise ResultsError(
            f"{where}: the game was played in the house with hash {game.house[:12]}, not {found[:12]}"
        )


def nobody() -> str:
    """Return a name for a player who gave none."""
    return f"player-{secrets.token_hex(3)}"
