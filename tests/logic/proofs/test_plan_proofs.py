"""Proofs that there is no plan: a proof names the facts that it uses, stated or not."""

import re
import time
from pathlib import Path

import pytest

from tests.logic.workers import in_process
from vitruvius.logic import GrammarError, House, Unsatisfiable
from vitruvius.logic.grammar import find
from vitruvius.logic.language.linter import findings

TYPES = ("hall", "den", "bath", "passage")
ROOMS = """topology(ring).
type(hall; den; bath; passage).  empty(hall; den; bath; passage).
opens(outside, hall).
opens(hall, (den; bath; passage)).
opens(passage, den).
loops(hall,bath).
lit(den).
central(hall; passage).
oblong(passage).
degree(hall,1,3).
"""
OPENS = "opens(hall, (den; bath; passage))."
SIZES = """door_width(0.8). door_margin(0.1). window_margin(0.65). door_clearance(0.45). passage(0.42).
room_gap(0.0).
house_size(W, D) :- { W =< 9*D, D =< 9*W }.
room_size(hall, W, D)    :- { W >= 2, W =< 5, D >= 2, D =< 5 }.
room_size(den, W, D)     :- { W >= 2, W =< 5, D >= 2, D =< 5 }.
room_size(bath, W, D)    :- { W >= 2, W =< 5, D >= 2, D =< 5 }.
room_size(passage, W, D) :- { W >= 1.2, W =< 2, D >= 2, D =< 9 }.
window_size(_, L, Wall) :- { L >= 0.6, L =< 0.6*Wall, L =< 2.4 }.
"""

CASES = {
    "no type without lit/1 has a window": (
        ":- not window(R,south), room(R,bath).",
        {"bath": 1},
        ["lit(bath) is not stated", "--type bath=1"],
    ),
    "one enters by the types of opens/2 alone": (
        ":- room(R,hall), from(R,outside).",
        {},
        ["opens(outside,any_other_type) is not stated"],
    ),
    "a type opens into those of its opens/2 alone": (
        ":- room(R,bath), not entered(R,passage).",
        {"bath": 1},
        ["opens(passage,any_other_type) is not stated", "--type bath=1"],
    ),
    "a type without opens/2 opens into none": (
        ":- room(R,bath), not from(_,R).",
        {"bath": 1},
        ["opens(bath,any_other_type) is not stated", "--type bath=1"],
    ),
    "a count of none of the type that all is entered by": (
        "",
        {"hall": 0},
        ["opens(outside,any_other_type) is not stated", "--type hall=0"],
    ),
    "other doors need loops/2": (
        ":- room(R,bath), room(Q,den), not linked(R,Q).",
        {"bath": 1, "den": 1, "hall": 1},
        ["loops(bath,den) is not stated", "opens(bath,any_other_type) is not stated",
         "opens(den,any_other_type) is not stated", "--type bath=1", "--type den=1"],
    ),
    "the hub is of the types of central/1": (
        ":- hub(R), not room(R,den).",
        {},
        ["central(any_other_type) is not stated"],
    ),
    "what is longer one way is oblong": (
        ":- room(R,den), not runs(R,_).",
        {"den": 1},
        ["oblong(den) is not stated", "--type den=1"],
    ),
    "corners lie outside by notches/1": (
        ":- { notch(_,_) } 0.",
        {},
        ["notches(4) is not stated"],
    ),
}  # fmt: skip


def grammar(folder: Path, text: str) -> Path:
    folder.mkdir()
    (folder / "rooms.lp").write_text(text)
    (folder / "sizes.pl").write_text(SIZES)
    return folder


def stated(text: str) -> str:
    """Return a fact that states all possible values in place of a fact of the grammar."""
    types = "; ".join(TYPES)
    match re.split(r"[(,)]", text):
        case ["opens", first, *_]:
            return f"opens({first}, ({types}))."
        case ["central", *_]:
            return f"central({types})."
    return ""


def without(text: str, types: dict, reason: str) -> tuple[str, dict]:
    """Return the grammar and the request with one reason of a proof actually removed."""
    if option := re.fullmatch(r"--type (\w+)=.*", reason):
        return text, {name: count for name, count in types.items() if name != option[1]}
    if missing := re.fullmatch(r"(.*) is not stated", reason):
        return text + (stated(missing[1]) or f"{missing[1]}.") + "\n", types
    changed = text.replace(reason, stated(reason), 1)
    assert changed != text
    return changed, types


@pytest.mark.parametrize("title", CASES)
def test_a_proof_names_the_facts_that_matter_and_each_is_needed(title: str, tmp_path: Path) -> None:
    rule, types, expected = CASES[title]
    text = ROOMS + (f"#program house.\n{rule}\n#program base.\n" if rule else "")
    folder = grammar(tmp_path / "mine", text)
    begin = time.process_time()
    with pytest.raises(Unsatisfiable) as caught:
        next(in_process.generate(3, types=types, grammar=folder))
    assert time.process_time() - begin < 5
    reasons = [reason.text for reason in caught.value.reasons]
    assert sorted(reasons) == sorted([*expected, rule] if rule else expected)
    lines = text.split("\n")
    for reason in caught.value.reasons:
        if reason.text.endswith(" is not stated"):
            # The fact's place is that of the grammar's own facts with its first argument, or of its kind.
            kind, first = re.split(r"[(,]", reason.text)[:2]
            same = [line for line in lines if line.startswith(f"{kind}({first},")]
            kin = same or [line for line in lines if line.startswith(f"{kind}(")]
            assert (reason.line is None) == (not kin)
            assert reason.line is None or lines[reason.line - 1] == kin[0]
        elif not reason.text.startswith("--"):
            assert reason.line
            assert reason.text in lines[reason.line - 1]
    for number, reason in enumerate(sorted(reasons)):  # The request first: rules are loaded.
        changed, fewer = without(text, types, reason)
        other = folder if changed == text else grammar(tmp_path / f"other{number}", changed)
        assert isinstance(next(in_process.generate(3, types=fewer, grammar=other)), House), reason


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (
            OPENS,
            "opens(hall,bath). opens(den,passage).",
            ["4:19 opens(den,passage)", "5:1 opens(passage,den)"],
        ),
        (OPENS, "opens(hall, bath).", ["2:1 type(passage)"]),
        ("opens(outside, hall).", "", ["1:1 topology(ring)"]),
        ("opens(outside, hall).", "opens(hall,hall).", ["1:1 topology(ring)"]),
        ("central(hall; passage).", "", ["1:1 topology(ring)"]),
    ],
)  # fmt: skip
def test_what_nobody_can_enter_is_found_at_load(
    old: str, new: str, expected: list[str], tmp_path: Path
) -> None:
    folder = grammar(tmp_path / "mine", ROOMS.replace(old, new))
    found = [f"{each.line}:{each.column} {each.text.partition(': ')[0]}" for each in findings(find(folder))]
    assert sorted(found) == sorted(expected)
    with pytest.raises(GrammarError):
        next(in_process.generate(1, grammar=folder))


def test_a_clause_for_rooms_of_all_types_gives_each_its_size(tmp_path: Path) -> None:
    folder = grammar(tmp_path / "mine", ROOMS)
    sizes = re.sub(r"room_size\((?!passage).*\n", "", SIZES).replace("room_size(passage,", "room_size(_,")
    (folder / "sizes.pl").write_text(sizes)
    assert findings(find(folder)) == []
