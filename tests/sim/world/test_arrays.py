"""The table of arrays, its page, and the interface of overlays."""

# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false

from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

from vitruvius.sim import Config, HouseVectorEnv
from vitruvius.sim.arrays import ArrayRow
from vitruvius.sim.drive import Drive
from vitruvius.sim.parts import PARTS, ObservedPart
from vitruvius.sim.runtime import Array, ti
from vitruvius.sim.world import overlays, page
from vitruvius.sim.world.kind import WorldKind

KIND = 40


def test_the_page_of_arrays_is_printed_from_the_table():
    written = (Path(__file__).parents[3] / "docs/arrays.md").read_text("utf-8")
    assert written == page.page(), "./run python -m vitruvius.sim.world.page > docs/arrays.md"


def test_speeds_of_bodies_that_drive_have_an_array_of_their_own():
    kinds = WorldKind(Config(drives=True, drive=Drive(sideways=0.5))), WorldKind(Config())
    driving, walking = ({row.name: row.width_of(kind.sizes()) for row in kind.rows} for kind in kinds)
    assert (driving["reals"], driving["wholes"], driving["speeds"]) == (5, 7, 3)
    assert (walking["reals"], walking["wholes"]) == (4, 10)
    assert "speeds" not in walking


def test_a_part_that_sees_the_room_brings_the_table_of_rooms(monkeypatch):
    monkeypatch.setitem(PARTS, "goal", ObservedPart("room", 1, sees_room=True))
    named = {row.name for row in WorldKind(Config(observe=("rays", "goal"))).rows}
    assert {"surroundings", "rooms", "extras"} <= named


@ti.data_oriented
class Curtain:
    """An overlay for this test: a curtain around each body, which it pushes twice in an episode."""

    ROWS: ClassVar = (ArrayRow("left", ti.i32, ("n",), saved=True),)
    KIND: ClassVar[int] = KIND
    COLUMN: ClassVar[str] = "is curtain"

    def __init__(self, config, body, lanes):
        self.lanes = lanes

    @staticmethod
    def asked(config):
        return True

    @staticmethod
    def check(knows_distance):
        pass

    @staticmethod
    def arrays(shapes, num_envs):
        return {"left": Array(ti.i32, num_envs)}

    @ti.func
    def begin(self, world: ti.template(), e, state):
        world.left[e] = 2

    @ti.func
    def cut(self, world: ti.template(), e, state, action, moved, blocked):
        met = -1
        if world.left[e] > 0:
            moved, blocked, met = state, 1, 0
        return moved, blocked, met

    @ti.func
    def advance(self, world: ti.template(), e, state, met):
        if met == 0:
            world.left[e] -= 1

    @ti.func
    def hide(self, world: ti.template(), e, state, ray, distance: ti.template(), kind: ti.template()):
        if world.left[e] > 0:
            for r in range(ti.static(self.lanes)):
                distance[r], kind[r] = 0.1, ti.u32(KIND)

    @staticmethod
    def drawn(config, arrays, shape, e):
        return np.full((arrays["left"][e], 4), 1.0)


@pytest.mark.parametrize("backend", ["continuous", "free"])
def test_an_overlay_is_met_seen_pushed_drawn_and_saved_without_any_code_for_it(monkeypatch, backend):
    monkeypatch.setattr(overlays, "OVERLAYS", (Curtain,))
    envs = HouseVectorEnv(num_envs=2, backend=backend)
    seen, info = envs.reset(seed=0)
    forward = np.full(2, 2) if backend == "continuous" else np.array([[0.7, 0.0]] * 2, np.float32)
    start, pushed = info["pose"], []
    for left in (1, 0):
        assert (seen[..., 0] < 0.02).all()
        seen, *_, info = envs.step(forward)
        assert info["blocked"].all()
        np.testing.assert_array_equal(info["pose"], start)
        assert envs.state["left"].tolist() == [left] * 2
        pushed.append(len(envs.scene(0).over))
    assert pushed == [1, 0]
    assert (seen[..., 0] > 0.02).any()
    envs.step(forward)
    assert (envs.info()["pose"] != start).any()
