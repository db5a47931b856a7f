"""Report in a real browser: opened as a file, filtered, played, and controlled by the keyboard.

The fixture ``page`` fails a test if the page logs an error or a warning, or makes a request to another host.
"""

import json
from pathlib import Path

import msgspec
import pytest
from playwright.sync_api import Browser, Page, expect

from benchmarks import SECTIONS
from tests.agent.report.conftest import STEPS, recorded, untrained
from tests.agent.report.test_report import LINE, measured, metrics
from tests.benchmarks.reports import report as timed
from tests.benchmarks.reports import simulator_report
from tests.browsing import box, cut_on_paper, findings, too_wide
from tests.conftest import opened_page
from vitruvius.agent.banks import benchmark
from vitruvius.agent.recording import trace
from vitruvius.agent.recording.trace import Trace
from vitruvius.agent.report.folder import describe, write_report
from vitruvius.logic import House, save

pytestmark = pytest.mark.second_part("reports are driven in a browser")


@pytest.fixture(scope="module")
def houses() -> list[House]:
    """Return 30 houses of family, with 2 to 6 rooms, and a flat."""
    return [*benchmark("test-v1")[:30], benchmark("home-test-v1")[0]]


@pytest.fixture(scope="module")
def vetoed() -> Trace:
    """Return an episode with masked actions, without a map."""
    return recorded(untrained()).trace


@pytest.fixture(scope="module")
def file(tmp_path_factory, houses, mapped, vetoed) -> Path:
    """Write a report of houses, runs, scores and two episodes."""
    folder = tmp_path_factory.mktemp("run")
    metrics(folder, msgspec.json.encode(LINE).decode())
    measured(folder, houses[:2])
    describe(folder, "An agent in houses that it has never seen")
    (folder / "generator.json").write_text(json.dumps(timed()))
    (folder / "simulator.json").write_text(json.dumps(simulator_report()))
    save(houses[:2], folder / "measured.jsonl")
    save(houses[2:-1], folder / "stars.jsonl")
    save(houses[-1:], folder / "homes.jsonl")
    trace.save(mapped, folder / "a.trace.json")
    trace.save(vetoed, folder / "b.trace.json")
    return write_report(folder, studies=SECTIONS)


@pytest.fixture
def opened(page: Page, file: Path) -> Page:
    page.goto(file.as_uri())
    page.wait_for_selector(".plans[data-ready]")
    page.wait_for_selector(".episode:nth-of-type(2)[data-ready]")
    return page


def inked(page: Page, episode: int = 0) -> str:
    """Return the drawing on an episode's canvas."""
    return page.evaluate(
        """(episode) => {
            const canvas = document.querySelectorAll(".stage canvas")[episode];
            return canvas.toDataURL();
        }""",
        episode,
    )


def test_nothing_is_fetched_but_the_file_itself(page: Page, file: Path) -> None:
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.goto(file.as_uri())
    page.wait_for_selector(".plans[data-ready]")
    page.wait_for_selector(".episode[data-ready]")
    assert asked == [file.as_uri()]


def test_houses_are_filtered_by_what_they_are(opened: Page, houses) -> None:
    cards, count = opened.locator(".sheet li"), opened.locator(".filters output")
    expect(count).to_have_text("31 of 31 houses")
    expect(cards).to_have_count(24)
    opened.get_by_role("button", name="Show more (7 left)").click()
    expect(cards).to_have_count(31)
    opened.get_by_label("Grammar").select_option("home")
    expect(cards).to_have_count(1)
    opened.get_by_role("button", name="All houses").click()
    expect(count).to_have_text("31 of 31 houses")
    opened.locator("select[name=most]").select_option("2")
    expect(cards).to_have_count(6)
    opened.get_by_role("button", name="All houses").click()
    opened.get_by_label("With room").select_option("bedroom")
    many = sum(sum(room.type == "bedroom" for room in house.counted) >= 2 for house in houses)
    opened.get_by_label("at least").select_option("2")
    assert 0 < many < 31
    expect(count).to_have_text(f"{many} of 31 houses")
    piece = "sofa"
    opened.get_by_role("button", name="All houses").click()
    opened.get_by_label("With furniture").select_option(piece)
    some = sum(any(each.type == piece for room in house.rooms for each in room.pieces) for house in houses)
    expect(count).to_have_text(f"{some} of 31 houses")
    opened.get_by_role("button", name="All houses").click()
    opened.get_by_label("Order").select_option("small")
    areas = [round(sum(room.area for room in house.rooms), 1) for house in houses]
    assert areas.index(min(areas)) == 30
    words = f"homes.jsonl, house 0: 4 rooms, {min(areas):g} m²"
    expect(cards.first.locator("button")).to_have_attribute("aria-label", words)


def test_houses_can_be_ordered_by_how_well_an_agent_did_in_them(opened: Page) -> None:
    opened.get_by_label("Order").select_option("agent, targets in secondary rooms")
    first = opened.locator(".sheet span")
    expect(first.nth(0)).to_have_text("measured.jsonl, house 1: ratio 0.4")
    expect(first.nth(1)).to_have_text("measured.jsonl, house 0: ratio 0.5")
    expect(first.nth(2)).to_have_text("homes.jsonl, house 0")


def test_a_house_is_enlarged_and_the_keys_go_on_to_the_next(opened: Page) -> None:
    opened.locator(".sheet button").nth(2).press("Enter")
    large = opened.locator("dialog p")
    first = large.text_content()
    opened.keyboard.press("ArrowRight")
    assert large.text_content() != first
    opened.keyboard.press("ArrowLeft")
    expect(large).to_have_text(first or "")
    opened.keyboard.press("Escape")
    expect(opened.locator("dialog")).not_to_be_visible()
    expect(opened.locator(".sheet button").nth(2)).to_be_focused()


def test_an_episode_plays_to_its_end_and_stops(opened: Page) -> None:
    episode = opened.locator(".episode").first
    place = episode.locator(".place")
    expect(place).to_have_text(f"step 0 of {STEPS}, 0 targets")
    episode.get_by_role("button", name="Play").click()
    expect(episode.get_by_role("button", name="Pause")).to_be_visible()
    episode.get_by_label("Speed").select_option("100")
    expect(place).to_contain_text(f"step {STEPS} of {STEPS}")
    expect(episode.get_by_role("button", name="Play")).to_be_visible()
    expect(episode.locator(".choice .words")).to_have_text("The episode is over.")


def test_an_episode_is_scrubbed_and_played_by_the_keyboard_alone(opened: Page, mapped) -> None:
    episode = opened.locator(".episode").first
    bar, place = episode.get_by_label("Step of the episode"), episode.locator(".place")
    bar.focus()
    for key, step in (
        ("ArrowRight", 1),
        ("Shift+ArrowRight", 26),
        ("ArrowLeft", 25),
        ("Home", 0),
        ("End", STEPS),
    ):
        opened.keyboard.press(key)
        expect(place).to_contain_text(f"step {step} of")
        expect(bar).to_have_value(str(step))
    found = mapped.column("found")
    expect(bar).to_have_attribute("aria-valuetext", place.text_content() or "")
    opened.keyboard.press("Home")
    opened.keyboard.press("n")
    expect(place).to_contain_text(f"step {int((found > 0).argmax())} of {STEPS}, 1 target")
    episode.locator(".stage").focus()
    opened.keyboard.press("Home")
    opened.keyboard.press("Space")
    expect(episode.get_by_role("button", name="Pause")).to_be_visible()
    expect(bar).not_to_have_value("0")
    opened.keyboard.press("Space")
    expect(episode.get_by_role("button", name="Play")).to_be_visible()


def test_each_layer_is_drawn_until_its_key_switches_it_off(opened: Page, mapped) -> None:
    episode = opened.locator(".episode").first
    plan, bar = episode.locator(".stage > svg"), episode.get_by_label("Step of the episode")
    every, believed = mapped.map.every, mapped.map.belief.array().any(axis=(1, 2))
    sought = mapped.column("goal_kind")[::every] == 1
    bar.fill(str(every * int((believed & sought).nonzero()[0][-1])))
    bar.focus()
    for number in range(2, 8):
        opened.keyboard.press(str(number))
    nothing = inked(opened)
    for number, name in enumerate(("target", "path", "rays", "map", "belief", "goal"), start=2):
        box = episode.locator(f"input[name={name}]")
        opened.keyboard.press(str(number))
        expect(box).to_be_checked()
        assert inked(opened) != nothing, name
        opened.keyboard.press(str(number))
        expect(box).not_to_be_checked()
        assert inked(opened) == nothing, name
    expect(plan).to_be_visible()
    opened.keyboard.press("1")
    expect(plan).not_to_be_visible()


def test_values_and_vetoes_are_said_for_each_step(opened: Page, vetoed) -> None:
    episode = opened.locator(".episode").nth(1)
    wanted, action = vetoed.column("wanted"), vetoed.column("action")
    step = int((wanted != action).argmax())
    values = vetoed.column("values")[step] * vetoed.value_unit
    episode.get_by_label("Step of the episode").focus()
    if wanted[0] == action[0]:
        opened.keyboard.press("v")
    expect(episode.locator(".place")).to_contain_text(f"step {step} of")
    words = episode.locator(".choice .words")
    names = vetoed.actions
    expect(words).to_contain_text(
        f"Veto: the agent preferred “{names[wanted[step]]}”, the safety shield chose “{names[action[step]]}”."
    )
    cells = episode.locator(".choice tbody td:nth-child(2)")
    expect(cells).to_have_text([f"{value:.3f}" for value in values])
    expect(episode.locator(".choice tbody tr").nth(int(wanted[step])).locator("td").last).to_have_text(
        "forbidden"
    )
    inked_before = inked(opened, 1)
    opened.keyboard.press("9")
    assert inked(opened, 1) != inked_before
    expect(words).not_to_contain_text("Veto")
    opened.keyboard.press("8")
    expect(cells).to_have_text(["", "", ""])
    expect(episode.locator("input[name=map]")).to_be_disabled()


def test_a_table_is_sorted_by_the_column_that_is_clicked(opened: Page) -> None:
    table = opened.locator("#evaluation table.figures").last
    names = table.locator("tbody th")
    expect(names).to_have_text(["agent", "explorer", "oracle"])
    table.get_by_role("button", name="targets").press("Enter")
    expect(names).to_have_text(["oracle", "explorer", "agent"])
    table.get_by_role("button", name="targets").press("Enter")
    expect(names).to_have_text(["agent", "explorer", "oracle"])


def test_the_theme_can_be_chosen_and_follows_the_system(opened: Page) -> None:
    def paper() -> str:
        return opened.evaluate("getComputedStyle(document.body).backgroundColor")

    assert paper() == "rgb(255, 255, 255)"
    opened.emulate_media(color_scheme="dark")
    dark = paper()
    assert dark != "rgb(255, 255, 255)"
    opened.get_by_role("button", name="Theme: system").click()
    expect(opened.get_by_role("button", name="Theme: light")).to_be_visible()
    assert paper() == "rgb(255, 255, 255)"
    opened.emulate_media(media="print", color_scheme="dark")
    assert paper() == "rgb(255, 255, 255)"
    expect(opened.locator(".filters")).not_to_be_visible()


WIDER = """() => [...document.querySelectorAll("body *")].filter((each) => {
    let within = each;
    const scrolls = () => /auto|scroll|hidden/.test(getComputedStyle(within).overflowX);
    while (within && !scrolls()) within = within.parentElement;
    return !within && each.getBoundingClientRect().right > innerWidth + 1;
}).map((each) => each.outerHTML.slice(0, 80))"""
SMALL = """() => [...document.querySelectorAll("a, button, input, select, summary")].map((each) => {
    const { width, height } = (each.closest("label") ?? each).getBoundingClientRect();
    return [each.outerHTML.slice(0, 80), width, height];
}).filter(([, width, height]) => width && Math.min(width, height) < 24)"""
LEAST_TEXT = """() => Math.min(...[...document.querySelectorAll(".plot text")]
    .filter((each) => each.getBoundingClientRect().width).map((each) => {
        const { a, b } = each.getScreenCTM(); // some are turned
        return Math.hypot(a, b) * parseFloat(getComputedStyle(each).fontSize);
    }))"""


def test_on_a_telephone_the_plan_its_controls_and_what_is_said_of_the_step_are_seen_together(
    browser: Browser, file: Path
) -> None:
    context = browser.new_context(is_mobile=True, has_touch=True)
    page = context.new_page()
    page.goto(file.as_uri())
    page.wait_for_selector(".plans[data-ready]")
    page.wait_for_selector(".episode:nth-of-type(2)[data-ready]")
    for width, height in ((320, 568), (768, 1024), (844, 390)):
        page.set_viewport_size({"width": width, "height": height})
        assert page.evaluate("[innerWidth, document.documentElement.scrollWidth]") == [width, width]
        assert page.evaluate(WIDER) == []
        assert page.evaluate(SMALL) == []
        assert page.evaluate(LEAST_TEXT) >= 9
        for episode in page.locator(".episode").all():
            for seen in (".choice caption", ".choice tr:last-child", ".layers label:last-of-type"):
                episode.locator(".stage").evaluate("(each) => each.scrollIntoView()")
                block = "center" if width < height else "nearest"
                episode.locator(seen).last.evaluate("(each, block) => each.scrollIntoView({ block })", block)
                parts = [episode.locator(each).last for each in (seen, ".stage", ".controls")]
                boxes = [part.bounding_box() for part in parts]
                for each in boxes:
                    assert each
                    assert each["y"] >= -1
                    assert each["y"] + each["height"] <= height + 1
                for one, other in ((0, 1), (0, 2), (1, 2)):
                    a, b = boxes[one], boxes[other]
                    assert a
                    assert b
                    beside = a["x"] + a["width"] <= b["x"] + 1 or b["x"] + b["width"] <= a["x"] + 1
                    above = a["y"] + a["height"] <= b["y"] + 1 or b["y"] + b["height"] <= a["y"] + 1
                    assert beside or above, (width, seen)
            path = episode.locator("[name=path]")
            before = path.is_checked()
            path.tap()
            expect(path).to_be_checked(checked=not before)
    context.close()


CUT_OFF = """() => [...document.querySelectorAll(".plot text, .timeline-key span, caption")]
    .filter((each) => {
    const { left, right, width } = each.getBoundingClientRect();
    const within = each.closest("svg")?.getBoundingClientRect() ?? { left: 0, right: innerWidth };
    return width && (left < Math.max(0, within.left) - 1 || right > Math.min(innerWidth, within.right) + 1);
    }).map((each) => each.outerHTML.slice(0, 120))"""


def test_on_a_telephone_plots_keys_and_captions_are_whole_and_keys_name_what_is_there(opened: Page) -> None:
    for width in (390, 1280):
        opened.set_viewport_size({"width": width, "height": 844})
        assert opened.evaluate(CUT_OFF) == [], width
    for episode in opened.locator(".episode").all():
        key, marks = episode.locator(".timeline-key"), episode.locator(".timeline")
        for words, mark in (("pick-up", "picked"), ("veto", "veto"), ("blocked move", "bump")):
            assert (words in str(key.text_content())) == (marks.locator(f".{mark}").count() > 0)


def test_the_first_screen_is_an_episode_that_can_be_played_under_one_sentence(opened: Page) -> None:
    lead = opened.locator("header p:visible")
    expect(lead).to_have_count(1)
    expect(lead).to_contain_text("agent collects 6.5 targets in secondary rooms per episode")
    for width, height in ((1280, 800), (390, 844)):
        opened.set_viewport_size({"width": width, "height": height})
        play = opened.locator(".episode").first.get_by_role("button", name="Play")
        expect(opened.locator(".stage").first).to_be_in_viewport(ratio=0.99)
        expect(play).to_be_in_viewport(ratio=0.99)


def test_the_page_fits_screens_and_paper_and_axe_finds_nothing(opened: Page) -> None:
    opened.locator("summary").first.click()
    assert findings(opened) == []
    opened.locator(".sheet button").first.click()
    assert findings(opened) == []  # of an enlarged house
    opened.keyboard.press("Escape")
    assert too_wide(opened) == []
    assert cut_on_paper(opened) == []
    stage, drawn = (box(opened.locator(each).first) for each in (".stage", ".stage canvas"))
    assert drawn["height"] <= stage["height"]
    # All tables are whole, also those folded on the screen, except for the numbers of curves.
    shown, every = (f"table.figures tbody tr{which}" for which in (":visible", ":not(figure details *)"))
    assert opened.locator(shown).count() == opened.locator(every).count()


def test_on_a_telephone_the_first_screen_shows_the_episode_under_a_long_title(
    browser: Browser, file: Path
) -> None:
    with opened_page(browser, is_mobile=True, has_touch=True, viewport={"width": 390, "height": 844}) as page:
        page.goto(file.as_uri())
        page.wait_for_selector(".episode[data-ready]")
        stage, controls = (box(page.locator(each).first) for each in (".stage", ".controls"))
        assert stage["y"] + stage["height"] <= controls["y"] + 1


def test_a_browser_that_cannot_unpack_says_so_in_one_line(page: Page, file: Path) -> None:
    page.add_init_script("delete window.DecompressionStream")
    page.goto(file.as_uri())
    line = page.locator(".episode").first.get_by_role("alert")
    expect(line).to_have_text("This part cannot be shown: this browser is older than 2023: use a newer one")
    expect(page.locator("#evaluation table").last).to_be_visible()
