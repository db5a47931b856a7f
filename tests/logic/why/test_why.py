"""Explanations of parts of a house: rules and picks, alternatives, tight bounds."""

import json
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import jsonschema
import msgspec
import numpy as np
import pytest
from clingo import Function, Symbol, parse_term

from tests.logic.workers import in_process
from tests.sample_houses import changed_star
from vitruvius.cli import main
from vitruvius.logic import (
    House,
    HouseFileError,
    Piece,
    Rect,
    RequestError,
    Star,
    StarRoom,
    explain_house,
    save,
)
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.house.part_names import part_names, target_in
from vitruvius.logic.layout.program import Program
from vitruvius.logic.placement.layout import RoomLayout
from vitruvius.logic.request.fixed_rooms import fixed_rooms
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.why.answer import Derivation, Why
from vitruvius.logic.why.star import StarWitness
from vitruvius.logic.why.support import Support

TINY = """type(cell).
#program house.
link(a,b).  link(b,c).  link(c,b).
from(a).
reached(X) :- from(X).
reached(Y) :- reached(X), link(X,Y).
small(b).
large(X) :- reached(X), not small(X), X != a.
far(X) :- link(_,X), 1 { reached(X); small(X) }.
option(colour,red,1).  option(colour,blue,2).
painted(C) :- pick(colour,C).
either(N) :- N = 1..2, reached((a;z)).
-dry(X) :- large(X).
dull(X) :- -dry(X).
"""


class Explained:
    """House with explanations, in this process."""

    def __init__(self, builder: Builder, request: dict, seed: int) -> None:
        self.builder, self.request = builder, HouseRequest.read(request)
        self.house = builder.house(self.request, seed, 0)
        self.layout = builder.origin
        self.witness = StarWitness(builder, self.house)
        self.answers: dict[str, Why] = {}

    def why(self, target: str) -> Why:
        if target not in self.answers:
            self.answers[target] = self.witness.why(target)
        return self.answers[target]

    def pieces(self) -> Iterator[tuple[str, RoomLayout, Piece]]:
        """Yield each piece and companion with its target."""
        for number, room in enumerate(self.house.star.rooms):
            names = part_names([piece.type for piece in room.pieces])
            for name, piece in zip(names, room.pieces, strict=True):
                yield f"R{number}.{name}", self.layout.rooms[number], piece

    def targets(self) -> list[str]:
        rooms = [f"R{number}" for number in range(len(self.house.star.rooms))]
        return ["main", *rooms, *(f"{room}.door" for room in rooms), *(name for name, _, _ in self.pieces())]


@pytest.fixture(scope="module")
def builder() -> Builder:
    return in_process.builder("family")


@pytest.fixture(scope="module")
def family(builder: Builder) -> Explained:
    """Return four rooms with furniture at walls, in corners and in the middle."""
    return Explained(builder, {"rooms": 4, "types": {"hall": 1}, "furniture": {"hallTable": 1}}, 24)


@pytest.fixture(scope="module")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> tuple[Support, list[Symbol], Path]:
    file = tmp_path_factory.mktemp("tiny") / "tiny.lp"
    file.write_text(TINY)
    program = Program([file], {"rooms": 1}, [("house", [])])
    program.models = []
    program.sample(
        np.random.default_rng(0), without=[Function("pick", [Function("colour"), Function("blue")])]
    )
    atoms = program.models[0][1]
    return Support(program, atoms), atoms, file


def lines_of(node: Derivation, file: Path) -> list[tuple[str, int]]:
    """Return the atoms of a derivation with the lines of their rules, for one file."""
    return [
        (each.atom, each.rule.line or 0) for each in node.all() if each.rule and each.rule.file == str(file)
    ]


@pytest.mark.parametrize(
    ("atom", "expected"),
    [
        (
            "reached(c)",
            [("reached(c)", 6), ("link(b,c)", 3), ("reached(a)", 5), ("from(a)", 4), ("link(a,b)", 3)],
        ),
        ("painted(red)", [("painted(red)", 11), ("option(colour,red,1)", 10)]),
        ("either(2)", [("either(2)", 12), ("reached(a)", 5), ("from(a)", 4)]),
        ("far(c)", [("far(c)", 9), ("link(b,c)", 3)]),
        ("small(b)", [("small(b)", 7)]),
    ],
)
def test_an_atom_is_derived_by_its_rules_down_to_facts_and_picks(
    tiny: tuple[Support, list[Symbol], Path], atom: str, expected: list[tuple[str, int]]
) -> None:
    support, _, file = tiny
    (tree,) = support.trees([parse_term(atom)])
    assert sorted(lines_of(tree, file)) == sorted(expected)


def test_an_atom_that_is_false_by_name_is_derived_too(tiny: tuple[Support, list[Symbol], Path]) -> None:
    support, _, file = tiny
    (tree,) = support.trees([parse_term("dull(c)")])
    assert lines_of(tree, file)[:3] == [("dull(c)", 14), ("-dry(c)", 13), ("large(c)", 8)]


def test_a_pick_names_its_options_and_the_weights_of_unequal_ones(
    tiny: tuple[Support, list[Symbol], Path],
) -> None:
    support, _, _ = tiny
    (tree,) = support.trees([parse_term("painted(red)")])
    assert tree.body[0].options == ("blue (weight 2)", "red (weight 1)")


def test_no_derivation_rests_on_itself(tiny: tuple[Support, list[Symbol], Path]) -> None:
    """``reached(b)`` and ``reached(c)`` derive each other."""
    support, atoms, _ = tiny

    def require(node: Derivation, above: tuple[str, ...]) -> None:
        assert node.atom not in above
        for each in node.body:
            require(each, (*above, node.atom))

    for atom in atoms:
        (tree,) = support.trees([atom])
        require(tree, ())


def test_every_part_of_a_house_is_derived_from_facts_and_picks(family: Explained) -> None:
    for target in family.targets():
        answer = family.why(target)
        assert bool(answer.derivations) == (target != "main")
        nodes = [node for tree in answer.derivations for node in tree.all()]
        derived = {node.atom for node in nodes if node.rule}
        for node in nodes:
            assert node.atom in derived, (target, node.atom)
            if node.rule and not node.body:
                assert ":-" not in node.rule.text or "not " in node.rule.text or ".." in node.rule.text
                assert not node.atom.startswith("pick(")
        if target != "main":
            assert any(node.options for node in nodes), target


def test_rules_are_quoted_from_their_lines(family: Explained) -> None:
    for target in family.targets():
        for tree in family.why(target).derivations:
            for node in tree.all():
                if node.rule:
                    text = Path(node.rule.file or "").read_text().split("\n")[(node.rule.line or 0) - 1]
                    assert text[(node.rule.column or 0) - 1 :].startswith(node.rule.text.split()[0])


def test_a_piece_is_named_by_the_atoms_that_place_it(family: Explained) -> None:
    for target, layout, piece in family.pieces():
        atoms = [tree.atom for tree in family.why(target).derivations]
        assert {parse_term(atom) for atom in atoms} <= set(layout.furniture)
        assert re.match(rf"on\({piece.type},|with\(\w+,\d+,{piece.type},", atoms[0])


# Alternatives, by stage 1's own program and stage 2


def test_what_could_be_instead_can_and_what_could_not_cannot(family: Explained) -> None:
    asked = possible = also = 0
    for target, layout, _ in family.pieces():
        program, granted = family.builder.programs.furniture_for(layout.type.name, family.request)
        model = next(model for shown, model in program.models or [] if shown == layout.furniture)
        picks = [atom for atom in model if atom.match("pick", 2)]
        for choice in family.why(target).choices:
            variable = parse_term(choice.name)
            others = [pick for pick in picks if pick.arguments[0] != variable]
            for other in choice.instead:
                pick = Function("pick", [variable, parse_term(other.value)])
                houses = placed(family, layout, program, [*granted, *others, pick])
                assert bool(houses) == other.possible
                assert layout.furniture not in houses
                assert other.possible or other.because
                for freed in [set(other.also), *({*other.also} - {each} for each in other.also)]:
                    kept = [each for each in others if str(each.arguments[0]) not in freed]
                    houses = placed(family, layout, program, [*granted, *kept, pick])
                    assert bool(houses) == (other.possible or (bool(other.also) and freed == {*other.also}))
                    if variable.name != "count":  # no answer takes the piece away
                        assert all(is_there(variable, furniture) for furniture in houses)
                asked, possible, also = asked + 1, possible + other.possible, also + len(other.also)
    assert 0 < possible < asked
    assert also > 1


def placed(
    family: Explained, layout: RoomLayout, program: Program, atoms: list[Symbol]
) -> list[list[Symbol]]:
    """Return the first sampled layout with these atoms that has sizes and places, in a list, if any."""
    rng = np.random.default_rng(0)
    for _ in range(100):
        furniture = program.sample(rng, atoms)
        if furniture is None:
            return []
        if family.builder.placer.conflict(layout.type, furniture, ()) is None:
            return [furniture]
    return []


def is_there(variable: Symbol, furniture: list[Symbol]) -> bool:
    """Return True if the piece in a variable stands in the room, and for variables without a piece."""
    piece = variable.arguments[:2]
    return len(piece) < 2 or any(each.name == "on" and each.arguments[:2] == piece for each in furniture)


def test_what_a_room_could_be_instead_is_what_the_rules_allow(family: Explained) -> None:
    program, granted = family.builder.programs.rooms_for(family.request)
    assert program.models
    picks = [atom for atom in program.models[-1][1] if atom.match("pick", 2)]
    for number in range(len(family.house.star.rooms)):
        type_, side = family.why(f"R{number}").choices
        for choice, name in ((type_, f"pick(type({number}),%s)"), (side, f"side({number},%s)")):
            for other in choice.instead:
                kept = [pick for pick in picks if str(pick.arguments[0]) != choice.name]
                assumed = [*granted, *kept, parse_term(name % other.value)]
                assert program.possible(assumed) == other.possible
                if other.also:
                    fewer = [pick for pick in kept if str(pick.arguments[0]) not in other.also]
                    assert program.possible([*granted, *fewer, parse_term(name % other.value)])


def test_a_rule_that_forbids_is_named(builder: Builder) -> None:
    """With three rooms each is the only one of its basic type."""
    three = Explained(builder, {"rooms": 3}, 0)
    (basic,) = {
        reason.text
        for other in three.why("R0").choices[0].instead
        for reason in other.because
        if reason.text.startswith(":-")
    }
    assert basic == ":- rooms >= 3, basic(T), not room(_,T)."


# Lengths, by plain geometry


def measures(family: Explained, number: int) -> dict[str, float]:
    """Return the lengths of a room and of its parts in its own frame, by name as in ``bed.depth``."""
    room, layout = family.house.star.rooms[number], family.layout.rooms[number]
    side = layout.side.name
    south, east = room.y + room.height, room.x + room.width

    def framed(rect: Rect) -> tuple[float, float, float, float]:
        x1, y1, x2, y2 = rect.box
        match side:
            case "north":
                return x1 - room.x, south - y2, x2 - room.x, south - y1
            case "east":
                return y1 - room.y, x1 - room.x, y2 - room.y, x2 - room.x
            case "south":
                return east - x2, y1 - room.y, east - x1, y2 - room.y
            case _:
                return south - y2, east - x2, south - y1, east - x1

    width, depth = framed(room)[2:]
    door = framed(room.door)[0]
    found = {"room.width": width, "room.depth": depth, "door.left": door}
    left, right, front, back = [0.0], [width], [0.0], [depth]
    atoms = [atom for _, atom in family.builder.placer.pieces(layout)]
    places = {(*map(str, atom.arguments[:2]),): atom.arguments[2].name for atom in atoms if atom.name == "on"}
    for name, piece, atom in zip(part_names([p.type for p in room.pieces]), room.pieces, atoms, strict=True):
        x1, y1, x2, y2 = framed(piece)
        place = places[(*map(str, atom.arguments[:2]),)]
        match place:
            case "left":
                along, out, start = y2 - y1, x2 - x1, y1
                left.append(x2)
            case "right":
                along, out, start = y2 - y1, x2 - x1, y1
                right.append(x1)
            case "back":
                along, out, start = x2 - x1, y2 - y1, x1
                back.append(y1)
            case "front_left" | "front_right":
                along, out, start = x2 - x1, y2 - y1, x1 if place == "front_left" else width - x2
                front.append(y2)
            case _:
                found |= {f"{name}.across": x1, f"{name}.inwards": y1}
                sideways = {"left", "right"} & {
                    atom.arguments[3].name if atom.name == "with" else "",
                    *(a.arguments[2].name for a in layout.furniture if a.name == "faces" and atom.name == "on"
                      and a.arguments[:2] == atom.arguments[:2]),
                }  # fmt: skip
                along, out, start = (y2 - y1, x2 - x1, 0) if sideways else (x2 - x1, y2 - y1, 0)
        turned = atom.name == "on" and any(
            each.name == "turned" and each.arguments[:2] == atom.arguments[:2] for each in layout.furniture
        )
        found |= {f"{name}.length": out if turned else along, f"{name}.depth": along if turned else out}
        if place != "middle":
            found[f"{name}.along"] = start
    return found | {
        "floor.left": max(left),
        "floor.right": min(right),
        "floor.front": max(front),
        "floor.back": min(back),
    }


def test_lengths_are_those_of_the_house_and_lie_between_their_bounds(family: Explained) -> None:
    for target in family.targets()[1:]:
        number, _ = target_in(family.house, target)
        assert number is not None
        measured = measures(family, number)
        thing = target.partition(".")[2] or "room"
        lengths = family.why(target).lengths
        assert lengths
        for length in lengths:
            assert length.value == pytest.approx(measured[f"{thing}.{length.name}"], abs=1e-6)
            assert length.least - 1e-6 <= length.value <= length.greatest + 1e-6


def test_bounds_that_are_tight_are_equations_of_the_plan(family: Explained) -> None:
    checked = 0
    for target in family.targets()[1:]:
        number, _ = target_in(family.house, target)
        assert number is not None
        measured = measures(family, number)
        for bound in family.why(target).tight:
            left, right = (value(side, measured) for side in re.split(" <?= ", bound.text))
            assert left == pytest.approx(right, abs=1e-6), (target, bound.text)
            checked += 1
    assert checked > 10


def value(text: str, measured: dict[str, float]) -> float:
    """Return the value of a sum such as ``0.7 room.depth + bed.along + 0.42``."""
    total = 0.0
    for term in text.split(" + "):
        factor, _, name = term.rpartition(" ")
        total += float(factor or 1) * (measured[name] if "." in name and name[0].isalpha() else float(name))
    return total


def test_the_main_room_lies_between_what_its_rooms_need_and_what_is_allowed(family: Explained) -> None:
    width, height = family.why("main").lengths
    floor = family.house.star.floor
    assert (width.value, height.value) == (floor.width, floor.height)
    rooms = fixed_rooms(family.house)
    for length, sides in ((width, ("north", "south")), (height, ("east", "west"))):
        assert length.least <= length.value <= length.greatest
        for side in sides:
            there = [room for room in rooms if room.side == side]
            # From the first door to the last, regardless of anything beyond them.
            needed = sum(room.width for room in there) + 0.6 * (len(there) - 1)
            if there:
                needed -= there[0].door + there[-1].width - there[-1].door - 0.762
            assert length.least >= needed - 1e-6


# Houses that the rules do not generate, fixed rooms, grids


def test_an_edited_house_is_refused(builder: Builder, family: Explained) -> None:
    moved = msgspec.structs.replace(family.house.star.rooms[0], x=family.house.star.rooms[0].x + 0.01)
    edited = changed_star(family.house, rooms=(moved, *family.house.star.rooms[1:]))
    with pytest.raises(HouseFileError, match="seed 24, house 0: it was edited"):
        StarWitness(builder, edited)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"grammar_hash": "0" * 64, "index": 1}, "other rules than those in"),
        ({"versions": {"clingo": "1"}, "index": 1}, "other versions, {'clingo': '1'}, not"),
        ({"request": {"rooms": 1, "types": {"palace": 1}}}, "there is no room type palace"),
    ],
)
def test_a_house_of_other_rules_is_refused(
    builder: Builder, family: Explained, changes: dict, words: str
) -> None:
    assert family.house.provenance
    other = msgspec.structs.replace(family.house.provenance, **changes)
    with pytest.raises(HouseFileError, match=words):
        StarWitness(builder, msgspec.structs.replace(family.house, provenance=other))


def test_a_house_without_provenance_is_refused(family: Explained) -> None:
    with pytest.raises(HouseFileError, match="the house file does not name its rules: use"):
        explain_house(msgspec.structs.replace(family.house, provenance=None), "R0")


@pytest.mark.parametrize(
    ("target", "words"),
    [
        ("R9", "there is no R9: .*the house has main, R0"),
        ("R11", "there is no R11: did you mean R1?"),
        ("R{bedroom}.bde", r"did you mean R\d.bed\? R\d has door, "),
        ("R{bedroom}.bed7", r"there is no R\d.bed7: did you mean"),
        ("main.door", "the main room has no parts"),
    ],
)
def test_a_part_that_is_not_there_is_refused_with_what_is(family: Explained, target: str, words: str) -> None:
    bedroom = [room.type for room in family.house.star.rooms].index("bedroom")
    with pytest.raises(RequestError, match=words):
        target_in(family.house, target.format(bedroom=bedroom))


def test_the_second_of_a_kind_has_a_number() -> None:
    bed = Piece(0, 0, 1, 1, "bed")
    sofa = Piece(0, 0, 1, 1, "sofa", "N", (bed,))
    room = StarRoom(0, 0, 9, 9, "bedroom", (bed, sofa, bed), Rect(1, 0, 1, 0))
    house = House.of_star(Star(Rect(0, 9, 9, 9), (room,)))
    targets = {
        "R0.bed": 0,
        "R0.bed1": 0,
        "R0.bed2": 2,
        "R0.bed.2": 2,
        "R0.sofa": 1,
        "R0.bed.3": 3,
        "R0": None,
    }
    assert {target: target_in(house, target)[1] for target in targets} == targets


def test_a_fixed_room_says_that_the_request_keeps_it(builder: Builder, family: Explained) -> None:
    kept = msgspec.to_builtins(family.house.star.rooms[1])
    house = Explained(builder, {"rooms": 4, "keep": [kept]}, 0)
    number = house.house.star.rooms.index(family.house.star.rooms[1])
    for target in (f"R{number}", f"R{number}.door"):
        assert "the request keeps it (keep)" in house.why(target).about
        assert not house.why(target).lengths
    assert any(
        "keep:" in r.text for c in house.why(f"R{number}").choices for o in c.instead for r in o.because
    )
    assert "between the rooms that the request keeps" in house.why("main").about


@pytest.fixture
def on_grid() -> Iterator[Explained]:
    """Yield a house on a grid. At the end a builder without a grid resets the process's one Prolog engine."""
    yield Explained(in_process.builder("family", 0.3), {"rooms": 3, "cell": 0.3}, 1)
    in_process.builder("family")


def test_on_a_grid_bounds_are_whole_cells(on_grid: Explained) -> None:
    for target in ("main", "R0.door", "R1.door", "R2.door"):
        for length in on_grid.why(target).lengths:
            for metres in (length.value, length.least, length.greatest):
                assert metres / 0.3 == pytest.approx(round(metres / 0.3), abs=1e-6)


# The command


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Callable[..., tuple[int, str, str]]:
    def command(*arguments: str) -> tuple[int, str, str]:
        with pytest.raises(SystemExit) as end:
            main(["explain", *arguments])
        out, err = capsys.readouterr()
        return int(end.value.code or 0), out, err

    return command


def test_the_command_answers_as_the_library_does(
    family: Explained, tmp_path: Path, run: Callable[..., tuple[int, str, str]]
) -> None:
    file = tmp_path / "houses.jsonl"
    save([msgspec.structs.replace(family.house, provenance=None), family.house], file)
    target = next(target for target, _, piece in family.pieces() if piece.children)
    code, out, _ = run(str(file), "--why", target, "--house", "1", "--json")
    assert code == 0
    found, schema = json.loads(out), Path(__file__).parents[3] / "docs" / "answers.schema.json"
    jsonschema.validate(found, json.loads(schema.read_text()))
    assert msgspec.convert(found["answer"]["why"], Why) == family.why(target)


def test_the_answer_reads_as_sections_with_files_and_lines(family: Explained) -> None:
    target = next(target for target, _, piece in family.pieces() if piece.children)
    text = str(family.why(target))
    for words in (
        f"{target}: a ",
        "\nDerived from facts and picks\n",
        "\nAlternatives, with all other picks unchanged\n",
        "\nLengths, and their possible ranges\n",
        " m, of ",
    ):
        assert words in text
    assert re.search(r"\n +pick\(count\(\w+\),\d\) +picked out of .*; rules/room/room.lp:\d+: option\(", text)
    assert re.search(r"\n +may\(\w+,\w+,\d,\d\) +furniture.lp:\d+: may\(", text)


def test_a_choice_is_explained_once_by_the_comment_above_it(family: Explained) -> None:
    text = str(family.why(f"R{len(family.house.star.rooms) - 1}"))
    assert "pick(bars," in text
    assert text.count("the rooms in a row, cut by three bars into the four sides.") == 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "explain --rooms 3 .* or a part of a house"),
        (("--why", "R0"), "explain --rooms 3 .* or a part of a house"),
        (("HOUSES",), ": name a part with --why"),
        (("HOUSES", "--why", "R0", "--rooms", "3"), "--rooms: for a request, not for"),
        (("HOUSES", "--why", "R0", "--house", "1"), "has houses 0 to 0"),
    ],
)
def test_a_command_that_asks_for_two_things_or_none_is_refused(
    family: Explained,
    tmp_path: Path,
    run: Callable[..., tuple[int, str, str]],
    arguments: tuple[str, ...],
    words: str,
) -> None:
    file = tmp_path / "houses.jsonl"
    save([family.house], file)
    code, _, error = run(*(str(file) if each == "HOUSES" else each for each in arguments))
    assert code == 2
    assert re.search(words, error)
