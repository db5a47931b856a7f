"""A user's backend: the documentation's example runs unchanged, and invalid backends are refused."""

import importlib
import re
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from tests import sample_houses
from tests.sim.conformance.autoreset import check_autoreset_modes
from tests.sim.conformance.claims import check_vector_env
from vitruvius.logic import House, Star
from vitruvius.sim import HouseVectorEnv, Oracle
from vitruvius.sim.backends.backend import METHODS

pytestmark = pytest.mark.second_part("a backend of the docs, in every autoreset mode")

DOCS = Path(__file__).parents[3] / "docs"
NAME = "main_room:MainRoom"
HOUSES = [sample_houses.drawn(sample_houses.ONE_ROOM), *sample_houses.RANDOM[:2]]
EMPTY = [House.of_star(Star(house.star.floor)) for house in HOUSES]
"""Houses with only their main rooms."""


@pytest.fixture(scope="module", autouse=True)
def folder(tmp_path_factory):
    """Save the class of the documentation page, and yield its folder."""
    path = tmp_path_factory.mktemp("backends")
    code = re.search(r"```python\n(.*?)```", (DOCS / "tutorials" / "backend.md").read_text(), re.DOTALL)
    assert code
    (path / "main_room.py").write_text(code[1])
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(path)
        yield path


def make(**arguments) -> HouseVectorEnv:
    return HouseVectorEnv(**({"houses": HOUSES, "num_envs": 3, "backend": NAME} | arguments))


@pytest.mark.parametrize("preset", ["default", "paper"])
@pytest.mark.parametrize("mode", AutoresetMode)
def test_the_backend_in_the_docs_conforms_in_every_autoreset_mode(mode, preset):
    envs = make(autoreset_mode=mode, preset=preset, max_episode_steps=20)
    check_vector_env(envs, steps=100, options={"house": [0, 1, 0]})


def test_its_autoreset_modes_give_the_same_episodes():
    check_autoreset_modes(lambda mode: make(autoreset_mode=mode, max_episode_steps=20), steps=60)


@pytest.mark.parametrize("preset", ["default", "paper"])
@pytest.mark.parametrize("by_ray", [False, True])
def test_it_equals_the_continuous_backend_in_a_house_of_a_main_room_alone(preset, by_ray):
    """Rays agree within 1e-5 m; moves, starts and targets are equal, in both shapes of the loop."""
    arguments = {"num_envs": 200, "houses": EMPTY, "preset": preset, "by_ray": by_ray}
    ours, theirs = make(**arguments), make(**arguments | {"backend": "continuous"})
    (seen, info), (their_seen, their_info) = ours.reset(seed=0), theirs.reset(seed=0)
    plan = np.random.default_rng(0).choice(3, p=[0.1, 0.1, 0.8], size=(60, 200))
    blocked = picked = different = 0
    for actions in plan:
        for name in ("pose", "house", "target", "blocked"):
            np.testing.assert_array_equal(info[name], their_info[name])
        np.testing.assert_allclose(
            seen[..., -2] * ours.config.range, their_seen[..., -2] * ours.config.range, atol=2e-5
        )
        different += (seen[..., -1] != their_seen[..., -1]).sum()
        blocked += info["blocked"].sum()
        (seen, reward, *_, info), (their_seen, *_, their_info) = ours.step(actions), theirs.step(actions)
        picked += reward.sum()
    assert blocked > 100
    assert picked
    assert different < 1e-5 * plan.size * ours.config.rays


def test_an_environment_with_it_swaps_banks_restores_states_renders_and_has_an_oracle():
    envs = gymnasium.make_vec("Vitruvius/House-v0", num_envs=4, houses=HOUSES[:1], backend=NAME)
    unwrapped = envs.unwrapped
    assert isinstance(unwrapped, HouseVectorEnv)
    envs.reset(seed=0)
    assert (Oracle(unwrapped).play() > 10).all()
    unwrapped.set_houses(HOUSES[1:])
    _, info = envs.reset(seed=0)
    state, plan = unwrapped.state, np.random.default_rng(0).integers(0, 3, (20, 4))
    once = [envs.step(actions)[0] for actions in plan]
    unwrapped.state = state
    np.testing.assert_array_equal(once, [envs.step(actions)[0] for actions in plan])
    for pose, message in (
        ((0.0, 0.0, 0.1), "multiple of pi/4"),
        ((-9.0, 0.0, 0.0), "the robot cannot stand at"),
    ):
        with pytest.raises(ValueError, match=message):
            envs.reset(options={"house": info["house"], "pose": [pose] * 4})


def test_targets_in_rooms_that_it_cannot_reach_are_refused_with_the_room():
    with pytest.raises(ValueError, match=re.escape("house 0 of 2: the robot cannot reach room R0 (hall)")):
        make(houses=HOUSES[1:], targets="secondary")


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("mainroom", "there is no backend mainroom: there are continuous, free, grid, or module:Class"),
        ("mainroom:MainRoom", "backend 'mainroom:MainRoom' cannot be used: No module named 'mainroom'"),
        (":MainRoom", "backend ':MainRoom' cannot be used"),
        (".main_room:MainRoom", "backend '.main_room:MainRoom' cannot be used"),
        ("main_room:", "backend 'main_room:' cannot be used"),
        ("main_room:Mainroom", "cannot be used: module 'main_room' has no attribute 'Mainroom'"),
        ("main_room:WALL", "backend 'main_room:WALL' cannot be used: it is not a class"),
    ],
)
def test_a_name_that_names_no_backend_is_refused(name, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        make(backend=name)


@pytest.mark.parametrize("method", METHODS)
def test_a_class_that_lacks_a_method_is_refused_by_its_name(method, monkeypatch):
    whole = importlib.import_module("main_room")
    methods = {name: vars(whole.MainRoom)[name] for name in METHODS if name != method}
    monkeypatch.setattr(whole, "Lacking", type("Lacking", (), methods), raising=False)
    message = (
        f"backend 'main_room:Lacking' cannot be used: it has no {method}(), "
        "see vitruvius.sim.backends.backend.Backend"
    )
    with pytest.raises(ValueError, match=re.escape(message)):
        make(backend="main_room:Lacking")


def test_the_docs_page_describes_every_method_of_a_backend():
    rows = re.findall(r"^\| `(\w+)\(", (DOCS / "backends.md").read_text(), re.MULTILINE)
    assert rows == ["__init__", *METHODS]
