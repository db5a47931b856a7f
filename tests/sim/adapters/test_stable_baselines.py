"""Our environments as environments of Stable-Baselines3."""

import pytest
from gymnasium import Wrapper
from gymnasium.vector import AutoresetMode, VectorWrapper
from gymnasium.wrappers.vector import RecordEpisodeStatistics

from tests import sample_houses
from vitruvius.sim import HouseVectorEnv

HOUSES = [sample_houses.drawn(sample_houses.ONE_ROOM)] * 2


def test_options_may_be_one_for_each():
    from vitruvius.sim.adapters.stable_baselines import StableBaselinesVecEnv

    theirs = StableBaselinesVecEnv(HouseVectorEnv(HOUSES, 2, autoreset_mode=AutoresetMode.SAME_STEP))
    theirs.set_options([{"house": 1}, {"house": 0}])
    theirs.reset()
    assert [info["house"] for info in theirs.reset_infos] == [1, 0]
    with pytest.raises(ValueError, match="the 2 environments a dictionary, all with the same keys"):
        theirs.set_options([{"house": 1}, {}])


class Worth(VectorWrapper):
    """A wrapper with its own attribute and method."""

    worth = 7

    def doubled(self) -> int:
        return 2 * self.worth


class Unused(VectorWrapper):
    """A wrapper around no environment."""


def test_attributes_and_methods_are_those_of_the_outermost_layer_that_has_them():
    from vitruvius.sim.adapters.stable_baselines import StableBaselinesVecEnv

    envs = HouseVectorEnv(HOUSES, 2, autoreset_mode=AutoresetMode.SAME_STEP)
    worth = Worth(envs)
    theirs = StableBaselinesVecEnv(RecordEpisodeStatistics(worth))
    assert theirs.env_method("doubled") == [14, 14]
    theirs.set_attr("worth", 9)
    theirs.set_attr("own", 1)
    assert (worth.worth, theirs.get_attr("worth", [0]), theirs.env_method("doubled", indices=1)) == (
        9,
        [9],
        [18],
    )
    assert not hasattr(envs, "worth")
    assert theirs.get_attr("own") == [1, 1]
    assert theirs.get_attr("houses", 0) == [HOUSES]
    for kind, wrapped in ((Worth, True), (RecordEpisodeStatistics, True), (Unused, False), (Wrapper, False)):
        assert theirs.env_is_wrapped(kind) == [wrapped, wrapped]
    with pytest.raises(AttributeError, match="nothing"):
        theirs.get_attr("nothing")


def test_other_modes_than_same_step_are_refused():
    from vitruvius.sim.adapters.stable_baselines import StableBaselinesVecEnv

    with pytest.raises(ValueError, match=r"needs AutoresetMode\.SAME_STEP"):
        StableBaselinesVecEnv(HouseVectorEnv(HOUSES, 2))
