"""Mistakes in rule files that clingo and SWI-Prolog ignore are found, by file, line and column."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.logic.workers import in_process
from vitruvius.cli import main
from vitruvius.logic import GrammarError, GrammarWarning, generate, lint
from vitruvius.logic.grammar import SHIPPED, find, shipped
from vitruvius.logic.language import linter
from vitruvius.logic.language.asp.statements import place
from vitruvius.logic.language.asp.vocabulary import Words, _core, core_words, words
from vitruvius.logic.language.linter import findings
from vitruvius.logic.language.loaded import LoadedGrammar
from vitruvius.logic.layout.conditional import Source
from vitruvius.logic.layout.program import Part
from vitruvius.logic.layout.relaxed import Relaxed


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("room_gap(0.6).", "room_gab(0.6)."),
        ("W >= 2.4, W =< 3.7", "W >= 3.8, W =< 3.7"),
        ("room_size(bathroom,", "room_size(bathrom,"),
    ],
    ids=["as-written", "as-solved", "as-used"],
)
def test_generate_refuses_what_lint_calls_an_error(old: str, new: str, tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / "family", folder)
    text = (folder / "sizes.pl").read_text()
    assert text.count(old) == 1
    (folder / "sizes.pl").write_text(text.replace(old, new))
    with pytest.raises(GrammarError) as caught:
        next(in_process.generate(rooms=3, grammar=folder))
    assert caught.value.message == findings(find(folder))[0].text


RULES = """
group(bedroom,night). group(bathroom,wet). group(kitchen,day). group(hall,day).
:- room(R,T), room(R+1,U), group(T,G), group(U,G), rooms < 4.
zone(bedroom,quiet). zone(kitchen,loud).
:- room(R,T), zone(T,quiet), side(R,south).
wing(north,a). wing(east,b). wing(south,a). wing(west,c).
:- side(R,S), side(Q,T), wing(S,W), wing(T,W), room(R,bathroom), room(Q,kitchen).
cost(bedroom,2). cost(hall,3). cost(kitchen,1).
:- #sum{ C,R : room(R,T), cost(T,C) } > 40.
opposite(S,T) :- clockwise(S,N), clockwise(N,T).
:- opposite(S,T), side(R,S), side(Q,T), room(R,bathroom), room(Q,bathroom).
#const most = 2.
:- #count{ R : room(R,hall) } > most, not room(_,T) : basic(T).
first_half(0..rooms/2).
:- first_half(R), room(R,bathroom), |R-Q| = 1, room(Q,bathroom).
chain(R,R+1) :- room(R,hall), room(R+1,hall).
chain(R,Q) :- chain(R,P), chain(P,Q).
:- chain(R,R+3).
last_room(M) :- M = #max{ R : room(R,_) }.
:- last_room(M), room(M,hall).
option(number,1..rooms,1).
:- pick(number,N), { room(_,bedroom) } > N.
-dark(R) :- side(R,south).
:- -dark(R), room((R+1)\\rooms,kitchen), not not room(R,hall).
allowed(0,bedroom). allowed(1..9,(bedroom;kitchen;bathroom;hall)).
:- room(R,T), not allowed(R,T), R < 2.
#program room.
option(head(K),(left;right),1) :- K = 1..2.
:- pick(head(K),S), on(bed,K,T,N), T != S, T != back.
small(toilet;sink;shower).
:- on(P,_,S,_), on(Q,_,S,_), small(P), small(Q), P < Q.
:- on(Piece,1,back,1), this_room = bathroom.
:- may(T,bed,_,M), T = this_room, on(bed,M,left,_).
"""


def test_rules_of_many_kinds_draw_no_finding(tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / "family", folder)
    with (folder / "rooms.lp").open("a") as rules:
        rules.write(RULES)
    assert findings(find(folder)) == []


BOUND = {
    "family": (
        "rooms.lp",
        ":- rooms >= 12, room(0,T), room(1,T).",
        ":- room(77,hall).",
        "#const many = 37. :- rooms > many, room(0,hall).",
        ":- { room(_,hall) } > 30.",
        "weight(hall,W) :- W = rooms/40+7, rooms > 100.",
    ),
    "clinic": (
        "rooms.lp",
        "#program house.",
        ":- wing(_,_,_).",
        ":- wing(3,south,_).",
        ":- rooms = 33, room(0,ward).",
        ":- in_row(R,(_,west),2), room(R,ward).",
        "#program room.",
        ":- on(bed,_,left_back,_), doorway(left,_).",
        ":- on(bed,_,left,_), on(bed,_,between(back,_),_).",
    ),
    "apartments": (
        "rooms.lp",
        "#program units.",
        ":- unit(14,7).",
    ),
}
IDLE = ":- rooms >= 12, room(R,_), R >= rooms."
"""Rule that binds in no house of any size, so that all sizes are tried."""


@pytest.mark.second_part("large grammars")
@pytest.mark.parametrize(("grammar", "never"), [("family", [IDLE]), ("clinic", []), ("apartments", [])])
def test_rules_that_bind_only_in_larger_houses_or_beside_some_doors_draw_no_finding(
    grammar: str, never: list[str], tmp_path: Path
) -> None:
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / grammar, folder)
    file, *rules = BOUND[grammar]
    with (folder / file).open("a") as text:
        text.write("\n".join(["", *rules, "#program house.", *never]))
    found = findings(find(folder))
    assert [(each.severity, each.text) for each in found] == [
        ("warning", f"this rule never binds: {rule}") for rule in never
    ]


def test_nothing_is_ground_in_which_no_rule_that_has_not_bound_yet_stands(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """All rules of ``home`` but one bind in houses of 6 and 8 rooms, and in rooms with any doors.

    The exception is a rule about a television below a window. For this rule the types of rooms with pieces
    are ground with a plan.
    """
    ground: list[list[str]] = []
    relaxed = linter.Relaxed

    def counted(source: Source, constants: dict[str, Any], parts: list[Part], most: int) -> Relaxed:
        ground.append([name for name, _ in parts])
        return relaxed(source, constants, parts, most=most)

    monkeypatch.setattr(linter, "Relaxed", counted)
    assert not findings(find("home"))
    with_plan = [parts for parts in ground if parts == ["room", "plan", "doorways"]]
    assert ground.count(["house", "typical"]) == 2
    assert len(with_plan) == 7
    assert ground.count(["room"]) == len(ground) - 9


def test_sizes_and_facts_of_pieces_that_no_room_has_are_warnings_and_change_nothing(tmp_path: Path) -> None:
    """Therefore grammars may share files, such as the sizes and arrangements of the clinic's pieces."""
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / "family", folder)
    before = next(in_process.generate(rooms=3, grammar=folder))
    (folder / "shared.pl").write_text(
        "piece_size(couch, L, D, _) :- { L >= 1.8, L =< 2, D = 0.7 }.\n"
        "piece_size(lamp, L, D, _) :- { L = 0.3, D = L }.\n"
        "piece_size(showerr, L, D, _) :- { L = 0.3, D = L }.\n"
    )
    (folder / "shared.lp").write_text(
        "stands(couch,(left;back)).\nclear_front(couch).\nhides(couch).\nbeside(couch,lamp,0,1).\n"
    )
    found = {(Path(each.file).name, each.line): each for each in findings(find(folder))}
    assert {each.severity for each in found.values()} == {"warning"}
    assert set(found) == {*(("shared.pl", n) for n in (1, 2, 3)), *(("shared.lp", n) for n in (1, 2, 3, 4))}
    assert found["shared.pl", 3].text.endswith("Did you mean shower?")
    with pytest.warns(GrammarWarning, match="piece_size: lamp is no piece in any room"):
        after = next(generate(rooms=3, grammar=folder))
    assert after.rooms == before.rooms


@pytest.mark.parametrize("grammar", ["family", "home"])
def test_the_words_of_the_core_that_are_read_as_text_are_those_of_its_syntax_trees(grammar: str) -> None:
    topology = find(grammar).topology

    def places(found: Words) -> list[list[tuple[object, list[tuple[str, int, int]]]]]:
        kinds = found.derived, found.used, found.constants
        return [
            [(name, [place(use.statement.node) for use in uses]) for name, uses in kind.items()]
            for kind in kinds
        ]

    by_text, by_trees = core_words(topology), words(_core(topology), core=Words())
    assert (places(by_text), by_text.stated) == (places(by_trees), by_trees.stated)


@pytest.mark.second_part("every grammar")
@pytest.mark.parametrize("grammar", sorted({*shipped()} - {"home"}))
def test_the_shipped_grammars_are_clean(grammar: str) -> None:
    """For ``home`` see ``test_nothing_is_ground_in_which_no_rule_that_has_not_bound_yet_stands``."""
    assert findings(find(grammar)) == []


def test_all_mistakes_are_listed_not_just_the_first(tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / "family", folder)
    with (folder / "furniture.lp").open("a") as rules:
        rules.write("may(attic,bed,1,1).\nmay(cellar,bed,1,1).\n")
    assert sum("no room type has this name" in finding.text for finding in lint(folder)) == 2


def test_nothing_of_a_refused_grammar_is_run(tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / "family", folder)
    with (folder / "sizes.pl").open("a") as rules:
        rules.write(f"\n:- open('{tmp_path}/trace', write, S), close(S).\n")
    assert [finding.severity for finding in lint(folder)] == ["error"]
    assert not (tmp_path / "trace").exists()


@pytest.mark.parametrize("file", ["rooms.lp", "sizes.pl", "looks.json"])
@pytest.mark.parametrize(
    ("content", "says"),
    [
        (lambda text: text.encode("utf-16"), "1:1: this file is UTF-16: save it as UTF-8"),
        (lambda text: text.encode("utf-16-be"), "1:1: this file is UTF-16 or not text: save it as UTF-8"),
        (lambda text: b"%\n% k" + "ü".encode("latin-1") + text.encode(), "2:4: not UTF-8: byte 0xfc, ü in"),
        (lambda text: b"\n \0" + text.encode(), "2:2: a NUL character"),
        (
            lambda text: f"% {text}".replace("\n", "\r").encode(),
            "a line ends with a carriage return only: save",
        ),
    ],
    ids=["utf-16", "utf-16 without its mark", "latin-1", "a NUL", "carriage returns"],
)
def test_a_file_in_another_encoding_is_one_error(
    file: str, content: Callable[[str], bytes], says: str, tmp_path: Path
) -> None:
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / "clinic", folder)
    (folder / file).write_bytes(content((folder / file).read_text()))
    (found,) = findings(find(folder))
    assert f"{found.file}:{found.line}:{found.column}: {found.text}".startswith(str(folder / file))
    assert says in f"{found.line}:{found.column}: {found.text}"


@pytest.mark.second_part("every grammar")
def test_what_changes_no_rule_is_no_error(tmp_path: Path) -> None:
    """Variants are a byte order mark where it is read, line ends of two letters, and the extreme numbers."""
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / "clinic", folder)
    for file in folder.iterdir():
        mark = b"" if file.suffix == ".lp" else b"\xef\xbb\xbf"
        file.write_bytes(mark + file.read_bytes().replace(b"\n", b"\r\n"))
    with (folder / "rooms.lp").open("a") as rules:
        rules.write('odd(-2147483648;2147483647). odd("9999999999"). % 9999999999\n%*\nü 9999999999 *%\n')
        rules.write("#program house.\n:- odd(X), X = -2147483648, { room(_,_) } < X+1000, room(0,ward).\n")
    assert linter.errors(find(folder), LoadedGrammar(find(folder))) == []


def test_the_lint_command_prints_each_finding_on_a_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("vitruvius.logic.lint", lambda grammar, _: findings(find(grammar)))
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / "family", folder)
    (folder / "sizes.pl").write_text((folder / "sizes.pl").read_text().replace("room_gap", "room_gab"))

    def said(*arguments: str) -> tuple[int, str]:
        with pytest.raises(SystemExit) as end:
            main(["lint", *arguments])
        return int(end.value.code or 0), capsys.readouterr().out

    code, lines = said(str(folder))
    assert code == 1
    assert "sizes.pl:7:1: error: nothing uses room_gab/1: did you mean room_gap/1?" in lines
    assert json.loads(said(str(folder), "--json")[1])["answer"]["findings"][0]["line"] == 7
    assert said("family")[0] == 0
    assert said("nowhere")[0] == 5


def test_rule_files_by_other_names_are_warnings_and_notes_are_not(tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / "family", folder)
    rule = ":- room(R,hall), side(R,north).\n"
    texts = {
        "more.LP": rule,
        "rules.txt": rule,
        "sizes.pl.txt": "",
        "notes.txt": "Halls: none.",
        "old.bak": rule,
    }
    for name, text in texts.items():
        (folder / name).write_text(text)
    found = {Path(each.file).name: each.text for each in findings(find(folder))}
    assert {name: text.partition("Rename it ")[2] for name, text in found.items()} == {
        "more.LP": "more.lp",
        "rules.txt": "rules.lp, or rules.pl for lengths",
        "sizes.pl.txt": "sizes.pl",
    }
    for file in folder.glob("*.lp"):
        file.unlink()
    with pytest.raises(GrammarError, match=r"no \.lp file: rename more\.LP"):
        find(folder)


def test_a_grammar_may_leave_out_types_that_the_files_it_includes_furnish(tmp_path: Path) -> None:
    rules = '#include "home/furniture.lp".\n#include "home/arrangement.lp".\ntopology(ring).\n'
    rules += "type(hall;living;kitchen;bedroom;bathroom).\ncentral(hall).\nopens(outside,hall).\n"
    rules += "opens(hall,(living;kitchen;bedroom;bathroom)).\n"
    sizes = "".join(f":- include('home/{name}.pl').\n" for name in ("sizes", "furniture", "lengths"))
    (tmp_path / "rooms.lp").write_text(rules)
    (tmp_path / "sizes.pl").write_text(sizes)
    assert findings(find(tmp_path)) == []
    (tmp_path / "rooms.lp").write_text(rules + "type(studdy).\nopens(hall,studdy).\n")
    [found] = findings(find(tmp_path))
    assert found.text == (
        "type(studdy): this type has no furniture: see may/4, empty/1. Did you mean study, as included?"
    )
    opening = "opening(hall,living).\nopening_size(hall,living,L,_) :- { L >= 4.5 }.\n".splitlines(True)
    (tmp_path / "rooms.lp").write_text(rules + opening[0])
    (tmp_path / "sizes.pl").write_text(sizes + opening[1])
    [found] = findings(find(tmp_path))
    assert found.text.endswith(
        "L >= 4.5, Wall =< 4 (the longest wall that these rooms share) and L =< Wall exclude each other"
    )
