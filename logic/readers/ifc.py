"""Reader of IFC (ISO 16739, buildingSMART), also zipped: spaces, doors and windows of a storey.

IfcOpenShell (extra ``ifc``) opens the file, and ``ifc_solids.py`` projects the solids onto the floor.
"""

import re
import subprocess
import sys
from contextlib import suppress
from importlib.util import find_spec
from typing import Any
from zipfile import ZipFile

import msgspec
import shapely

from vitruvius.logic.errors import RequestError
from vitruvius.logic.installation import required_by
from vitruvius.logic.opener import ZIPPED, archive_of, member_of
from vitruvius.logic.readers.ifc_solids import Solids, main
from vitruvius.logic.readers.sketch import Passage, Sketch, Space, polygons, require_plain

FORMAT = "IFC"

SCHEMA = re.compile(rb"FILE_SCHEMA\s*\(\s*\(\s*'IFC", re.IGNORECASE)

ENDINGS = (".ifc", ".ifcxml")
"""Suffixes of IFC files in an archive."""

MAX_BYTES = 1 << 24
"""Largest size of all files of an archive together, unpacked, in bytes."""

SECONDS = 120
"""Wall-clock time that IfcOpenShell may take, seconds."""


def is_ifc(content: bytes, _: Any) -> bool:
    """Return True if the content is IFC in STEP form, or an archive with such a file."""
    if content.startswith(ZIPPED):
        return _member(content) is not None
    return content.lstrip().startswith(b"ISO-10303-21") and SCHEMA.search(content[:65536]) is not None


def _member(content: bytes) -> tuple[ZipFile, str] | None:
    """Return an archive that holds IFC, and the name of the IFC file; None for another archive."""
    with suppress(ValueError):
        archive = archive_of(content, MAX_BYTES)
        names = [name for name in archive.namelist() if name.lower().endswith(ENDINGS)]
        return (archive, names[0]) if names else None
    return None


def _unpacked(content: bytes) -> bytes:
    """Return the IFC of an archive. Raises ``RequestError`` if it is damaged, or in XML."""
    found = _member(content) if content.startswith(ZIPPED) else None
    if found is None:
        return content
    archive, name = found
    try:
        content = member_of(archive, name)
    except ValueError as error:
        raise RequestError(f"plan: {error}") from None
    if not content.lstrip().startswith(b"ISO-10303-21"):
        raise RequestError(f"plan: {name} of the archive is not IFC in STEP form: export it as .ifc")
    return content


def read_ifc(content: bytes, _: Any, storey: str | None) -> Sketch:
    """Return the spaces of the file as rooms. Raises ``ModuleNotFoundError`` without IfcOpenShell."""
    content = _unpacked(content)
    with required_by("IFC"):
        if find_spec("ifcopenshell") is None:
            raise ModuleNotFoundError(name="ifcopenshell")
    command = [sys.executable, "-P", "-c", f"from {main.__module__} import main; main()"]
    command += [] if storey is None else [storey]
    try:
        done = subprocess.run(command, input=content, capture_output=True, timeout=SECONDS, check=False)
        found = msgspec.json.decode(done.stdout, type=Solids)
        if found.error:
            raise RequestError(found.error)
        return _sketch(found)
    except (subprocess.TimeoutExpired, msgspec.DecodeError, UnicodeDecodeError, shapely.errors.ShapelyError):
        raise RequestError("plan: IFC that IfcOpenShell cannot read: export it again") from None


def _sketch(found: Solids) -> Sketch:
    """Return the rooms, doors and windows that the process with IfcOpenShell found."""
    shapes, doors, windows = (
        list(map(shapely.from_wkt, each))
        for each in ([shape for _, shape in found.spaces], found.doors, found.windows)
    )
    require_plain([*shapes, *doors, *windows])
    spaces = [
        Space((words or [""])[0], tuple(words), part)
        for (words, _), shape in zip(found.spaces, shapes, strict=True)
        for part in polygons(shape)
    ]
    return Sketch(FORMAT, spaces, list(map(Passage, doors)), list(windows), north_up=True)
