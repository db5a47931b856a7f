"""Several targets at once, compared with environments that have each of them alone."""

import pickle
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests import sample_houses
from vitruvius.sim import DEFAULT, HouseVectorEnv
from vitruvius.sim.drive import COMMANDS, Drive
from vitruvius.sim.tasks.words import in_words

pytestmark = pytest.mark.second_part("kernels of several targets")

HOUSES = [sample_houses.drawn("Aa+aa.bBb\n......+bb\n......bbb", cell=1.2)]
COUNT, NUMBER = 32, 3
DRIVEN = replace(DEFAULT, drive=Drive(commands=COMMANDS))


def made(targets: Any, backend: str, **more: Any) -> HouseVectorEnv:
    preset = DRIVEN if backend == "free" else DEFAULT
    return HouseVectorEnv(HOUSES, COUNT, targets=targets, backend=backend, preset=preset, **more)


def gaps(envs: HouseVectorEnv, places: np.ndarray, poses: np.ndarray) -> np.ndarray:
    """Return metres (E, n) between bodies at poses (E, 3) and targets (E, n, 2); negative for an overlap."""
    away = np.abs(places - poses[:, None, :2]) - envs.config.target / 2
    body = max(envs.config.body) / 2
    if envs.config.drives:  # a disc
        return np.hypot(*np.moveaxis(np.maximum(away, 0), 2, 0)) - body
    return away.max(2) - body


@pytest.mark.parametrize("backend", ["continuous", "free", "grid"])
def test_rays_show_the_nearest_of_the_targets_and_each_can_be_picked_up(backend):
    several, alone = made({"task": "all", "at_once": NUMBER}, backend), made("all", backend)
    _, first = alone.reset(seed=4)
    _, info = several.reset(seed=4)
    coming, found, others = several.targets(40), np.zeros(COUNT, int), 0
    np.testing.assert_array_equal(coming[:, 0], first["target"])
    np.testing.assert_array_equal(info["targets"], coming[:, :NUMBER])
    np.testing.assert_array_equal(info["pose"], first["pose"])
    plan = np.random.default_rng(1).choice(3, p=[0.15, 0.15, 0.7], size=(150, COUNT))
    for turn, actions in enumerate(plan):
        before = info["targets"]
        observation, reward, _, _, info = several.step(actions)
        gap = gaps(several, before, info["pose"])
        assert reward[(gap < -1e-4).any(1)].all()
        assert not reward[(gap > 1e-4).all(1)].any()
        for e in np.flatnonzero(reward):
            assert (info["targets"][e] == coming[e, NUMBER + found[e]]).all(1).any()
            found[e], others = found[e] + 1, others + (gap[e, 0] > 1e-4)
        if turn % 15 == 0:
            options = {"house": info["house"], "pose": info["pose"]}
            seen = np.stack([
                alone.reset(options=options | {"target": info["targets"][:, k]})[0] for k in range(NUMBER)
            ])  # fmt: skip
            nearest = seen[..., 0].argmin(0)[None]
            np.testing.assert_allclose(observation[..., 0], seen[..., 0].min(0), atol=1e-5)
            shown = np.take_along_axis(seen[..., 1], nearest, 0)[0]
            assert (observation[..., 1] != shown).mean() < 1e-3
            assert shown.any()
    assert found.sum() > 9
    assert others > 2


@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
def test_targets_that_are_there_go_along_with_states_and_ends(mode):
    envs = made(
        {"task": "all", "at_once": NUMBER, "terms": {"targets": 2}}, "continuous", autoreset_mode=mode
    )
    _, info = envs.reset(seed=1)
    rows = np.random.default_rng(3).choice(3, p=[0.1, 0.1, 0.8], size=(400, COUNT))
    found, ends = np.zeros(COUNT), 0
    for actions in rows[:300]:
        _, reward, terminated, _, info = envs.step(actions)
        found += reward
        np.testing.assert_array_equal(terminated, found == 2)
        if mode == "SameStep" and terminated.any():
            last = info["final_info"]
            np.testing.assert_array_equal(last["targets"][terminated, 0], last["target"][terminated])
            assert (gaps(envs, last["targets"], last["pose"])[terminated, 0] < 1e-4).all()
        found[terminated], ends = 0, ends + terminated.sum()
    assert ends > 3
    copy = pickle.loads(pickle.dumps(envs))
    for actions in rows[300:]:
        ours, theirs = envs.step(actions), copy.step(actions)
        np.testing.assert_array_equal(ours[0], theirs[0])
        np.testing.assert_array_equal(ours[-1]["targets"], theirs[-1]["targets"])
    state = envs.state
    state["others"][3] = np.nan
    with pytest.raises(ValueError, match="target is outside its house"):
        envs.state = state


def test_wrong_numbers_of_targets_at_once_are_refused():
    assert in_words({"task": "main", "at_once": 3}) == "targets in the main room, 3 at once"
    range_, kind = "at_once is .*: it must be 1 to 64 targets", "at_once must be a whole number, not "
    for number, said in ((0, range_), (65, range_), (2.0, kind), (True, kind)):
        with pytest.raises(ValueError, match=said):
            HouseVectorEnv(HOUSES, targets={"task": "main", "at_once": number})
    several = {"task": "main", "at_once": 2}
    for preset in (replace(DEFAULT, geodesic=True), replace(DEFAULT, latency=2)):
        with pytest.raises(ValueError, match="several targets at once support neither the distance"):
            HouseVectorEnv(HOUSES, targets=several, preset=preset)
    with pytest.raises(ValueError, match="another number of targets at once"):
        HouseVectorEnv(HOUSES, targets="main").set_houses(HOUSES, several)
