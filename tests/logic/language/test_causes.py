"""One mistake in a grammar is one error, which names the mistake and not its consequences."""

import re
import shutil
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import pytest

from tests.logic.language.test_mistakes import linted
from tests.programs import PATIENCE
from vitruvius.logic import GrammarError
from vitruvius.logic.grammar import SHIPPED, find

MISSPELT = [
    ("rooms.lp", "type(hall;", "tpye(hall;", "did you mean type/1?"),
    ("rooms.lp", "topology(ring)", "toplogy(ring)", "did you mean topology/1?"),
    ("rooms.lp", "topology(ring).", "", "name a topology, as in topology(ring)."),
    ("rooms.lp", "topology(ring).", "topology(ring;corridor).", "a topology is named by a fact alone"),
    ("rooms.lp", "topology(ring).", "topology(ring) :- rooms > 2.", "a topology is named by a fact alone"),
    ("rooms.lp", "topology(ring).", "topology(ring,corridor).", "did you mean topology/1?"),
    ("rooms.lp", "opens(dining,", "opnes(dining,", "did you mean opens/2?"),
    ("rooms.lp", "kitchen; bedroom; bathroom", "kitchen; bedrom; bathroom", "did you mean bedroom?"),
    (
        "rooms.lp",
        "kitchen; bedroom; bathroom",
        "kitchen; bathroom",
        "bedroom,bed,0,2): no room type has this name",
    ),
    ("rooms.lp", "oblong(corridor)", "oblong(coridor)", "did you mean corridor?"),
    ("rooms.lp", ":- window(R,S)", ":- windw(R,S)", "did you mean window/2?"),
    ("rooms.lp", "window(R,S), window(R,T)", "window(R)", "window/1 is known in #program room alone"),
    ("rooms.lp", "#program house.", "#program hose.", "did you mean house?"),
    ("arrangement.lp", "#program room.", "#program rom.", "did you mean room?"),
    ("furniture.lp", "may(bedroom,bed,0,2)", "may(bedroom,bedd,0,2)", "did you mean bed?"),
    ("furniture.lp", "may(bedroom,bed,0,2)", "mya(bedroom,bed,0,2)", "did you mean may/4?"),
    ("furniture.lp", "stands(bed, ", "stands(bedd, ", "did you mean bed?"),
    ("furniture.lp", "stands(bed, ", "stnads(bed, ", "did you mean stands/2?"),
    ("furniture.lp", "turns(singleBed,(", "turns(singleBd,(", "did you mean singleBed?"),
    ("furniture.lp", "beside(bed,bedside", "beside(bde,bedside", "did you mean bed?"),
    ("rooms.lp", "#program house.", "", "put it after #program house. (4 more of this file too)"),
    (
        "rooms.lp",
        "degree(corridor,",
        "room_area(kitchen,6,12). degree(corridor,",
        "room_area belongs in a .pl file",
    ),
    (
        "rooms.lp",
        "% The smaller homes",
        "%* The smaller homes",
        "{line}:1: error: a comment begins here and does not end",
    ),
    (
        "sizes.pl",
        "%!  room_area",
        "/*  room_area",
        "{line}:1: error: syntax error: end_of_file_in_block_comment: a comment",
    ),
    (
        "lengths.pl",
        "door_width(0.8)",
        "door_width(0,8)",
        "door_width/2: 0,8 is read as two terms: write 0.8",
    ),
    ("lengths.pl", "door_margin(0.1)", f"door_margin({10**400})", "is larger than any house"),
    (
        "sizes.pl",
        "room_area(kitchen,   6.0, 16.0)",
        "room_area(kitchen, 6, 1600000000)",
        "is larger than any house",
    ),
    ("sizes.pl", "room_size(kitchen,", "room_size(kichen,", "Did you mean kitchen?"),
    (
        "rooms.lp",
        "corridor; living; dining;",
        "corridor; lounge; dining;",
        "Did you mean lounge, which has no",
    ),
    (
        "rooms.lp",
        "degree(hall,1,4)",
        "degree(hall,few,many)",
        "{line}:24: error: degree(hall,few,many): give",
    ),
    ("rooms.lp", "degree(hall,1,4)", "degree(1,4,hall)", "degree(1,4,hall): give two whole numbers"),
    ("rooms.lp", "notches(2)", "notches(two)", "notches(two): the number of corners must be a whole number"),
    ("rooms.lp", "type(hall;", "type(7; hall;", "7: a type is named by a word"),
    ("furniture.lp", "may(bedroom,bed,0,2)", "may(bedroom,12,0,1)", "12: a piece is named by a word"),
    (
        "rooms.lp",
        "central(corridor; hall; living)",
        "central(corridor, hall, living)",
        "did you mean central/1?",
    ),
    (
        "rooms.lp",
        "opens(outside, (hall; corridor; living))",
        "opens((hall; corridor; living), outside)",
        "7:1: error: opens(hall,outside): write outside first",
    ),
    ("furniture.pl", "piece_size(bed, ", "piece_size(bde, ", "Did you mean bed?"),
]

OF_UNITS = [
    ("public(", "pubic(", "did you mean public/1?"),
    ("units(5,9)", "unit(5,9)", "did you mean units/2?"),
    ("units(5,9)", "units(few,many)", "units(few,many): give two whole numbers"),
]

GONE = {
    "rooms.lp": "no .lp file states type/1: is a file gone?",
    "furniture.lp": "no .lp file states may/4: is a file gone?",
    "sizes.pl": "no .pl file states room_size/3: is a file gone?",
    "lengths.pl": "no .pl file states door_width/1, ",
    "furniture.pl": "no .pl file states piece_size/4: is a file gone?",
}


TWICE = {
    "home": [
        ("notches(3).", "notches(2) is stated too, at rooms.lp:2:18"),
        ("degree(hall,2,4).", "degree(hall,1,4) is stated too, at rooms.lp:{line}:24"),
        ("weight(bedroom,3).", "weight(bedroom,6) is stated too, at rooms.lp:5:1"),
        ("may(bedroom,bed,1,1).", "may(bedroom,bed,0,2) is stated too, at furniture.lp:"),
        ("option(wet,(a;b),1).  picks(wet,2).  picks(wet,1).", "picks(wet,2) is stated too, at zz.lp:1:23"),
        ("beside(bed,chair,0,1).  at_head(bed,chair).  at_head(bed,bedside).", "is stated too, at zz.lp:1:"),
    ],
    "apartments": [("units(4,6).", "units(5,9) is stated too, at rooms.lp:5:1")],
}
"""Messages about a repeated statement, in a file of its own, of something that is stated once."""


def findings_of(folder: Path, solver: ProcessPoolExecutor) -> list[str]:
    found, _ = solver.submit(linted, folder).result(timeout=PATIENCE)
    return [str(each) for each in found]


def line_of(words: str, text: str) -> int:
    """Return the line of a file on which words begin; 1 if it lacks them."""
    return text.partition(words)[0].count("\n") + 1


def test_a_size_of_no_type_is_likely_to_be_that_of_a_type_without_a_size(
    solver: ProcessPoolExecutor, tmp_path: Path
) -> None:
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / "home", folder)
    text = (folder / "sizes.pl").read_text()
    (folder / "sizes.pl").write_text(re.sub(r"room_size\(wc,", "room_size(toilette,", text))
    (found,) = findings_of(folder, solver)
    assert "no room type: see type/1. Did you mean wc?" in found


@pytest.mark.parametrize(("file", "old", "new", "says"), MISSPELT)
def test_a_misspelt_name_is_one_error(
    file: str, old: str, new: str, says: str, solver: ProcessPoolExecutor, tmp_path: Path
) -> None:
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / "home", folder)
    text = (folder / file).read_text()
    start = ":- room(R,(kitchen;bedroom)), "
    old, new = old.replace(":- window", f"{start}window"), new.replace(":- windw", f"{start}windw")
    assert text.count(old) >= 1
    (folder / file).write_text(text.replace(old, new, 1))
    found = findings_of(folder, solver)
    says = says.format(line=line_of(old, text))
    assert [says in each for each in found] == [True], found


@pytest.mark.parametrize(("old", "new", "says"), OF_UNITS)
def test_a_mistake_in_a_grammar_of_units_is_one_error(
    old: str, new: str, says: str, solver: ProcessPoolExecutor, tmp_path: Path
) -> None:
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / "apartments", folder)
    text = (folder / "rooms.lp").read_text()
    (folder / "rooms.lp").write_text(text.replace(old, new, 1))
    (found,) = findings_of(folder, solver)
    assert says in found


@pytest.mark.parametrize("file", GONE)
@pytest.mark.parametrize("how", ["deleted", "emptied"])
def test_a_file_that_is_gone_is_one_error(
    file: str, how: str, solver: ProcessPoolExecutor, tmp_path: Path
) -> None:
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / "home", folder)
    (folder / file).unlink()
    if how == "emptied":
        (folder / file).touch()
    (found,) = findings_of(folder, solver)
    assert GONE[file] in found


def test_mistakes_of_several_causes_are_all_listed(solver: ProcessPoolExecutor, tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / "home", folder)
    with (folder / "furniture.lp").open("a") as rules:
        rules.write("may(attic,bed,1,1).\nhides(soffa).\nturns(bedd,back).\nbeside(fridge,plant,2,1).\n")
    found = findings_of(folder, solver)
    assert len(found) == 4
    for each in ("attic", "did you mean sofa?", "did you mean bed?", "the smaller first"):
        assert sum(each in finding for finding in found) == 1


@pytest.mark.parametrize("grammar", TWICE)
def test_what_is_stated_twice_is_one_error_that_names_both_places(
    grammar: str, solver: ProcessPoolExecutor, tmp_path: Path
) -> None:
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / grammar, folder)
    for second, says in TWICE[grammar]:
        (folder / "zz.lp").write_text(second + "\n")
        (found,) = findings_of(folder, solver)
        first = says.partition(" ")[0]
        assert says.format(line=line_of(first, (folder / "rooms.lp").read_text())) in found
        assert "zz.lp:1:" in found


@pytest.mark.parametrize("name", ["ring", "corridor"])
def test_a_topology_named_twice_is_one_error_that_names_both_places(name: str, tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / "home", folder)
    (folder / "zz.lp").write_text(f"\n  topology({name}).\n")
    with pytest.raises(GrammarError, match=r"zz\.lp:2:3: .* rooms\.lp:2:1 names ring: keep one"):
        find(folder)
