"""The score is computed by geometry: in small houses with one fault each, it finds that fault."""

from typing import Any

import msgspec
import pytest

from benchmarks.briefs.bank import BriefEntry
from benchmarks.briefs.judge import faults, lines
from benchmarks.briefs.score import Answer, judged, judged_all, score
from vitruvius.logic import House, HouseFileError
from vitruvius.logic.request.brief import read_brief

pytestmark = pytest.mark.second_part("each study is run in small")

BRIEF: dict[str, Any] = {
    "rooms": [
        {"name": "Hall", "area": 12, "outside": ["north", "west"]},
        {"name": "Bed", "area": 12, "outside": True},
        {"name": "Bath", "size": [2, 4]},
    ],
    "doors": [["Hall", "Bed"], ["Hall", "Bath"]],
    "no_doors": [["Bed", "Bath"]],
    "next_to": [["Bed", "Bath"]],
    "entrance": {"room": "Hall", "side": "north"},
    "outline": {"width": 6, "depth": 6, "voids": [{"width": 4, "depth": 1, "corner": "south-east"}]},
}
HOUSE: dict[str, Any] = {
    # HHHBBB    a hall, a bedroom, below both a bathroom, and in the south-east a notch
    # HHHBBB
    # aaaaaa
    "format": "vitruvius-2",
    "unit": "m",
    "topology": "any",
    "rooms": [
        {"name": "Hall", "type": "", "x": 0, "y": 0, "width": 3, "height": 4},
        {"name": "Bed", "type": "", "x": 3, "y": 0, "width": 3, "height": 4},
        {"name": "Bath", "type": "", "x": 0, "y": 4, "width": 6, "height": 1},
    ],
    "doors": [
        {"x": 3, "y": 1, "width": 0, "height": 0.8, "between": ["Hall", "Bed"]},
        {"x": 1, "y": 4, "width": 0.8, "height": 0, "between": ["Bath", "Hall"]},
        {"x": 1, "y": 0, "width": 0.8, "height": 0, "between": ["Hall", "outside"]},
    ],
}
WHOLE = BRIEF | {
    "rooms": [*BRIEF["rooms"][:2], {"name": "Bath", "size": [1, 6]}],
    "outline": {"width": 6, "depth": 5},
}
ENTRY = BriefEntry("one", "house", "", WHOLE, "house")


def changed(part: str, place: int, **how: Any) -> House:
    """Return the house with a changed room or door."""
    record = HOUSE | {part: [{**each} for each in HOUSE[part]]}
    record[part][place] |= how
    return House.from_dict(record)


def broken(house: House, brief: dict[str, Any]) -> list[str]:
    return [line.words for line in lines(house, read_brief(brief)) if not line.kept]


def test_a_right_house_has_no_fault_and_keeps_all() -> None:
    house = House.from_dict(HOUSE)
    assert faults(house, read_brief(WHOLE)) == []
    assert broken(house, WHOLE) == []


@pytest.mark.parametrize(
    ("part", "place", "how", "fault"),
    [
        ("rooms", 1, {"x": 2.5, "width": 3.5}, "Hall and Bed overlap"),
        ("rooms", 1, {"height": 3}, "3.00 m² of the outline are no room"),
        ("doors", 0, {"x": 2.5}, "a door of Hall and Bed is in no wall between them"),
        ("doors", 0, {"y": 3.5}, "a door of Hall and Bed is in no wall between them"),
        ("doors", 0, {"height": 0.5}, "a door of Hall and Bed is 0.50 m wide"),
        ("doors", 2, {"y": 4}, "a door of Hall and outside is in no wall between them"),
        ("doors", 1, {"between": ["Hall", "outside"]}, "no door leads to Bath"),
        ("rooms", 1, {"name": "Bad"}, "the rooms are Bad, Bath, Hall, not Bath, Bed, Hall"),
    ],
)
def test_a_wrong_house_has_its_fault(part: str, place: int, how: dict[str, Any], fault: str) -> None:
    if how.get("name"):  # the doors name the room too
        record = HOUSE | {"doors": HOUSE["doors"][1:], "rooms": [{**each} for each in HOUSE["rooms"]]}
        record["rooms"][place] |= how
        house = House.from_dict(record)
    else:
        house = changed(part, place, **how)
    assert fault in faults(house, read_brief(WHOLE))


def test_a_window_in_an_inner_wall_is_a_fault() -> None:
    def with_window(x: float) -> House:
        window = {"x": x, "y": 1, "width": 0, "height": 1, "room": "Hall"}
        return House.from_dict(HOUSE | {"windows": [window]})

    assert faults(with_window(0), read_brief(WHOLE)) == []
    assert faults(with_window(3), read_brief(WHOLE)) == ["a window of Hall is in no outer wall"]


def test_a_room_in_a_void_and_a_void_that_is_missed_are_faults() -> None:
    found = faults(House.from_dict(HOUSE), read_brief(BRIEF))
    assert found == ["Bath lies in a void", "-4.00 m² of the outline are no room"]


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"doors": [["Bed", "Bath"]], "no_doors": []}, ["a door joins Bed and Bath"]),
        ({"no_doors": [["Bed", "Hall"]]}, ["no door joins Bed and Hall"]),
        ({"apart": [["Bed", "Hall"]]}, ["Bed is not next to Hall"]),
        ({"entrance": "Bed"}, ["the house is entered by Bed"]),
        ({"entrance": {"room": "Hall", "side": "west"}}, ["the house is entered by Hall"]),
        ({"area": 40}, ["the house has 40.0 m²"]),
        ({"outline": {"width": 6.01}}, ["the outline is 6.01 m wide"]),
        (
            {"tolerance": 0.01, "rooms": [{"name": "Hall", "area": 11.8}, *WHOLE["rooms"][1:]]},
            ["Hall has 11.8 m²"],
        ),
        ({"rooms": [*WHOLE["rooms"][:2], {"name": "Bath", "size": [2, 3]}]}, ["Bath measures 2.0 by 3.0 m"]),
        ({"rooms": [*WHOLE["rooms"][:2], {"name": "Bath", "type": "wc"}]}, ["Bath is of type wc"]),
        (
            {"rooms": [{"name": "Hall", "outside": ["east"]}, *WHOLE["rooms"][1:]]},
            ["Hall has an outer wall in the east"],
        ),
    ],
)
def test_the_line_that_a_house_breaks_is_found(more: dict[str, Any], words: list[str]) -> None:
    assert broken(House.from_dict(HOUSE), WHOLE | more) == words


def test_rooms_are_next_to_each_other_from_a_tenth_of_a_metre_of_wall_on() -> None:
    brief = {"rooms": [{"name": name} for name in ("Hall", "Bed", "Bath")], "next_to": [["Bed", "Bath"]]}
    assert broken(changed("rooms", 2, width=3.1), brief) == []
    assert broken(changed("rooms", 2, width=3.05), brief) == ["Bed is next to Bath"]


def test_the_score_counts_what_is_right_and_does_not_depend_on_the_order_of_answers() -> None:
    bank = [msgspec.structs.replace(ENTRY, name=name) for name in ("one", "two", "three", "four")]
    bank.append(msgspec.structs.replace(ENTRY, name="five", answer="impossible"))
    wrong = changed("rooms", 1, height=3).to_dict()
    answers = [
        Answer("one", (HOUSE, HOUSE), seconds=1.0),
        Answer("two", (wrong,), seconds=2.0),
        Answer("three", impossible=True),
        Answer("five", impossible=True, seconds=3.0),
    ]
    found = score(judged_all(bank, answers))
    assert found == score(judged_all(bank, answers[::-1]))
    assert (found["right"], found["houses"], found["valid"], found["all lines kept"]) == (2 / 5, 2, 0.5, 0.5)
    assert (found["impossible"], found["false refutations"], found["known impossible, named so"]) == (
        2,
        1,
        1.0,
    )
    assert found["different plans"] == 0.5
    assert found["edges kept"] == 7 / 8
    assert found["areas kept"] == 5 / 6
    assert found["seconds"] == {3: (2.0, pytest.approx(2.9))}


def test_what_is_no_house_is_a_wrong_answer_and_no_error() -> None:
    assert not judged(ENTRY, Answer("one", ({"rooms": []},))).right
    assert not judged(ENTRY, None).right


def test_answers_to_no_brief_and_second_answers_are_refused() -> None:
    with pytest.raises(HouseFileError, match="tow"):
        judged_all([ENTRY], [Answer("tow")])
    with pytest.raises(HouseFileError, match="one has two"):
        judged_all([ENTRY], [Answer("one"), Answer("one")])
