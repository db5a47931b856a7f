"""Each way in which an environment may fail to conform is found, and named by its claim."""

import re

import numpy as np
import pytest
from gymnasium import spaces
from gymnasium.envs.registration import EnvSpec

from sim import check_autoreset_modes, check_vector_env
from sim.conformance import ConformanceError
from sim.conformance.claims import CLAIMS
from tests.sim.conformance.walk import DISABLED, NEXT, SAME, Walk

WRONG_ATTRIBUTES = {
    "attributes: Walk(num_envs=0): num_envs is 0": {"num_envs": 0},
    "observation_space is Box": {"observation_space": spaces.Box(-9, 9, (3, 2), np.float64)},
    "action_space is Discrete(3)": {"action_space": spaces.Discrete(3)},
    "metadata has no 'autoreset_mode'": {"metadata": {"render_modes": [], "render_fps": 9}},
    "is 'NextStep': expected an AutoresetMode": {
        "metadata": {"render_modes": ["rgb_array"], "render_fps": 9, "autoreset_mode": "NextStep"}
    },
    "autoreset_mode is not that of the metadata": {"autoreset_mode": DISABLED},
    "render_mode is 'human'": {"render_mode": "human"},
    "another one comes back from to_json": {"spec": EnvSpec("Walk-v0", kwargs={"sizes": (1, 2)})},
    "spec: spec raised TypeError": {"spec": EnvSpec("Walk-v0", kwargs={"rng": np.random.default_rng()})},
}


@pytest.mark.parametrize("message", WRONG_ATTRIBUTES)
def test_a_wrong_attribute_is_reported(message):
    envs = Walk()
    for name, value in WRONG_ATTRIBUTES[message].items():
        setattr(envs, name, value)
    with pytest.raises(ConformanceError, match=re.escape(message)):
        check_vector_env(envs, steps=30)


def test_a_spec_that_make_vec_cannot_set_is_reported():
    kind = type("Fixed", (Walk,), {"spec": property(lambda self: None)})
    with pytest.raises(ConformanceError, match="spec: spec raised AttributeError"):
        check_vector_env(kind(), steps=30)


def changed(change):
    """``step``, and then a change to what it returns: a list of five."""

    def step(self, actions):
        given = list(Walk.step(self, actions))
        change(self, given)
        return tuple(given)

    return step


def put(part: int, value):
    """``step`` with one of its five parts replaced by a function of it."""
    return changed(lambda self, given: given.__setitem__(part, value(given[part])))


def clumsy(self, actions):
    given = Walk.step(self, actions)
    actions[0] = 0
    return given


def reused(self):
    self.buffer = getattr(self, "buffer", self.state.copy())
    self.buffer[:] = Walk.see(self)
    return self.buffer


def popping(self, options):
    return Walk.mask(self, {"reset_mask": options.pop("reset_mask")} if "reset_mask" in options else {})


def cast(self, options):
    return np.asarray(options.get("reset_mask", np.ones(self.num_envs)), bool)


def longer(self, options):
    """A mask may be too long."""
    mask = options.get("reset_mask", np.ones(self.num_envs, bool))
    assert mask.dtype == np.bool_
    return mask[: self.num_envs]


def masked(change):
    """``reset``, and then a change by a mask, if there is one, to environment and observation."""

    def reset(self, *, seed=None, options=None):
        observation, info = Walk.reset(self, seed=seed, options=options)
        if options:
            change(self, options["reset_mask"], observation)
        return observation, info

    return reset


def shift(self, mask, observation):
    observation[~mask] += 0.01


def stir(self, mask, observation):
    self.rng[-1].normal()


def deaf(self, *, seed=None, options=None):
    """Seeds count for resets of all only."""
    return Walk.reset(self, seed=None if options else seed, options=options)


def lasting(self, index):
    """A new episode begins where the last one ended."""
    kept = self.state[index, 0]
    Walk.begin(self, index)
    if self.over[index]:
        self.state[index, 0] = kept


def unseeded(self, index, action):
    return Walk.move(self, index, action) + np.random.default_rng().normal()


def counted(self):
    self.calls = getattr(self, "calls", 0) + 1
    return {"calls": np.full(self.num_envs, self.calls)}


def paid(self, index, action):
    """The step after an end is rewarded."""
    Walk.begin(self, index)
    return 1.0


def led(self, index, action):
    """The step after an end makes its action too."""
    Walk.begin(self, index)
    self.state[index, 0] += 0.1 * action
    return 0.0


def ending(**changes):
    """``final`` with some of its entries changed by functions of them, or left out."""

    def final(self, over):
        given = Walk.final(self, over)
        for key, change in changes.items():
            value = given.pop(key)
            if change is not None:
                given[key] = change(value)
        return given

    return final


def alias(self, given):
    if "final_obs" in given[4]:
        given[0] = given[4]["final_obs"]


def sizes(self):
    return tuple(np.zeros((4, 5 + index, 3), np.uint8) for index in range(self.num_envs))


def screens(self):
    self.screen = getattr(self, "screen", np.zeros((4, 5, 3), np.uint8))
    return tuple(self.screen for _ in range(self.num_envs))


def one_closing(self, **kwargs):
    assert not self.closed
    self.closed = True


BROKEN = {
    # message: (mode, method, what replaces it)
    "returned an array (3, 2) of float32: expected a tuple of obs": (
        NEXT,
        "reset",
        lambda self, **_: self.see(),
    ),
    "returned a tuple of 4": (NEXT, "step", lambda self, actions: Walk.step(self, actions)[:4]),
    "observation is an array (3, 2) of float64": (NEXT, "see", lambda self: self.state.astype(float)),
    "observation is an array (2, 3)": (NEXT, "see", lambda self: Walk.see(self).T),
    "observation is not in its space": (NEXT, "see", lambda self: Walk.see(self) + 9),
    "returns: step 1 after reset(seed=0): reward is an array (3, 1)": (
        NEXT,
        "step",
        put(1, lambda r: r[:, None]),
    ),
    "reward is an array (3,) of int64": (NEXT, "step", put(1, lambda r: r.astype(int))),
    "reward is [": (NEXT, "step", put(1, lambda r: r / 0)),
    "terminated is an array (3,) of uint8": (NEXT, "step", put(2, lambda flags: flags.astype(np.uint8))),
    "truncated is a list of 3": (NEXT, "step", put(3, lambda flags: flags.tolist())),
    "info is a list of 3": (NEXT, "tell", lambda self: [{} for _ in range(3)]),
    "info['_left'] is a mask for 'left'": (NEXT, "tell", lambda self: {"_left": np.ones(3, bool)}),
    "info['_left'] is an array (3,) of int64": (NEXT, "tell", lambda self: {"_left": np.ones(3, int)}),
    "info['deep']['left'] is an array (2,)": (NEXT, "tell", lambda self: {"deep": {"left": np.ones(2)}}),
    "changed the actions": (NEXT, "step", clumsy),
    "determinism: step 1 after reset(seed=0): reward is another": (NEXT, "move", unseeded),
    "infos: reset(seed=0): info['calls'] is another": (NEXT, "tell", counted),
    "distinct: step": (NEXT, "seeds", lambda self, seed: [seed] * 3),
    "another seed to make a difference": (NEXT, "seeds", lambda self, seed: range(3)),
    "expected the random numbers to go on": (
        NEXT,
        "reset",
        lambda self, seed=None, options=None: Walk.reset(self, seed=seed or 0, options=options),
    ),
    "expected seed + i for environment i": (
        NEXT,
        "seeds",
        lambda self, seed: range(seed + 1, seed + 4) if isinstance(seed, int) else Walk.seeds(self, seed),
    ),
    "did not follow their seeds": (
        NEXT,
        "seeds",
        lambda self, seed: Walk.seeds(self, seed if isinstance(seed, int) else sorted(seed)),
    ),
    "seeds: a list of too many seeds: was accepted": (
        NEXT,
        "seeds",
        lambda self, seed: range(seed, seed + 3) if isinstance(seed, int) else seed,
    ),
    "options: reset(options=": (DISABLED, "mask", popping),
    "memory: step 1 after reset(seed=0): observation is the same memory as in reset": (NEXT, "see", reused),
    "info['left'] is the same memory": (NEXT, "tell", lambda self: {"left": self.state[:, 1]}),
    "depends on what a caller wrote": (
        NEXT,
        "step",
        changed(lambda self, given: setattr(self, "over", given[3])),
    ),
    "autoreset: step 30 after reset(seed=0): no episode ended in 30 steps": (
        NEXT,
        "move",
        lambda self, index, action: 0.0,
    ),
    "expected 0 in the step after an end": (NEXT, "again", paid),
    "expected none in the step after an end": (NEXT, "stopped", lambda self, over: over.copy()),
    "no step after an end changed the observation": (NEXT, "begin", lasting),
    "expected it to be ignored after an end": (NEXT, "again", led),
    "final_obs is there for": (SAME, "final", ending(final_obs=None, _final_obs=None)),
    "expected it where episodes ended": (SAME, "final", ending(_final_obs=np.ones_like)),
    "final_info is there for": (SAME, "final", ending(final_info=None, _final_info=None)),
    "final_info is an array": (SAME, "final", ending(final_info=lambda info: np.full(3, None))),
    "of float64: expected an array (2,) of float32": (
        SAME,
        "final",
        ending(final_obs=lambda x: x + 0.0 * np.ones(2)),
    ),
    "final_obs shares memory": (SAME, "step", changed(alias)),
    "final_obs is always the observation itself": (SAME, "begin", lasting),
    "changed an observation outside its mask": (DISABLED, "reset", masked(shift)),
    "no reset by mask changed an observation": (DISABLED, "begin", lasting),
    "refusals: a step of ended environments: was accepted": (DISABLED, "refuse", lambda self: None),
    "a reset_mask (4,) of bool: was accepted": (DISABLED, "mask", longer),
    "a reset_mask (3,) of int64: was accepted": (DISABLED, "mask", cast),
    "environment 0 is not as this seed has it": (DISABLED, "reset", deaf),
    "other environments went on differently": (DISABLED, "reset", masked(stir)),
    "render: render(): returned an array (3, 4, 5, 3)": (
        NEXT,
        "render",
        lambda self: np.stack(Walk.render(self)),
    ),
    "a picture is an array (4, 5, 3) of float64": (NEXT, "render", lambda self: [np.zeros((4, 5, 3))] * 3),
    "pictures share memory": (NEXT, "render", screens),
    "pictures have sizes": (NEXT, "render", sizes),
    "close: the second close() raised AssertionError": (NEXT, "close", one_closing),
}


@pytest.mark.filterwarnings("ignore:divide by zero")
@pytest.mark.parametrize("message", BROKEN)
def test_a_method_that_does_not_conform_is_reported(message):
    mode, method, replacement = BROKEN[message]
    kind = type("Broken", (Walk,), {method: replacement})
    with pytest.raises(ConformanceError, match=re.escape(message)):
        check_vector_env(kind(mode), steps=30)


def test_every_claim_has_an_environment_that_fails_it():
    assert set(CLAIMS) <= {message.split(":")[0] for message in [*BROKEN, *WRONG_ATTRIBUTES]}


WRONG_EPISODES = {
    "another observation in SAME_STEP than in NEXT_STEP": ("final", ending(final_obs=lambda x: -x)),
    "another terminated in SAME_STEP": (
        "stopped",
        lambda self, over: self.state[:, 1] <= 0 if self.mode is SAME else Walk.stopped(self, over),
    ),
    "another reward in DISABLED": (
        "move",
        lambda self, index, action: Walk.move(self, index, action) * (0.5 if self.mode is DISABLED else 1),
    ),
    "event 0 of its episodes: another observation in SAME_STEP": (
        "seeds",
        lambda self, seed: np.array(Walk.seeds(self, seed)) + (self.mode is SAME),
    ),
}


@pytest.mark.parametrize("message", WRONG_EPISODES)
def test_autoreset_modes_that_give_other_episodes_are_reported(message):
    method, replacement = WRONG_EPISODES[message]
    kind = type("Broken", (Walk,), {method: replacement})
    with pytest.raises(ConformanceError, match=re.escape(message)):
        check_autoreset_modes(kind, steps=30)


def test_skipping_an_unknown_claim_is_an_error():
    with pytest.raises(ValueError, match="no claim is named 'seed': there are attributes, spec"):
        check_vector_env(Walk(), skip=["seed"])
