"""The checks accept an environment that conforms, and report each kind of violation."""

import re
from types import MethodType

import numpy as np
import pytest
from gymnasium import spaces
from gymnasium.envs.registration import EnvSpec
from gymnasium.vector import AutoresetMode

from tests.sim.conformance.autoreset import check_autoreset_modes
from tests.sim.conformance.claims import CLAIMS, check_vector_env
from tests.sim.conformance.trial import ConformanceError
from tests.sim.conformance.walk import DISABLED, NEXT, SAME, Walk


@pytest.mark.parametrize("num_envs", [1, 3])
@pytest.mark.parametrize("mode", AutoresetMode)
def test_a_conforming_environment_passes_in_every_autoreset_mode(mode, num_envs):
    check_vector_env(Walk(mode, num_envs), steps=30, options={"anything": [1]})


def test_the_autoreset_modes_of_a_conforming_environment_agree():
    check_autoreset_modes(Walk, steps=60)


def paid(self, index, action):
    """Reward the step after an end."""
    Walk.begin(self, index)
    return 1.0


def led(self, index, action):
    """Make the action of the step after an end."""
    Walk.begin(self, index)
    self.state[index, 0] += 0.1 * action
    return 0.0


def counted(self):
    self.calls = getattr(self, "calls", 0) + 1
    return {"calls": np.full(self.num_envs, self.calls)}


def reused(self):
    self.buffer = getattr(self, "buffer", self.state.copy())
    self.buffer[:] = Walk.see(self)
    return self.buffer


def popping(self, options):
    return Walk.mask(self, {"reset_mask": options.pop("reset_mask")} if "reset_mask" in options else {})


def unmasked(self, **arguments):
    observation, info = Walk.reset(self, **arguments)
    if arguments["options"]:
        observation[~arguments["options"]["reset_mask"]] += 0.01
    return observation, info


def deaf(self, *, seed=None, options=None):
    """Ignore the seed of a reset by mask."""
    return Walk.reset(self, seed=None if options else seed, options=options)


def unmarked(self, over):
    return Walk.final(self, over) | {"_final_obs": np.ones_like(over)}


def one_closing(self, **_):
    assert not self.closed
    self.closed = True


BROKEN = {
    "attributes: Walk(num_envs=3): action_space is": (NEXT, "action_space", spaces.Discrete(3)),
    "spec: spec: another one": (NEXT, "spec", EnvSpec("Walk-v0", kwargs={"sizes": (1, 2)})),
    "returns: reset(seed=None): observation is an array (2, 3)": (NEXT, "see", lambda self: Walk.see(self).T),
    "determinism: step 1 after reset(seed=0): reward is another": (
        NEXT,
        "move",
        lambda self, index, action: Walk.move(self, index, action) + np.random.default_rng().normal(),
    ),
    "infos: reset(seed=0): info['calls'] is another": (NEXT, "tell", counted),
    "memory: step 1 after reset(seed=0): observation is the same memory as in reset": (NEXT, "see", reused),
    "distinct: step": (NEXT, "seeds", lambda self, seed: [seed] * 3),
    "seeds: a list of too many seeds: was accepted": (
        NEXT,
        "seeds",
        lambda self, seed: range(seed, seed + 3) if isinstance(seed, int) else seed,
    ),
    "options: reset(options=": (DISABLED, "mask", popping),
    "expected 0 in the step after an end": (NEXT, "again", paid),
    "expected it to be ignored after an end": (NEXT, "again", led),
    "autoreset: step 30 after reset(seed=0): no episode ended": (NEXT, "move", lambda *_: 0.0),
    "expected it where episodes ended": (SAME, "final", unmarked),
    "changed an observation outside its mask": (DISABLED, "reset", unmasked),
    "environment 0 is not as this seed has it": (DISABLED, "reset", deaf),
    "refusals: a step of ended environments: was accepted": (DISABLED, "refuse", lambda self: None),
    "render: render(): a picture is an array (4, 5, 3) of float64": (
        NEXT,
        "render",
        lambda self: [np.zeros((4, 5, 3))] * 3,
    ),
    "close: the second close() raised AssertionError": (NEXT, "close", one_closing),
}
"""Violations by message: the autoreset mode, an attribute of ``Walk``, and its faulty replacement."""


@pytest.mark.parametrize("message", BROKEN)
def test_an_environment_that_does_not_conform_is_reported(message):
    mode, name, replacement = BROKEN[message]

    envs = Walk(mode)
    setattr(envs, name, MethodType(replacement, envs) if callable(replacement) else replacement)
    with pytest.raises(ConformanceError, match=re.escape(message)):
        check_vector_env(envs, steps=30)


def test_every_claim_has_an_environment_that_fails_it():
    assert set(CLAIMS) <= {message.split(":")[0] for message in BROKEN}


def test_autoreset_modes_that_give_other_episodes_are_reported():
    kind = type(
        "Broken",
        (Walk,),
        {"move": lambda self, *given: Walk.move(self, *given) * (0.5 if self.mode is DISABLED else 1)},
    )
    with pytest.raises(ConformanceError, match="another reward in DISABLED"):
        check_autoreset_modes(kind, steps=30)
