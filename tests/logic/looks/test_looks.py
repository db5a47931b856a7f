"""A grammar's folder may define looks of types, checked by line and column; palettes remain distinct."""

import json
import math
import os
import shutil
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace

from tests.plans import PLANS
from vitruvius.logic import GrammarError, House, Piece, RequestError, Room, lint
from vitruvius.logic.drawing.canvas import Block, Part, Strokes
from vitruvius.logic.drawing.draw import draw, plan
from vitruvius.logic.drawing.palettes import PALETTES, Palette, style
from vitruvius.logic.grammar import SHIPPED, shipped
from vitruvius.logic.house.parts import ORIGINAL, Provenance
from vitruvius.logic.looks.looks import DEFAULT, MIN_CONTRAST, contrast, folder_looks, looks_of

APART = 15
"""Least difference of colours for the colour-blind: CIE 1976, of which 2.3 is just visible."""

GREYS_APART = 10
"""Least difference of greys in lightness, of 0 to 100."""


def folder(tmp_path: Path, looks: object) -> Path:
    """Write a copy of a grammar with these looks."""
    mine = tmp_path / "mine"
    shutil.copytree(SHIPPED / "family", mine)
    (mine / "looks.json").write_text(looks if isinstance(looks, str) else json.dumps(looks, indent=1))
    return mine


def test_a_grammar_s_folder_names_colours_and_symbols(tmp_path: Path) -> None:
    wave = [["curve", [0, 0.5, 0.3, 0, 0.7, 1, 1, 0.5]]]
    looks = {
        "rooms": {"bedroom": "#ffeecc"},
        "pieces": {"wardrobe": "wave", "piano": "table"},
        "symbols": {"wave": wave},
    }
    mine, house = folder(tmp_path, looks), PLANS["flat"]
    drawing = plan(house, 500, look=style([house], grammar=mine))
    parts = {shape.name: shape.shapes for shape in drawing.shapes if isinstance(shape, Part)}
    floor = parts["R1"][0]
    assert isinstance(floor, Block)
    assert floor.fill == "#ffeecc"
    assert [type(shape).__name__ for shape in parts["R1.wardrobe"]] == ["Block", "Curve"]
    assert [type(shape).__name__ for shape in parts["R1.bed"]] != ["Block", "Curve"]  # as all beds are
    draw([house], tmp_path / "plans", grammar=mine)
    assert "#ffeecc" in (tmp_path / "plans/house-0.svg").read_text()


def test_houses_of_a_shipped_grammar_have_its_looks_whatever_folder_is_here(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (folder(tmp_path, {"rooms": {"ward": "#ffeecc"}})).rename(tmp_path / "clinic")
    made = replace(PLANS["flat"], provenance=Provenance("clinic", "", {}, 0, 0, {}))
    assert looks_of(made).rooms["ward"] == folder_looks(SHIPPED / "clinic").rooms["ward"] != "#ffeecc"
    assert looks_of(replace(made, provenance=Provenance("../clinic", "", {}, 0, 0, {}))) is DEFAULT


def test_a_desk_is_a_worktop_in_the_grammars_that_call_it_so_alone() -> None:
    kitchen = House((Room(0, 0, 3, 3, "R0", "kitchen", (Piece(0, 0, 2, 0.6, "desk", "S"),)),))

    def forms(house: House, kind: str = "desk") -> object:
        return looks_of(house).symbol(kind)

    for named in ("family", "paper"):
        theirs = replace(kitchen, provenance=Provenance(named, "", {}, 0, 0, {}))
        assert looks_of(theirs).name("desk") == "worktop"
        assert forms(theirs) != forms(kitchen)
    assert looks_of(replace(kitchen, topology=ORIGINAL)).name("desk") == "worktop"
    for named in ("mine", "home", "clinic"):
        theirs = replace(kitchen, provenance=Provenance(named, "", {}, 0, 0, {}))
        assert looks_of(theirs).name("desk") == "desk"
        assert forms(theirs) == forms(theirs, "writingDesk")
    assert looks_of(kitchen).name("coffeeTable") == "coffee table"


MISTAKES = [
    ('{"names": {"desk": ""}}', 1, 12, '"" is not a name'),
    ('{"rooms": {\n  "living": "green"}}', 2, 3, "living: .green. is not a colour: write it as"),
    (
        '{"rooms": {"living": "#303030"}}',
        1,
        12,
        r"text is not readable on #303030: the contrast is 1\.\d, less",
    ),
    ('{"pieces": {"sofa":\n "soffa"}}', 1, 13, 'there is no symbol "soffa": did you mean sofa[?]'),
    ('{"pieces": {"sofa": ["a", {"b": 1}], "bed": 3}}', 1, 13, "there is no symbol"),
    ('{"heights": {"sofa": 0}}', 1, 14, "0 is not a height: give metres, more"),
    (
        '{"symbols": {"s": [["line", [0, 0, 1, 1]],\n\n ["lin", [0, 0]]]}}',
        3,
        2,
        "no form lin: did you mean line[?]",
    ),
    ('{"symbols": {"s": [["ring", [0, 0]]]}}', 1, 20, "a ring has 3 numbers, not 2 numbers"),
    ('{"symbols": {"s": [["box", [0, 0, 1, 7]]]}}', 1, 20, "from 0 to 1"),
    ('{"colours": {}}', 1, 2, "there is no colours: "),
    ('{"rooms": {"a": "#ffffff",\n "a": "#eeeeee"}}', 2, 2, "a appears twice"),
    ('{"rooms": {"a": "#ffffff",}}', 1, 27, "not JSON"),
    ("[]", 1, 1, "expected an object with rooms, pieces, heights, symbols"),
]


@pytest.mark.parametrize(("text", "line", "column", "words"), MISTAKES)
def test_lint_and_draw_name_a_mistake_in_looks_by_line_and_column(
    text: str, line: int, column: int, words: str, tmp_path: Path
) -> None:
    mine = folder(tmp_path, text)
    with pytest.raises(GrammarError, match=words) as caught:
        style([PLANS["flat"]], grammar=mine)
    assert (caught.value.file, caught.value.line, caught.value.column) == (mine / "looks.json", line, column)


def test_lint_finds_what_is_wrong_with_looks_and_types_that_the_grammar_does_not_have(tmp_path: Path) -> None:
    mine = folder(tmp_path, {"rooms": {"hall": "red"}, "pieces": {"bed": "bde"}})
    found = [(each.severity, Path(each.file).name, each.line, each.text.split(":")[0]) for each in lint(mine)]
    assert found == [("error", "looks.json", 3, "hall"), ("error", "looks.json", 6, "bed")]
    (mine / "looks.json").write_text('{"rooms": {"kitchn": "#ffffff"},\n "pieces": {"bathtub": "table"}}')
    texts = [(each.severity, each.line, each.column, each.text) for each in lint(mine)]
    assert texts[0] == ("warning", 1, 12, "the grammar has no room kitchn: did you mean kitchen?")
    assert texts[1][:3] == ("warning", 2, 13)
    assert texts[1][3].startswith("the grammar has no piece bathtub")


def test_what_is_no_file_of_looks_is_not_read(tmp_path: Path) -> None:
    mine = folder(tmp_path, {})
    (mine / "looks.json").unlink()
    os.mkfifo(mine / "looks.json")
    with pytest.raises(GrammarError, match="is a device or a pipe"):
        folder_looks(mine)
    with pytest.raises(GrammarError, match="no such directory"):
        folder_looks(tmp_path / "none")


@pytest.mark.parametrize("grammar", shipped())
def test_names_are_readable_on_every_floor_of_a_shipped_grammar(grammar: str) -> None:
    assert all(
        contrast(colour, PALETTES["colour"].ink) >= MIN_CONTRAST
        for colour in folder_looks(SHIPPED / grammar).rooms.values()
    )


MACHADO = {
    "normal": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "protanopia": (
        (0.152286, 1.052583, -0.204868),
        (0.114503, 0.786281, 0.099216),
        (-0.003882, -0.048116, 1.051998),
    ),
    "deuteranopia": (
        (0.367322, 0.860646, -0.227968),
        (0.280085, 0.672501, 0.047413),
        (-0.011820, 0.042940, 0.968881),
    ),
    "tritanopia": (
        (1.255528, -0.076749, -0.178779),
        (-0.078411, 0.930809, 0.147602),
        (0.004733, 0.691367, 0.303900),
    ),
}
"""Views of the colour-blind, from linear RGB: Machado, Oliveira and Fernandes (2009), severity 1."""


def lab(colour: str, sight: str = "normal") -> np.ndarray:
    """Return the CIE L*a*b* values (D65) of a colour as a kind of sight perceives it."""
    value = np.array([int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)])
    linear = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
    seen = np.clip(np.array(MACHADO[sight]) @ linear, 0, 1)
    to_xyz = [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.1191920, 0.9503041],
    ]
    xyz = np.array(to_xyz) @ seen / [0.95047, 1.0, 1.08883]
    f = np.where(xyz > (6 / 29) ** 3, np.cbrt(xyz), xyz / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


@pytest.mark.parametrize("sight", MACHADO)
def test_the_colour_blind_tell_the_distinct_colours_apart_and_what_came_from_what_went(sight: str) -> None:
    from vitruvius.logic.drawing.difference import COLOURS

    for colours, least in ((PALETTES["distinct"].floors, APART), ([*COLOURS.values()], 20)):
        for one, other in combinations(colours, 2):
            assert np.linalg.norm(lab(one, sight) - lab(other, sight)) >= least


def test_greys_differ_in_lightness_and_words_are_readable_on_every_floor() -> None:
    for one, other in combinations(PALETTES["grey"].floors, 2):
        assert abs(lab(one)[0] - lab(other)[0]) >= GREYS_APART
    for palette in PALETTES.values():
        assert all(contrast(floor, palette.ink) >= MIN_CONTRAST for floor in palette.floors)
        assert contrast(palette.paper, palette.ink) >= MIN_CONTRAST
    grey = PALETTES["grey"]
    texts = [
        getattr(grey, name) for name in ("ink", "paper", "wall", "faint", "edge", "wood", "mark", "pattern")
    ]
    assert all(len({each[1:3], each[3:5], each[5:]}) == 1 for each in (*grey.floors, *texts))


def many_types(count: int) -> House:
    """Return a row of rooms, each of another type."""
    return House(tuple(Room(4.0 * k, 0, 4, 4, f"R{k}", f"t{k}") for k in range(count)))


TOLD_APART = 9
"""Least difference between a new type's colour and any other in a drawing of up to 8 new types."""


@pytest.mark.parametrize("known", [(), ("bedroom", "bathroom", "kitchen", "living", "corridor")])
def test_colours_of_new_types_differ_from_all_others_of_a_drawing_and_are_readable(
    known: tuple[str, ...],
) -> None:
    words = ["office", "lobby", "lab", "foyer", "patio", "atelier", "cellar", "library", "gym", "sauna"]
    for names in list(combinations(words, 8))[::3]:
        types = [*known, *names]
        house = House(tuple(Room(4.0 * k, 0, 4, 4, f"R{k}", kind) for k, kind in enumerate(types)))
        look = style([house])
        for new in names:
            colour = look.fill(new).colour
            assert contrast(colour, PALETTES["colour"].ink) >= MIN_CONTRAST
            for other in {*types} - {new}:
                assert np.linalg.norm(lab(colour) - lab(look.fill(other).colour)) >= TOLD_APART


@pytest.mark.parametrize("name", ["distinct", "grey"])
def test_all_types_of_a_drawing_differ_in_colour_or_pattern(name: str) -> None:
    palette: Palette = PALETTES[name]
    count = len(palette.floors) * len(palette.hatches)
    house = many_types(count)
    look = style([house], name)  # pyright: ignore[reportArgumentType]
    assert len({look.fill(room.type) for room in house.rooms}) == count
    drawing = plan(house, 3000, look=look)
    seen = set()
    for part in (shape for shape in drawing.shapes if isinstance(shape, Part) and "." not in shape.name):
        floor, *hatch = part.shapes
        assert isinstance(floor, Block)
        ends = [end for strokes in hatch if isinstance(strokes, Strokes) for end in strokes.ends]
        left, top, right, bottom = floor.box
        for x, y in (point for pair in ends for point in pair):
            assert left - 1e-6 <= x <= right + 1e-6
            assert top - 1e-6 <= y <= bottom + 1e-6
        ways = {round(math.degrees(math.atan2(y1 - y0, x1 - x0))) % 180 for (x0, y0), (x1, y1) in ends}
        dotted = bool(ends) and all(math.dist(*pair) < 2 for pair in ends)
        seen.add((floor.fill, dotted, *sorted(ways)))
    assert len(seen) == count


def test_a_type_has_one_fill_in_all_houses_of_a_drawing_and_patterns_come_last() -> None:
    houses = [*PLANS.values()]
    look = style(houses, "distinct")
    types = {room.type for house in houses for room in house.rooms}
    assert sum(not fill.hatch for fill in look.fills.values()) == min(
        len(types), len(PALETTES["distinct"].floors)
    )
    with pytest.raises(RequestError, match="no palette distinc: did you mean distinct"):
        style(houses, "distinc")  # pyright: ignore[reportArgumentType]


def test_the_looks_that_the_documentation_shows_are_right(tmp_path: Path) -> None:
    page = (Path(__file__).parents[3] / "docs/drawing.md").read_text()
    mine = folder(tmp_path, page.split("```json\n")[1].split("```")[0])
    assert folder_looks(mine).symbol("boiler") == (("ring", (0.5, 0.5, 0.4)), ("line", (0.0, 0.9, 1.0, 0.9)))
