"""Recipes and examples of the reference pass lint; houses with a recipe obey it, and others do not."""

import re
import shutil
from collections import Counter
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from itertools import combinations, pairwise
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from vitruvius.logic.checking.least_main_room import side_of
from vitruvius.logic.errors import Finding
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import SHIPPED, TOPOLOGIES, find
from vitruvius.logic.house.boxes import BACK, TOLERANCE, WALLS, is_on_wall, walls_touched
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import Piece, Room
from vitruvius.logic.house.star import StarRoom
from vitruvius.logic.language.linter import all_warnings, errors
from vitruvius.logic.language.loaded import LoadedGrammar
from vitruvius.logic.language.reference import Recipe, asp_entries, prolog_entries, recipes
from vitruvius.logic.request.house_request import HouseRequest

SAMPLE = (2, 4, 4, 4, 9, 9, 9)
"""Numbers of rooms of the houses in which a recipe is tested."""
SHARED_WALLS = (7, 8, 9, 9, 12)
"""Numbers of rooms of houses whose rooms share walls."""


def made(folder: Path, times: int = 1) -> tuple[list[Finding], list[House]]:
    """Return lint's findings about a grammar, and its houses: the sample, repeated ``times`` times."""
    grammar = find(folder)
    loaded = LoadedGrammar(grammar)
    builder = Builder(grammar, loaded=loaded)
    sample = SHARED_WALLS if grammar.shares_walls else SAMPLE
    houses = [builder.house(HouseRequest(n), 0, index) for index, n in enumerate(sample * times)]
    return errors(grammar, loaded) + all_warnings(grammar, loaded), houses


@pytest.fixture(scope="module")
def plain(solver: ProcessPoolExecutor) -> Callable[[str], list[House]]:
    """Return a function that returns the houses of a shipped grammar without changes."""
    return cache(
        lambda grammar: solver.submit(made, SHIPPED / grammar, 5 if grammar == "family" else 1).result()[1]
    )


# - the claim of each recipe, as plain geometry ---------------------------------------------------


class Standing(NamedTuple):
    """Piece as seen from the door: its wall or the middle, metres along that wall and out from it."""

    piece: Piece
    room: StarRoom
    wall: str
    length: float
    depth: float

    def distance(self, wall: str) -> float:
        """Return the distance from this wall of the room to the piece's side there, metres."""
        side = seen(self.room).index(wall)
        return abs(self.piece.box[side] - self.room.box[side])


def seen(room: StarRoom) -> list[str]:
    """Return the names, as seen from the door, of the west, north, east and south wall."""
    door = next(wall for wall in range(4) if is_on_wall(room.door, room, wall))
    return [("front", "left", "back", "right")[(wall - door) % 4] for wall in range(4)]


def size(box: Piece | StarRoom, wall: int) -> tuple[float, float]:
    """Return the lengths of a box along this wall, and away from the wall, metres."""
    return (box.width, box.height) if wall % 2 else (box.height, box.width)


def width_and_depth(room: StarRoom) -> tuple[float, float]:
    return size(room, seen(room).index("front"))


def stands(piece: Piece, room: StarRoom) -> Standing:
    back = BACK[piece.orientation] if piece.orientation else seen(room).index("front")
    wall = seen(room)[back] if back in walls_touched(piece, room) else "middle"
    return Standing(piece, room, wall, *size(piece, back))


def sides(house: House) -> list[tuple[str, str | None]]:
    return [(room.type, side_of(house.star, room)) for room in house.star.rooms]


def count(house: House, type_: str) -> int:
    return sum(room.type == type_ for room in house.rooms)


CLAIMS: dict[str, tuple[Callable, Callable]] = {}
"""Functions of each recipe: the things in houses that it binds, and the claim about each of them."""


def claim(of: Callable[[list[House]], Iterable[Any]]) -> Callable[[Callable], Callable]:
    """Return a decorator for the claim of the recipe with the function's name."""

    def add(says: Callable) -> Callable:
        CLAIMS[says.__name__] = of, says
        return says

    return add


def rooms(*types: str) -> Callable:
    return lambda houses: [room for house in houses for room in house.star.rooms if room.type in types]


def pieces(*types: str) -> Callable:
    return lambda houses: [
        stands(piece, room)
        for house in houses
        for room in house.star.rooms
        for piece in room.children
        if piece.type in types
    ]


@claim(list)
def across(house: House) -> bool:
    opposite = {(WALLS[wall], WALLS[(wall + 2) % 4]) for wall in range(4)}
    return not any(
        {a, b} == {"kitchen", "bathroom"} and (s, t) in opposite
        for (a, s), (b, t) in combinations(sides(house), 2)
    )


@claim(list)
def at_most_two_in_a_row(house: House) -> bool:
    types = [room.type for room in house.star.rooms]
    return not any(a == b == c for a, b, c in zip(types, types[1:], types[2:], strict=False))


@claim(lambda houses: [house for house in houses if len(house.star.rooms) < 5])
def from_five_rooms_on(house: House) -> bool:
    return count(house, "hall") == 0


@claim(list)
def next_to(house: House) -> bool:
    near = [a if b[0] == "bedroom" else b for a, b in pairwise(sides(house)) if a[1] == b[1]]
    return all(room in near for room in sides(house) if room[0] == "bathroom")


@claim(list)
def no_more_than(house: House) -> bool:
    return count(house, "bathroom") <= count(house, "bedroom")


@claim(list)
def on_one_side(house: House) -> bool:
    return len({side for type_, side in sides(house) if type_ == "bathroom"}) == 1


@claim(list)
def one_for_three(house: House) -> bool:
    return count(house, "bathroom") == -(-len(house.star.rooms) // 3)


@claim(lambda houses: [houses])
def weight_by_rooms(houses: list[House]) -> bool:
    return sum(count(house, "hall") for house in houses) > sum(len(house.star.rooms) for house in houses) / 3


@claim(rooms("bathroom"))
def different_walls(room: StarRoom) -> bool:
    walls = [stands(piece, room).wall for piece in room.children if piece.type in {"toilet", "shower"}]
    return len(walls) == len(set(walls))


@claim(rooms("hall"))
def either_or(room: StarRoom) -> bool:
    return len({piece.type for piece in room.children} & {"sofa", "hallTable"}) == 1


@claim(lambda houses: [sofa for sofa in pieces("sofa")(houses) if sofa.wall == "middle"])
def facing_the_door(sofa: Standing) -> bool:
    return seen(sofa.room)[BACK[sofa.piece.orientation]] == "back"


@claim(pieces("shower"))
def in_a_corner(shower: Standing) -> bool:
    return len(walls_touched(shower.piece, shower.room)) == 2


@claim(pieces("wardrobe"))
def not_left_of_the_door(wardrobe: Standing) -> bool:
    beside_it = wardrobe.wall == "front" and wardrobe.distance("left") < wardrobe.distance("right")
    return wardrobe.wall != "left" and not beside_it


@claim(pieces("toilet"))
def not_opposite_the_door(toilet: Standing) -> bool:
    return toilet.wall != "back"


@claim(rooms("hall"))
def not_side_by_side(room: StarRoom) -> bool:
    """Check the left, back and right wall, since the door divides the front wall."""
    for wall, end in (("left", "front"), ("back", "left"), ("right", "front")):
        there = [each for piece in room.children if (each := stands(piece, room)).wall == wall]
        there.sort(key=lambda each: each.distance(end))
        if any(a.piece.type == b.piece.type == "cupboard" for a, b in pairwise(there)):
            return False
    return True


@claim(pieces("shelf", "cabinet"))
def by_the_wall(piece: Standing) -> bool:
    width, depth = width_and_depth(piece.room)
    if piece.piece.type == "cabinet":
        return piece.wall == "back" and 2 - TOLERANCE <= width - piece.length <= 3 + TOLERANCE
    return piece.wall in {"left", "right"} and depth / 3 - TOLERANCE <= piece.length <= depth / 2 + TOLERANCE


@claim(lambda houses: [sofa for sofa in pieces("sofa")(houses) if sofa.wall != "middle"])
def companions(sofa: Standing) -> bool:
    return [child.type for child in sofa.piece.children] == ["plant"]


@claim(lambda houses: [house for house in houses if count(house, "suite")])
def largest_bedroom(house: House) -> bool:
    largest = max(house.secondary, key=lambda room: room.area * (room.type in {"bedroom", "suite"}))
    with_armchair = [
        room for room in house.secondary if "armchair" in {piece.type for piece in room.children}
    ]
    return with_armchair == [largest]


@claim(rooms("study"))
def new_room(room: StarRoom) -> bool:
    width, depth = width_and_depth(room)
    lecterns = [stands(piece, room).wall for piece in room.children if piece.type == "lectern"]
    return 2.5 <= depth <= width <= 4 and len(lecterns) == 1 and lecterns[0] in {"back", "left"}


@claim(rooms("gallery"))
def proportions(room: StarRoom) -> bool:
    width, depth = width_and_depth(room)
    benches = [stands(piece, room) for piece in room.children]
    return 2 * depth <= width + TOLERANCE <= 3 * depth + 2 * TOLERANCE and all(
        abs(bench.length - 3 * bench.depth) < TOLERANCE for bench in benches
    )


@claim(rooms("cell", "chapel"))
def square_rooms(room: StarRoom) -> bool:
    return abs(room.width - room.height) < TOLERANCE


@claim(pieces("bureau"))
def chair_at_a_desk(bureau: Standing) -> bool:
    """Return True if the chair touches the middle of the desk's front."""
    (chair,) = bureau.piece.children
    front = (BACK[bureau.piece.orientation] + 2) % 4
    across = 1 - front % 2
    middles = [(each.box[across] + each.box[across + 2]) / 2 for each in (bureau.piece, chair)]
    touching = abs(chair.box[(front + 2) % 4] - bureau.piece.box[front]) < TOLERANCE
    return chair.type == "chair" and touching and abs(middles[0] - middles[1]) < TOLERANCE


@claim(rooms("classroom"))
def rows_of_desks(room: StarRoom) -> bool:
    """Return True if the chairs of a row are in one line."""
    front = seen(room).index("front")
    edges = Counter(
        round(piece.children[0].box[front], 6) for piece in room.children if piece.type == "schoolDesk"
    )
    return 2 <= len(edges) <= 3 and max(edges.values()) == 2


@claim(lambda houses: [room for house in houses for room in house.rooms if room.type.startswith("office")])
def desks_by_area(room: Room) -> bool:
    return sum(piece.type == "desk" for piece in room.children) == room.area // 6


@claim(list)
def balcony(house: House) -> bool:
    names = {room.name for room in house.rooms if room.type == "balcony"}
    lit = {window.room for window in house.windows} | {
        name for door in house.doors if names & {*door.between} for name in door.between
    }
    dark = [room for room in house.rooms if room.type in {"living", "bedroom"} and room.name not in lit]
    return len(names) == 1 and not dark and names.isdisjoint(window.room for window in house.windows)


@claim(lambda houses: [house for house in houses if count(house, "consulting") > 1])
def same_size(house: House) -> bool:
    sizes = {(room.width, room.height) for room in house.rooms if room.type == "consulting"}
    sizes_of_washrooms = {
        tuple(sorted((room.width, room.height))) for room in house.rooms if room.type == "washroom"
    }
    return all(
        max(each) - min(each) < TOLERANCE
        for some in (sizes, sizes_of_washrooms)
        for each in zip(*some, strict=True)
    )


def obeyed(name: str, houses: list[House]) -> bool:
    """Return True if the recipe binds something in the houses, and its claim holds for all of it."""
    of, says = CLAIMS[name]
    bound = list(of(houses))
    return bool(bound) and all(map(says, bound))


@pytest.mark.second_part("a grammar with each")
@pytest.mark.parametrize("recipe", recipes(), ids=lambda recipe: recipe.name)
def test_a_recipe_does_what_its_title_says(
    recipe: Recipe, solver: ProcessPoolExecutor, plain: Callable[[str], list[House]], tmp_path: Path
) -> None:
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / recipe.grammar, folder)
    for file in recipe.files:
        shutil.copy(file, folder)
    findings, houses = solver.submit(made, folder).result()
    assert findings == []
    assert obeyed(recipe.name, houses)
    assert not obeyed(recipe.name, plain(recipe.grammar)), f"{recipe.grammar} obeys it without the recipe"


def with_examples(folder: Path, grammar: str, topology: str, clauses: set[str]) -> Path:
    """Write a copy of a shipped grammar with all examples of the page for its topology."""
    shutil.copytree(SHIPPED / grammar, folder)
    entries = {
        part: [entry.example for entry in found if entry.name != "topology"]
        for part, found in asp_entries(topology).items()
    }
    # The examples of furniture use family's pieces.
    furniture = entries.pop("room") + entries.pop("pick")
    stated = entries.pop("topology")
    if topology == "dissection":  # As a topology of the user, which alone may state more of it.
        text = (TOPOLOGIES / "dissection.lp").read_text()
        (folder / "dissection.lp").write_text("\n".join([text, *stated, ""]))
    if topology == "star":
        entries["room"] = furniture
    for part, examples in entries.items():
        if not examples:  # Few topologies have units.
            continue
        (folder / f"examples_{part}.lp").write_text("\n".join([f"#program {part}.", *examples, ""]))
    # Included files are changed in a copy.
    lengths, included = folder / "sizes.pl", ":- include('home/lengths.pl')."
    if included in lengths.read_text():
        shutil.copy(SHIPPED / "home" / "lengths.pl", folder)
        lengths.write_text(lengths.read_text().replace(included, ""))
    # A clause for every type does not go with the page's clause for one type.
    for file in folder.glob("*.pl"):
        file.write_text(file.read_text().replace("window_size(_,", "window_size(kitchen,"))
    stated = "".join(file.read_text() for file in folder.glob("*.pl"))
    sizes = [entry.example for entry in prolog_entries() if entry.name in clauses]
    (folder / "more.pl").write_text("\n".join(example for example in sizes if example not in stated))
    return folder


def test_all_examples_of_the_page_together_are_a_grammar(solver: ProcessPoolExecutor, tmp_path: Path) -> None:
    """The copy of family states the named lengths already.

    One door leads to a room. No room is the largest, or spacious.
    """
    folder = with_examples(tmp_path / "mine", "family", "star", {"room_size", "piece_size"})
    findings, houses = solver.submit(made, folder).result()
    never_binds = re.compile(r"binds: .*(between\(|doorway\(|largest|spacious|taken)")
    assert [each for each in findings if not never_binds.search(each.text)] == []
    assert {"rack", "keg"} <= {
        piece.type for house in houses for room in house.star.rooms for piece in room.pieces
    }


@pytest.mark.parametrize(
    ("grammar", "topology"),
    [("home", "ring"), ("home", "corridor"), ("home", "dissection"), ("apartments", "building")],
)
def test_all_examples_of_the_page_for_plans_together_are_a_grammar(
    grammar: str, topology: str, tmp_path: Path
) -> None:
    clauses = {"room_size", "piece_size", "room_area", "window_size"}
    folder = with_examples(tmp_path / "mine", grammar, topology, clauses)
    rooms = folder / "rooms.lp"
    rooms.write_text(rooms.read_text().replace("topology(ring).", f"topology({topology})."))
    mine = find(folder)
    assert errors(mine, LoadedGrammar(mine)) == []
