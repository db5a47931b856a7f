"""Briefs that a known plan keeps at their limits have a house: what refuted one would be wrong."""

from benchmarks.briefs.attempts import attempt
from benchmarks.briefs.planted import planted, row_of
from logic.grammar import find
from logic.request.brief import alone
from tests.logic.workers import in_process

BRIEFS = range(60)


def test_a_brief_that_a_plan_keeps_at_its_limits_has_a_house_that_keeps_it() -> None:
    builder = in_process._builder(find("plain"), 0.0)
    for number in BRIEFS:
        entry = planted(number, most=4)
        row = row_of(number, entry, attempt(builder, alone(entry.read)))
        assert row.said == "house", row
