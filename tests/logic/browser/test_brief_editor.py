"""The editor of a brief in the page of ``vitruvius watch``: table, bubbles, lines and JSON say the same."""

import json
from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests.browsing import findings, too_wide
from tests.logic.browser.test_watch import Watched, drawn, watching

pytestmark = pytest.mark.second_part("pages are driven in a browser, and solvers are compared")


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Watched]:
    with watching(tmp_path_factory.mktemp("grammars") / "mine", "plain") as watched:
        yield watched


@pytest.fixture
def editor(server: Watched, page: Page) -> Page:
    """Open the page with the initial brief: the rooms and the door of the house that is shown."""
    page.goto(f"{server.address}#rooms=2&seed=0&count=2&size=260")
    drawn(page, 2)
    page.get_by_label("By a brief").check()
    expect(page.locator(".bubble")).to_have_count(2)
    drawn(page, 2)
    return page


def brief(page: Page) -> dict[str, Any]:
    """Return the brief that the page shows as JSON."""
    return json.loads(page.locator("#brief-json").input_value())


def test_a_brief_begins_as_the_house_that_is_shown_so_that_it_has_a_house(
    server: Watched, page: Page
) -> None:
    page.goto(f"{server.address}#rooms=4&seed=0&count=1&size=260")
    drawn(page, 1)
    joints = page.locator("#sheet [data-part^='R'][data-part*='-R']").count()
    page.get_by_label("By a brief").check()
    expect(page.locator(".bubble")).to_have_count(4)
    assert [room["name"] for room in brief(page)["rooms"]] == [f"Room {number}" for number in range(1, 5)]
    assert len(brief(page)["doors"]) == joints
    drawn(page, 1)


def test_a_bubble_that_is_dropped_on_another_has_a_door_to_it_and_lines_turn(
    editor: Page,
) -> None:
    editor.get_by_role("button", name="Add a room").click()
    bubbles = editor.locator(".bubble")
    bubbles.nth(2).hover()
    editor.mouse.down()
    bubbles.nth(0).hover(force=True)
    editor.mouse.up()
    expect(editor.locator(".joint")).to_have_count(2)
    assert brief(editor)["doors"] == [["Room 1", "Room 2"], ["Room 3", "Room 1"]]
    drawn(editor, 2)
    editor.get_by_label("Between Room 3 and Room 1", exact=True).select_option("apart")
    assert brief(editor)["apart"] == [["Room 3", "Room 1"]]
    assert brief(editor)["doors"] == [["Room 1", "Room 2"]]
    drawn(editor, 2)
    editor.locator(".joint.apart .reach").dispatch_event("click")
    expect(editor.locator(".joint.no_doors")).to_have_count(1)


def test_what_the_table_says_stands_in_the_json_and_in_the_address(editor: Page) -> None:
    editor.get_by_label("Name of room 1").fill("Hall")
    editor.get_by_label("Area of Hall").or_(editor.get_by_label("Area of Room 1")).fill("8..9.5")
    editor.get_by_label("The house is entered by").first.check()
    editor.get_by_label("Outer wall of").first.select_option("south")
    editor.get_by_label("Width, m").fill("6")
    said = {
        "rooms": [
            {"name": "Hall", "type": "room", "area": [8, 9.5], "outside": ["south"]},
            {"name": "Room 2", "type": "room"},
        ],
        "doors": [["Hall", "Room 2"]],
        "entrance": "Hall",
        "outline": {"width": 6},
    }
    assert brief(editor) == said
    drawn(editor, 2)
    editor.reload()
    drawn(editor, 2)
    assert brief(editor) == said
    expect(editor.locator("#command")).to_contain_text("--brief brief.json")
    house = editor.locator("#sheet li [data-part='Hall']")
    expect(house).to_have_count(2)


def test_what_is_no_brief_is_said_in_words_and_nothing_is_drawn(editor: Page) -> None:
    for label, text, words in (
        ("Area of Room 1", "12..10", "“12..10” is not a length or an area"),
        ("Name of room 1", "Room 2", "another room is called Room 2"),
        ("Name of room 1", "", "a room has a name"),
    ):
        editor.get_by_label(label).fill(text)
        expect(editor.locator("#brief-wrong")).to_contain_text(words)
        expect(editor.locator("#status")).to_contain_text("No houses are drawn")
        editor.get_by_label(label).fill("" if "Area" in label else "Room 1")
        expect(editor.locator("#brief-wrong")).to_have_text("")
        drawn(editor, 2)
    editor.get_by_text("As JSON").click()
    editor.get_by_label("The brief as JSON").fill('{"rooms": 3}')
    expect(editor.locator("#brief-wrong")).to_contain_text("this is no JSON of a brief")


def test_a_brief_keeps_a_room_and_forgets_what_was_wrong_of_one_that_is_left_out(editor: Page) -> None:
    editor.get_by_label("Area of Room 2").fill("much")
    expect(editor.locator("#brief-wrong")).to_contain_text("“much” is not a length")
    editor.get_by_role("button", name="Leave Room 2 out").click()
    expect(editor.locator("#brief-wrong")).to_have_text("")
    drawn(editor, 2)
    expect(editor.get_by_role("button", name="Leave Room 1 out")).to_be_disabled()


def test_an_address_that_holds_no_brief_is_said_to_hold_none(server: Watched, page: Page) -> None:
    page.goto(f"{server.address}#rooms=2&seed=0&count=2&size=260&brief=%7B%22rooms%22%3A3%7D")
    expect(page.locator("#brief-wrong")).to_contain_text("this is no JSON of a brief")
    expect(page.locator("#brief-json")).to_have_value('{"rooms":3}')
    expect(page.locator("#status")).to_contain_text("No houses are drawn")


def test_a_brief_that_is_impossible_is_proved_by_its_lines(editor: Page) -> None:
    """Two rooms always share a wall."""
    wanted = {**brief(editor), "apart": [["Room 1", "Room 2"]]}
    editor.get_by_text("As JSON").click()
    editor.get_by_label("The brief as JSON").fill(json.dumps(wanted))
    expect(editor.locator("#answer")).to_contain_text("brief: Room 1 is not next to Room 2")


@pytest.mark.parametrize("width", [390, 1280])
def test_the_editor_fits_the_screen_and_axe_finds_nothing(editor: Page, width: int) -> None:
    editor.set_viewport_size({"width": width, "height": 844})
    assert too_wide(editor) == []
    assert findings(editor) == []
