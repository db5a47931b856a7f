"""Environments that conform pass the checks, in every autoreset mode."""

from typing import Any

import gymnasium
import pytest
from gymnasium.vector import AutoresetMode, VectorEnv, VectorWrapper

from sim import check_autoreset_modes, check_vector_env
from sim.conformance import ConformanceError
from tests.sim.conformance.walk import DISABLED, Walk


def gymnasiums(name: str, mode: AutoresetMode) -> VectorEnv:
    arguments: Any = {"autoreset_mode": mode.value}
    return gymnasium.make_vec(name, num_envs=3, vectorization_mode="sync", vector_kwargs=arguments)


class Kept(VectorWrapper):
    """Keeps the caller's options from an environment that pops from them."""

    def reset(self, *, seed=None, options=None):
        return super().reset(seed=seed, options=None if options is None else dict(options))


ENVIRONMENTS = ["CartPole-v1", "Blackjack-v1", "FrozenLake-v1"]
"""Their observations are arrays, tuples and numbers."""


@pytest.mark.parametrize("name", ENVIRONMENTS)
@pytest.mark.parametrize("mode", AutoresetMode)
def test_gymnasium_environments_pass_in_every_autoreset_mode(mode, name):
    check_vector_env(Kept(gymnasiums(name, mode)), steps=200)


@pytest.mark.parametrize("name", ENVIRONMENTS)
def test_gymnasium_environments_give_the_same_episodes_in_every_autoreset_mode(name):
    check_autoreset_modes(lambda mode: gymnasiums(name, mode), steps=200)


def test_gymnasium_itself_fails_the_claim_options_because_it_pops_the_callers_reset_mask():
    with pytest.raises(ConformanceError, match=r"options: reset\(options=.*reset_mask.*left them as \{\}"):
        check_vector_env(gymnasiums("CartPole-v1", DISABLED), steps=200)


def test_gymnasiums_vector_cart_pole_passes_except_for_lists_of_seeds():
    envs = gymnasium.make_vec("CartPole-v1", num_envs=3, vectorization_mode="vector_entry_point")
    with pytest.raises(ConformanceError, match=r"seeds: .*must be a python integer"):
        check_vector_env(envs, steps=200)
    check_vector_env(envs, steps=200, skip=["seeds"])


@pytest.mark.parametrize("num_envs", [1, 3])
@pytest.mark.parametrize("mode", AutoresetMode)
def test_a_conforming_environment_passes_in_every_autoreset_mode(mode, num_envs):
    check_vector_env(Walk(mode, num_envs), steps=30, options={"anything": [1]})


def test_the_autoreset_modes_of_a_conforming_environment_agree():
    check_autoreset_modes(Walk, steps=60)
