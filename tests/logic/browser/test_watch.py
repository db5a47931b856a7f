"""The page of ``vitruvius watch``, in a browser and by requests alone: rule files are saved, houses too."""

import asyncio
import http.client
import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import Browser, Page, Route, expect

from tests.browsing import answered_under_the_finger, box, cut_on_paper, findings, line_is_seen, too_wide
from tests.logic.workers.in_process import generate
from tests.programs import PATIENCE
from vitruvius.cli import main
from vitruvius.logic.browser.watch.pool import PROCESSES, Pool, Spares, Stale
from vitruvius.logic.drawing.canvas import svg
from vitruvius.logic.drawing.draw import plan
from vitruvius.logic.drawing.palettes import style
from vitruvius.logic.grammar import SHIPPED
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.workers.messages import Counted, CountLayouts, Made, MakeHouse

pytestmark = pytest.mark.second_part("pages are driven in a browser, and solvers are compared")

expect.set_options(timeout=1000 * PATIENCE)


@dataclass
class Watched:
    """Grammar that a process watches, and the page's address."""

    folder: Path
    address: str
    process: subprocess.Popen[str]

    def save(self, name: str, text: str) -> None:
        """Save a file as many editors do: write another file, and rename it."""
        (self.folder / "new").write_text(text)
        (self.folder / "new").rename(self.folder / name)

    def restore(self) -> None:
        """Restore all files of the shipped grammar."""
        for file in (SHIPPED / "family").iterdir():
            if (self.folder / file.name).read_text() != file.read_text():
                self.save(file.name, file.read_text())

    def ask(self, path: str = "", body: object = None, **headers: str) -> tuple[int, str]:
        """Return the status and the text of an answer to a plain request."""
        url = urlsplit(self.address)
        connection = http.client.HTTPConnection(url.hostname or "", url.port, timeout=PATIENCE)
        method = "GET" if body is None else "POST"
        text = body if isinstance(body, str) or body is None else json.dumps(body)
        connection.request(method, path if path[:1] == "/" else url.path + path, text, headers)
        answer = connection.getresponse()
        return answer.status, answer.read().decode()


@contextmanager
def watching(folder: Path, grammar: str = "family") -> Iterator[Watched]:
    """Run the command on a copy of a grammar."""
    shutil.copytree(SHIPPED / grammar, folder)
    command = [sys.executable, "-m", "vitruvius.cli", "watch", str(folder)]
    root = str(Path(__file__).parents[3])
    environment = os.environ | {"PYTHONPATH": root}
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, cwd=root, env=environment) as process:
        assert process.stderr
        said = [process.stderr.readline() for _ in range(3)]
        yield Watched(folder, said[1].strip(), process)
        process.kill()


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Watched]:
    with watching(tmp_path_factory.mktemp("grammars") / "mine") as watched:
        yield watched


@pytest.fixture
def watched(server: Watched, page: Page) -> Watched:
    """Open the page with its first sheet, four houses of the shipped rules."""
    server.restore()
    page.goto(f"{server.address}#rooms=4&seed=0&count=4&size=260")
    drawn(page, 4)
    return server


def drawn(page: Page, houses: int) -> None:
    """Wait until the page shows this number of houses of the current rules."""
    expect(page.locator("#status")).to_contain_text(f"{houses} house{'s' * (houses > 1)}, drawn in")
    expect(page.locator("#sheet li:not(.old) svg")).to_have_count(houses)
    expect(page.locator("#sheet .old")).to_have_count(0)


def rooms(page: Page, type_: str) -> int:
    """Return the number of rooms of a type in all houses of the page."""
    return (
        page.locator(f'#sheet [data-part][aria-label$=", {type_}"]')
        .and_(page.locator('[data-part]:not([data-part*="."])'))
        .count()
    )


def test_saving_a_rule_file_draws_the_houses_of_the_new_rules_and_lints_them(
    watched: Watched, page: Page
) -> None:
    assert rooms(page, "hall") > 0
    rules = (watched.folder / "rooms.lp").read_text()
    watched.save("rooms.lp", f"{rules}\n:- room(_,hall).\n:- rooms < 0.\n")
    expect(page.locator("#code .here")).to_contain_text(":- room(_,hall).")
    drawn(page, 4)
    assert rooms(page, "hall") == 0
    never_binds = page.locator(
        "#code .line.warning + .note.warning", has_text="this rule never binds: :- rooms < 0."
    )
    expect(never_binds).to_have_count(1)
    expect(page.locator('[role="tab"][aria-selected="true"]')).to_contain_text("rooms.lp")


def test_a_mistake_stands_at_its_line_beside_the_last_good_houses(watched: Watched, page: Page) -> None:
    shown = page.locator("#sheet svg").evaluate_all("(all) => all.map((each) => each.outerHTML)")
    rules = (watched.folder / "rooms.lp").read_text()
    watched.save("rooms.lp", rules.replace("type(bedroom; bathroom", "type(bedroom bathroom"))
    note = page.locator("#code .note.error")
    expect(note).to_contain_text("rooms.lp:3:14: error: syntax error")
    assert page.locator("#code .line.error").get_attribute("data-line") == "3"
    expect(page.locator("#sheet li.old")).to_have_count(4)
    assert page.locator("#sheet svg").evaluate_all("(all) => all.map((each) => each.outerHTML)") == shown
    watched.save("rooms.lp", rules)
    drawn(page, 4)
    expect(note).to_have_count(0)


def test_a_colour_of_the_looks_is_saved_and_seen(watched: Watched, page: Page) -> None:
    floor = page.locator('#sheet [data-part][aria-label$=", kitchen"] > [fill]').first
    before = floor.get_attribute("fill")
    watched.save("looks.json", '{"rooms": {"kitchen": "#ffe0b0"}}')
    expect(floor).to_have_attribute("fill", "#ffe0b0")
    watched.restore()
    expect(floor).to_have_attribute("fill", before or "")
    drawn(page, 4)


def test_a_proof_names_the_rules_that_conflict_and_leads_to_their_lines(watched: Watched, page: Page) -> None:
    page.get_by_label("bathroom", exact=True).fill("4")
    answer = page.locator("#answer")
    expect(answer).to_contain_text("no house of mine has 4 rooms, 4 of type bathroom")
    expect(answer).to_contain_text("There is a house with --rooms 6")
    page.get_by_role("button", name="rooms.lp:10").click()
    assert page.locator("#code .here").inner_text().split() == [
        "10", ":-", "rooms", ">=", "3,", "basic(T),", "not", "room(_,T).",
    ]  # fmt: skip
    page.get_by_label("bathroom", exact=True).fill("")
    drawn(page, 4)
    expect(answer).to_be_hidden()


def test_a_click_on_a_piece_says_by_which_picks_and_rules_it_stands_there(
    watched: Watched, page: Page
) -> None:
    piece = page.locator('#sheet li:first-child [data-part="R0.bed"], #sheet [data-part*=".bed"]').first
    name = piece.get_attribute("data-part") or ""
    piece.click()
    answer = page.locator("#answer")
    expect(answer.locator("h2")).to_have_text(f"Why {name}")
    expect(answer).to_contain_text("picked out of")
    page.get_by_role("button", name=re.compile(r"^furniture\.lp:\d+")).first.click()
    place = page.locator("#code .here")
    assert (place.get_attribute("data-line") or "0") > "0"
    assert "bed" in place.inner_text()


def test_all_of_it_works_by_the_keyboard(watched: Watched, page: Page) -> None:
    first = page.locator("#sheet li").first.locator("[data-part]")
    names = first.evaluate_all("(all) => all.map((each) => each.dataset.part)")
    first.first.focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Enter")
    answer = page.locator("#answer")
    expect(answer.locator("h2")).to_have_text(f"Why {names[1]}")
    expect(answer.locator("section").first).to_be_visible()
    page.keyboard.press("Escape")
    expect(answer).to_be_hidden()
    page.keyboard.press("ArrowDown")
    assert page.evaluate(
        "[...document.querySelectorAll('#sheet li')].indexOf(document.activeElement.closest('li'))"
    )
    page.get_by_role("tab").first.focus()
    page.keyboard.press("End")
    expect(page.locator('[role="tab"][aria-selected="true"]')).to_have_text("looks.json")
    page.get_by_role("slider", name="Rooms").focus()
    page.keyboard.press("ArrowRight")
    expect(page.locator("#sheet li").first).to_contain_text("5 rooms")
    page.get_by_label("hall", exact=True).focus()
    page.keyboard.press("ArrowUp")
    page.keyboard.press("ArrowUp")
    expect(page.locator("#command")).to_contain_text("--rooms 5 --type hall=1")


def test_sliders_and_boxes_ask_for_other_houses_and_outlive_a_reload(watched: Watched, page: Page) -> None:
    page.get_by_role("slider", name="Houses").fill("3")
    page.get_by_label("Seed", exact=True).fill("5")
    page.get_by_label("bedroom", exact=True).fill("2")
    page.get_by_text("Pieces").click()
    page.get_by_label("wardrobe", exact=True).fill("1..")
    command = "--rooms 4 --type bedroom=2 --piece bedroom.wardrobe=1.. --seed 5 --count 3"
    expect(page.locator("#command")).to_contain_text(command)
    drawn(page, 3)
    assert rooms(page, "bedroom") == 6
    page.reload()
    drawn(page, 3)
    expect(page.locator("#command")).to_contain_text(command)
    assert rooms(page, "bedroom") == 6


def test_the_page_shows_the_houses_that_generate_makes(watched: Watched, page: Page) -> None:
    question = {"version": next(versions(watched))["version"], "request": {"rooms": 4, "seed": 7, "count": 3}}
    answer = [json.loads(line) for line in watched.ask("sheet", question)[1].splitlines()]
    houses = list(generate(rooms=4, seed=7, count=3, grammar=watched.folder))
    parts = sorted((part for part in answer if "house" in part), key=lambda part: part["index"])
    assert [part["house"] for part in parts] == [json.loads(json.dumps(house.to_dict())) for house in houses]
    look = style(houses[:1], grammar=watched.folder)
    assert parts[0]["svg"] == svg([((0, 0), plan(houses[0], 300, 300, look=look))], 300, 300)


def versions(watched: Watched) -> Iterator[dict[str, Any]]:
    """Yield the rules from the stream of events: the current ones, then at each change."""
    url = urlsplit(watched.address)
    connection = http.client.HTTPConnection(url.hostname or "", url.port, timeout=PATIENCE)
    connection.request("GET", f"{url.path}events")
    for line in connection.getresponse():
        if line.startswith(b"data: "):
            yield json.loads(line.removeprefix(b"data: "))


def test_on_a_telephone_what_is_tapped_is_answered_in_its_place(server: Watched, phone: Page) -> None:
    server.restore()
    phone.goto(f"{server.address}#rooms=4&count=8")
    drawn(phone, 8)
    assert box(phone.locator("#houses"))["y"] < box(phone.locator("#rules"))["y"]
    for kind in (".bed", ".toilet"):
        part = phone.locator(f"#sheet li:last-child [data-part$='{kind}']").first
        part.scroll_into_view_if_needed()
        answered_under_the_finger(phone, part)
    phone.get_by_role("button", name=re.compile(r"^\w+\.(lp|pl):\d+")).first.tap()
    line_is_seen(phone)
    phone.get_by_role("button", name="Close the answer").tap()
    assert 0 <= box(part)["y"] < 844
    server.save("rooms.lp", (server.folder / "rooms.lp").read_text() + "\n:- rooms < 0.\n")
    expect(phone.locator("#code .note.warning")).to_contain_text("this rule never binds")
    phone.get_by_role("tab", name="sizes.pl").tap()
    phone.locator("#findings .place").first.tap()
    line_is_seen(phone)
    phone.locator("[name='type.bathroom']").fill("4")
    expect(phone.locator("#answer")).to_contain_text("no house of mine has 4 rooms, 4 of type bathroom")
    phone.locator("#answer .place").first.tap()
    line_is_seen(phone)


def test_the_page_fits_screens_and_paper_and_axe_finds_nothing(watched: Watched, page: Page) -> None:
    page.locator("#sheet [data-part*='.bed']").first.click()
    expect(page.locator("#answer section").first).to_be_visible()
    assert findings(page) == []
    assert too_wide(page) == []
    assert cut_on_paper(page) == []
    expect(page.locator("#answer")).to_be_visible()
    expect(page.locator("#rules")).to_be_hidden()


@pytest.mark.parametrize(
    ("label", "text", "words"),
    [
        ("bathroom", "abc", "bathroom: “abc” is not a count: write 2, 1..3, 2.. or nothing."),
        ("kitchen", "3..1", "kitchen: 3..1 has its minimum above its maximum."),
        ("Seed", "-1", "Seed: a whole number from 0 to 2147483647."),
        ("Seed", "", "Seed: a whole number from 0 to 2147483647."),
    ],
)
def test_a_wrong_field_is_answered_in_words_and_an_old_proof_goes(
    watched: Watched, page: Page, label: str, text: str, words: str
) -> None:
    page.get_by_label("bathroom", exact=True).fill("4")
    expect(page.locator("#answer")).to_contain_text("no house")
    field = page.get_by_label(label, exact=True)
    field.fill(text)
    expect(page.locator("#wrong")).to_have_text(words)
    expect(field).to_have_attribute("aria-invalid", "true")
    expect(page.locator("#answer")).to_be_hidden()
    expect(page.locator("#sheet li:not(.old)")).to_have_count(0)
    page.get_by_label("bathroom", exact=True).fill("")
    field.fill("0")
    expect(page.locator("#wrong")).to_have_text("")


def test_back_and_forward_go_through_what_was_asked_for(watched: Watched, page: Page) -> None:
    seed, hall = page.get_by_label("Seed", exact=True), page.get_by_label("hall", exact=True)
    command = page.locator("#command")
    page.get_by_role("button", name="Another seed").click()
    expect(command).to_contain_text("--seed 1")
    page.get_by_role("button", name="Another seed").click()
    expect(command).to_contain_text("--seed 2")
    hall.press_sequentially("1..")
    expect(command).to_contain_text("--type hall=1..")
    page.go_back()
    expect(hall).to_have_value("")
    expect(command).to_contain_text("--seed 2")
    page.go_back()
    expect(seed).to_have_value("1")
    drawn(page, 4)
    page.go_forward()
    page.go_forward()
    expect(hall).to_have_value("1..")
    expect(command).to_contain_text("--type hall=1.. --seed 2")
    page.goto(f"{watched.address}#seed=5&count=4&type.cellar=2")
    drawn(page, 4)
    expect(page.locator("#wrong")).to_have_text("These rules have no cellar: its count is left out.")


def test_after_the_end_of_the_server_each_button_says_what_to_do(tmp_path: Path, browser: Browser) -> None:
    page = browser.new_page()
    words = "The server has stopped: run vitruvius watch {} again, and open the address that it prints."
    with watching(tmp_path / "mine") as watched:
        page.goto(f"{watched.address}#rooms=2&count=1")
        drawn(page, 1)
        watched.process.kill()
        watched.process.wait()
        expected = words.format(watched.folder)
        expect(page.locator("#status")).to_have_text(expected)
        page.locator("#sheet [data-part=R0]").click()
        expect(page.locator("#answer")).to_contain_text(expected)
        page.get_by_role("button", name="Another seed").click()
        expect(page.locator("#sheet .old")).to_have_count(1)
        expect(page.locator("#status")).to_have_text(expected)
    page.close()


SLOW = """
let told;
window.answers = [];
export const engine = {
  editable: false,
  open(onRules) { onRules({version: 1, saved: Date.now() - 3600000, grammar: "fake", files: []}); },
  // Deaf to the signal: each answer waits until the test gives it.
  sheet(version, request, onPart) {
    return new Promise((resolve) => window.answers.push(() => {
      const svg = `<svg xmlns="http://www.w3.org/2000/svg"><text>seed ${request.seed}</text></svg>`;
      onPart({kinds: {types: {}, most_rooms: 9}});
      onPart({index: 0, house: {}, types: {}, svg});
      resolve();
    }));
  },
  async lint() { throw new Error("lint reached its limit"); },
  why: null,
};
"""


def asked(page: Page, questions: int) -> None:
    """Wait until the page has asked ``SLOW`` this often. The page's policy forbids ``wait_for_function``."""
    for _ in range(200):
        if page.evaluate("window.answers?.length ?? 0") >= questions:
            return
        page.wait_for_timeout(50)
    pytest.fail(f"the page did not ask {questions} times in 10 s")


def test_a_stale_answer_never_takes_the_place_of_a_newer_one(server: Watched, page: Page) -> None:
    def engine(route: Route) -> None:
        route.fulfill(body=SLOW, content_type="text/javascript")

    page.route("**/engine.js", engine)
    page.goto(f"{server.address}#count=1")
    asked(page, 1)
    page.get_by_label("Seed", exact=True).fill("1")
    asked(page, 2)
    page.evaluate("answers[1]()")
    expect(page.locator("#sheet")).to_have_text("seed 1")
    page.evaluate("answers[0]()")
    page.wait_for_timeout(50)
    assert page.locator("#sheet").inner_text() == "seed 1"
    # The time counts from the page's request, not from the save. The findings of lint follow.
    said = re.compile(r"1 house, drawn in \d\.\d\d s\. Some rules were not checked\.")
    expect(page.locator("#status")).to_have_text(said)


def test_many_saves_in_a_row_end_in_the_houses_of_the_last(watched: Watched, page: Page) -> None:
    rules = (watched.folder / "rooms.lp").read_text()
    for barred in ("bedroom", "kitchen", "hall"):
        watched.save("rooms.lp", f"{rules}\n:- room(R,{barred}), R > 0.\n")
        page.wait_for_timeout(120)
    drawn(page, 4)
    expect(page.locator("#code")).to_contain_text("room(R,hall)")
    assert rooms(page, "bedroom") > 4
    assert rooms(page, "hall") <= 4


@pytest.mark.parametrize(
    ("path", "headers", "said"),
    [
        ("/", {}, "the token in this address is not that of this page"),
        ("/wrong/events", {}, "the token in this address is not that of this page"),
        ("", {"Host": "rebound.example:80"}, "the host rebound.example:80 is not this machine"),
    ],
)
def test_only_this_machine_with_the_token_is_answered(
    server: Watched, path: str, headers: dict[str, str], said: str
) -> None:
    status, text = server.ask(path, **headers)
    assert status == 403
    assert text.startswith(said)
    assert text.count("\n") == 1


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ("{", "Input data was truncated"),
        (
            {"version": 1, "request": {"rooms": 0, "seed": 0, "count": 1}},
            "Expected `int` >= 1 - at `$.request.rooms`",
        ),
        ({"version": 1}, "sheet: name the houses by request"),
    ],
)
def test_what_is_no_question_is_refused_by_a_line(server: Watched, body: object, said: str) -> None:
    assert server.ask("sheet", body) == (400, f"{said}\n")


def test_the_page_is_served_to_this_machine_alone(server: Watched) -> None:
    port = urlsplit(server.address).port
    with socket.socket() as other, pytest.raises(OSError):  # noqa: PT011
        other.bind(("127.0.0.1", port or 0))
    addresses = {line.split()[1] for line in Path("/proc/net/tcp").read_text().splitlines()[1:]}
    assert {each.split(":")[0] for each in addresses if each.endswith(f":{port:04X}")} == {"0100007F"}


def test_ctrl_c_ends_it_at_once_with_all_processes(tmp_path: Path) -> None:
    with watching(tmp_path / "mine") as watched:
        url = urlsplit(watched.address)
        streams = []
        for path, body in (
            ("events", None),
            ("sheet", {"version": 1, "request": {"rooms": 9, "seed": 0, "count": 48}}),
        ):
            connection = http.client.HTTPConnection(url.hostname or "", url.port, timeout=PATIENCE)
            connection.request("POST" if body else "GET", url.path + path, json.dumps(body))
            streams.append(connection.getresponse())
        assert "kinds" in streams[1].readline().decode()
        workers = children(watched.process.pid)
        assert workers
        watched.process.send_signal(signal.SIGINT)
        assert watched.process.wait(PATIENCE) == 130
        assert watched.process.stderr
        assert watched.process.stderr.read() == "interrupted\n"
        assert not [worker for worker in workers if is_alive(worker)]


def test_a_process_that_starts_as_its_parent_ends_says_nothing_and_leaves_nothing(tmp_path: Path) -> None:
    lookup = tmp_path / "swipl"
    # A file in the folder marks that the process has started, since solver processes may write no file.
    lookup.write_text(f"#!/bin/sh\ntrap '' PIPE\nmkdir {tmp_path}/started.$$\nsleep 0.5\necho 'A=\"b\"'\n")
    lookup.chmod(0o755)
    parent = (
        "import os, pathlib, time\n"
        "from vitruvius.logic.workers.messages import Prepare\n"
        "from vitruvius.logic.workers.solver import Solver\n"
        "solver = Solver(Prepare(grammar=''))\n"
        f"while not [*pathlib.Path({str(tmp_path)!r}).glob('started.*')]: time.sleep(0.01)\n"
        "os._exit(0)\n"
    )
    path = os.pathsep.join((str(tmp_path), os.environ["PATH"]))
    said = subprocess.run(
        [sys.executable, "-c", parent],
        stderr=subprocess.PIPE,
        cwd=Path(__file__).parents[3],
        env=os.environ | {"PATH": path},
        text=True,
        timeout=PATIENCE,
        check=True,
    ).stderr  # Read until all processes that could write there have ended.
    assert said == ""
    (started,) = tmp_path.glob("started.*")
    deadline = time.monotonic() + PATIENCE
    while is_alive(int(started.suffix[1:])):  # A killed process closes its files just before it ends.
        assert time.monotonic() < deadline
        time.sleep(0.01)


def test_past_its_end_the_page_starts_no_process() -> None:
    async def asked() -> set[int]:
        spares = Spares(SHIPPED / "family")
        pool = Pool(SHIPPED / "family", spares)
        pool.end()
        spares.end()
        before = {each for each in children(os.getpid()) if is_alive(each)}
        spares.refill()  # As a sheet does that is cut off.
        with pytest.raises(Stale):
            await pool.verdict()
        return {each for each in children(os.getpid()) if is_alive(each)} - before

    with ThreadPoolExecutor(1) as thread:
        assert not thread.submit(asyncio.run, asked()).result()


def children(parent: int) -> list[int]:
    """Return the child processes of a process."""
    listed = Path(f"/proc/{parent}/task").glob("*/children")
    return [int(child) for each in listed for child in each.read_text().split()]


def is_alive(process: int) -> bool:
    try:
        return "\nState:\tZ" not in Path(f"/proc/{process}/status").read_text()
    except FileNotFoundError:
        return False


def test_a_folder_that_goes_and_comes_back_is_watched_on(server: Watched) -> None:
    server.restore()
    told = versions(server)
    files = {file.name: file.read_text() for file in server.folder.iterdir()}
    away = server.folder.with_name("away")
    server.folder.rename(away)
    gone = next(each for each in told if not each["files"])
    answer = server.ask("sheet", {"version": gone["version"], "request": {"rooms": 1, "seed": 0, "count": 1}})
    assert "there is no such directory" in answer[1]
    away.rename(server.folder)
    assert {file["name"]: file["text"] for file in next(told)["files"]} == files
    server.save("rooms.lp", "% Nothing.")
    assert "% Nothing." in [file["text"] for file in next(told)["files"]]


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        ("famly", 5, "there is no such directory, and there is no grammar famly: did you mean family?"),
        ("--port 70000", 2, "--port 70000: ports are 0 to 65535"),
        ("--seconds 0", 2, "--seconds 0: must be above 0"),
    ],
)
def test_a_wrong_command_is_answered_by_a_line(
    arguments: str, code: int, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as end:
        main(["watch", *arguments.split()])
    assert end.value.code == code
    assert said in capsys.readouterr().err


def test_a_port_in_use_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(SystemExit) as end:
            main(["watch", "--port", str(port)])
    assert end.value.code == 2
    assert f"--port {port}: is in use: choose another" in capsys.readouterr().err


def test_a_question_that_nobody_waits_for_gives_its_process_back() -> None:
    async def asked() -> None:
        spares = Spares(SHIPPED / "family")
        pool = Pool(SHIPPED / "family", spares)
        await pool.verdict()
        slow = CountLayouts(request=HouseRequest(9), share=1e5)
        counts = [
            asyncio.ensure_future(pool.ask(lambda worker: list(worker.series(slow, Counted, 1e5, "late"))))
            for _ in range(2 * PROCESSES)
        ]
        await asyncio.sleep(0.1)
        for count in counts:
            count.cancel()
        house = MakeHouse(request=HouseRequest(1), seed=0, index=0)

        def made(worker: Any) -> Made:
            return worker.asked(house, Made, PATIENCE, "late")

        assert (await asyncio.wait_for(pool.ask(made), PATIENCE)).house
        pool.end()
        with pytest.raises(Stale):
            await pool.ask(made)
        spares.end()

    before = {each for each in children(os.getpid()) if is_alive(each)}
    with ThreadPoolExecutor(1) as thread:  # In this one runs the browser's loop.
        thread.submit(asyncio.run, asked()).result()
    assert {each for each in children(os.getpid()) if is_alive(each)} <= before
