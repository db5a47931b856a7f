"""Copies of rule files in a grammar's folder: each is one error, or the user's own topology."""

import re
import shutil
from pathlib import Path

import pytest

from tests.logic.workers.in_process import builder
from vitruvius.logic import GrammarError, check
from vitruvius.logic.grammar import RULES, SHIPPED, STAR, TOPOLOGIES, find, shipped
from vitruvius.logic.proofs.answer import house_or_proof
from vitruvius.logic.request.house_request import HouseRequest

CORE = sorted(RULES.rglob("*.[lp][lp]"))
OWN = ["ring", "corridor", "dissection"]
"""Shipped topologies of one file, for rooms that share walls. A grammar may own a copy of each."""

EDITS = {
    "whole": lambda text: text,
    "with another comment": lambda text: f'% My own, 2026. It\'s "mine".\n\n{text}',
    "without its comments": lambda text: re.sub(r"^%.*\n", "", re.sub(r"%\*.*?\*%", "", text, flags=re.S)),
    "without its last lines": lambda text: "\n".join(text.split("\n")[: -max(2, len(text.split("\n")) // 8)]),
}


def mine(folder: Path, grammar: str = "home") -> Path:
    return shutil.copytree(SHIPPED / grammar, folder / "mine")


@pytest.mark.parametrize("edit", ["whole", "with another comment"])
def test_a_copy_of_a_shared_file_is_one_error_that_names_both(edit: str, tmp_path: Path) -> None:
    folder = mine(tmp_path)
    for file in CORE:
        copy = folder / f"of_mine{file.suffix}"
        copy.write_text(EDITS[edit](file.read_text()))
        with pytest.raises(GrammarError, match=r": delete the copy") as error:
            find(folder)
        assert (error.value.file, str(file) in error.value.message) == (copy, True)
        copy.unlink()


@pytest.mark.parametrize("edit", EDITS)
@pytest.mark.parametrize("grammar", shipped())
def test_a_copy_of_a_file_beside_it_is_one_error_that_names_both(
    grammar: str, edit: str, tmp_path: Path
) -> None:
    folder = mine(tmp_path, grammar)
    for file in sorted(folder.glob("*.[lp][lp]")):
        copy = file.with_name(f"{file.stem} (copy){file.suffix}")
        copy.write_text(EDITS[edit](file.read_text()))
        with pytest.raises(GrammarError, match="keep one of the two") as error:
            find(folder)
        assert {Path(str(error.value.file)).name} | {file.name, copy.name} == {file.name, copy.name}
        assert str(error.value).count(file.name) + str(error.value).count(copy.name) == 2
        copy.unlink()


@pytest.mark.parametrize("name", OWN)
@pytest.mark.parametrize("named", ["mine", "as it was"])
def test_a_copy_of_a_topology_can_be_a_topology_of_ones_own(name: str, named: str, tmp_path: Path) -> None:
    folder, own = mine(tmp_path), name if named == "as it was" else "mine"
    text = EDITS["without its comments" if named == "mine" else "whole"](
        (TOPOLOGIES / f"{name}.lp").read_text()
    )
    (folder / f"{own}.lp").write_text(re.sub(r"most_rooms\(\d+\)", "most_rooms(4)", text))
    rooms = (folder / "rooms.lp").read_text()
    (folder / "rooms.lp").write_text(rooms.replace("topology(ring)", f"topology({own})"))
    made = builder(folder)
    assert made.loaded.most_rooms == 4
    if named == "mine":
        assert check(house_or_proof(made, HouseRequest(4), 1, 0)) == []


def test_every_shipped_topology_is_one_that_can_be_copied_or_says_that_it_cannot() -> None:
    apart = {STAR, *(file for file in TOPOLOGIES.glob("*.lp") if "#include" in file.read_text())}
    assert {file.stem for file in {*TOPOLOGIES.glob("*.lp")} - apart} == set(OWN)


def test_rules_that_share_some_statements_are_no_copies(tmp_path: Path) -> None:
    folder = mine(tmp_path)
    (folder / "more.lp").write_text(
        "#program house.\n:- { room(R,living) } != 1.\n:- room(0,kitchen).\n:- room(1,kitchen).\n"
    )
    (folder / "none.lp").write_text("% Nothing.\n")
    (folder / "nothing.lp").write_text("#program house.\n")
    assert len(find(folder).own) == 6


@pytest.mark.parametrize("unread", ['"', "'", "%*", "/*", "\\'", '"\\', "0'", "%"])
def test_a_file_of_anything_is_read_at_once(unread: str, tmp_path: Path) -> None:
    folder = mine(tmp_path)
    files = len(find(folder).prolog)
    for suffix in ("lp", "pl"):
        (folder / f"strange.{suffix}").write_text(unread * 200_000)
    assert len(find(folder).prolog) == files + 1
