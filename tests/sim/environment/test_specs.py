"""The arguments of an environment are recovered from its spec, from JSON and from a pickle."""

import copy
import json
import pickle
import re
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any, ClassVar, cast

import gymnasium
import numpy as np
import pytest
import torch
from gymnasium.envs.registration import EnvSpec
from gymnasium.vector import AutoresetMode
from gymnasium.wrappers import FlattenObservation

from tests import sample_houses
from vitruvius.logic import House
from vitruvius.sim import DEFAULT, Collect, Config, HouseEnv, HouseVectorEnv, Points, Reach
from vitruvius.sim.config import PRESETS
from vitruvius.sim.drive import Drive
from vitruvius.sim.fields import stated
from vitruvius.sim.tasks.remembering import Battery
from vitruvius.sim.tasks.tasks import TARGETS, stated_task, task
from vitruvius.sim.tasks.terms import PLAIN, Terms

HOUSES = [sample_houses.drawn(sample_houses.ONE_ROOM)]
NAME = "Vitruvius/House-v0"


@dataclass(frozen=True)
class OwnTerms(Terms):
    """Terms of a user."""

    worth: float = 2.0


@dataclass(frozen=True)
class OwnTask:
    """A task of a user."""

    share: float = 0.5
    terms: Terms = PLAIN
    ends_on_pick_up: ClassVar[bool] = False

    def spaces(self, house: House) -> list[Any]:
        return [room.box for room in house.rooms]


ARGUMENTS: dict[str, dict[str, Any]] = {
    "configuration": {"preset": Config(observe=("rays", "goal"), flat=True, body=(0.3, 0.3))},
    "fields": {"preset": {"rays": 8, "kinds": ["table"], "drive": {"time_step": 0.1}}},
    "drive": {"preset": Config(drive=Drive(commands=((0.1, 0.2), (0.0, 1.0)))), "backend": "free"},
    "houses": {"houses": tuple(HOUSES)},
    "numpy": {"preset": replace(DEFAULT, **{"noise": np.float32(0.5)}), "seed": np.int64(3)},
    "device": {"device": torch.device("cpu")},
    "task": {"targets": Collect(main=False, terms=Terms(step=-0.1))},
    "points": {"targets": Points(cast(Any, np.array([[1.0, 1.0]])), start=(0.6, 0.6, 0.0))},
    "terms": {"targets": Reach("bedroom", terms=OwnTerms(worth=np.float64(3.0)))},
    "terms in a dictionary": {"targets": {"task": "all", "terms": OwnTerms(steps=30)}},
    "named terms": {"targets": Collect(terms=Battery(capacity=300, step=-0.1))},
    "named task": {"targets": {"task": "visit", "terms": {"step": -0.1}}},
    "own task": {"targets": OwnTask(share=0.25, terms=OwnTerms())},
}  # fmt: skip


@pytest.mark.parametrize("name", ARGUMENTS)
def test_a_spec_comes_back_from_json_and_makes_the_same_environment(name: str) -> None:
    arguments: dict[str, Any] = {"houses": HOUSES} | ARGUMENTS[name]
    env = gymnasium.make(NAME, **arguments)
    spec = env.spec
    assert spec
    for again in (EnvSpec.from_json(spec.to_json()), pickle.loads(pickle.dumps(spec)), copy.deepcopy(spec)):
        assert again == spec
        remade = gymnasium.make(again)
        assert remade.spec == spec
        one, other = env.unwrapped._arguments, remade.unwrapped._arguments  # pyright: ignore
        assert one["houses"] == other["houses"]
        assert stated_task(one["targets"]) == stated_task(other["targets"])
        assert remade.observation_space == env.observation_space
        assert remade.action_space == env.action_space


def test_many_environments_come_back_from_their_spec() -> None:
    arguments: dict[str, Any] = {"houses": HOUSES, "preset": Config(rays=8), "max_episode_steps": 7}
    mode = AutoresetMode.SAME_STEP
    envs = gymnasium.make_vec(NAME, 2, autoreset_mode=mode, **arguments)
    spec = envs.spec
    assert spec
    assert spec.max_episode_steps == 7
    remade = gymnasium.make_vec(EnvSpec.from_json(spec.to_json()))
    assert remade.spec == spec
    assert (remade.num_envs, remade.metadata["autoreset_mode"]) == (2, mode)
    np.testing.assert_array_equal(remade.reset(seed=3)[0], envs.reset(seed=3)[0])
    assert pickle.loads(pickle.dumps(envs)).spec == spec


def test_wrappers_come_back_with_the_environment() -> None:
    env = FlattenObservation(gymnasium.make(NAME, houses=HOUSES, preset={"rays": 8}))
    assert env.spec
    assert gymnasium.make(EnvSpec.from_json(env.spec.to_json())).observation_space == env.observation_space


IDS = ["House-v0", "House-continuous-v0", "House-free-v0", "House-grid-v0", "Paper-v0"]


@pytest.mark.parametrize("name", IDS)
def test_each_id_comes_back_from_its_spec_and_says_how_long_episodes_are(name: str) -> None:
    env = gymnasium.make(f"Vitruvius/{name}")
    assert env.spec
    assert env.spec.max_episode_steps == 1500
    assert gymnasium.make(EnvSpec.from_json(env.spec.to_json())).spec == env.spec


@pytest.mark.parametrize(("arguments", "steps"), [
    ({"preset": "long"}, 3000),
    ({"preset": {"steps": 12}}, 12),
    ({"targets": {"task": "all", "terms": {"steps": 9}}}, 9),
    ({"max_episode_steps": 5}, 5),
    ({"max_episode_steps": 2000, "preset": {"steps": 12}}, 2000),
    ({"max_episode_steps": -1, "preset": {"steps": 12}}, 12),
])  # fmt: skip
def test_episodes_are_as_long_as_the_spec_says(arguments: dict[str, Any], steps: int) -> None:
    env = gymnasium.make(NAME, houses=HOUSES, **arguments)
    assert env.spec
    assert env.spec.max_episode_steps == steps
    if steps != 2000:
        return
    env.reset(seed=0)
    ends = [env.step(0)[3] for _ in range(steps)]
    assert ends.index(True) == steps - 1


def test_a_task_that_no_name_states_stays_itself() -> None:
    class Local(OwnTask):
        """A class that no other process finds."""

    class Named:
        """A class with its own attributes."""

    own = Local()
    assert stated_task(own) is own
    other = Named()
    other.share = 2  # pyright: ignore[reportAttributeAccessIssue]
    assert stated_task(other) is other  # pyright: ignore[reportArgumentType]
    assert stated_task("habit") == "habit"
    for named in (*TARGETS.values(), Reach("hall")):
        assert task(json.loads(json.dumps(stated_task(named)))) == named


FULL = Config(kinds=("bed",), drive=Drive(commands=((0.1, 0.2),)), varied=(("noise", 0.0, 0.1),))
VALUES = {each.name: getattr(FULL, each.name) for each in fields(Config)}


def as_arrays(value: Any) -> Any:
    """Return a value in NumPy's types."""
    if isinstance(value, Drive | str) or value == FULL.varied:
        return value
    array = np.array(value)
    return array if array.ndim else array[()]


@pytest.mark.parametrize("name", VALUES)
@pytest.mark.parametrize("form", ["json", "numpy"])
def test_each_field_is_taken_from_json_and_from_numpy(name: str, form: str) -> None:
    value = VALUES[name]
    given = json.loads(json.dumps(stated(value))) if form == "json" else as_arrays(value)
    config = replace(DEFAULT, **{name: given})
    assert getattr(config, name) == value
    assert config == replace(DEFAULT, **{name: value})
    assert hash(config) == hash(replace(DEFAULT, **{name: value}))
    json.dumps(stated(config))


@pytest.mark.parametrize("name", PRESETS)
def test_presets_come_back_from_json(name: str) -> None:
    assert Config(**json.loads(json.dumps(stated(PRESETS[name])))) == PRESETS[name]


@pytest.mark.parametrize(
    ("given", "plain"),
    [
        ({"task": "all", "at_once": np.int64(3)}, {"task": "all", "at_once": 3}),
        ({"task": "habit", "seed": np.int64(4)}, {"task": "habit", "seed": 4}),
        ({"points": np.array([[1.0, 2.0]])}, {"points": [[1.0, 2.0]]}),
        ({"task": "all", "terms": {"targets": np.int16(2)}}, {"task": "all", "terms": {"targets": 2}}),
    ],
)  # fmt: skip
def test_a_task_of_numpys_numbers_is_the_task_of_pythons(given: Any, plain: Any) -> None:
    assert task(given) == task(plain)
    assert json.loads(json.dumps(stated_task(task(given)))) == stated_task(task(plain))


def test_the_eye_is_in_the_middle_of_a_body_unless_it_is_put_elsewhere() -> None:
    for wide in (Config(body=(0.6, 0.4)), replace(DEFAULT, body=(0.6, 0.4)), Config(body=[0.6, 0.4])):  # pyright: ignore[reportArgumentType]
        assert wide.eye == (0.3, 0.2)
    assert replace(Config(eye=(0.1, 0.1)), body=(0.6, 0.4)).eye == (0.1, 0.1)
    with pytest.raises(ValueError, match=r"eye is \(1.0, 1.0\) m: it must lie within the"):
        Config(eye=(1.0, 1.0))
    with pytest.raises(ValueError, match="free does not support eye outside the middle"):
        HouseEnv(HOUSES, backend="free", preset={"eye": [0.1, 0.1]})


WRONG: dict[str, dict[str, Any]] = {
    "there is no field of preset ray: did you mean rays": {"preset": {"ray": 8}},
    "there is no field of drive sped: did you mean speed": {"preset": {"drive": {"sped": 1.0}}},
    "observe must be a list, not 'rays'": {"preset": {"observe": "rays"}},
    "body must have 2 values, not [0.3]": {"preset": {"body": [0.3]}},
    "body must be a list, not 0.3": {"preset": {"body": 0.3}},
    "rays must be a whole number, not True": {"preset": {"rays": True}},
    "preset has a drive, which backend 'continuous' does not use: use the backend free": {"preset": "drive"},
    "targets: there is no argument room: did you mean rooms": {"targets": {"room": "kitchen"}},
}


@pytest.mark.parametrize("words", WRONG)
def test_wrong_fields_are_refused_in_words(words: str) -> None:
    with pytest.raises(ValueError, match=re.escape(words)):
        HouseEnv(HOUSES, **WRONG[words])


def test_a_target_lies_near_its_house() -> None:
    envs = HouseVectorEnv([*HOUSES, sample_houses.RANDOM[0]], 2)
    envs.reset(seed=0)
    where = {"house": [1, 1], "target": [[1.0, 1.0], [500.0, 500.0]]}
    for options, house in ((where, 1), ({"target": where["target"]}, 0)):
        words = rf"\(500.000, 500.000\) m is more than 100 m from house {house}"
        with pytest.raises(ValueError, match=words):
            envs.reset(options=options)
    envs.reset(options=where | {"reset_mask": [True, False]})


def test_a_path_is_text() -> None:
    spec = HouseEnv(HOUSES)
    spec.spec = EnvSpec("Own-v0", kwargs={"houses": Path("houses.jsonl")})
    assert spec.spec
    assert spec.spec.kwargs == {"houses": "houses.jsonl"}
