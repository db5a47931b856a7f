"""A grammar under edit: its current rule files, and answers to questions about them."""

import asyncio
import contextlib
import os
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Annotated, Any

import msgspec
from msgspec import Meta
from watchfiles import awatch

from vitruvius.logic.browser.watch.pool import Pool, Spares, Stale
from vitruvius.logic.drawing.canvas import svg
from vitruvius.logic.drawing.draw import plan
from vitruvius.logic.drawing.palettes import style
from vitruvius.logic.errors import (
    Finding,
    GrammarError,
    LimitReached,
    RequestError,
    VitruviusError,
    to_record,
)
from vitruvius.logic.grammar import MOST_BYTES, reading_of
from vitruvius.logic.house.house import House
from vitruvius.logic.looks import looks
from vitruvius.logic.request.counts import MOST_ROOMS
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.why.answer import file_name
from vitruvius.logic.workers.explain import MAKING
from vitruvius.logic.workers.messages import Explain, Explained, Judged, Lint, Made, MakeHouse
from vitruvius.logic.workers.pool import late

PLAN = 300
"""Side of the square of a plan, in CSS pixels; the page scales the plan."""

QUIET_MS, MAX_WAIT_MS = 10, 200
"""Time without a change after which a save is complete, and the longest wait for it, in milliseconds."""

LOOK_MS = 1000
"""Interval at which the files are read without a reported change, in milliseconds.

Not all file systems report changes.
"""

MOST_HOUSES = 48


class Rules(msgspec.Struct, frozen=True):
    """Rule files of one version."""

    version: int
    grammar: str
    files: tuple[dict[str, str], ...]


class Sheet(msgspec.Struct, frozen=True, omit_defaults=True):
    """Contact sheet of houses 0 to ``count - 1`` of a request."""

    rooms: Annotated[int, Meta(ge=1, le=MOST_ROOMS)]
    seed: Annotated[int, Meta(ge=0, lt=2**31)]
    count: Annotated[int, Meta(ge=1, le=MOST_HOUSES)]
    types: dict[str, int | tuple[int, int | None]] = {}
    furniture: dict[str, int | tuple[int, int | None]] = {}
    brief: dict[str, Any] | None = None

    def asked(self) -> dict[str, Any]:
        """Return the request in the form of files, which ``HouseRequest.read`` takes."""
        return {
            key: value for key, value in msgspec.to_builtins(self).items() if key not in ("seed", "count")
        }


class Session:
    """Current rules of a directory, reported to all listeners, and answers to questions about them."""

    def __init__(self, directory: Path, name: str, seconds: float) -> None:
        """Start spare processes. ``seconds`` limits each answer.

        Raises ``MissingProgram`` if a solver is missing.
        """
        self._directory, self._name, self._seconds = directory, name, seconds
        self._files: dict[str, str] = {}
        self._ended = False
        self._changed = asyncio.Event()
        self._spares = Spares(directory)
        self._spares.check()

    def begin(self) -> None:
        """Read the rules, and follow their changes in the running event loop."""
        self.rules = self._read(1)
        self._pool = Pool(self._directory, self._spares)
        self._watching = asyncio.ensure_future(self._watch())

    def end(self) -> None:
        """End all processes, and notify the listeners."""
        self._ended = True
        self._watching.cancel()
        self._changed.set()
        self._pool.end()
        self._spares.end()

    async def versions(self) -> AsyncIterator[Rules]:
        """Yield the current rules, then the newest version after each change, until the end."""
        version = 0
        while not self._ended:
            if self.rules.version > version:
                version = self.rules.version
                yield self.rules
            else:
                await self._changed.wait()

    async def sheet(self, version: int, sheet: Sheet) -> AsyncIterator[dict[str, Any]]:
        """Yield the parts of an answer, as ``page/page.js`` lists them."""
        pool = self._pool_of(version)
        houses = [asyncio.ensure_future(self._house(pool, sheet, index)) for index in range(sheet.count)]
        try:
            said = await self._verdict(pool)
            yield said
            if "kinds" not in said:
                return
            for house in asyncio.as_completed(houses):
                part = await house
                yield part
                if part.get("problem", {}).get("kind", "LimitReached") != "LimitReached":
                    return  # No other house would fare better.
        finally:
            for house in houses:
                house.cancel()
            self._spares.refill()

    async def _verdict(self, pool: Pool) -> dict[str, Any]:
        """Return the part of an answer about mistakes in the rules, or the room types if there are none."""
        try:
            said = await pool.verdict()
        except GrammarError as error:
            where = str(error.file or self._directory)
            finding = Finding("error", where, error.line or 1, error.column or 1, error.message)
            return {"findings": self._named([finding])}
        except VitruviusError as error:
            return {"index": 0, "problem": self._problem(error)}
        if isinstance(said, Judged):
            return {"findings": self._named(said.findings)}
        return {"kinds": {"types": said.types, "most_rooms": said.most_rooms}}

    async def lint(self, version: int) -> list[dict[str, Any]]:
        """Return findings about rules without errors."""
        pool = self._pool_of(version)
        late = "lint reached its limit: raise it with --seconds"
        found = await pool.ask(lambda worker: worker.asked(Lint(), Judged, self._seconds, late))
        return self._named(found.findings)

    async def why(self, version: int, house: dict[str, Any], part: str) -> dict[str, Any]:
        """Return the explanation of a part of a house of these rules. Raises as ``explain_house`` does."""
        try:
            made = House.from_dict(house)
        except ValueError as error:
            raise RequestError(f"house: {error}") from None
        question = Explain(target=part, house=made.to_dict(), searching=self._seconds)
        late = f"{part} reached its limit of {self._seconds:g} seconds: raise it with --seconds"
        whole, *parts = await self._pool_of(version).ask(
            lambda worker: [
                each.why for each in worker.series(question, Explained, self._seconds, late, MAKING)
            ]
        )
        for more in parts:
            whole = whole.joined(more)
        return self._named(whole)

    def _pool_of(self, version: int) -> Pool:
        if version != self.rules.version:
            raise Stale
        return self._pool

    async def _house(self, pool: Pool, sheet: Sheet, index: int) -> dict[str, Any]:
        """Return house ``index`` and its plan, or the reason for its absence."""
        try:
            request = HouseRequest.read(sheet.asked(), seconds=self._seconds)
            question = MakeHouse(request=request, seed=sheet.seed, index=index)
            said = late(request, index)
            made = await pool.ask(lambda worker: worker.asked(question, Made, request.seconds, said))
            house = House.from_dict(made.house)
            drawing = plan(house, PLAN, PLAN, look=style([house], grammar=self._directory))
        except VitruviusError as error:
            return {"index": index, "problem": self._problem(error)}
        types = {room.name: room.type for room in house.counted}
        drawn = svg([((0, 0), drawing)], PLAN, PLAN)
        return {"index": index, "house": house.to_dict(), "types": types, "svg": drawn}

    async def _watch(self) -> None:
        """Follow all changes of the files, even if the directory is removed and created again."""
        while True:
            place, folders = _identity(self._directory), self._folders()
            if place is None:
                self._take()
                await asyncio.sleep(LOOK_MS / 1000)
                continue
            events = awatch(
                *folders,
                step=QUIET_MS,
                debounce=MAX_WAIT_MS,
                recursive=False,
                rust_timeout=LOOK_MS,
                yield_on_timeout=True,
            )
            async for _ in events:
                self._take()
                if (_identity(self._directory), self._folders()) != (place, folders):
                    break

    def _take(self) -> None:
        """Load the current files if they have changed."""
        rules = self._read(self.rules.version + 1)
        if rules.files == self.rules.files:
            return
        self._pool.end()
        self.rules, self._pool = rules, Pool(self._directory, self._spares)
        self._changed.set()
        self._changed.clear()

    def _folders(self) -> set[Path]:
        """Return the folders of the files."""
        return {self._directory, *(Path(file).parent for file in self._files)}

    def _read(self, version: int) -> Rules:
        """Return the rule files, ``.lp`` before ``.pl``, then the looks, then the included files."""
        reading = reading_of(self._directory)
        own = [file for suffix in (".lp", ".pl") for file in _shown(self._directory, f"*{suffix}")]
        reading.follow(own)
        contents = {file: reading.contents[file] for file in own if file in reading.contents}
        for file in _shown(self._directory, looks.FILE_NAME):
            with contextlib.suppress(OSError):  # The solver process reports what is wrong with it.
                contents[file] = file.read_bytes()
        contents |= reading.contents
        self._files = {str(file): reading.name(file) for file in contents}
        texts = [content.decode("utf-8", "replace").replace("\r\n", "\n") for content in contents.values()]
        named = zip(self._files.values(), texts, strict=True)
        return Rules(version, self._name, tuple({"name": name, "text": text} for name, text in named))

    def _problem(self, error: VitruviusError) -> Any:
        """Return the error that replaces a house, for the page.

        All kinds of limits become ``LimitReached``.
        """
        record = to_record(error)
        if isinstance(error, LimitReached):
            record["kind"] = LimitReached.__name__
        return self._named(record)

    def _named(self, said: Any) -> Any:
        """Return a message as JSON with short file names: ``rooms.lp``, ``home/furniture.lp``."""
        return self._short(msgspec.to_builtins(said))

    def _short(self, record: Any) -> Any:
        if isinstance(record, dict):
            return {
                key: self._files.get(value, file_name(value))
                if key == "file" and value
                else self._short(value)
                for key, value in record.items()
            }
        return [self._short(each) for each in record] if isinstance(record, list | tuple) else record


def _shown(directory: Path, pattern: str) -> list[Path]:
    """Return files whose text may be shown. ``grammar.find`` refuses other files with a message."""
    return [
        file
        for file in sorted(directory.glob(pattern))
        if Path(os.path.realpath(file)).parent == directory
        and not file.name.startswith(".")
        and file.is_file()
        and file.stat().st_size <= MOST_BYTES
    ]


def _identity(directory: Path) -> tuple[int, int] | None:
    try:
        found = directory.stat()
    except OSError:
        return None
    return found.st_dev, found.st_ino
