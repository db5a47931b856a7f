"""Curricula: which houses and targets a stage has, and when the next one begins."""

import re
from typing import Any

import pytest

from agent.curriculum import CURRICULA, Curriculum, Stage, emptied
from logic.errors import RequestError
from sim import HouseVectorEnv
from tests import worlds

BANK = [*worlds.RANDOM, worlds.drawn(worlds.ONE_ROOM)]
MAIN, ALL = Stage(0.25, "main", (0, 2), furnished=False), Stage(1.0, "secondary", (1, None))


def test_a_stage_ends_at_its_fraction_of_the_run():
    curriculum = Curriculum((MAIN, Stage(0.5, "mixed"), ALL))
    assert [curriculum.at(x) for x in (0.0, 0.24, 0.25, 0.49, 0.5, 0.99, 1.0)] == [0, 0, 1, 1, 2, 2, 2]


def test_a_stages_houses_are_those_of_the_bank_with_its_numbers_of_rooms():
    counts = [len(house.rooms) for house in BANK]
    assert len(set(counts)) > 2
    for least, most in ((1, 2), (2, 2), (3, None)):
        chosen = Stage(1.0, "mixed", (least, most)).houses(BANK)
        assert chosen == [h for h, n in zip(BANK, counts, strict=True) if least <= n <= (most or 99)]


def test_an_empty_house_keeps_its_rooms_and_doors_and_nothing_else():
    for house in BANK:
        empty = emptied(house)
        assert not any(room.pieces for room in empty.rooms)
        assert empty.floor == house.floor
        assert empty.format == house.format
        for room, before in zip(empty.rooms, house.rooms, strict=True):
            assert (room.box, room.type, room.door) == (before.box, before.type, before.door)
    assert Stage(1.0, "main", furnished=False).houses(BANK) == [emptied(house) for house in BANK]


def test_a_stage_without_houses_is_refused_with_its_number_and_the_bank():
    bank = [house for house in BANK if len(house.rooms) > 2]
    message = "stage 1 of 2 (main targets, 0 to 2 rooms, empty): mine.jsonl has no such house, only with"
    with pytest.raises(RequestError, match=re.escape(message)):
        Curriculum((MAIN, ALL)).banks(bank, "mine.jsonl")
    with pytest.raises(RequestError, match="the bank has no such house, only with no rooms"):
        Curriculum((MAIN, ALL)).banks([])


@pytest.mark.parametrize("targets", CURRICULA)
def test_the_shipped_curricula_end_with_all_furnished_houses_and_the_targets_asked_for(targets):
    stages = CURRICULA[targets].stages
    assert (stages[0].targets, stages[0].furnished) == ("main", False)
    assert stages[-1].targets == targets
    assert [stage.rooms[1] or 99 for stage in stages] == sorted(stage.rooms[1] or 99 for stage in stages)
    banks = CURRICULA[targets].banks(BANK)
    assert banks[-1] == BANK
    assert [len(bank) for bank in banks] == sorted(map(len, banks))
    for stage, houses in zip(stages, banks, strict=True):
        HouseVectorEnv(houses, num_envs=2, targets=stage.targets).reset(seed=0)


WRONG_STAGES: dict[str, dict[str, Any]] = {
    "until must lie above 0 and be at most 1, not 0": {"until": 0},
    "until must lie above 0 and be at most 1, not 1.5": {"until": 1.5},
    "until must lie above 0 and be at most 1, not nan": {"until": float("nan")},
    "targets must be one of main, mixed, secondary, not 'all'": {"targets": "all"},
    "rooms must be the least and the most of a house, not (3, 2)": {"rooms": (3, 2)},
    "rooms must be the least and the most of a house, not (-1, 2)": {"rooms": (-1, 2)},
    "rooms must be at least 1 where targets are secondary, not 0": {"targets": "secondary"},
}


@pytest.mark.parametrize("message", WRONG_STAGES)
def test_a_stage_that_cannot_be_is_refused(message):
    with pytest.raises(RequestError, match=re.escape(message)):
        Stage(**({"until": 1.0, "targets": "main"} | WRONG_STAGES[message]))


@pytest.mark.parametrize(
    ("message", "ends"),
    [
        ("until must be 1 for the last stage: stages end at []", []),
        ("until must be 1 for the last stage: stages end at [0.5, 0.9]", [0.5, 0.9]),
        ("until must rise from stage to stage: they end at [0.5, 0.5, 1.0]", [0.5, 0.5, 1.0]),
    ],
)
def test_a_curriculum_that_no_run_can_follow_is_refused(message, ends):
    with pytest.raises(RequestError, match=re.escape(message)):
        Curriculum(tuple(Stage(end, "main") for end in ends))
