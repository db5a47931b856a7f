"""From rules to houses: claims about every house, and about every request without a house."""

import gc
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.logic.workers import in_process
from tests.programs import PATIENCE, finished
from vitruvius.logic import (
    GrammarError,
    House,
    RequestError,
    Unsatisfiable,
    check,
    generate,
    lint,
    load,
)
from vitruvius.logic.grammar import SHIPPED, find
from vitruvius.logic.language.linter import findings
from vitruvius.logic.workers import pool
from vitruvius.logic.workers.messages import Open
from vitruvius.logic.workers.solver import Solver

GOLDEN = Path(__file__).parents[2] / "golden" / "family-4-rooms.json"
Edit = Callable[[str, str, str], Path]


@pytest.fixture
def edited(tmp_path: Path) -> Edit:
    """Return a function that replaces one text in one file of a copy of the family grammar."""

    def edit(file: str, old: str, new: str) -> Path:
        folder = tmp_path / "mine"
        if not folder.exists():
            shutil.copytree(SHIPPED / "family", folder)
        text = (folder / file).read_text()
        assert old in text
        (folder / file).write_text(text.replace(old, new, 1))
        return folder

    return edit


def line_of(file: Path, text: str) -> int:
    return next(number for number, line in enumerate(file.read_text().split("\n"), 1) if text in line)


# Houses.


@pytest.mark.parametrize("rooms", range(1, 17))
def test_houses_of_every_size_keep_every_promise(rooms: int) -> None:
    """There are 128 houses in all."""
    houses = list(generate(rooms=rooms, seed=rooms, count=8))
    assert [check(house) for house in houses] == [[]] * len(houses)
    assert {len(house.star.rooms) for house in houses} == {rooms}


def test_a_house_is_a_function_of_its_seed_and_index() -> None:
    houses = list(generate(rooms=4, seed=3, count=5))
    assert len({json.dumps(house.to_dict()["floor"]) for house in houses}) == 5
    assert list(generate(rooms=4, seed=3, count=2, start=3)) == houses[3:]
    assert list(generate(rooms=4, seed=3, count=5, workers=3)) == houses
    assert next(generate(rooms=4, seed=4)) != houses[0]


def test_a_seed_gives_the_golden_house() -> None:
    """The same seed gives the same house on every machine, to a millionth of a metre."""
    made, golden = next(generate(rooms=4, seed=2026)), load(GOLDEN)[0]
    assert flat(made) == pytest.approx(flat(golden), abs=1e-6)
    assert [[piece.type for piece in room.pieces] for room in made.star.rooms] == [
        [piece.type for piece in room.pieces] for room in golden.star.rooms
    ]


def flat(house: House) -> list[float]:
    rects = [
        house.star.floor,
        *(rect for room in house.star.rooms for rect in (room, room.door, *room.pieces)),
    ]
    return [value for rect in rects for value in rect.box]


def test_types_are_exact_counts() -> None:
    for house in generate(rooms=6, types={"bedroom": 3, "hall": 0}, count=5):
        types = [room.type for room in house.star.rooms]
        assert (types.count("bedroom"), types.count("hall")) == (3, 0)


def test_houses_have_types_and_furniture_within_the_ranges_asked_for() -> None:
    asked = {"bed": 1, "bedroom.wardrobe": (1, None), "shower": (0, 0)}
    houses = list(generate(rooms=7, types={"bedroom": (2, 3), "hall": (1, None)}, furniture=asked, count=5))
    for house in houses:
        types = [room.type for room in house.star.rooms]
        assert types.count("bedroom") in {2, 3}
        assert types.count("hall") >= 1
        for room in house.star.rooms:
            pieces = [piece.type for piece in room.pieces]
            assert "shower" not in pieces
            if room.type == "bedroom":
                assert pieces.count("bed") == 1
                assert pieces.count("wardrobe") >= 1
        assert check(house) == []
    assert houses[0].provenance
    assert houses[0].provenance.request["types"] == {"bedroom": [2, 3], "hall": [1, None]}


def test_a_house_says_where_it_comes_from() -> None:
    house = next(generate(rooms=2, types={"bedroom": 1}, seed=5, start=7))
    assert house.provenance
    assert (house.provenance.grammar, house.provenance.seed, house.provenance.index) == ("family", 5, 7)
    assert house.provenance.request == {"rooms": 2, "types": {"bedroom": 1}}
    assert set(house.provenance.versions) == {"vitruvius", "clingo", "swi-prolog"}
    assert House.from_dict(json.loads(json.dumps(house.to_dict()))) == house


def test_a_new_room_type_needs_two_files_and_no_python(edited: Edit) -> None:
    """As in docs/use.md: the type and its furniture in a .lp file, their sizes in a .pl file."""
    folder = edited("furniture.lp", "may(bedroom,bed,1,2).", "may(bedroom,bed,1,2).")
    for file, lines in (
        ("furniture.lp", "type(study).\nmay(study,lectern,1,1).      stands(lectern, (back; left)).\n"),
        (
            "sizes.pl",
            "room_size(study, W, D) :- { W >= 2.5, W =< 4.0, D >= 2.5, D =< W }.\n"
            "piece_size(lectern, L, D, _) :- { L >= 0.5, L =< 0.8, D = 0.5 }.\n",
        ),
    ):
        with (folder / file).open("a") as rules:
            rules.write(lines)
    assert findings(find(folder)) == []
    (house,) = in_process.generate(rooms=4, types={"study": 1}, grammar=folder)
    (study,) = (room for room in house.star.rooms if room.type == "study")
    assert [piece.type for piece in study.pieces] == ["lectern"]
    assert check(house) == []


@pytest.mark.parametrize("cell", [0.287, 0.3, 0.5])
def test_houses_on_a_grid_keep_every_promise_with_every_edge_on_a_cell(cell: float) -> None:
    """The check knows the grid from the provenance: see the next test."""
    for rooms in (1, 2, 3, 5, 8, 16):
        for house in in_process.generate(rooms, cell=cell, seed=rooms, count=3):
            assert check(house) == []
            assert house.provenance
            assert house.provenance.request["cell"] == cell
            corner = (house.star.floor.x, house.star.floor.y) * 2
            assert all(
                (edge - origin) / cell == pytest.approx(round((edge - origin) / cell), abs=1e-6)
                for room in house.star.rooms
                for rect in (room, room.door, *room.pieces)
                for edge, origin in zip(rect.box, corner, strict=True)
            )


def test_check_reports_a_house_off_its_grid() -> None:
    house = next(in_process.generate(rooms=2, cell=0.3))
    record = house.to_dict()
    record["R0"]["children"][0]["width"] += 0.05
    assert any("off the grid of 0.3 m" in line for line in check(House.from_dict(record)))
    record = house.to_dict()
    record["floor"]["width"] += 0.1
    assert any("not whole cells" in line for line in check(House.from_dict(record)))


# No houses: proofs, limits and errors.


def test_too_many_of_a_type_is_proved_impossible() -> None:
    with pytest.raises(Unsatisfiable, match="9 of type bathroom") as caught:
        next(generate(rooms=3, types={"bathroom": 9, "kitchen": 1}))
    assert [reason.text for reason in caught.value.reasons] == ["--rooms 3", "--type bathroom=9"]


def test_a_room_too_small_for_its_furniture_is_proved_impossible(edited: Edit) -> None:
    """No bed of 1.9 m and no passage fit into 2 m. Stage 2 proves it, and stage 1 learns it."""
    large = "room_size(bedroom,  W, D) :- { W >= 3.2, W =< 5.2, D >= 3.2, D =< 5.2 }."
    folder = edited("sizes.pl", large, "room_size(bedroom, 2.0, 2.0).")
    with pytest.raises(Unsatisfiable) as caught:
        next(in_process.generate(rooms=3, grammar=folder))
    texts = [reason.text for reason in caught.value.reasons]
    assert {"passage(0.42).", "room_size(bedroom, 2.0, 2.0).", "may(bedroom,bed,1,2)."} < set(texts)
    (room,) = next(in_process.generate(rooms=1, grammar=folder, seed=1)).star.rooms
    assert room.type != "bedroom"


@pytest.mark.parametrize(
    ("wrong", "word"),
    [
        ({"rooms": 0}, "rooms"),
        ({"rooms": 129}, "128"),
        ({"rooms": 2.5}, "rooms"),
        ({"rooms": 3, "count": 0}, "count"),
        ({"rooms": 3, "types": {"bedroom": -1}}, "bedroom"),
        ({"rooms": 3, "types": {"bedroom": (2, 1)}}, "smaller first"),
        ({"rooms": 3, "types": {"bedroom": 1.5}}, "whole number"),
        ({"rooms": 3, "types": {"bedrom": 1}}, "did you mean bedroom.*There are bathroom, bedroom"),
        ({"rooms": 3, "furniture": {"bad": 1}}, "did you mean bed"),
        ({"rooms": 3, "furniture": {"hall.bed": 1}}, "no piece bed"),
        ({"rooms": 3, "cell": 0.2}, "0.287"),
        ({"rooms": 3, "seconds": 0.0}, "seconds"),
    ],
)
def test_a_request_without_sense_is_refused(wrong: dict, word: str) -> None:
    with pytest.raises(RequestError, match=word):
        next(generate(**wrong))


def test_an_unknown_grammar_is_named() -> None:
    with pytest.raises(GrammarError, match=r"famly.*family"):
        generate(rooms=3, grammar="famly")


@pytest.mark.parametrize(
    ("file", "old", "new", "says"),
    [
        ("sizes.pl", "L =< 2.2, D >= 0.5,  D", "L =< 2.2 D >= 0.5,  D", "operator"),
        (
            "sizes.pl",
            "piece_size(sofa,      L, D, _) :- { L >=",
            "piece_size(sofa, L, D, _) :- { M >=",
            "ingleton",
        ),
        ("sizes.pl", "passage(0.42).", ":- atom_length(X, Y), passage(X, Y).", "runs code"),
    ],
)
def test_a_wrong_rule_is_named_by_file_and_line(
    edited: Edit, file: str, old: str, new: str, says: str
) -> None:
    """SWI-Prolog drops such a clause and continues. Here it is an error."""
    folder = edited(file, old, new)
    with pytest.raises(GrammarError, match=says) as caught:
        next(in_process.generate(rooms=3, grammar=folder))
    assert str(caught.value.file) == str(folder / file)
    assert caught.value.line == line_of(folder / file, new)
    assert caught.value.column


def test_rules_that_never_end_meet_the_limit(edited: Edit) -> None:
    loop = "piece_size(toilet, L, D, W) :- piece_size(toilet, L, D, W).\npiece_size(tub,"
    with pytest.raises(GrammarError, match="never ends"):
        next(generate(rooms=3, grammar=edited("sizes.pl", "piece_size(toilet,", loop)))


def test_hidden_files_of_a_grammar_are_not_read(edited: Edit) -> None:
    folder = edited("sizes.pl", "passage(0.42).", "passage(0.42).  % größer als der Körper")
    (folder / ".#rooms.lp").symlink_to("nowhere")
    (folder / "old.lp").mkdir()
    assert check(next(in_process.generate(rooms=1, grammar=folder))) == []


# Processes.

SCRIPT = """
import signal
from vitruvius.logic import generate
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background has it ignored
for house in generate(rooms=16, count=9999):
    print("house", flush=True)
"""


def children(process: int) -> list[int]:
    if Path("/proc/self/stat").exists():  # a minimal Linux has no ps
        listed = Path(f"/proc/{process}/task").glob("*/children")
        return [int(pid) for children in listed for pid in children.read_text().split()]
    found = finished(["pgrep", "-P", str(process)])
    return [int(pid) for pid in found.stdout.split()]


def test_a_solver_waits_for_the_next_request_for_the_same_rules(edited: Edit) -> None:
    """Starting a solver takes half a second. A new one starts after an edit of the rules.

    None starts after a request that has no house or makes no sense.
    """
    folder = edited("sizes.pl", "passage(0.42).", "passage(0.43).")
    first = next(generate(rooms=2, grammar=folder))
    waiting = set(children(os.getpid()))
    for types, error in (({"bathroom": 9}, Unsatisfiable), ({"bathrom": 1}, RequestError)):
        with pytest.raises(error):
            next(generate(rooms=2, grammar=folder, types=types))
    again = next(generate(rooms=2, grammar=folder))
    assert set(children(os.getpid())) == waiting
    assert again == first
    edited("sizes.pl", "passage(0.43).", "passage(0.9).")
    assert next(generate(rooms=2, grammar=folder)) != first
    assert set(children(os.getpid())) != waiting


@pytest.mark.second_part("several processes")
def test_of_several_solvers_one_hears_what_clingo_remarks_on_in_the_same_rules(
    edited: Edit, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Grounding all furniture for the remarks takes half of the time to load a grammar."""
    opened: list[bool] = []

    def counted(opening: Open) -> Solver:
        opened.append(opening.remarks)
        return Solver(opening)

    monkeypatch.setattr("vitruvius.logic.workers.pool.Solver", counted)
    folder = edited("rooms.lp", "#program house.", "% mine\n#program house.")
    assert len([*generate(rooms=1, grammar=folder, count=2, workers=2)]) == 2
    assert opened == [True, False]
    wrong = edited("arrangement.lp", "#program room.", "#program room.\n:- this_room + 1 > 2.")
    with pytest.raises(GrammarError, match="operation undefined"):
        next(generate(rooms=1, grammar=wrong))


def test_a_solver_that_was_killed_while_it_waited_is_replaced(edited: Edit) -> None:
    folder = edited("sizes.pl", "passage(0.42).", "passage(0.44).")
    before = set(children(os.getpid()))
    first = next(generate(rooms=2, grammar=folder))
    for worker in set(children(os.getpid())) - before:
        os.kill(worker, signal.SIGKILL)
        os.waitid(os.P_PID, worker, os.WEXITED | os.WNOWAIT)
    assert next(generate(rooms=2, grammar=folder)) == first


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGKILL])
def test_no_solver_outlives_its_parent(how: signal.Signals) -> None:
    parent = subprocess.Popen(
        [sys.executable, "-c", SCRIPT], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    )
    assert parent.stdout
    assert parent.stdout.readline() == "house\n"
    (worker,) = children(parent.pid)
    parent.send_signal(how)
    parent.wait(PATIENCE)
    end = time.monotonic() + PATIENCE
    while alive(worker) and time.monotonic() < end:
        time.sleep(0.02)
    assert not alive(worker)
    parent.stdout.close()


def alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    return Path(f"/proc/{process}/stat").read_text().split()[2] != "Z" if Path("/proc").exists() else True


@pytest.mark.parametrize("where", [".", "beside"])
def test_a_solver_imports_nothing_from_the_current_folder_or_beside_the_program(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, where: str
) -> None:
    folder = tmp_path / where
    (folder / "vitruvius").mkdir(parents=True)
    for name in ("clingo", "msgspec", "numpy", "pyswip", "queue", "token", "types", "vitruvius/__init__"):
        (folder / f"{name}.py").write_text(f"open({str(tmp_path / 'trace')!r}, 'a').write({name!r})\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sys.path", [str(folder), *sys.path])
    assert check(next(generate(rooms=1, cell=0.35))) == []
    assert not (tmp_path / "trace").exists()


def test_a_script_beside_modules_of_the_user_with_names_of_our_folders_works(tmp_path: Path) -> None:
    for name in ("logic", "agent", "sim/__init__", "benchmarks/__init__"):
        file = tmp_path / f"{name}.py"
        file.parent.mkdir(exist_ok=True)
        file.write_text("raise SystemExit('it was imported')\n")
    (tmp_path / "script.py").write_text(
        "import gymnasium, vitruvius, vitruvius.agent.avoidance\n"
        "house = next(vitruvius.generate(rooms=1))\n"
        "env = gymnasium.make('Vitruvius/House-v0', houses=[house])\n"
        "print(vitruvius.check(house), env.reset(seed=0)[0].shape)\n"
    )
    ended = finished([sys.executable, tmp_path / "script.py"])
    assert (ended.stdout, ended.stderr) == ("[] (40, 2)\n", "")


@pytest.mark.second_part("several processes")
def test_requests_leave_no_descriptor_open_but_those_of_waiting_solvers(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Descriptors are closed at once, not at the next garbage collection."""
    monkeypatch.setattr(pool, "MOST_IDLE", 1)
    gc.disable()
    try:
        opened = []
        for cell in (0.3, 0.31):
            next(generate(rooms=1, cell=cell))
            opened.append(len(os.listdir("/dev/fd")))
        assert lint() == []
        opened.append(len(os.listdir("/dev/fd")))
    finally:
        gc.enable()
    assert len({*opened}) == 1, opened


def test_a_main_room_on_a_grid_is_at_most_twice_as_long_as_wide() -> None:
    """A main room narrows if its width leaves no whole height.

    One of these 60 houses once broke the limit.
    """
    houses = in_process.generate(2, cell=0.5, seed=102, count=60)
    assert [violation for house in houses for violation in check(house)] == []
