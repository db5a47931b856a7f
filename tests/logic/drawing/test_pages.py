"""A plan on paper is as large as its scale says, in millimetres, on a page that holds it."""

import re
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from tests.plans import PLANS
from vitruvius.cli import main
from vitruvius.logic import House, RequestError, Room, save
from vitruvius.logic.drawing.canvas import Block, Part, Rings, Text
from vitruvius.logic.drawing.draw import MILLIMETRE
from vitruvius.logic.drawing.pages import BORDER, SIZES, page, scale_of
from vitruvius.logic.drawing.palettes import style

FLAT = PLANS["flat"]
LOOK = style([FLAT])


@pytest.mark.parametrize(("ratio", "size"), [(50, "A3"), (100, "A4"), (20, "A1")])
def test_rooms_have_the_millimetres_of_the_scale_and_the_plan_keeps_clear_of_the_page_s_edge(
    ratio: int, size: str
) -> None:
    [((left, top), drawing), ((_, below), block)], width, height = page(FLAT, LOOK, ratio)
    assert sorted([round(width * MILLIMETRE, 6), round(height * MILLIMETRE, 6)]) == [*SIZES[size]]
    parts = {shape.name: shape.shapes[0] for shape in drawing.shapes if isinstance(shape, Part)}
    for room in FLAT.rooms:
        floor = parts[room.name]
        assert isinstance(floor, Block)
        assert (floor.box[2] - floor.box[0]) * MILLIMETRE == pytest.approx(1000 * room.width / ratio)
        assert (floor.box[3] - floor.box[1]) * MILLIMETRE == pytest.approx(1000 * room.height / ratio)
    said = {each.text for each in block.shapes if isinstance(each, Text)}
    assert {"House", "Scale", f"1:{ratio} on {size}", "N"} <= said
    [walls] = [shape for shape in drawing.shapes if isinstance(shape, Rings)]
    border = BORDER / MILLIMETRE
    for x, y in (point for ring in walls.rings for point in ring):
        assert border <= x + left <= width - border
        assert border <= y + top <= below
    assert below + block.height <= height - border + 1e-6


def test_a_page_that_is_too_small_is_refused_with_what_fits() -> None:
    with pytest.raises(
        RequestError,
        match=r"house 3 is 210 x 174 mm at 1:50, too large for A4: a larger --paper, or --scale 1:100",
    ):
        page(FLAT, LOOK, 50, "A4", "house 3")
    page(FLAT, LOOK, 100, "A4")  # the scale in the error
    vast = House((Room(0, 0, 100, 100, "R0", "hall"),))
    with pytest.raises(RequestError, match="too large for A0: --scale 1:200"):
        page(vast, style([vast]), 50)


@pytest.mark.parametrize("text", ["50", "1:0", "2:1", "1:x", "1:50000", ""])
def test_a_scale_is_one_metre_to_so_many(text: str) -> None:
    with pytest.raises(RequestError, match="write it as 1:50"):
        scale_of(text)
    assert scale_of(" 1 : 50") == 50


def test_the_command_writes_pages_as_svg_in_millimetres_and_as_one_pdf(tmp_path: Path) -> None:
    save([FLAT, PLANS["chain"]], tmp_path / "houses.jsonl")

    def run(*options: str) -> int | str | None:
        with pytest.raises(SystemExit) as end:
            main(["draw", str(tmp_path / "houses.jsonl"), "--out", str(tmp_path / "out"), *options])
        return end.value.code

    assert run("--scale", "1:100", "--paper", "A3", "--palette", "grey") == 0
    root = ET.parse(tmp_path / "out/house-0.svg").getroot()
    width, _, box = root.attrib["width"], root.attrib["height"], root.attrib["viewBox"].split()
    assert width.endswith("mm")
    assert float(width[:-2]) / float(box[2]) == pytest.approx(MILLIMETRE, rel=1e-5)
    assert len([*(tmp_path / "out").iterdir()]) == 2
    assert run("--scale", "1:100", "--format", "pdf") == 0
    content = (tmp_path / "out/plans.pdf").read_bytes()
    boxes = re.findall(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", content)
    assert len(boxes) == 2
    for wide, high in boxes:  # points, 72 to an inch
        assert sorted(float(side) / 72 * 25.4 for side in (wide, high)) == pytest.approx(
            SIZES["A4"], abs=0.01
        )
    assert run("--paper", "A4") == 2
    assert run("--scale", "1:50", "--one-scale") == 2
