"""Random sequences of calls: refused calls change nothing, and repeated calls have the same answers."""

import pytest

from benchmarks.reliability.environments import Player
from tests import sample_houses

BANKS = [sample_houses.RANDOM[:2], sample_houses.RANDOM[2:5]]


@pytest.mark.second_part("many kernels")
@pytest.mark.parametrize(("kind", "mode"), [("distances", "Disabled"), ("free", "SameStep")])
def test_calls_have_the_same_answers_in_any_batch_and_a_refused_call_changes_nothing(kind, mode):
    player = Player(kind, mode, BANKS)
    for seed in range(5):
        player.play(seed)
    assert player.calls["refused"] > 10
    assert player.calls["reset"] > 20
