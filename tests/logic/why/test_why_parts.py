"""An explanation comes in parts: the derivation at once, then alternatives while there is time."""

from collections.abc import Iterator
from pathlib import Path
from time import monotonic
from typing import Any

import pytest
from clingo import ast

from tests.logic.workers.in_process import builder
from vitruvius.logic import explain_house
from vitruvius.logic.errors import Reason
from vitruvius.logic.grammar import RULES, SHIPPED
from vitruvius.logic.house.part_names import doors_by_name, part_names, windows_by_name
from vitruvius.logic.layout.reading import parse
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.why.answer import Why, as_text
from vitruvius.logic.why.shared_walls import PlanWitness
from vitruvius.logic.why.support import _remark


@pytest.fixture(scope="module")
def witness() -> PlanWitness:
    home = builder("home")
    return PlanWitness(home, home.house(HouseRequest(4), 0, 0))


def targets(witness: PlanWitness) -> Iterator[str]:
    house = witness._house
    yield from (*doors_by_name(house), *windows_by_name(house))
    for room in house.rooms:
        yield from (
            room.name,
            *(f"{room.name}.{name}" for name in part_names([each.type for each in room.pieces])),
        )


def test_every_part_of_a_home_is_derived_first_and_in_no_time(witness: PlanWitness) -> None:
    asked = list(targets(witness))
    assert len(asked) > 15
    for target in asked:
        first = next(witness.parts(target, monotonic()))
        assert first.derivations, target
        assert not first.choices
        assert next(as_text([first])).startswith(f"{target}: ")


def test_a_limit_ends_only_what_could_be_instead(witness: PlanWitness) -> None:
    """The 14 values of a bed would take minutes, and late attempts find nothing.

    On a busy machine, five seconds may be too few for the first of them.
    """
    target = next(each for each in targets(witness) if each.endswith(".bed"))
    for seconds in (0.0, 5.0, 40.0):
        begun = monotonic()
        whole = witness.why(target, begun + seconds)
        assert monotonic() - begun < seconds + 15
        assert whole.derivations
        assert whole.lengths
        assert whole.others >= 10
        assert whole.tried == (whole.others if seconds else 0)
        every = [each for choice in whole.choices for each in choice.instead]
        if any(each.known for each in every):
            break
    assert any(each.known for each in every)
    assert all(each.possible or each.because or not each.known for each in every)
    assert str(whole) == "\n".join(as_text([whole]))


def test_the_derivation_comes_however_few_the_seconds(witness: PlanWitness) -> None:
    """A solver process takes seconds to start and to generate the house again."""
    why = explain_house(witness._house, "entrance", seconds=0.01)
    assert why.derivations
    assert "entrance reached the limit of 0.01 seconds: raise it with --seconds" in why.limit


def test_the_parts_of_an_answer_are_the_answer(witness: PlanWitness) -> None:
    parts = list(witness.parts("entrance"))
    whole = parts[0]
    for part in parts[1:]:
        whole = whole.joined(part)
    assert whole.tried == whole.others > 0
    assert list(as_text(parts)) == str(whole).split("\n")


def options() -> Iterator[Reason]:
    """Yield the rules of all choices in all shipped files."""
    for file in (*RULES.rglob("*.lp"), *SHIPPED.rglob("*.lp")):
        found: list[ast.AST] = []
        parse([file], found.append)
        for statement in found:
            if statement.ast_type == ast.ASTType.Rule and str(statement.head).startswith("option("):
                place: Any = statement.location
                yield Reason(str(statement), str(file), place.begin.line, place.begin.column)


def test_a_comment_that_is_quoted_is_whole_sentences() -> None:
    quoted = {comment for option in options() if (comment := _remark(option))}
    assert len(quoted) >= 4
    for comment in quoted:
        assert not comment[0].islower(), comment
        assert comment[-1] in ".:", comment
    assert any(comment.endswith(" a court behind them.") and len(comment) > 60 for comment in quoted)


def test_a_comment_belongs_to_the_rule_right_below_it(tmp_path: Path) -> None:
    file = tmp_path / "rules.lp"
    file.write_text(
        "% Of another.\n\n% - choose ---\n% Beds stand where\n% one wakes well.\n"
        "option(a,1,1).\noption(b,1,1).\n"
    )
    assert _remark(Reason("", str(file), 6, 1)) == "Beds stand where one wakes well."
    assert not _remark(Reason("", str(file), 7, 1))
    assert Why("R0", "a").joined(Why("R0", "", limit="60 s")).limit == "60 s"
