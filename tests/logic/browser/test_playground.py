"""The playground: houses, mistakes and proofs of solvers in the browser, compared with those of Python."""

import json
import re
import socket
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page, expect

from tests.browsing import answered_under_the_finger, box, cut_on_paper, findings, line_is_seen, too_wide
from tests.docs.reader import ROOT
from tests.logic.browser.answers import answered
from tests.logic.workers.in_process import generate
from tests.programs import PATIENCE
from vitruvius.logic import House, check
from vitruvius.logic.browser.playground import folder
from vitruvius.logic.browser.playground.server import listening
from vitruvius.logic.errors import MissingProgram, RequestError, VitruviusError
from vitruvius.logic.grammar import SHIPPED

pytestmark = pytest.mark.second_part("pages are driven in a browser, and solvers are compared")

WHOLE = 1000 * PATIENCE
"""Timeout of an answer, milliseconds."""

SHEETS = {
    "family": {"rooms": 5, "seed": 3, "count": 2, "types": {"bedroom": 2, "hall": [1, None]}},
    "paper": {"rooms": 3, "seed": 0, "count": 1, "furniture": {"bedroom.bed": 2}},
    "home": {"rooms": 4, "seed": 1, "count": 1, "types": {"bedroom": [1, 2]}},
    "clinic": {"rooms": 4, "seed": 0, "count": 1},
}


def rules(grammar: str) -> dict[str, str]:
    """Return the rule files of a shipped grammar, by name."""
    return {file.name: file.read_text() for file in SHIPPED.joinpath(grammar).glob("*.[lp][lp]")}


def houses_of(page: Page, grammar: str, **asked: Any) -> list[dict[str, Any]]:
    """Return the houses that the browser generates."""
    request = {"types": {}, "furniture": {}, **asked}
    return [part["house"] for part in answered(page, grammar, rules(grammar), request) if "house" in part]


def drawn(page: Page, address: str) -> None:
    """Open the page, and wait for its houses."""
    page.goto(address)
    expect(page.locator("#status")).to_contain_text("drawn in", timeout=WHOLE)


def edit(page: Page, name: str, old: str, new: str) -> None:
    """Change a rule file in the page's editor."""
    page.get_by_role("tab", name=name).click()
    area = page.get_by_role("textbox", name="Text of the rule file")
    text = area.input_value()
    assert old in text
    area.fill(text.replace(old, new, 1))


def test_the_browser_makes_the_same_houses_as_python_number_for_number(opened):
    for grammar, asked in SHEETS.items():
        found = houses_of(opened, grammar, **asked)
        made = [house.converted().to_dict() for house in generate(grammar=grammar, **asked)]
        expected = json.loads(json.dumps(made))
        assert not any(check(House.from_dict(house)) for house in found)
        for house in found + expected:
            assert house["provenance"].pop("versions").keys() == {"vitruvius", "clingo", "swi-prolog"}
            house["provenance"].pop("promises", None)  # Of Python's alone.
        assert found == expected, grammar


def test_the_first_houses_that_one_sees_are_homes_with_an_entrance(page, at):
    drawn(page, f"{at}#count=1")
    expect(page.locator("#command")).to_contain_text("--grammar home")
    expect(page.locator("[data-part=entrance]")).to_have_count(1)
    expect(page.locator("[hidden]:visible")).to_have_count(0)


def test_while_solvers_load_the_page_shows_how_much_has_come_and_grey_cards(page, at):
    held = []
    page.route("**/clingo.wasm", lambda route: held.append(route))  # noqa: PLW0108 (playwright marks it)
    page.goto(f"{at}?grammar=family#rooms=2&count=2")
    expect(page.locator("#status")).to_have_text("Loading the solvers: 3.8 of 6.5 MB.", timeout=WHOLE)
    expect(page.locator("#sheet li:empty")).to_have_count(2)
    expect(page.get_by_role("tab", selected=True)).to_have_text("sizes.pl")
    held[0].continue_()
    expect(page.locator("#sheet li:not(.old) svg")).to_have_count(2, timeout=WHOLE)
    expect(page.locator("#sheet li")).to_have_count(2)


def test_random_numbers_are_those_of_numpy(opened):
    seeds = [[0, 0], [2**31 - 1, 127], [12345678901234, 5]]
    found = opened.evaluate(
        """async (seeds) => {
            const { Generator } = await import("./solver/random.js");
            return seeds.map((seed) => {
                const rng = new Generator(seed);
                return [rng.exponentials(2000), rng.permutation(9), String(rng.seed()), rng.permutation(300)];
            });
        }""",
        seeds,
    )
    for seed, (exponentials, few, drawn_, many) in zip(seeds, found, strict=True):
        rng = np.random.default_rng(seed)
        np.testing.assert_allclose(exponentials, rng.exponential(size=2000), rtol=1e-12)
        assert few == rng.permutation(9).tolist()
        assert int(drawn_) == rng.integers(2**63)
        assert many == rng.permutation(300).tolist()


def test_a_mistake_stands_at_its_line_and_a_changed_rule_makes_other_houses(page, at):
    drawn(page, f"{at}?grammar=family#rooms=2&count=1")
    first = page.locator("[data-part=R0]")
    kind = str(first.get_attribute("aria-label")).removeprefix("R0, ")
    edit(page, "rooms.lp", "type(bedroom;", "type(bedroom")
    expect(page.locator("#findings li").first).to_contain_text("rooms.lp:3:14", timeout=WHOLE)
    expect(page.locator("#findings li").first).to_contain_text("syntax error")
    edit(page, "rooms.lp", "type(bedroom", "type(bedroom;")
    expect(page.locator("#findings li")).to_have_count(0, timeout=WHOLE)
    edit(page, "sizes.pl", "door_width(", "door_widht(")
    expect(page.locator("#findings li").first).to_contain_text("did you mean door_width/1?", timeout=WHOLE)
    edit(page, "sizes.pl", "door_widht(", "door_width(")
    edit(page, "rooms.lp", "#program house.", f"#program house.\n:- room(0,{kind}).")
    expect(first).not_to_have_attribute("aria-label", f"R0, {kind}", timeout=WHOLE)
    edit(page, "rooms.lp", "#program house.", "#program house.\n:- rom(_,hall).")
    expect(page.locator("#findings li").first).to_contain_text("did you mean room/2?", timeout=WHOLE)
    page.reload()  # Edits outlive a reload, until they are reverted.
    expect(page.locator("#findings li").first).to_contain_text("did you mean room/2?", timeout=WHOLE)
    page.get_by_role("button", name="As shipped").click()
    expect(page.locator("#findings li")).to_have_count(0, timeout=WHOLE)
    expect(first).to_have_attribute("aria-label", f"R0, {kind}", timeout=WHOLE)


def test_a_proof_names_the_rules_that_conflict(page, at):
    drawn(page, f"{at}?grammar=family#rooms=3&count=1")
    page.locator("[name='type.bathroom']").fill("2")
    answer = page.locator("#answer")
    expect(answer).to_contain_text(":- rooms >= 3, basic(T), not room(_,T).", timeout=WHOLE)
    for reason in ("rooms: 3", "bathroom: 2", "basic(bedroom; bathroom; kitchen)."):
        expect(answer).to_contain_text(reason)
    advice = "There is a house with 2 rooms, or without bathroom: 2."
    expect(answer).to_contain_text(advice, timeout=WHOLE)
    page.locator("[name='type.bathroom']").fill("")
    expect(page.locator("#status")).to_contain_text("drawn in", timeout=WHOLE)
    edit(page, "sizes.pl", "D >= 1.9,  D =< 2.1", "D >= 4.9, D =< 5")
    expect(answer).to_contain_text("since no bedroom can be furnished", timeout=WHOLE)
    for reason in (
        "may(bedroom,bed,1,2).",
        "passage(0.42).",
        "room_size(bedroom, W, D)",
        "D >= 4.9, D =< 5 }.",
    ):
        expect(answer).to_contain_text(reason)


def test_the_playgrounds_tutorial_leads_where_it_says(page, at):
    text = (ROOT / "docs" / "tutorials" / "playground.md").read_text()
    shown, types, size, may = (block.strip() for block in re.findall(r"```prolog\n(.*?)```", text, re.DOTALL))
    answer, status, mistakes = (page.locator(each) for each in ("#answer", "#status", "#findings li"))
    drawn(page, f"{at}?grammar=family#rooms=4&count=1")
    edit(page, "sizes.pl", shown, shown.replace("D >= 3.2, D =< 5.2", "D >= 6.2, D =< 8.2"))
    expect(page.locator("#command")).to_contain_text("family-edited")
    expect(status).to_contain_text("drawn in", timeout=WHOLE)
    page.get_by_role("button", name="As shipped").click()
    edit(page, "rooms.lp", types.replace("; study", ""), types)
    expect(mistakes.first).to_contain_text("study", timeout=WHOLE)
    hall = next(
        line for line in rules("family")["sizes.pl"].splitlines() if line.startswith("room_size(hall")
    )
    edit(page, "sizes.pl", hall, f"{hall}\n{size}")
    edit(page, "furniture.lp", "may(bedroom,", f"{may}\nmay(bedroom,")
    page.locator("[name='type.study']").fill("1")
    expect(page.locator("#sheet [data-part*='.desk']").first).to_be_visible(timeout=WHOLE)
    edit(page, "furniture.lp", "may(study,desk", "may(study,dek")
    expect(mistakes.first).to_contain_text("furniture.lp:3:11", timeout=WHOLE)
    expect(mistakes.first).to_contain_text("did you mean desk?")
    edit(page, "furniture.lp", "may(study,dek", "may(study,desk")
    page.locator("[name=rooms]").fill("3")
    for reason in ("rooms: 3", "study: 1", *re.findall(r"^- `(.*?\.)`, line", text, re.MULTILINE)):
        expect(answer).to_contain_text(reason, timeout=WHOLE)
    expect(answer).to_contain_text("There is a house with 4 rooms, or without study: 1.", timeout=WHOLE)
    edit(page, "rooms.lp", ":- rooms >= 3", "% :- rooms >= 3")
    expect(status).to_contain_text("drawn in", timeout=WHOLE)


def test_rules_without_end_are_stopped_and_the_page_goes_on(page, at):
    drawn(page, f"{at}?grammar=family#rooms=2&count=1")
    edit(page, "rooms.lp", "#program house.", "number(0). number(N+1) :- number(N).\n#program house.")
    expect(page.locator("#status")).to_have_text("Drawing.")
    page.get_by_role("button", name="Stop").click()
    expect(page.locator("#status")).to_have_text("Stopped.")
    edit(page, "rooms.lp", "number(0).", "number(1).")
    expect(page.locator("#status")).to_have_text("Drawing.")
    edit(page, "rooms.lp", "number(1). number(N+1) :- number(N).", "")  # The solvers are still busy.
    expect(page.locator("#status")).to_contain_text("drawn in", timeout=WHOLE)


def test_the_houses_come_as_a_file_that_python_reads(page, at, tmp_path):
    drawn(page, f"{at}?grammar=paper#rooms=2&count=2")
    with page.expect_download() as download:
        page.get_by_role("button", name="Houses as a file").click()
    file = tmp_path / "houses.jsonl"
    download.value.save_as(file)
    records = [json.loads(line) for line in file.read_text().splitlines()]
    assert [len(House.from_dict(record).counted) for record in records] == [2, 2]


def test_the_address_holds_grammar_request_and_edits_for_a_reload_back_forward_and_others(
    page, at, browser, phone
):
    grammar, command = page.get_by_label("Rules of"), page.locator("#command")
    drawn(page, f"{at}#grammar=family&rooms=2&count=1&type.hall=0")
    edit(page, "sizes.pl", "door_width(", "% mine\ndoor_width(")
    expect(command).to_contain_text("--grammar family-edited --rooms 2 --type hall=0")
    expect(page).to_have_url(re.compile("edits="))
    page.reload()
    area = page.get_by_role("textbox", name="Text of the rule file")
    page.get_by_role("tab", name="sizes.pl").click()
    expect(area).to_have_value(re.compile("% mine"))
    shared = page.url
    grammar.select_option("paper")
    expect(command).to_contain_text("--grammar paper --rooms 2 --type hall=0")
    page.reload()
    expect(grammar).to_have_value("paper")
    expect(command).to_contain_text("--grammar paper --rooms 2 --type hall=0")
    page.go_back()
    expect(grammar).to_have_value("family")
    page.get_by_role("tab", name="sizes.pl").click()
    expect(area).to_have_value(re.compile("% mine"))
    page.get_by_role("button", name="As shipped").click()
    expect(area).not_to_have_value(re.compile("% mine"))
    page.go_back()
    expect(area).to_have_value(re.compile("% mine"))
    page.go_forward()
    expect(area).not_to_have_value(re.compile("% mine"))
    # Another browser, which has stored nothing; and a link that was cut.
    phone.goto(shared)
    expect(phone.locator("#command")).to_contain_text("--grammar family-edited --rooms 2 --type hall=0")
    phone.goto(f"{at}#grammar=family&edits=xxxx&rooms=2")
    phone.reload()
    expect(phone.locator("#command")).to_contain_text("--grammar family --rooms 2")


def test_the_edited_rules_come_as_a_folder_from_which_python_makes_the_same_house(page, at, tmp_path):
    drawn(page, f"{at}#grammar=clinic&rooms=4&count=1")
    expect(page.get_by_role("button", name="Rules as a zip")).to_be_disabled()
    edit(page, "rooms.lp", "%", "% ä ½\n%")
    expect(page.locator("#command code")).to_contain_text("clinic-edited")
    expect(page.locator("#sheet li:not(.old) svg")).to_have_count(1, timeout=WHOLE)
    kept = {}
    for name in ("Rules as a zip", "Houses as a file"):
        with page.expect_download() as download:
            page.get_by_role("button", name=name).click()
        kept[name] = tmp_path / download.value.suggested_filename
        download.value.save_as(kept[name])
    expect(page.locator("#command")).to_contain_text("“Rules as a zip”, unpack the file, and beside it run")
    expect(page.locator("#command code")).to_contain_text("generate --grammar clinic-edited --rooms 4")
    with zipfile.ZipFile(kept["Rules as a zip"]) as file:
        assert file.testzip() is None
        file.extractall(tmp_path)
    made = tmp_path / "clinic-edited"
    names = {each.name for each in (SHIPPED / "clinic").iterdir()}
    assert {each.name for each in made.iterdir()} == names
    [house] = generate(grammar=made, rooms=4, count=1)
    record = json.loads(kept["Houses as a file"].read_text())
    assert house.converted().to_dict()["rooms"] == House.from_dict(record).converted().to_dict()["rooms"]
    assert house.provenance
    assert record["provenance"]["grammar_hash"] == house.provenance.grammar_hash


def test_on_a_telephone_what_is_tapped_is_answered_in_its_place(phone, at):
    drawn(phone, f"{at}#grammar=family&rooms=3&count=3")
    assert box(phone.locator("#houses"))["y"] < box(phone.locator("#rules"))["y"]
    part = phone.locator("#sheet li:last-child [data-part*='.toilet']").first
    part.scroll_into_view_if_needed()
    answered_under_the_finger(phone, part)
    expect(phone.locator("#answer")).to_contain_text("A toilet in")
    phone.locator("#answer .place").first.tap()
    line_is_seen(phone)
    phone.get_by_role("button", name="Close the answer").tap()
    assert 0 <= box(part)["y"] < 844


def test_the_page_fits_screens_and_paper_and_axe_finds_nothing(page, at):
    drawn(page, f"{at}#grammar=family&rooms=2&count=1")
    page.locator("#sheet [data-part=R0]").click()
    edit(page, "rooms.lp", "#program house.", "#program house.\n:- rom(_,hall).")
    expect(page.locator("#findings li").first).to_contain_text("did you mean room/2?", timeout=WHOLE)
    assert findings(page) == []
    assert too_wide(page) == []
    assert cut_on_paper(page) == []


def test_without_the_server_a_stopped_page_says_what_to_do(browser, at):
    page = browser.new_page()
    drawn(page, f"{at}#grammar=family&rooms=2&count=1")
    page.context.set_offline(True)
    page.get_by_role("slider", name="Rooms").fill("9")
    page.get_by_role("button", name="Stop").click()
    page.get_by_role("button", name="Another seed").click()
    expect(page.locator("#status")).to_contain_text(
        "The solvers cannot be loaded: the server of this page has stopped"
    )
    page.context.set_offline(False)
    page.get_by_role("slider", name="Rooms").fill("2")
    expect(page.locator("#status")).to_contain_text("drawn in", timeout=WHOLE)
    page.close()


def test_a_browser_without_webassembly_is_told(page, at):
    page.add_init_script("delete window.WebAssembly")
    page.goto(at)
    expect(page.locator("#status")).to_contain_text("The solvers need WebAssembly")


def test_a_folder_with_something_in_it_is_left_alone(tmp_path):
    (tmp_path / "mine").touch()
    with pytest.raises(RequestError, match="is not empty: choose a new folder"):
        folder.write(tmp_path)
    assert [file.name for file in tmp_path.iterdir()] == ["mine"]


def test_a_port_in_use_is_an_error_of_one_line(tmp_path):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(RequestError, match=f"--port {port}: is in use: choose another"):
            listening(tmp_path, port)


def test_without_npm_or_a_network_one_line_says_so(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(MissingProgram, match="npm, which fetches the solvers for browsers, is missing"):
        folder.solvers()
    npm = tmp_path / "npm"
    npm.write_text("#!/bin/sh\necho npm error code ENOTFOUND >&2\nexit 1\n")
    npm.chmod(0o755)
    with pytest.raises(VitruviusError, match="npm cannot fetch the solvers for browsers: code ENOTFOUND"):
        folder.solvers()
    assert not any((tmp_path / "cache" / "vitruvius").iterdir())


def test_the_lock_has_hashes_and_names_no_host():
    lock = Path(folder.HERE, "package-lock.json").read_text()
    packages = [each for name, each in json.loads(lock)["packages"].items() if name]
    assert packages
    assert all(each["integrity"].startswith("sha512-") for each in packages)
    assert "http" not in lock
