"""The plan nearest to an impossible one: its walls move as little as possible, and it has a house."""

import json
from pathlib import Path
from typing import Any

import pytest

from tests.logic.generation.test_shared_walls import copied
from tests.logic.request.test_given_plan import BOXES, Box, geojson
from vitruvius.cli import main
from vitruvius.logic import Unsatisfiable, check, generate, nearest_plan
from vitruvius.logic.request.given_plan import read_plan
from vitruvius.logic.request.own_plan import OwnPlan

NARROW: dict[str, Box] = BOXES | {"bath": (6, 3, 7.17, 5.2)}
"""Plan with a bath of 1.17 m, which must be at least 1.2 m wide."""


def record(boxes: dict[str, Box]) -> dict[str, Any]:
    return geojson(boxes, bath="bathroom", hall="hall", living="living", kitchen="kitchen", bedroom="bedroom")


def moved(plan: OwnPlan, share: float, to: OwnPlan) -> OwnPlan:
    """Return a plan part of the way from one plan to another."""
    boxes = {}
    for one, other in zip(plan.rooms, to.rooms, strict=True):
        west, north, east, south = (a + share * (b - a) for a, b in zip(one.box, other.box, strict=True))
        boxes[one.name] = (west, -south, east, -north)
    return read_plan(record(boxes), snap=0.0)


@pytest.mark.usefixtures("solved_here")
def test_a_room_is_as_much_wider_as_it_must_be_and_has_a_house() -> None:
    found = nearest_plan(record(NARROW), grammar="home")
    assert found.changes == ("bath 0.030 m wider",)
    assert "plan: bath is 1.17 by 2.20 m" in str(found.proof)
    assert check(next(generate(plan=found.plan, grammar="home"))) == []
    with pytest.raises(Unsatisfiable, match="plan: bath"):
        next(generate(plan=moved(read_plan(record(NARROW)), 0.99, found.plan), grammar="home"))


@pytest.mark.usefixtures("solved_here")
def test_a_wall_that_moves_takes_both_of_its_rooms_and_the_door_in_it() -> None:
    boxes = NARROW | {"bath": (6, 3, 8.4, 4.1)}  # 1.1 m deep, at a kitchen
    found = nearest_plan(record(boxes), grammar="home")
    assert found.changes == ("bath 0.100 m deeper",)
    house = next(generate(plan=found.plan, grammar="home"))
    again = nearest_plan(house, grammar="home")
    assert (again.plan, again.changes, again.proof) == (read_plan(house), (), None)


@pytest.mark.usefixtures("solved_here")
def test_an_area_too_small_is_made_up_for_exactly(tmp_path: Path) -> None:
    rules = copied(tmp_path, ("sizes.pl", "limit(room_area(living,     8.0, 120.0)).", ""))
    boxes = BOXES | {"living": (0.4, 0, 4, 4)}  # 14.4 m², that are 15 at least
    found = nearest_plan(record(boxes), grammar=rules)
    rooms = {room.name: room for room in found.plan.rooms}
    assert 15 <= rooms["living"].area < 15.001
    assert check(next(generate(plan=found.plan, grammar=rules))) == []


@pytest.mark.usefixtures("solved_here")
def test_what_no_lengths_can_mend_is_proved() -> None:
    two = geojson(BOXES, hall="hall", living="kitchen", kitchen="kitchen", bedroom="study", bath="bathroom")
    with pytest.raises(Unsatisfiable, match="room\\(R,living\\)"):
        nearest_plan(two, grammar="home")


def test_the_command_says_the_proof_and_what_moves(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "plan.geojson").write_text(json.dumps(record(NARROW)))
    words = ["generate", "--plan", str(tmp_path / "plan.geojson"), "--grammar", "home", "--nearest", "--json"]
    with pytest.raises(SystemExit) as end:
        main(words)
    assert end.value.code == 0
    out, err = capsys.readouterr()
    assert json.loads(out)["answer"]["broken"] == ["bath 0.030 m wider"]
    assert "walls move as little as possible:\n  bath 0.030 m wider" in err
    assert "room_size(bathroom" in err
