"""Plans, maps and briefs that are bombs or no files, or that take a reader long."""

import gzip
import io
import json
import math
import os
import zipfile
from collections.abc import Callable
from pathlib import Path

from tests.hostile.case import ACCEPTED, REFUSED, Case, Yard, titled
from tests.hostile.houses import bomb
from tests.hostile.subjects import Answer

MAP = """
image: map.pgm
resolution: 0.05
origin: [0, 0, 0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.2
"""
MERGED = "a: &a {k: v}\n" + "".join(
    f"{b}: &{b}\n  <<: [{', '.join([f'*{a}'] * 12)}]\n" for a, b in zip("abcdefgh", "bcdefghi", strict=True)
)


def crossing(corners: int) -> list[list[float]]:
    """Return an outline each of whose sides crosses nearly all others."""
    turn = 2 * math.pi * (corners // 2) / corners
    return [[10 + 9 * math.cos(k * turn), 10 + 9 * math.sin(k * turn)] for k in range(corners)]


def geojson(corners: list[list[float]]) -> str:
    return json.dumps({"type": "Polygon", "coordinates": [[*corners, corners[0]]]})


def svg(label: str) -> str:
    polygon = '<polygon points="0,0 400,0 400,400 0,400"/>'
    return f'<svg><g class="Floorplan"><g class="Space Bedroom">{polygon}<text>{label}</text></g></g></svg>'


def archive(*files: bytes) -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as packed:
        for number, file in enumerate(files):
            packed.writestr(f"{number}/unit.geojson", file)
    return content.getvalue()


DEEP = "[" * 100_000 + "]" * 100_000

CONTENTS: dict[str, tuple[str, Callable[[], str | bytes], tuple[str, ...]]] = {
    "merge keys in merge keys": ("map.yaml", lambda: MERGED + MAP, (REFUSED,)),
    "a tag that makes an object": ("map.yaml", lambda: MAP + "mode: !!python/name:os.system", (REFUSED,)),
    "a tag that its value is not of": ("map.yaml", lambda: MAP.replace("0.65", "!!bool x"), (REFUSED,)),
    "a number of sixties": ("map.yaml", lambda: MAP.replace("0.05", "1:" * 400 + "1.5"), (REFUSED,)),
    "a picture elsewhere": ("map.yaml", lambda: MAP.replace("map.pgm", "SECRET"), (REFUSED,)),
    "lists in lists": ("map.yaml", lambda: "[" * 60_000, (REFUSED,)),
    "deep GeoJSON": ("plan.geojson", lambda: f'{{"type": "Polygon", "coordinates": {DEEP}}}', (REFUSED,)),
    "an outline that crosses itself": ("plan.geojson", lambda: geojson(crossing(4001)), (REFUSED,)),
    "a plan of HouseExpo that crosses itself": (
        "plan.json",
        lambda: json.dumps({"verts": crossing(4001), "room_category": {"Bed": [[0, 0, 5, 5]]}}),
        (REFUSED,),
    ),
    "corners of 400 digits": ("plan.geojson", lambda: geojson([[10**400, 0], [0, 1], [1, 1]]), (REFUSED,)),
    "many line ends before DXF": ("plan.dxf", lambda: "0" + "\n" * 1_000_000, (REFUSED,)),
    "a label of many digits": ("plan.svg", lambda: svg("9" * 400 + " m x 4 m"), (ACCEPTED,)),
    "a label of no number": ("plan.svg", lambda: svg("3..2 m x 4 m"), (ACCEPTED,)),
    "a label of many points": ("plan.svg", lambda: svg("." * 1_000_000), (ACCEPTED,)),
    "an archive of large files": ("plan.zip", lambda: archive(*[b" " * (1 << 23)] * 9), (REFUSED,)),
    "an archive of many files": ("plan.zip", lambda: archive(*[b"{}"] * 9999), (REFUSED,)),
    "a bomb that is a plan": ("plan.json", lambda: bomb(1 << 30), (REFUSED,)),
    "a bomb that is a brief": ("brief.json", lambda: bomb(1 << 30), (REFUSED,)),
    "a deep brief": ("brief.json", lambda: f'{{"rooms": {DEEP}}}', (REFUSED,)),
    "a brief of an endless number": ("brief.json", lambda: f'{{"area": {"1" * 5000}}}', (REFUSED,)),
    "a brief that is cut": ("brief.json", lambda: gzip.compress(b"{}" * 99)[:-9], (REFUSED,)),
}


def _written(name: str, content: Callable[[], str | bytes]) -> Callable[[Yard], Path]:
    def make(yard: Yard) -> Path:
        path, text = yard.input / name, content()
        path.write_bytes(yard.filled(text).encode() if isinstance(text, str) else text)
        return path

    return make


def _made(name: str, make: Callable[[Path], object]) -> Callable[[Yard], Path]:
    def made(yard: Yard) -> Path:
        make(yard.input / name)
        return yard.input / name

    return made


NO_FILES: dict[str, Callable[[Path], object]] = {
    "a pipe": os.mkfifo,
    "a link to zeros": lambda path: path.symlink_to("/dev/zero"),
    "a folder": Path.mkdir,
}

CASES = [
    *(
        Case("plans, maps, briefs", titled(title), _written(name, content), answers)
        for title, (name, content, answers) in CONTENTS.items()
    ),
    *(
        Case("plans, maps, briefs", f"{title} for {name}", _made(name, make), (REFUSED,))
        for title, make in NO_FILES.items()
        for name in ("map.yaml", "plan.geojson", "plan.svg", "brief.json")
    ),
]


def read(path: Path) -> Answer:
    """Return the answer of the reader of the file's kind."""
    from vitruvius.logic import load
    from vitruvius.logic.request.brief import read_brief
    from vitruvius.logic.request.given_plan import read_plan

    if path.name == "brief.json":
        read_brief(path)
    elif path.suffix == ".yaml":
        load(path)
    else:
        read_plan(path)
    return Answer(ACCEPTED, "")
