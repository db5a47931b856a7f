"""Readers of plans of other programs, each of which recognises its format by a file's content."""

from codecs import BOM_UTF8
from collections.abc import Callable
from typing import Any, NamedTuple

from vitruvius.logic.readers.cubicasa import is_cubicasa, read_cubicasa
from vitruvius.logic.readers.houseexpo import is_houseexpo, read_houseexpo
from vitruvius.logic.readers.ifc import is_ifc, read_ifc
from vitruvius.logic.readers.imdf import is_imdf, read_imdf
from vitruvius.logic.readers.resplan import is_resplan, read_resplan
from vitruvius.logic.readers.sketch import Sketch, require_few


class Reader(NamedTuple):
    """A format: a test of content and its JSON value, if any, and a reader of one storey."""

    recognises: Callable[[bytes, Any], bool]
    read: Callable[[bytes, Any, str | None], Sketch]


READERS = (
    Reader(is_houseexpo, read_houseexpo),
    Reader(is_resplan, read_resplan),
    Reader(is_imdf, read_imdf),
    Reader(is_cubicasa, read_cubicasa),
    Reader(is_ifc, read_ifc),
)


def sketch(content: bytes, record: Any, storey: str | None = None) -> Sketch | None:
    """Return the plan in a file of one of ``READERS``; None for another file.

    Raises ``RequestError`` for a damaged file of a known format.
    """
    content = content.removeprefix(BOM_UTF8)
    reader = next((each for each in READERS if each.recognises(content, record)), None)
    if not reader:
        return None
    found = reader.read(content, record, storey)
    require_few(len(found.spaces), len(found.passages) + len(found.windows))
    return found
