"""Figures of an evaluation, on cases small enough to compute by hand."""

from dataclasses import replace

import numpy as np
import pytest

from tests.agent.evaluation.cases import result, scores
from vitruvius.agent.baselines.table import REFERENCES
from vitruvius.agent.evaluation.result import DEFINITIONS


def test_the_ratio_is_to_the_oracle_in_the_same_house():
    assert result(scores([5, 5])).figures("agent")["ratio"].value == pytest.approx((0.5 + 0.25) / 2)


def test_a_house_where_the_oracle_finds_nothing_does_not_count():
    assert result(scores([5, 0]), oracle=(10, 0)).ratio("agent").value == 0.5


def test_a_success_is_a_first_target_within_300_steps():
    figures = result(scores([1, 1], [300, 301])).figures("agent")
    assert figures["success"].value == 0.5


def test_spl_weighs_a_success_by_the_shortest_way_over_the_way_taken():
    """The paths are 100 of 200 steps; 200 of 800, which is no success; none; and the shortest path itself."""
    one = result(scores([1, 1, 0, 1], [200, 800, np.inf, 50]), oracle=(9,) * 4, rooms=(2,) * 4,
                 shortest=(100, 200, 100, 50))  # fmt: skip
    assert one.figures("agent")["spl"].value == pytest.approx((0.5 + 0 + 0 + 1) / 4)


def test_rooms_are_a_share_of_the_houses_own():
    figures = result(scores([1, 1], rooms=np.array([2, 1]))).figures("agent")
    assert figures["rooms"].value == pytest.approx((1 + 0.25) / 2)


def test_coverage_is_the_mean_over_houses_at_500_steps_and_at_1500():
    figures = result(scores([1, 1], coverage=np.array([[0.1, 0.3], [0.5, 0.9]]))).figures("agent")
    assert (figures["coverage_500"].value, figures["coverage_1500"].value) == pytest.approx((0.2, 0.7))


def test_blocked_moves_and_interventions_are_per_1000_steps():
    figures = result(scores([1, 1], blocked=3, interventions=30)).figures("agent")
    assert (figures["blocked"].value, figures["interventions"].value) == pytest.approx((1, 10))


@pytest.mark.parametrize(("mode", "share"), [("main", 0.5), ("secondary", 1.0)])
def test_the_human_is_beaten_by_more_targets_than_27_in_the_main_room_or_10_in_secondary_rooms(mode, share):
    assert result(scores([27, 28]), mode=mode).figures("agent")["human"].value == share


def test_in_mixed_mode_there_is_no_human():
    assert "human" not in result(scores([27, 28]), mode="mixed").figures("agent")


def test_training_runs_count_alike_and_widen_the_interval():
    one = result(scores([5, 10])).ratio("agent")
    two = result(scores([5, 10]), scores([10, 20])).ratio("agent")
    assert (one.value, one.low, one.high) == (0.5, 0.5, 0.5)
    assert two.value == 0.75
    assert (two.low, two.high) == (0.5, 1.0)


def test_by_rooms_each_house_counts_where_it_belongs():
    by_rooms = result(scores([5, 5])).by_rooms("agent")
    assert {rooms: each.value for rooms, each in by_rooms.items()} == {2: 0.5, 4: 0.25}


def test_a_difference_between_policies_is_paired_by_house():
    """The agent has a tenth more of the oracle's targets in each house, however hard the house is."""
    one = result(scores([5, 6]), others={"other": scores([4, 4])})
    assert one.difference("agent", "other") == pytest.approx((0.1, 0.1, 0.1))
    assert one.difference("other", "agent").value == pytest.approx(-0.1)


def test_every_figure_has_a_definition():
    known = set(result(scores([1, 1])).figures("agent"))
    assert known | {"first_find"} == set(DEFINITIONS)
    assert "first_find" in replace(result(scores([1, 1])), ends_on_pick_up=True).figures("agent")


def test_the_references_are_the_papers_agent_and_the_baselines_with_the_oracle_last():
    baselines = "random + avoidance", "script", "explorer", "searcher", "oracle"
    assert ("paper-original", "paper", *baselines) == REFERENCES
