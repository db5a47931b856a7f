"""The steps of the makers by themselves: what they learn, when they give up, what they refuse."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from clingo import Function, Number, parse_term

from tests.logic.request.test_given_plan import BOXES, geojson
from vitruvius.logic.errors import LimitReached, RequestError
from vitruvius.logic.generation import builder as building
from vitruvius.logic.generation import movable_doors
from vitruvius.logic.generation.brief import brief_maker, name_rooms
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.generation.furnish import GivenRoom, Unfurnishable
from vitruvius.logic.generation.given_plan import PATIENCE, DoorPlaces, GivenPlanDraft
from vitruvius.logic.generation.movable_doors import LooseRoom
from vitruvius.logic.generation.shared_walls import at_face
from vitruvius.logic.generation.star import StarDraft
from vitruvius.logic.generation.tiling import require_tiling
from vitruvius.logic.generation.unit import Unit
from vitruvius.logic.generation.units import alike
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import Rect, Room
from vitruvius.logic.layout.program import Conflict
from vitruvius.logic.placement.plan import Plan, PlanDoor, PlanRoom, sides
from vitruvius.logic.request.given_plan import read_plan
from vitruvius.logic.request.house_request import HouseRequest

DEN = GivenRoom("den", Rect(1, 1, 4, 3), [Rect(2, 4, 0.9, 0)])
NO_MOVE = LooseRoom(DEN, [None])
FOUR = HouseRequest(4)


def stub(**fields: Any) -> Any:
    """Return an object with these attributes."""
    return SimpleNamespace(**fields)


# - stars -----------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("fixed", "has_area", "words"),
    [
        ((), True, "left the main room an area outside house_area/2, but others might fit"),
        ((1,), False, "did not fit between the fixed rooms, but smaller ones might"),
        (
            (1,),
            True,
            "did not fit between the fixed rooms, or left the main room an area outside",
        ),
    ],
)
def test_rooms_that_do_not_fit_are_told_with_what_they_stand_between(
    fixed: tuple[int, ...], has_area: bool, words: str
) -> None:
    draft = stub(_loaded=stub(has_area=has_area), _request=stub(fixed=fixed))
    assert StarDraft._misfit(draft).startswith(f"the sampled rooms {words}")


# - walls of a thickness, plans by a user's topology ------------------------------------------------------
@pytest.mark.parametrize(
    ("door", "face"),
    [
        (Rect(5.1, 2, 0, 0.9), Rect(5, 2, 0, 0.9)),
        (Rect(0.9, 2, 0, 0.9), Rect(1, 2, 0, 0.9)),
        (Rect(2, 4.1, 0.9, 0), Rect(2, 4, 0.9, 0)),
        (Rect(2, 0.9, 0.9, 0), Rect(2, 1, 0.9, 0)),
    ],
)
def test_a_door_within_a_thick_wall_is_seen_at_the_face_of_the_room(door: Rect, face: Rect) -> None:
    assert at_face(door, DEN.rect, 0.1) == face


def test_rooms_that_overlap_are_told_with_the_edges_that_bring_them_there() -> None:
    rooms = [Room(0, 0, 4, 4, "R0", "den"), Room(3, 0, 4, 4, "R1", "den"), Room(7, 0, 2, 4, "R2", "den")]
    layout = "edge(0,east,a) edge(1,west,b) edge(1,east,c) edge(2,west,c) edge(0,north,outline(north)) hub(0)"

    def of_topology(why: str, edges: list[Any]) -> Exception:
        return RequestError(" ".join(map(str, edges)))

    loaded: Any = stub(rules=stub(topology_error=of_topology))
    with pytest.raises(RequestError) as told:
        require_tiling(House(tuple(rooms)), [parse_term(text) for text in layout.split()], loaded)
    assert str(told.value) == "edge(0,east,a) edge(1,west,b) edge(1,east,c)"


# - briefs --------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("states", "words"),
    [
        ({"depths": (8.0, 9.0)}, "have units: choose another grammar"),
        (
            {"has_area": True, "voids": (1,)},
            "house_area/2, which applies only to rectangular houses: leave out the voids",
        ),
        ({"has_area": True, "outdoor": True}, "outdoor"),
        ({"wholes": [1]}, "states whole_area/3"),
        ({"has_area": True, "wall_thickness": 0.1}, "and a brief does not support"),
    ],
)
def test_a_brief_is_refused_where_the_grammar_states_what_it_cannot_keep(
    states: dict[str, Any], words: str
) -> None:
    said = {"depths": None, "has_area": False, "outdoor": False, "voids": (), "wholes": []} | states
    placer = stub(
        ask=lambda *_: {"wholes": said["wholes"]}, wall_thickness=said.get("wall_thickness"), account=None
    )
    loaded = stub(**said, placer=placer, furniture={})
    with pytest.raises(RequestError, match=words):
        brief_maker(stub(name="mine"), loaded, stub(outline=stub(voids=said["voids"])))


def test_rooms_have_the_names_of_the_brief_and_its_labels_or_their_types() -> None:
    rooms = [PlanRoom(0, 0, 4, 4, 0, "den"), PlanRoom(4, 0, 4, 4, 1, "bath")]
    name_rooms(rooms, stub(rooms=[stub(name="Work", label="study"), stub(name="Tub", label="")]))
    assert [(room.name, room.type) for room in rooms] == [("Work", "study"), ("Tub", "bath")]


# - given plans ---------------------------------------------------------------------------------------
PLAN = read_plan(geojson(BOXES))


def test_a_door_that_the_plan_does_not_have_may_stand_in_all_of_its_wall() -> None:
    names = [room.name for room in PLAN.rooms]
    rooms = [PlanRoom(*sides(room), number, "den", room.name) for number, room in enumerate(PLAN.rooms)]
    hall, living, bedroom = map(names.index, ("hall", "living", "bedroom"))
    plan = Plan(rooms, [], [])
    draft: Any = stub(plan=PLAN, placer=stub(wall_thickness=None))
    box = PLAN.rooms[hall].box

    def span(door: PlanDoor) -> tuple[float, ...]:
        found = GivenPlanDraft._span(draft, plan, door)
        assert found is not None
        return found.box

    upright = PlanDoor(box[0], box[1] + 1, 0, 0.9, (hall, living))
    assert span(upright) == pytest.approx((box[0], box[1], box[0], box[3]))
    south = next(wall for wall in PLAN.walls if (wall.room, wall.behind) == (hall, bedroom))
    lying = PlanDoor(box[0] + 0.5, south.place, 0.9, 0, (hall, bedroom))
    assert span(lying) == pytest.approx((box[0], south.place, box[2], south.place))


def test_a_refuted_room_takes_its_own_place_and_doors_of_the_plan() -> None:
    draft: Any = stub(plan=PLAN)
    drawn = GivenPlanDraft._granted(draft, {0, 2, "outside"}, "drawn")
    assert [atom.arguments[0].arguments[0] for atom in drawn] == [Number(0), Number(2)]
    assert {atom.arguments[0].name for atom in drawn} == {"drawn"}
    assert GivenPlanDraft._granted(draft, {0}, "joined") == ()


def test_a_refuted_room_takes_the_rooms_behind_its_walls_where_a_door_leads_outside() -> None:
    near: list[Any] = []
    program = stub(atoms=lambda *_: [])
    hall = next(number for number, room in enumerate(PLAN.rooms) if room.name == "hall")
    other = next(wall.behind for wall in PLAN.walls if wall.room == hall and wall.behind is not None)

    def refuted(between: tuple[int | str, int | str]) -> set[Any]:
        draft: Any = stub(
            plan=PLAN,
            draft=stub(request=FOUR),
            programs=stub(rooms_for=lambda _: (program, [])),
            _granted=lambda rooms, kind: near.append((kind, {*rooms})) or (),
        )
        plan: Any = stub(doors_of=lambda _: [stub(between=between)], name=lambda _: "hall")
        GivenPlanDraft._refutation(draft, plan, [], hall, NO_MOVE, windows=False)
        (_, of_drawn), (_, of_joined) = near[-2:]
        assert of_joined == {hall}
        return of_drawn

    assert refuted((hall, other)) == {hall, other}
    behind = {wall.behind for wall in PLAN.walls if wall.room == hall}
    assert refuted((hall, "outside")) == {hall, "outside"} | behind


def test_a_room_with_an_opening_that_no_user_drew_keeps_its_doors() -> None:
    plan: Any = stub(doors_of=lambda _: [stub(opening=True)])
    draft: Any = stub(_span=lambda *_: Rect(0, 0, 1, 0))
    assert not GivenPlanDraft._moved(draft, plan, [], 0)


def given(**of_draft: Any) -> Any:
    """Return a house in a plan at work, with these attributes of its draft."""
    return GivenPlanDraft(
        stub(placer=None, rules=stub(programs=None), work=None, failures=0, **of_draft), PLAN
    )


@pytest.mark.parametrize("movable", [True, False])
def test_doors_are_moved_once_a_room_has_failed_often(movable: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    moves: list[bool] = []

    def furnished(*_: Any) -> list[str]:
        if moves and movable:
            return ["furnished"]
        raise Unfurnishable(0, DEN)

    monkeypatch.setattr(GivenPlanDraft, "_moved", lambda *_: moves.append(True) or movable)
    draft, plan = given(furnish=furnished), stub()
    for attempt in range(1, PATIENCE + 1):
        assert not moves
        if attempt == PATIENCE and movable:
            assert draft.furnish([], plan) == ["furnished"]
        else:
            with pytest.raises(Unfurnishable):
                draft.furnish([], plan)
        draft.draft.failures += 1
    assert moves == [True]


def test_after_a_search_for_doors_at_its_limit_no_other_follows(monkeypatch: pytest.MonkeyPatch) -> None:
    def unknown(self: GivenPlanDraft, *_: Any) -> bool:
        assert self.doors is DoorPlaces.SEARCHED
        self.doors = DoorPlaces.UNKNOWN
        return False

    def fails(*_: Any) -> None:
        raise Unfurnishable(0, DEN)

    monkeypatch.setattr(GivenPlanDraft, "_moved", unknown)
    draft, plan = given(furnish=fails), stub()
    draft.draft.failures = PATIENCE - 1
    for _ in range(2):
        with pytest.raises(Unfurnishable):
            draft.furnish([], plan)


# - rooms whose doors move --------------------------------------------------------------------------------
def fits_at(attempt: int) -> tuple[Any, Any]:
    """Return programs and a placer that refute a room's layouts before this attempt; 0 for no layout."""
    layouts = [[Function("layout", [Number(number)])] for number in range(1, attempt + 1)]

    def sample(*arguments: Any) -> Any:
        tried = len(arguments[-1])
        return layouts[tried] if tried < len(layouts) else None

    def conflict(term: Any) -> Conflict | None:
        (atom,) = term.arguments[2]
        return None if atom == layouts[-1][0] else Conflict({atom: True}, ())

    programs = stub(required_in=lambda *_: (), given=lambda *_: stub(sample=sample))
    return programs, stub(loose_conflict=conflict)


def test_a_room_whose_doors_move_gets_the_first_layout_that_has_places() -> None:
    rng = np.random.default_rng(0)
    for attempt in (1, 3):
        assert NO_MOVE.furniture(*fits_at(attempt), rng, FOUR, True) == [
            Function("layout", [Number(attempt)])
        ]
    assert NO_MOVE.furniture(*fits_at(0), rng, FOUR, True) is None


def test_nothing_is_known_of_a_room_past_a_number_of_layouts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(movable_doors, "MOST_LAYOUTS", 3)
    rng = np.random.default_rng(0)
    assert NO_MOVE.furniture(*fits_at(3), rng, FOUR, True)
    with pytest.raises(LimitReached, match=r"^3 layouts of a den of .* m with 1 door have no places"):
        NO_MOVE.furniture(*fits_at(4), rng, FOUR, True)


# - units -----------------------------------------------------------------------------------------------
def test_a_unit_that_is_refuted_is_refuted_under_every_number_that_knows_it() -> None:
    like = "unit({0},5) share({0},bath,1) way({0},south,0) deep({0},y,rows) inner({0},south) inner({0},east)"
    first, second = ([parse_term(text) for text in like.format(number).split()] for number in (1, 2))
    others = [parse_term(text) for text in ("unit(3,5)", "unit(1,6)", "edge(1,south,a)")]
    known = [*first, *second, *others]
    program = stub(atoms=lambda name, arity: {atom for atom in known if atom.match(name, arity)})
    unit = Unit(1, HouseRequest(5), "y", 7.3, 0, "south", frozenset({"south", "east"}))
    found = [*alike(program, unit, [*first, others[2]])]
    lacks = [
        {Function("inner", [Number(number), Function(side)]): False for side in ("west", "north")}
        for number in (1, 2)
    ]
    assert found == [dict.fromkeys(first, True) | lacks[0], dict.fromkeys(second, True) | lacks[1]]


# - houses --------------------------------------------------------------------------------------------
def test_each_house_begins_its_account_and_knows_what_made_it() -> None:
    begun: list[str] = []
    maker = stub(made=lambda request, work: (House((Room(0, 0, 4, 4, "R0", "den"),)), "its layout"))
    builder: Any = stub(
        account=stub(begin=lambda: begun.append("account")),
        maker_of=lambda _: maker,
        _provenance=lambda request, seed, index: stub(seed=seed, index=index),
    )
    made = Builder.house(builder, FOUR, 7, 2)
    assert (begun, builder.origin) == (["account"], "its layout")
    assert (made.provenance.seed, made.provenance.index) == (7, 2)  # pyright: ignore[reportOptionalMemberAccess]


def asks_nothing(wholes: list[Any]) -> Any:
    """Return a placer of a grammar that states these areas of rooms with their parts."""
    return stub(ask=lambda *_: {"wholes": wholes})


@pytest.mark.parametrize(
    "states",
    [
        {"has_area": True},
        {"wholes": [1]},
        {"plan": "a plan"},
        {"cell": 0.5},
        {"depths": (8, 9)},
        {"shares_walls": False},
        {},
    ],
)
def test_all_sizes_are_looked_at_where_walls_are_shared_and_areas_are_of_single_rooms(
    states: dict[str, Any],
) -> None:
    said = {"has_area": False, "wholes": [], "plan": None, "cell": 0.0, "depths": None, "shares_walls": True}
    each = stub(**said | states, furniture={})
    builder: Any = stub(loaded=each, grammar=each, placer=asks_nothing(each.wholes))
    assert Builder.decides_areas(builder, each) is (not states)


def test_promises_are_those_of_the_program_or_in_a_brief_of_its_maker(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(building, "promises_of", lambda program, *_, stated: f"promises of {program}")
    programs = iter(("one", "two", "three", "four"))

    class OneMaker:
        def stated(self, request: Any) -> str:
            return next(programs)

    maker, loaded = OneMaker(), stub(furniture={}, extremes={}, depths=None)
    builder: Any = stub(
        maker_of=lambda _: maker,
        loaded=loaded,
        placer=asks_nothing([]),
        grammar=stub(shares_walls=True),
        _promises={},
    )
    plain, brief = stub(brief=None, plan=None), stub(brief=stub(rooms=()), plan=None)
    promises = [Builder.promises(builder, each) for each in (plain, plain, brief, brief)]
    assert promises == [f"promises of {program}" for program in ("one", "two", "three", "three")]
