"""Explanations of parts of a plan: rooms on shared walls, doors, the entrance, windows, furniture."""

import msgspec
import pytest
from clingo import Function, parse_term

from tests.logic.why.derivations import require_whole
from tests.logic.workers.in_process import builder
from vitruvius.logic import House, HouseFileError, RequestError
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.house.part_names import doors_by_name, target_in
from vitruvius.logic.house.parts import OUTSIDE, Door, Window
from vitruvius.logic.request.given_plan import read_plan
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.why.answer import Why
from vitruvius.logic.why.shared_walls import PlanWitness

INFERENCES = 10**8


class Explained:
    """Plan with explanations, in this process."""

    def __init__(self, home: Builder, request: HouseRequest, seed: int) -> None:
        self.builder, self.request = home, request
        self.house = home.house(request, seed, 0)
        self.witness = PlanWitness(home, self.house)
        self.answers: dict[str, Why] = {}

    def why(self, target: str) -> Why:
        if target not in self.answers:
            self.answers[target] = self.witness.why(target)
        return self.answers[target]

    def door(self) -> str:
        return next(name for name, door in doors_by_name(self.house).items() if not door.is_entrance)

    def window(self) -> Window:
        return self.house.windows[0]

    def piece(self) -> str:
        room = max(self.house.rooms, key=lambda each: len(each.children))
        return f"{room.name}.{room.children[0].type}"

    def targets(self) -> list[str]:
        return ["R1", self.door(), "entrance", f"{self.window().room}.window", self.piece()]


@pytest.fixture(scope="module")
def home() -> Builder:
    return builder("home")


@pytest.fixture(scope="module")
def four(home: Builder) -> Explained:
    """Return four rooms, the fewest of a home."""
    return Explained(home, HouseRequest(4), 5)


@pytest.mark.second_part("a large plan")
def test_every_part_of_a_plan_is_derived_from_facts_and_picks_by_rules_in_files(four: Explained) -> None:
    for target in four.targets():
        nodes = [node for tree in four.why(target).derivations for node in tree.all()]
        assert any(node.options for node in nodes), target
        require_whole(nodes, target)
    about = {
        target: {tree.atom.split("(")[0] for tree in four.why(target).derivations}
        for target in four.targets()
    }
    assert [{"room", "edge"} <= about["R1"], about[four.door()], about["entrance"]] == [
        True,
        {"door"},
        {"entrance"},
    ]


def test_what_could_be_instead_can_and_what_could_not_cannot(four: Explained) -> None:
    """Stage 1's own program confirms them, with the other picks and with the named changes."""
    program, granted = four.builder.programs.rooms_for(four.request)
    assert program.models
    picks = [atom for atom in program.models[-1][1] if atom.match("pick", 2)]
    possible = impossible = named = 0
    for target in four.targets()[:4]:
        for choice in four.why(target).choices:
            for other in choice.instead:
                kept = [pick for pick in picks if str(pick.arguments[0]) != choice.name]
                asked = Function("pick", [parse_term(choice.name), parse_term(other.value)])
                # Stage 2 may forbid choices that stage 1 permits.
                lengths = any((reason.file or "").endswith(".pl") for reason in other.because)
                assert program.possible([*granted, *kept, asked]) == other.possible or lengths
                assert other.possible or other.because
                possible, impossible = possible + other.possible, impossible + (not other.possible)
                if other.also and not other.also[0].startswith("more than"):
                    fewer = [pick for pick in kept if str(pick.arguments[0]) not in other.also]
                    assert program.possible([*granted, *fewer, asked])
                    named += 1
    assert min(possible, impossible, named) > 0


def test_a_room_could_be_as_large_as_any_house_of_the_same_layout_has_it(four: Explained) -> None:
    """Walls are sampled again: no size exceeds the bounds, and some come near them."""
    layout = four.builder.origin
    assert layout
    why = {length.name: length for length in four.why("R1").lengths}
    room = four.house.room("R1")
    assert (why["width"].value, why["height"].value) == pytest.approx((room.width, room.height))
    plans = [four.builder.placer.walls(layout.layout, seed, INFERENCES) for seed in range(200)]
    for name, length in why.items():
        sizes = [getattr(plan.rooms[1], name) for plan in plans]
        assert (
            length.least - 1e-6 <= min(sizes) <= length.least + 0.3 * (length.greatest - length.least) + 1e-6
        )
        assert (
            length.greatest + 1e-6
            >= max(sizes)
            >= length.greatest - 0.3 * (length.greatest - length.least) - 1e-6
        )
        assert any((reason.file or "").endswith("sizes.pl") for reason in (*length.no_less, *length.no_more))


def test_a_door_and_a_window_lie_as_far_as_their_wall_and_its_margins_let_them(four: Explained) -> None:
    for target in (four.door(), "entrance", f"{four.window().room}.window"):
        _, part = target_in(four.house, target)
        assert isinstance(part, Door | Window)
        size, place = four.why(target).lengths
        assert size.value == pytest.approx(part.length)
        assert place.value == pytest.approx(getattr(part, place.name))
        names = part.between if isinstance(part, Door) else (part.room, OUTSIDE)
        rooms = [four.house.room(name) for name in names if name != OUTSIDE]
        axis = "xy".index(place.name)
        low, high = max(room.box[axis] for room in rooms), min(room.box[axis + 2] for room in rooms)
        margin = 0.1 if isinstance(part, Door) else 0.65
        assert place.least == pytest.approx(low + margin)
        assert place.greatest == pytest.approx(high - margin - part.length)
        assert (size.least, size.greatest) == (0.8, 0.8) or isinstance(part, Window)


def test_bounds_that_are_tight_are_on_lines_of_the_room_s_own_walls(four: Explained) -> None:
    why = four.why("R1")
    edges = [parse_term(tree.atom).arguments for tree in why.derivations if tree.atom.startswith("edge")]
    own = {f"{line}.{'y' if side.name in ('north', 'south') else 'x'}" for _, side, line in edges}
    for bound in why.tight:
        assert any(line in bound.text for line in own), bound.text
        assert bound.because


def test_names_of_doors_work_both_ways_and_what_is_not_there_is_refused_with_what_is(four: Explained) -> None:
    name = four.door()
    one, other = name.split("-")
    assert target_in(four.house, f"{other}-{one}") == target_in(four.house, name)
    (entrance,) = four.house.doors_of(OUTSIDE)
    assert target_in(four.house, "entrance")[1] == entrance
    assert target_in(four.house, "-".join(entrance.between))[1] == entrance
    for target, words in (
        ("R9", f"there is no R9: .*the house has R0, R1, R2, R3, .*{name}"),
        ("main", "there is no main: .*entrance"),
        (f"{one}.door", f"both its rooms: {one} has .*{name}"),
        ("entrance.bed", "a door has no parts"),
        (f"{four.window().room}.windw", f"did you mean {four.window().room}.window"),
    ):
        with pytest.raises(RequestError, match=words):
            target_in(four.house, target)


def test_in_a_plan_of_the_users_rooms_are_where_it_says(home: Builder, four: Explained) -> None:
    plan = read_plan(four.house)
    own = Explained(home, HouseRequest(4, plan=msgspec.structs.replace(plan, windows=())), 0)
    room, door, window = (own.why(target) for target in ("R1", own.door(), f"{own.window().room}.window"))
    assert "the plan says where it is" in room.about
    assert not room.lengths
    because = [reason.text for choice in room.choices for other in choice.instead for reason in other.because]
    assert "plan: R0 is of type living" in because
    assert "the plan has it there" in door.about
    assert not door.lengths
    assert window.lengths


def test_an_edited_plan_is_refused(home: Builder, four: Explained) -> None:
    edited = msgspec.structs.replace(four.house, windows=())
    assert isinstance(edited, House)
    with pytest.raises(HouseFileError, match="seed 5, house 0: it was edited"):
        PlanWitness(home, edited)
