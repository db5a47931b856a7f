"""Plans show the house in stable words and colours, and their files are complete."""

import dataclasses
import math
import subprocess
import sys
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Iterable, Iterator
from functools import reduce
from itertools import combinations, product
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import example, given, settings
from hypothesis import strategies as st
from msgspec.structs import replace
from PIL import Image, ImageColor

from tests.logic.house.handmade import Sketch, built, sketches, turned, turned_house
from tests.plans import PLANS
from tests.sample_houses import changed_star
from vitruvius.logic import House, Piece, Rect, load
from vitruvius.logic.drawing.canvas import (
    DENSITY,
    Block,
    Drawing,
    Line,
    Oval,
    Part,
    Rings,
    Shape,
    Text,
    flat,
    png,
    text_width,
)
from vitruvius.logic.drawing.door_leaves import Leaf, door_leaves
from vitruvius.logic.drawing.draw import contact_sheet, contact_sheet_svg, draw, plan, plan_png, plan_svg
from vitruvius.logic.drawing.frame import (
    BEYOND_OUTLINE_M,
    INNER_WALL_M,
    OUTER_WALL_M,
    Frame,
    drawn_extent,
    extent,
    grown,
)
from vitruvius.logic.drawing.furniture import piece_shapes
from vitruvius.logic.drawing.labels import MIN_FONT_PX, abbreviations
from vitruvius.logic.drawing.palettes import Inks, style
from vitruvius.logic.drawing.plan import boxes_of, house_shapes, opening, wall_boxes
from vitruvius.logic.house.boxes import distance, excess, overlap
from vitruvius.logic.house.part_names import doors_by_name, target_in, windows_by_name
from vitruvius.logic.house.parts import ORIGINAL, OUTSIDE, Door, Provenance, Room
from vitruvius.logic.house.promises import Thickness
from vitruvius.logic.looks.looks import DEFAULT as LOOKS

HOUSE = built(4.2, 4.2, tuple((sketch,) for sketch in sketches()))
INKS = Inks()
FLOORS = {fill.colour for fill in style([HOUSE]).fills.values()}
NAMESPACE = "{http://www.w3.org/2000/svg}"


def block(drawing: Drawing, name: str) -> Block:
    """Return the first rectangle of a part, which is the floor of a room."""
    part = next(shape for shape in drawing.shapes if isinstance(shape, Part) and shape.name == name)
    return next(shape for shape in part.shapes if isinstance(shape, Block))


class Picture:
    """Image of a plan, for questions in metres."""

    def __init__(self, house: House) -> None:
        self.image = plan_png(house)
        drawing = plan(house, self.image.width // DENSITY, self.image.height // DENSITY, measured=True)
        first = house.rooms[0]
        left, top, right, _ = block(drawing, first.name).box
        self.scale = (right - left) / first.width
        self.left, self.top = left - self.scale * first.x, top - self.scale * first.y

    def shows(self, colour: str, x: float, y: float) -> bool:
        """Return True if the point at these metres has this colour."""
        place = round((self.left + self.scale * x) * DENSITY), round((self.top + self.scale * y) * DENSITY)
        return self.image.getpixel(place) == ImageColor.getrgb(colour)


def words(drawing: Drawing) -> dict[str, Text]:
    """Return the words on a drawing."""
    return {shape.text: shape for shape in flat(drawing.shapes) if isinstance(shape, Text)}


def metre(drawing: Drawing, house: House) -> float:
    """Return the number of CSS pixels per metre."""
    left, _, right, _ = block(drawing, house.rooms[0].name).box
    return (right - left) / house.rooms[0].width


def many_rooms(sides: list[int]) -> House:
    """Return a house with rooms on sides of these numbers, of the four types in turn."""
    around: tuple[list[Sketch], ...] = ([], [], [], [])
    for number, side in enumerate(sides):
        sketch = sketches()[number % 4]
        around[side].append(dataclasses.replace(sketch, shift=4.5 * len(around[side])))
    length = 4.5 * max(map(len, around)) + 4
    return built(length, length, tuple(map(tuple, around)))


def middle(rect: Rect) -> tuple[float, float]:
    return rect.x + rect.width / 2, rect.y + rect.height / 2


@pytest.mark.parametrize("quarters", range(4))
def test_walls_are_drawn_with_a_gap_at_each_door(quarters: int) -> None:
    house = turned_house(HOUSE, quarters, 3.0, -2.0)
    picture = Picture(house)
    for room in house.star.rooms:
        x, y = middle(room.door)
        assert picture.shows(INKS.paper, x, y)
        beyond = 0.45 if room.door.width else 0.0, 0.45 if room.door.height else 0.0
        assert picture.shows(INKS.wall, x - beyond[0], y - beyond[1])
        assert picture.shows(INKS.wall, x + beyond[0], y + beyond[1])


@pytest.mark.parametrize("name", PLANS)
def test_shared_walls_are_drawn_once_open_at_doors_and_with_windows(name: str) -> None:
    house, picture = PLANS[name], Picture(PLANS[name])
    for door in house.doors:
        west, north, east, south = opening(house, boxes_of(house), door)
        x, y = (west + east) / 2, (north + south) / 2
        beyond = door.width / 2 + 0.1 * (door.width > 0), door.height / 2 + 0.1 * (door.height > 0)
        assert picture.shows(INKS.paper, x, y)
        assert picture.shows(INKS.wall, x - beyond[0], y - beyond[1])
        assert picture.shows(INKS.wall, x + beyond[0], y + beyond[1])


THICK = replace(
    PLANS["flat"],
    rooms=tuple(
        replace(room, x=room.x + 0.05, y=room.y + 0.05, width=room.width - 0.1, height=room.height - 0.1)
        for room in PLANS["flat"].rooms
    ),
    wall_thickness=Thickness(0.1, 0.3),
)


@pytest.mark.parametrize("house", [HOUSE, *PLANS.values(), THICK])
def test_walls_are_one_path_that_is_the_union_of_all_their_boxes(house: House) -> None:
    """With adjacent boxes each joint would be a line of another shade, or a step of a pixel."""
    frame, [region] = Frame(40.0, 0, 0), regions(house_shapes(house, Frame(40.0, 0, 0), style([house])))
    rings = [shapely.Polygon(ring) for ring in region.rings]
    drawn = reduce(shapely.symmetric_difference, rings)
    rooms = shapely.union_all([shapely.box(*frame.box(room)) for room in house.rooms])
    beyond = max(drawn_extent(house)[2] - extent(house)[2] - house.half_wall, 2 / 40) * 40
    outer = shapely.union_all([shapely.box(*grown(frame.box(tile), beyond)) for tile in house.tiles])
    inner = [] if house.wall_thickness else [shapely.box(*frame.place(box)) for box in wall_boxes(house)]
    expected = shapely.union_all([shapely.difference(outer, rooms), *inner])
    assert drawn.is_valid
    assert shapely.symmetric_difference(drawn, expected).area < 0.01
    inked = np.array(png([((0, 0), Drawing(500, 500, (region,)))], 500, 500))[:, :, 0] < 128
    assert inked.sum() / DENSITY**2 == pytest.approx(
        shapely.intersection(drawn, shapely.box(0, 0, 500, 500)).area, rel=0.01
    )


def test_what_is_occupied_in_a_map_is_one_path_too() -> None:
    cells = np.zeros((6, 8), int)
    cells[2, 1:7] = cells[1:5, 3] = 1
    house = House.from_grid(cells == 1, 0.5)
    drawing = plan(house, 300)
    (walls,) = (each for each in regions(drawing.shapes) if each.fill == INKS.wall)
    area = sum(shapely.Polygon(ring).area for ring in walls.rings)
    assert area == pytest.approx((cells == 1).sum() * (0.5 * metre(drawing, house)) ** 2)


def regions(shapes: Iterable[Shape]) -> list[Rings]:
    return [shape for shape in shapes if isinstance(shape, Rings)]


@pytest.mark.parametrize("house", [PLANS["flat"], THICK])
def test_dimension_lines_measure_the_whole_house(house: House) -> None:
    drawing = plan(house, 600, measured=True)
    west, north, east, south = drawn_extent(house) if house.wall_thickness else extent(house)
    scale, said = metre(drawing, house), words(drawing)
    for text, axis, length in (
        (f"{east - west:.2f} m", 0, east - west),
        (f"{south - north:.2f} m", 1, south - north),
    ):
        at = said[text].at
        assert said[text].turned == bool(axis)
        lines = [
            shape.points for shape in drawing.shapes if isinstance(shape, Line) and len(shape.points) == 2
        ]
        ends = [
            point[axis]
            for line in lines
            if line[0][1 - axis] == line[1][1 - axis] == at[1 - axis]
            for point in line
        ]
        assert max(ends) - min(ends) == pytest.approx(scale * length)


def test_a_plan_has_a_north_arrow_that_points_up() -> None:
    drawing = plan(HOUSE, 300, 300)
    north = words(drawing)["N"]
    (arrow,) = [
        shape
        for shape in drawing.shapes
        if isinstance(shape, Line) and len(shape.points) == 5 and shape.stroke == INKS.ink
    ]
    foot, tip, *_ = arrow.points
    assert tip[0] == foot[0] > north.at[0]
    assert tip[1] < north.at[1] < foot[1]


def test_types_are_written_in_words_and_have_one_abbreviation_in_all_drawings() -> None:
    room = replace(PLANS["flat"].rooms[0], type="commonCorridor", children=())
    house = House((room,), (), ())
    assert "common corridor" in words(plan(house, 600))
    sheets = [[PLANS["flat"]], [PLANS["flat"], house]]
    short = [abbreviations({*style(each).fills, *LOOKS.rooms}) for each in sheets]
    assert short[0] == short[1]


def test_a_piece_whose_name_does_not_fit_has_a_number_in_the_key() -> None:
    drawing = plan(strange_pieces(HOUSE), 300, 300)
    said = [shape for shape in flat(drawing.shapes) if isinstance(shape, Text)]
    pieces = sum(len(room.pieces) for room in HOUSE.star.rooms)
    assert sum(each.text == "1" for each in said) == pieces + 1
    assert [each.anchor for each in said if each.text == "piano"] == ["start"]
    large = plan(strange_pieces(HOUSE), 1600)
    assert sum(
        each.text == "piano" and each.anchor == "middle"
        for each in flat(large.shapes)
        if isinstance(each, Text)
    )


def test_a_tip_points_in_at_an_entrance_and_the_legend_says_so() -> None:
    drawing, house = plan(PLANS["chain"], 600), PLANS["chain"]
    scale = metre(drawing, house)
    tip, key = (
        shape for shape in flat(drawing.shapes) if isinstance(shape, Line) and shape.stroke == INKS.mark
    )
    (entrance,) = (door for door in house.doors if door.is_entrance)
    (left_x, left_y), (x, y), (right_x, right_y) = tip.points
    outside = block(drawing, "R0").box[1] - BEYOND_OUTLINE_M * scale
    assert left_y == right_y < y < outside  # south, into the hall
    assert left_x < x < right_x
    assert x == pytest.approx(block(drawing, "R0").box[0] + scale * (middle(entrance)[0] - house.rooms[0].x))
    assert key.points[1][1] == words(drawing)["entrance"].at[1]
    assert "entrance" not in words(plan(HOUSE, 600))


def test_a_garden_door_has_no_tip() -> None:
    hall = Room(0, 0, 4, 3, type="hall", name="R0")
    doors = Door(1, 0, 0.9, 0, ("R0", "outside")), Door(1, 3, 0.9, 0, ("R0", "outside"))
    entered, with_garden = (
        [
            shape
            for shape in flat(plan(House((hall,), doors[:count], (), hub="R0", topology="own"), 600).shapes)
            if isinstance(shape, Line) and shape.stroke == INKS.mark
        ]
        for count in (1, 2)
    )
    assert len(entered) == len(with_garden) == 2  # the entrance's, and the legend's


@pytest.mark.parametrize("house", [HOUSE, *PLANS.values()])
def test_all_walls_have_one_face_indoors_and_outer_ones_are_thicker_outside(house: House) -> None:
    """Therefore an outer wall that continues as an inner one has no step at a corner of rooms."""
    picture, half = Picture(house), INNER_WALL_M / 2
    boxes = [room.box for room in house.rooms]
    openings = [each.box for each in (*house.doors, *house.windows)]
    tried = {True: 0, False: 0}
    for axis, lines in enumerate(house.walls):
        for at, low, high in lines:
            along = low + 0.37 * (high - low)

            def point(
                across: float, at: float = at, along: float = along, axis: int = axis
            ) -> tuple[float, float]:
                return (at + across, along) if axis == 0 else (along, at + across)

            def box(x: float, y: float) -> tuple[float, float, float, float]:
                return x - 0.15, y - 0.15, x + 0.15, y + 0.15

            if any(overlap(box(*point(0)), each) >= 0 for each in openings):
                continue
            sides = [
                any(excess((*point(by), *point(by)), each) < 0 for each in boxes) for by in (-0.01, 0.01)
            ]
            inner = all(sides)
            tried[inner] += 1
            for side, indoors in zip((-1, 1), sides, strict=True):
                reach = half if indoors else OUTER_WALL_M - half
                near = [(by, True) for by in ([0.6 * reach] if reach else [])] + [(reach + 0.02, False)]
                for by, is_wall in near:
                    shown = picture.shows(INKS.wall, *point(side * by))
                    assert shown == is_wall or any(
                        overlap(box(*point(side * by)), piece.box) > 0
                        for room in house.rooms
                        for piece in room.pieces
                    )
    assert tried[True]
    assert tried[False]


@pytest.mark.parametrize("name", PLANS)
def test_windows_and_entrances_are_as_wide_as_they_are_and_as_deep_as_the_outer_wall(name: str) -> None:
    house, drawing = PLANS[name], plan(PLANS[name], 600)
    scale = metre(drawing, house)
    openings: list[tuple[str, Rect]] = [*windows_by_name(house).items()]
    openings += [(name, door) for name, door in doors_by_name(house).items() if door.is_entrance]
    assert openings
    for part, segment in openings:
        left, top, right, bottom = block(drawing, part).box
        sides = sorted([(right - left) / scale, (bottom - top) / scale])
        assert sides == pytest.approx(sorted([OUTER_WALL_M, segment.length]))


@pytest.mark.parametrize(
    "house", [HOUSE, *PLANS.values(), *(turned_house(HOUSE, quarters) for quarters in (1, 2, 3))]
)
def test_a_leaf_is_as_long_as_its_door_hangs_on_a_jamb_and_swings_into_a_room(house: House) -> None:
    drawing = plan(house, 600)
    scale, first = metre(drawing, house), block(drawing, house.rooms[0].name).box
    leaves = door_leaves(house)
    for leaf, (name, door) in zip(leaves, doors_by_name(house).items(), strict=True):
        ends = {(door.x, door.y), (door.x + door.width, door.y + door.height)}
        assert {leaf.hinge, leaf.jamb} == ends
        assert math.dist(leaf.hinge, leaf.tip) == pytest.approx(door.length)
        assert math.dist(leaf.tip, leaf.jamb) == pytest.approx(math.sqrt(2) * door.length)  # a right angle
        assert leaf.room in door.between
        assert excess(leaf.swing, house.room(leaf.room).box) <= 1e-6
        for piece in house.room(leaf.room).pieces:
            reach = distance((*leaf.hinge, *leaf.hinge), piece.box)
            assert overlap(leaf.swing, piece.box) <= 1e-6 or reach >= door.length - 1e-6
        (part,) = (each for each in drawing.shapes if isinstance(each, Part) and each.name == name)
        lines = [each for each in part.shapes if isinstance(each, Line) and each.stroke == INKS.edge]
        ((x0, y0), (x1, y1)) = lines[0].points
        assert math.dist((x0, y0), (x1, y1)) == pytest.approx(scale * door.length)
        assert (x1 - first[0]) / scale + house.rooms[0].x == pytest.approx(leaf.tip[0])
        assert (y1 - first[1]) / scale + house.rooms[0].y == pytest.approx(leaf.tip[1])
    for one, other in combinations(leaves, 2):
        assert one.room != other.room or not any(in_swing(other, point) for point in swing_points(one))


def test_a_leaf_sweeps_over_furniture_only_where_each_other_way_would_too() -> None:
    houses = load(Path(__file__).parents[3] / "agent/houses/home-test-v1.jsonl.gz")[:60]
    doors, blocked = 0, 0
    for house in houses:
        for leaf, door in zip(door_leaves(house), house.doors, strict=True):
            doors += 1
            if not sweeps_over_furniture(house, leaf):
                continue
            blocked += 1
            into = [name for name in door.between if name != OUTSIDE]
            for room in into:
                for hinge, jamb in ((leaf.hinge, leaf.jamb), (leaf.jamb, leaf.hinge)):
                    away = 1 if room == leaf.room else -1
                    tip = tuple(
                        h + away * (t - o) for h, t, o in zip(hinge, leaf.tip, leaf.hinge, strict=True)
                    )
                    other = Leaf(room, hinge, (tip[0], tip[1]), jamb)
                    assert (
                        sweeps_over_furniture(house, other) or excess(other.swing, house.room(room).box) > 0
                    )
    assert blocked < doors / 50


def sweeps_over_furniture(house: House, leaf: Leaf) -> bool:
    """Return True if one of many points of the quarter circle lies on a piece."""
    boxes = [piece.box for piece in house.room(leaf.room).pieces]
    return any(
        west < x < east and north < y < south
        for x, y in swing_points(leaf)
        for west, north, east, south in boxes
    )


def swing_points(leaf: Leaf) -> Iterator[tuple[float, float]]:
    """Yield points of the quarter circle that a leaf sweeps over."""
    (x, y), (tip_x, tip_y), (jamb_x, jamb_y) = leaf.hinge, leaf.tip, leaf.jamb
    for k, m in product(range(1, 20), range(31)):
        u, v = k / 20 * math.cos(m * math.pi / 60), k / 20 * math.sin(m * math.pi / 60)
        yield x + u * (tip_x - x) + v * (jamb_x - x), y + u * (tip_y - y) + v * (jamb_y - y)


def in_swing(leaf: Leaf, point: tuple[float, float]) -> bool:
    """Return True if a leaf sweeps over a point, other than at its edge."""
    west, north, east, south = leaf.swing
    inside = west + 1e-6 < point[0] < east - 1e-6 and north + 1e-6 < point[1] < south - 1e-6
    return inside and math.dist(leaf.hinge, point) < math.dist(leaf.hinge, leaf.tip) - 1e-6


@settings(max_examples=30)
@given(
    kind=st.sampled_from(sorted(LOOKS.pieces)),
    box=st.tuples(st.floats(0, 5), st.floats(0, 5), *[st.floats(0.3, 3)] * 2),
)
def test_every_symbol_s_front_faces_as_its_piece_does(
    kind: str, box: tuple[float, float, float, float]
) -> None:
    """A piece that is turned by quarters, with its orientation, is drawn like the turned drawing."""
    x, y, width, height = box
    frame, look = Frame(40.0, 0.0, 0.0), style([HOUSE])
    drawn = []
    for quarters in range(4):
        piece = turned(Piece(x, y, width, height, kind, "S"), quarters)
        places = []
        for shape in piece_shapes(piece, frame.box(piece), piece.orientation, frame.scale, look):
            is_box = isinstance(shape, Block | Oval)
            points = (shape.box[:2], shape.box[2:]) if is_box else getattr(shape, "points", ())
            turned_back = [back(point, quarters) for point in points]
            xs, ys = zip(*turned_back, strict=True)
            places += [min(xs), min(ys), max(xs), max(ys)] if is_box else [*xs, *ys]
        drawn.append(places)
    for other in drawn[1:]:
        assert other == pytest.approx(drawn[0], abs=1e-6)


def back(point: tuple[float, float], quarters: int) -> tuple[float, float]:
    """Return a point turned back by quarters, counter-clockwise about the origin."""
    for _ in range(quarters):
        point = point[1], -point[0]
    return point


def test_every_symbol_shows_its_front_but_those_of_pieces_that_have_none() -> None:
    """A symbol that looks the same from behind could not show the direction of its front."""

    def seen(turned_round: bool, forms: tuple) -> list:
        found = []
        for name, numbers in forms:
            us, vs = numbers[:2:2] if name == "ring" else numbers[::2], numbers[1::2]
            vs = [round(1 - v if turned_round else v, 6) for v in vs]
            apart = name in {"box", "oval"}  # by opposite corners, whichever
            found.append((name, [sorted(us), sorted(vs)] if apart else sorted(zip(us, vs, strict=True))))
        return sorted(found)

    same = {name for name, forms in LOOKS.symbols.items() if seen(True, forms) == seen(False, forms)}
    assert same == {"plant", "table", "stool"}


@pytest.mark.parametrize("quarters", range(4))
def test_a_mark_shows_where_the_front_of_a_piece_without_a_symbol_faces(quarters: int) -> None:
    house = turned_house(strange_pieces(HOUSE), quarters)
    picture = Picture(house)
    ways = {"N": (0, -1), "E": (1, 0), "S": (0, 1), "W": (-1, 0)}
    for piece in (piece for room in house.star.rooms for piece in room.pieces if piece.orientation):
        (x, y), (east, south) = middle(piece), ways[piece.orientation]
        ahead, aside = east * piece.width / 2, south * piece.height / 2
        assert picture.shows(INKS.mark, x + ahead, y + aside)
        assert not picture.shows(INKS.mark, x - ahead, y - aside)
    assert "front of furniture" in words(plan(house, 600))
    assert "front of furniture" not in words(plan(HOUSE, 600))


def strange_pieces(house: House) -> House:
    """Return the house with pieces of a type that has no symbol."""

    def strange(piece: Piece) -> Piece:
        return replace(piece, type="piano", children=tuple(map(strange, piece.children)))

    rooms = tuple(replace(room, children=tuple(map(strange, room.children))) for room in house.star.rooms)
    return changed_star(house, rooms=rooms)


def test_the_original_s_main_room_ends_where_a_room_begins() -> None:
    """The original's ``floor`` reaches under the rooms, and the orientations of its pieces are unreliable."""
    floor = Rect(-3.1, -3.1, 6.2, 6.2)
    house = House.of_star(replace(HOUSE.star, floor=floor), ORIGINAL)
    picture = Picture(house)
    assert picture.shows(INKS.wall, -3.2, 3.0)
    assert picture.shows(LOOKS.rooms["bedroom"], 0.9, -3.1)
    shapes = [*flat(plan(house, 300, 300).shapes)]
    assert not [shape for shape in shapes if isinstance(shape, Line) and shape.stroke == INKS.mark]
    assert "front of furniture" not in words(plan(house, 300, 300))


def test_every_room_is_labelled_clear_of_its_furniture() -> None:
    drawing = plan(HOUSE, 300, 300)
    labels = words(drawing)
    assert {"bedroom", "bathroom", "kitchen", "hall", "main room", "1 m"} <= set(labels)
    furniture = [shape.box for shape in flat(drawing.shapes) if isinstance(shape, Block) and shape.radius]
    floors = [shape for shape in flat(drawing.shapes) if isinstance(shape, Block) and not shape.radius][1:]
    for text in ("bedroom", "bathroom", "kitchen", "hall", "main room"):
        (x, y), size = labels[text].at, labels[text].size
        half = text_width(text, size) / 2
        assert size >= 7
        assert text == "main room" or any(
            excess((x - half, y - size / 2, x + half, y + size / 2), floor.box) < 0 for floor in floors
        )
        assert all(overlap((x - half, y - size / 2, x + half, y + size / 2), box) < 0 for box in furniture)


@pytest.mark.parametrize("size", [200, 300, 720])
def test_a_name_in_full_hides_no_furniture_and_the_key_has_the_abbreviations_that_are_used(size: int) -> None:
    bank = Path(__file__).parents[3] / "agent" / "houses"
    houses = [*load(bank / "home-test-v1.jsonl.gz")[:48], *load(bank / "test-v1.jsonl.gz")[:16]]
    seen = Counter[str]()
    for house in houses:
        drawing = plan(house, size, size)
        short = abbreviations({*LOOKS.rooms, *(room.type for room in house.counted)})
        inked = [shape for shape in flat(drawing.shapes) if isinstance(shape, Block | Text)]
        furniture = [shape.box for shape in inked if isinstance(shape, Block) and shape.fill == INKS.wood]
        named = [shape for shape in inked if isinstance(shape, Text) and shape.anchor == "middle"]
        for word in named:
            if word.text in short:
                (x, y), half = word.at, text_width(word.text, word.size) / 2
                box = x - half, y - word.size / 2, x + half, y + word.size / 2
                assert all(overlap(box, piece) < 0 for piece in furniture), word
                seen["in full"] += 1
        key = {word.text for word in words(drawing).values() if word.anchor == "start" and word.text in short}
        in_full = Counter(word.text for word in named if word.text in short)
        rooms = Counter(room.type for room in house.counted)
        assert key == {kind for kind in rooms if in_full[kind] < rooms[kind]}
        seen["short"] += bool(key)
    assert seen["in full"] > 200
    assert seen["short"] or size == 720


@pytest.mark.parametrize(("size", "metres"), [(300, 1), (240, 2), (160, 5)])
def test_the_scale_bar_is_as_long_as_it_says_and_long_enough_to_be_seen(size: int, metres: int) -> None:
    drawing = plan(HOUSE, size, size)
    end, y = words(drawing)[f"{metres} m"].at
    lines = [
        shape.points
        for shape in flat(drawing.shapes)
        if isinstance(shape, Line) and shape.stroke != INKS.mark
    ]
    (bar,) = [(a, b) for a, b, *_ in lines if a[1] == b[1] == y]
    assert bar[1][0] - bar[0][0] == pytest.approx(metres * metre(drawing, HOUSE))
    assert 18 <= bar[1][0] - bar[0][0] < end


def test_a_legend_says_what_the_marks_are() -> None:
    drawing = plan(strange_pieces(HOUSE), 300, 300)
    x, y = words(drawing)["front of furniture"].at
    marks = [shape for shape in flat(drawing.shapes) if isinstance(shape, Line) and shape.stroke == INKS.mark]
    assert marks[-1].points[0][1] == y
    assert 0 < x - marks[-1].points[1][0] < 10


SIDES = st.lists(st.integers(0, 3), min_size=1, max_size=128)


@settings(max_examples=12)
@given(sides=SIDES, cell=st.sampled_from([60, 150, 300, 720]))
@example(sides=[0, 1, 2, 3] * 32, cell=300)
@example(sides=[0, 1, 2, 3] * 12, cell=300)
def test_houses_of_up_to_128_rooms_are_drawn_in_both_formats_with_every_name_between_its_walls(
    sides: list[int], cell: int
) -> None:
    house = many_rooms(sides)
    assert contact_sheet([house], cell=cell).size == (DENSITY * cell, DENSITY * cell)
    ET.fromstring(contact_sheet_svg([house], cell=cell))
    drawing = plan(house, cell, cell)
    short = abbreviations({*LOOKS.rooms, *(room.type for room in house.star.rooms)})
    floors = [
        shape.box for shape in flat(drawing.shapes) if isinstance(shape, Block) and shape.fill in FLOORS
    ]
    for word in (shape for shape in flat(drawing.shapes) if isinstance(shape, Text)):
        if word.text in {*short, *short.values()} and word.anchor == "middle":
            half = text_width(word.text, word.size) / 2
            box = word.at[0] - half, word.at[1] - word.size / 2, word.at[0] + half, word.at[1] + word.size / 2
            assert word.size >= MIN_FONT_PX
            assert any(excess(box, floor) <= 0 for floor in floors)
    named = {word.text for word in flat(drawing.shapes) if isinstance(word, Text) and word.anchor == "middle"}
    keyed = {
        shape.text for shape in flat(drawing.shapes) if isinstance(shape, Text) and shape.anchor == "start"
    }
    assert {room.type for room in house.star.rooms} - named <= keyed


@given(
    box=st.tuples(*[st.floats(0, 12)] * 4),
    width=st.floats(0.1, 4),
    radius=st.floats(0, 6),
)
def test_a_rectangle_of_any_size_can_be_inked(box: tuple, width: float, radius: float) -> None:
    """Pillow refuses round corners that leave less than a pixel of a straight side."""
    x, y, across, down = box
    block = Block((x, y, x + across, y + down), "#ffffff", "#000000", width, radius)
    assert png([((0, 0), Drawing(30, 30, (block,)))], 30, 30).size == (60, 60)


def test_abbreviations_differ_and_are_as_short_as_they_can_be() -> None:
    assert abbreviations(["bedroom", "bathroom", "hall"]) == {"bathroom": "ba", "bedroom": "be", "hall": "h"}
    assert abbreviations(["bath", "bathroom"]) == {"bath": "bath", "bathroom": "bathr"}


def test_one_scale_makes_a_metre_as_long_in_all_plans(tmp_path: Path) -> None:
    houses = [HOUSE, many_rooms([0, 1, 2, 3] * 4), many_rooms([0])]
    for apart in (False, True):
        root = ET.fromstring(contact_sheet_svg(houses, one_scale=apart))
        metres = [
            float(cell.findall(f"{NAMESPACE}g")[0][0].attrib["width"]) / house.star.floor.width
            for cell, house in zip(root.findall(f"{NAMESPACE}g"), houses, strict=True)
        ]
        assert (max(metres) - min(metres) < 0.05) == apart
    plans = [ET.parse(path).getroot() for path in draw(houses, tmp_path, one_scale=True)[:-1]]
    widths = [float(root.findall(f"{NAMESPACE}g/{NAMESPACE}g")[0][0].attrib["width"]) for root in plans]
    metres = [width / house.star.floor.width for width, house in zip(widths, houses, strict=True)]
    assert max(metres) - min(metres) < 0.05


def test_the_colour_of_a_new_type_is_the_same_in_each_process() -> None:
    names = ["library", "greenhouse", "cellar", "foyer", "office"]
    code = (
        "from vitruvius.logic import House, Room; from vitruvius.logic.drawing.palettes import style; "
        f"rooms = tuple(Room(4 * k, 0, 4, 4, f'R{{k}}', name) for k, name in enumerate({names!r})); "
        f"print(*(style([House(rooms)]).fill(name).colour for name in {names!r}))"
    )
    printed = [
        subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout
        for _ in range(2)
    ]
    assert printed[0] == printed[1]
    assert len(set(printed[0].split())) == len(names)


def test_a_new_type_and_a_piece_without_a_symbol_show_their_names() -> None:
    lamp = replace(HOUSE.star.rooms[3].children[0], type="piano", orientation="")
    strange = changed_star(
        HOUSE, rooms=(replace(HOUSE.star.rooms[3], type="<salon> & co", children=(lamp,)),)
    )
    texts = [element.text for element in ET.fromstring(plan_svg(strange)).iter(f"{NAMESPACE}text")]
    assert {"<salon> & co", "piano"} <= set(texts)


def test_a_room_shows_the_name_that_somebody_gave_it_or_its_type_where_that_is_too_long() -> None:
    names = ("Nursery", "R1", "The room of the parents and of all of their children")
    rooms = [Room(4 * k, 0, 4, 4, name, "bedroom", ()) for k, name in enumerate(names)]
    drawing = plan(House(tuple(rooms)), 300, 300)
    texts = [shape for shape in flat(drawing.shapes) if isinstance(shape, Text) and shape.anchor == "middle"]
    assert Counter(text.text for text in texts if "m²" not in text.text) == {"Nursery": 1, "bedroom": 2}


def test_svg_and_png_have_the_same_shapes_and_size() -> None:
    root = ET.fromstring(plan_svg(HOUSE))
    image = plan_png(HOUSE)
    assert image.size == (int(root.attrib["width"]) * DENSITY, int(root.attrib["height"]) * DENSITY)
    shapes = plan(HOUSE, 720, int(root.attrib["height"]), measured=True).shapes
    (drawn,) = root.findall(f"{NAMESPACE}g")
    assert len(drawn) == len(shapes)


@pytest.mark.parametrize("house", [HOUSE, *PLANS.values()])
def test_each_part_of_an_svg_has_the_name_by_which_explain_takes_it(house: House) -> None:
    named = [
        each.attrib["data-part"]
        for each in ET.fromstring(plan_svg(house)).iter()
        if "data-part" in each.attrib
    ]
    assert len(named) == len(set(named))
    pieces = sum(len(room.pieces) for room in house.rooms)
    assert len(named) == len(house.rooms) + pieces + len(house.doors) + len(house.windows)
    for name in named:
        target_in(house, name)


def test_the_title_says_where_the_house_comes_from_as_far_as_it_fits() -> None:
    made = replace(HOUSE, provenance=Provenance("grammars/family", "", {}, 7, 12, {}))
    words = "family · seed 7 · house 12 · 4 rooms · 66 m²"

    def titles(width: int) -> set[str]:
        return {shape.text for shape in flat(plan(made, width, 300).shapes) if isinstance(shape, Text)}

    assert words in titles(340)
    assert "house 12 · 4 rooms · 66 m²" in titles(240)


@pytest.mark.parametrize(
    ("count", "columns", "shape"), [(1, None, (1, 1)), (5, 2, (2, 3)), (24, None, (6, 4))]
)
def test_a_sheet_shows_every_house_row_by_row(
    count: int, columns: int | None, shape: tuple[int, int]
) -> None:
    root = ET.fromstring(contact_sheet_svg([HOUSE] * count, columns, cell=100))
    assert len(root.findall(f"{NAMESPACE}g")) == count
    assert (int(root.attrib["width"]), int(root.attrib["height"])) == (100 * shape[0], 100 * shape[1])
    if count < 6:
        image = contact_sheet([HOUSE] * count, columns, cell=100)
        assert image.size == (100 * DENSITY * shape[0], 100 * DENSITY * shape[1])


@pytest.mark.parametrize("form", ["svg", "png"])
def test_a_plan_of_each_house_and_a_sheet_are_written(tmp_path: Path, form: str) -> None:
    paths = draw([HOUSE] * 11, tmp_path / "plans", form) if form == "svg" else draw([HOUSE], tmp_path, "png")
    assert all(path.is_file() for path in paths)
    assert paths[-1].name == f"contact-sheet.{form}"
    assert sorted(paths[0].parent.iterdir()) == sorted(paths)
    if form == "svg":
        assert [path.name for path in paths[:2]] == ["house-00.svg", "house-01.svg"]
        ET.parse(paths[0])
    else:
        assert Image.open(paths[0]).size == plan_png(HOUSE).size


def test_what_cannot_be_drawn_leaves_no_file(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="svg, png or pdf, not 'gif'"):
        draw([HOUSE], tmp_path, "gif")  # pyright: ignore[reportArgumentType]
    with pytest.raises(ValueError, match="no house"):
        draw([], tmp_path)
    assert not list(tmp_path.iterdir())


def test_a_plan_asks_a_house_for_its_tiles_no_oftener_where_it_has_more_doors(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked, tiles = [], House.tiles.fget
    assert tiles
    monkeypatch.setattr(House, "tiles", property(lambda house: asked.append(1) or tiles(house)))
    plan_svg(PLANS["flat"])
    assert len(asked) <= 2
