"""Stage 1: permitted layouts, sampled by weight and by their random numbers alone."""

from collections import Counter
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from clingo import Function, Number, Symbol
from scipy.stats import chisquare

from tests.logic.generation.test_shared_walls import ROW, copied
from tests.logic.workers.in_process import builder
from vitruvius.logic import GrammarError
from vitruvius.logic.generation.loop import NoLayout
from vitruvius.logic.grammar import find
from vitruvius.logic.layout.branching import Brancher
from vitruvius.logic.layout.program import Program
from vitruvius.logic.layout.terms import granted, parts, requirements
from vitruvius.logic.request.house_request import HouseRequest

FAMILY = find("family")
CHOICE = """
#program toys.
option(colour,red,1).  option(colour,blue,1).  option(colour,green,2).
option(size,(small;large),1).
option(hand,1..4,1).  picks(hand,2).
:- pick(colour,red), pick(size,large).
#show pick/2.
"""


def program(folder: Path, text: str) -> Program:
    file = folder / "rules.lp"
    file.write_text(text)
    return Program([file], {}, [("toys", [])])


def house(rooms: int, **types: int) -> tuple[Program, list[Symbol]]:
    required = requirements("among", {name: (count, count) for name, count in types.items()})
    made = Program(FAMILY.asp, {"rooms": rooms}, [("house", []), *parts(required)])
    return made, [granted(each) for each in required]


def samples(made: Program, count: int) -> list[tuple[str, ...]]:
    found = (made.sample(np.random.default_rng([7, i])) for i in range(count))
    return [tuple(map(str, layout or ())) for layout in found]


def test_a_layout_picks_as_many_values_as_each_variable_wants(tmp_path: Path) -> None:
    for layout in samples(program(tmp_path, CHOICE), 50):
        picks = Counter(atom.split("(")[1].split(",")[0] for atom in layout if atom.startswith("pick"))
        assert (picks["colour"], picks["size"], picks["hand"]) == (1, 1, 2)


def test_every_layout_that_the_rules_allow_is_sampled_and_no_other(tmp_path: Path) -> None:
    found = {
        (atom("colour", layout), atom("size", layout)) for layout in samples(program(tmp_path, CHOICE), 300)
    }
    assert found == set(product(["red", "blue", "green"], ["small", "large"])) - {("red", "large")}


def atom(name: str, layout: tuple[str, ...]) -> str:
    return next(text.split(",")[1].rstrip(")") for text in layout if text.startswith(f"pick({name},"))


def test_values_are_sampled_in_proportion_to_their_weights(tmp_path: Path) -> None:
    free = CHOICE.replace(":- pick(colour,red), pick(size,large).", "")
    seen = Counter(atom("colour", layout) for layout in samples(program(tmp_path, free), 2000))
    assert chisquare([seen["red"], seen["blue"], seen["green"]], [500, 500, 1000]).pvalue > 1e-3


@pytest.fixture(scope="module")
def worn() -> Program:
    """Return a program that was sampled for hundreds of houses, each with a nogood of its own."""
    made = bedroom()
    for seed in range(510):  # more searches than between two times of forgetting
        first = made.sample(np.random.default_rng(seed))
        assert first
        assert made.sample(np.random.default_rng(seed), nogoods=[dict.fromkeys(first, True)]) != first
    return made


def bedroom() -> Program:
    return Program(FAMILY.asp, {"this_room": "bedroom"}, [("room", [])], arguments=["--stats=2"])


def size(made: Program) -> tuple[int, int, int]:
    """Return the solver's numbers of variables, constraints, and learnt nogoods that it keeps."""
    made.end_search()
    statistics = made._control.statistics
    problem, learnt = statistics["problem"]["generator"], statistics["accu"]["solving"]["solvers"]["extra"]
    return problem["vars"], problem["constraints"], learnt["lemmas"] - learnt["lemmas_deleted"]


def test_a_sampled_layout_depends_on_its_random_numbers_alone(worn: Program) -> None:
    """The layout depends neither on earlier samples nor on the nogoods of other houses."""
    fresh = bedroom()
    for seed in range(1000, 1040):
        assert worn.sample(np.random.default_rng(seed)) == fresh.sample(np.random.default_rng(seed))


def test_a_solver_is_as_small_after_hundreds_of_houses_as_after_one(worn: Program) -> None:
    """Nogoods end with their house, and learnt ones are deleted. Otherwise each house would be slower."""
    fresh = bedroom()
    fresh.sample(np.random.default_rng(0))
    (variables, constraints, _), (worn_variables, worn_constraints, learnt) = size(fresh), size(worn)
    assert worn_variables <= variables
    assert worn_constraints <= constraints
    assert learnt < 1500  # of about 2,000


def test_one_search_gives_the_layouts_of_many() -> None:
    """The search continues past the time of forgetting, and no layout depends on earlier ones."""
    made, single = bedroom(), bedroom()
    for seed in range(1010):
        layout = made.sample(np.random.default_rng(seed))
        if seed % 20 == 0 or seed > 995:
            single.end_search()
            assert layout == single.sample(np.random.default_rng(seed))


def test_a_program_can_be_asked_anything_between_two_layouts() -> None:
    made, assumed = house(4, bedroom=2)
    fresh, _ = house(4, bedroom=2)
    wanted = [fresh.sample(np.random.default_rng(seed)) for seed in range(3)]
    assert made.possible(assumed)
    assert made.sample(np.random.default_rng(0)) == wanted[0]
    assert made.sample(np.random.default_rng(9), assumed)
    assert not made.possible(without=made.atoms("room", 2))
    assert made.sample(np.random.default_rng(1)) == wanted[1]
    assert made.sample(np.random.default_rng(9), without=made.atoms("room", 2)) is None
    assert made.sample(np.random.default_rng(2)) == wanted[2]


def test_a_program_with_one_layout_gives_it_again_and_again(tmp_path: Path) -> None:
    """Nothing is left to choose, so a search has no further model."""
    made = program(tmp_path, "#program toys. option(colour,red,1). #show pick/2.")
    assert samples(made, 5) == [("pick(colour,red)",)] * 5


def test_only_layouts_with_the_whole_conflict_are_excluded(tmp_path: Path) -> None:
    """A conflict includes absent pieces, too: with one more piece a layout may have a solution."""
    file = tmp_path / "coins.lp"
    file.write_text("""
        #program coins.
        option(coin(1..2),(heads;tails),1).
        heads(C) :- pick(coin(C),heads).
        :- not heads(1).
        #show heads/1.
    """)
    made = Program([file], {}, [("coins", [])])
    one, both = [[Function("heads", [Number(c)]) for c in range(1, n + 1)] for n in (1, 2)]
    nogoods = [{one[0]: True, both[1]: False}]
    for seed in range(8):
        assert made.sample(np.random.default_rng(seed), nogoods=nogoods) == both
    nogoods.append({both[1]: True, Function("never"): False})
    assert made.sample(np.random.default_rng(0), nogoods=nogoods) is None
    assert {str(made.sample(np.random.default_rng(seed))) for seed in range(20)} == {str(one), str(both)}


def test_all_layouts_of_four_rooms_in_the_family_grammar_are_about_equally_likely() -> None:
    """There are 4,440 layouts of four rooms: 60 orders of types, the sides, and the rooms in corners."""
    seen = Counter(samples(house(4)[0], 6000))
    shares = np.array(list(seen.values())) / 6000
    # 6000 uniform samples of 4,440 layouts have this mean entropy, which our samples nearly reach.
    uniform = np.unique(np.random.default_rng(0).integers(4440, size=6000), return_counts=True)[1] / 6000
    entropy, best = (-(p * np.log(p)).sum() for p in (shares, uniform))
    assert entropy > 0.95 * best


@pytest.mark.parametrize("rooms", [1, 2, 3, 7, 16])
def test_room_types_of_the_family_grammar_are_as_the_paper_demands(rooms: int) -> None:
    made, _ = house(rooms)
    for seed in range(20):
        atoms = made.sample(np.random.default_rng(seed)) or []
        types = [str(a.arguments[1]) for a in atoms if a.name == "room"]
        sides = [str(a.arguments[1]) for a in atoms if a.name == "side"]
        basic = [t for t in types if t in {"bedroom", "bathroom", "kitchen"}]
        assert len(types) == len(sides) == rooms
        assert len(basic) >= min(2, rooms - 1)
        assert rooms < 3 or len(set(basic)) == 3
        assert sides == sorted(sides, key=["north", "east", "south", "west"].index), "numbered clockwise"


def test_a_requirement_is_possible_or_not_by_the_rules() -> None:
    made, (bathrooms, bedrooms) = house(4, bathroom=9, bedroom=1)
    assert made.possible([bedrooms])
    assert not made.possible([bathrooms])
    rooms = [Function("room", [Number(r), Function("bedroom")]) for r in range(4)]
    assert not made.possible([bedrooms], without=rooms)


def test_a_syntax_error_is_reported_by_file_and_line(tmp_path: Path) -> None:
    with pytest.raises(GrammarError) as caught:
        program(tmp_path, "type(study).\ntype(library)) .\n")
    assert (caught.value.file, caught.value.line) == (str(tmp_path / "rules.lp"), 2)


def test_a_weight_is_a_positive_integer(tmp_path: Path) -> None:
    with pytest.raises(GrammarError, match="positive"):
        program(tmp_path, "#program toys. option(coin,heads,0).")


def test_layouts_of_a_plan_are_counted_and_every_one_of_them_is_sampled(tmp_path: Path) -> None:
    """The plans are homes of four rooms in a row. A layout counts once, even if its lengths may differ."""
    edits = (
        ("rooms.lp", "topology(ring)", "topology(row)"),
        ("rooms.lp", ":- not common.", ":- not common, rooms > 4."),
        ("rooms.lp", "may_be_lit(living; bedroom; dining; kitchen; study).", ""),
        (
            "rooms.lp",
            "lit(living).  lit(bedroom).  lit(dining).  lit(kitchen).  lit(study).",
            "lit(bedroom).",
        ),
    )
    rows = builder(copied(tmp_path, *edits, row=ROW))
    request = HouseRequest(4)
    name, number, exact = next(rows.programs.counts(request, 20))
    assert (name, exact) == ("4 rooms", True)
    program, assumed = rows.programs.rooms_for(request)
    sampled = {tuple(program.sample(np.random.default_rng(seed), assumed) or ()) for seed in range(1000)}
    assert len(sampled) == number == 12


def test_that_there_is_no_layout_is_found_without_all_sampled_picks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Eight rooms on 40 m² take 117,000 decisions in the sampled order, and a thousand in clasp's own."""
    decisions = 0
    decide = Brancher.decide

    def counted(*arguments: Any) -> int:
        nonlocal decisions
        decisions += 1
        return decide(*arguments)

    monkeypatch.setattr(Brancher, "decide", counted)
    area = ("lengths.pl", "door_width(0.8).", "door_width(0.8).  house_area(30.0, 40.0).")
    with pytest.raises(NoLayout):
        builder(copied(tmp_path, area)).house(HouseRequest(8), 0, 0)
    assert decisions < 30_000
