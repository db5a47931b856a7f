"""IFC (ISO 16739, buildingSMART): the spaces, doors and windows of a storey, by IfcOpenShell (extra ``ifc``).

What they look like from above is taken, whatever solid they are of: ``ifc_solids.py``.
"""

import re
import subprocess
import sys
from importlib.util import find_spec
from typing import Any

import msgspec
import shapely

from logic.errors import RequestError
from logic.readers.ifc_solids import Solids, main
from logic.readers.sketch import Passage, Sketch, Space, polygons

FORMAT = "IFC"

SCHEMA = re.compile(rb"FILE_SCHEMA\s*\(\s*\(\s*'IFC", re.IGNORECASE)

SECONDS = 120
"""Wall-clock time that IfcOpenShell may take, on a busy machine too."""


def is_ifc(content: bytes, _: Any) -> bool:
    """Whether a file is IFC in the form of STEP."""
    return content.lstrip().startswith(b"ISO-10303-21") and SCHEMA.search(content[:65536]) is not None


def read_ifc(content: bytes, _: Any) -> Sketch:
    """Spaces are rooms. Raises ``ModuleNotFoundError`` without IfcOpenShell."""
    if find_spec("ifcopenshell") is None:
        raise ModuleNotFoundError("IfcOpenShell reads IFC", name="ifcopenshell")
    command = [sys.executable, "-P", "-c", f"from {main.__module__} import main; main()"]
    try:
        done = subprocess.run(command, input=content, capture_output=True, timeout=SECONDS, check=False)
        found = msgspec.json.decode(done.stdout, type=Solids)
        if found.error:
            raise RequestError(found.error)
        return _sketch(found)
    except (subprocess.TimeoutExpired, msgspec.DecodeError, UnicodeDecodeError, shapely.errors.ShapelyError):
        raise RequestError("plan: IFC that IfcOpenShell cannot read: export it again") from None


def _sketch(found: Solids) -> Sketch:
    """Return the rooms, doors and windows that the process of IfcOpenShell found."""
    spaces = [
        Space((words or [""])[0], tuple(words), part)
        for words, shape in found.spaces
        for part in polygons(shapely.from_wkt(shape))
    ]
    passages = [Passage(each) for each in map(shapely.from_wkt, found.doors)]
    return Sketch(FORMAT, spaces, passages, list(map(shapely.from_wkt, found.windows)), north_up=True)
