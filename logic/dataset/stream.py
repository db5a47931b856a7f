"""Houses of a request as a list that generates each house when it is indexed."""

import hashlib
import json
import re
from collections.abc import Sequence
from typing import SupportsIndex, Unpack, overload

from vitruvius.logic.errors import RequestError
from vitruvius.logic.files.gallery import Houses
from vitruvius.logic.house.house import House
from vitruvius.logic.request.arguments import Stated, house_request
from vitruvius.logic.request.counts import MOST_ROOMS, whole
from vitruvius.logic.spelling import keywords
from vitruvius.logic.workers.pool import houses

MOST_HOUSES = 2**31 - 1
"""Largest number of houses of a seed."""

WRITTEN = re.compile(r"(.+):rooms=(\d+)(?:\.\.(\d+))?")
"""Pattern of a stream in one line: ``home:rooms=4..10``."""


class HouseStream(Sequence[House]):
    """Houses of a grammar for several numbers of rooms in turn: house i has ``rooms[i % n]`` rooms.

    House i is a function of the grammar, its request, the seed and i. The stream stores no house.
    """

    @keywords(pieces="furniture", rules="grammar", timeout="seconds")
    def __init__(
        self,
        rooms: int | Sequence[int],
        *,
        seed: int = 0,
        count: int = MOST_HOUSES,
        **stated: Unpack[Stated],
    ) -> None:
        """Set ``rooms`` (a number, or several as in ``range(4, 11)``) and further arguments of ``generate``.

        Raises as ``generate`` does for arguments that make no sense.
        """
        numbers = [rooms] if isinstance(rooms, int) else list(rooms)
        if not numbers:
            raise RequestError("rooms: give a number or a range: the list is empty")
        self.seed, self.length = whole("seed", seed, 0), whole("count", count, 1)
        self.requests = [house_request(number, **stated) for number in numbers]

    @classmethod
    def read(cls, text: str) -> "HouseStream | None":
        """Return the stream of a line such as ``home:rooms=4..10``, or None for another text.

        The numbers of rooms may be one number, as in ``family:rooms=4``. Raises ``RequestError`` for a number
        that no house has, and as ``generate`` does for a grammar.
        """
        found = WRITTEN.fullmatch(text)
        if found is None:
            return None
        least, most = int(found[2]), int(found[3] or found[2])
        if not 1 <= least <= most <= MOST_ROOMS:
            raise RequestError(f"{text}: give 1 to {MOST_ROOMS} rooms, the smaller number first")
        return cls(range(least, most + 1), grammar=found[1])

    @property
    def hash(self) -> str:
        """Hash that names the houses in their order: SHA-256 of all that determines them."""
        requests = [each.to_dict() for each in self.requests]
        made_of = [self.requests[0].rules.hash, self.seed, self.length, requests]
        return hashlib.sha256(json.dumps(made_of, sort_keys=True, default=str).encode()).hexdigest()

    def __len__(self) -> int:
        """Return the number of houses, none of which need exist yet."""
        return self.length

    @overload
    def __getitem__(self, index: SupportsIndex) -> House: ...
    @overload
    def __getitem__(self, index: slice) -> Houses: ...
    def __getitem__(self, index: SupportsIndex | slice) -> House | Houses:
        """Generate a house, or the houses of a slice. Raises as ``generate`` does."""
        places = range(self.length)[index]
        if isinstance(places, range):
            return Houses(self[int(place)] for place in places)
        request = self.requests[places % len(self.requests)]
        (house,) = houses(request, self.seed, range(places, places + 1))
        return house
