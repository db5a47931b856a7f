"""Environments as those of Stable-Baselines3."""

import pytest
from gymnasium.vector import AutoresetMode

from sim import HouseVectorEnv
from tests import sample_houses

HOUSES = [sample_houses.drawn(sample_houses.ONE_ROOM)] * 2


def test_options_may_be_one_for_each():
    from sim.adapters.stable_baselines import StableBaselinesVecEnv

    theirs = StableBaselinesVecEnv(HouseVectorEnv(HOUSES, 2, autoreset_mode=AutoresetMode.SAME_STEP))
    theirs.set_options([{"house": 1}, {"house": 0}])
    theirs.reset()
    assert [info["house"] for info in theirs.reset_infos] == [1, 0]
    with pytest.raises(ValueError, match="a dictionary with the same keys for each of 2"):
        theirs.set_options([{"house": 1}, {}])


def test_other_modes_than_same_step_are_refused():
    from sim.adapters.stable_baselines import StableBaselinesVecEnv

    with pytest.raises(ValueError, match=r"needs AutoresetMode\.SAME_STEP"):
        StableBaselinesVecEnv(HouseVectorEnv(HOUSES, 2))
