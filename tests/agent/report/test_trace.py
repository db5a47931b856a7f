"""A trace records an episode in few bytes; a malformed trace is refused."""

import json

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from tests.agent.report.conftest import HOUSE, STEPS, recorded, untrained, with_planner
from vitruvius.agent.planner import FREE, TAKEN
from vitruvius.agent.recording import trace
from vitruvius.agent.recording.film import watch
from vitruvius.agent.recording.recorder import PICTURE_STEPS, Recorder
from vitruvius.agent.recording.trace import FORMAT, Packed, Trace, TraceError
from vitruvius.sim.geometry import geometry


class Notes:
    """True states of the environment and the policy at each step."""

    def begin(self, envs, policy):
        self.envs, self.policy, self.scenes, self.blocked = envs, policy, [], []
        self.actions, self.states = [], []

    def note(self, moment):
        self.scenes.append(self.envs.scene(0))
        if moment.step:
            self.blocked.append(bool(moment.blocked[0]))
        if moment.actions is not None:
            planner = self.policy.tracker.planner
            self.actions.append((int(moment.actions[0]), self.policy.choice))
            self.states.append((planner.pose(0), planner.occupancy(0), planner.state))


@pytest.fixture(scope="module")
def both() -> tuple[Trace, Notes]:
    """Return an episode of an agent that keeps a map, and its true states."""
    recorder, notes = Recorder("with planner", "main", 3), Notes()
    watch(with_planner(), HOUSE, [notes, recorder], seed=3, steps=STEPS)
    return recorder.trace, notes


kinds = st.sampled_from(["uint8", "uint16", "int16"])
shapes = arrays.array_shapes(max_dims=3, max_side=6)


@given(kinds.flatmap(lambda kind: arrays.arrays(kind, shapes)))
def test_an_array_that_is_packed_and_unpacked_is_the_same(array) -> None:
    packed = msgspec.json.decode(msgspec.json.encode(Packed.of(array)), type=Packed)
    assert packed.array().dtype == array.dtype
    assert np.array_equal(packed.array(), array)


def test_what_is_recorded_is_what_happened(both) -> None:
    made, notes = both
    pose = np.array([scene.pose for scene in notes.scenes])
    steps = np.column_stack([made.column("east"), made.column("south")])
    assert np.abs(np.array(made.origin) + made.sensor.step * steps - pose[:, :2]).max() < 1e-4
    assert np.array_equal(made.column("heading"), np.rint(pose[:, 2] / (np.pi / 4)) % 8)
    distance = made.column("distance") / 65535 * made.sensor.range
    assert np.abs(distance - [scene.distance for scene in notes.scenes]).max() < 1e-3
    hits = np.unpackbits(made.column("hits"), axis=1)[:, : made.sensor.rays]
    assert np.array_equal(hits, [scene.is_target for scene in notes.scenes])
    targets = np.array(made.targets)[made.column("found")]
    assert np.abs(targets - [scene.target for scene in notes.scenes]).max() < 1e-3
    assert made.column("action").tolist() == [action for action, _ in notes.actions]
    assert made.column("blocked").tolist() == notes.blocked
    values = made.column("values") * made.value_unit
    assert np.abs(values - [choice.values[0].numpy() for _, choice in notes.actions]).max() < 1e-4
    allowed = np.array([choice.allowed[0].numpy() for _, choice in notes.actions])
    assert np.array_equal(
        np.unpackbits(made.column("allowed")[:, None], axis=1, bitorder="little")[:, :3], allowed
    )


def test_the_map_lies_on_the_house(both) -> None:
    made, notes = both
    assert made.map
    ground = made.map.ground.array()
    assert len(ground) == -(-STEPS // PICTURE_STEPS)
    _, occupancy, _ = notes.states[(len(ground) - 1) * PICTURE_STEPS]
    assert np.count_nonzero(ground[-1] == 3) == np.count_nonzero(occupancy == TAKEN)
    assert np.count_nonzero(np.isin(ground[-1], (1, 2))) == np.count_nonzero(occupancy == FREE)
    rows, columns = np.nonzero(ground[-1] == 3)
    place = (
        np.column_stack([columns, rows]) * made.map.cell + [made.map.west, made.map.north] + made.map.cell / 2
    )
    shape, (table,) = geometry(HOUSE), HOUSE.star.rooms[0].pieces
    solid = [table.x + table.width / 2, table.y + table.height / 2, table.width / 2, table.height / 2]
    middle, half = np.split(np.vstack([shape.verticals, shape.horizontals, solid]), 2, axis=1)
    away = np.maximum(np.abs(place[:, None] - middle) - half, 0).max(axis=-1).min(axis=-1)
    assert away.max() < 2 * made.map.cell


def test_a_target_is_believed_to_be_nowhere_where_it_would_have_been_seen(both) -> None:
    made, _ = both
    assert made.map
    ground, belief = made.map.ground.array(), made.map.belief.array()
    assert belief.max() <= 100
    assert belief.any()
    assert not belief[ground == 3].mean() > 10
    seen = ground == 2
    surely = seen[:, 2:-2, 2:-2].copy()
    for y in range(-2, 3):
        for x in range(-2, 3):
            surely &= np.roll(seen, (y, x), axis=(1, 2))[:, 2:-2, 2:-2]
    assert surely.any()
    assert not belief[:, 2:-2, 2:-2][surely].any()


def test_where_it_believes_the_target_to_be_is_where_the_target_is(both) -> None:
    made, _ = both
    known = made.column("goal_kind") == 2
    assert known.any()
    targets = np.array(made.targets)[made.column("found")[:-1]]
    near = np.abs(made.column("goal") / 100 - targets).max(axis=1)[known] < 0.15
    assert near.mean() > 0.9  # at the very step of a pick-up it is the last target's


def test_looking_on_changes_nothing_that_the_agent_does(both) -> None:
    notes = Notes()
    watch(with_planner(), HOUSE, [notes], seed=3, steps=STEPS)
    assert [action for action, _ in notes.actions] == [action for action, _ in both[1].actions]
    for (_, _, alone), (_, _, watched) in zip(notes.states, both[1].states, strict=True):
        assert all(np.array_equal(alone[name], watched[name]) for name in alone)


def test_an_episode_of_an_agent_without_a_map_has_its_values_and_vetoes() -> None:
    made = recorded(untrained()).trace
    assert made.map is None
    assert "advice" not in made.columns
    wanted, action, allowed = (made.column(name) for name in ("wanted", "action", "allowed"))
    assert (wanted != action).any()
    assert ((allowed >> action) & 1).all()
    assert not ((allowed >> wanted) & 1)[wanted != action].any()


def test_the_same_episode_gives_the_same_bytes_and_they_are_few(tmp_path, mapped) -> None:
    for name in ("one", "other"):
        trace.save(mapped if name == "one" else recorded(with_planner()).trace, tmp_path / name)
    assert (tmp_path / "one").read_bytes() == (tmp_path / "other").read_bytes()
    assert (tmp_path / "one").stat().st_size < 200 * STEPS
    read = trace.load(tmp_path / "one")
    assert msgspec.json.encode(read) == msgspec.json.encode(mapped)


def _changed(**changes):
    return lambda made: made | changes


def _column(name, **changes):
    return lambda made: made | {"columns": made["columns"] | {name: made["columns"][name] | changes}}


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (_changed(format="vitruvius-trace-2"), f"a trace of version vitruvius-trace-2, not {FORMAT}"),
        (_changed(format="vitruvius-2"), "not a trace: "),
        (_changed(length=7), "must be uint8 of shape"),
        (_changed(targets=[]), "fewer targets than were picked up"),
        (_changed(house={}), "not a trace: "),
        (_changed(columns={}), "column action is missing"),
        (_column("action", data="eJwDAAAAAAE="), "its data are not of shape"),
        (_column("action", data="AAAA"), "cannot be unpacked"),
        (_column("action", data="?"), "not a trace: "),
        (_column("action", shape=[10**9]), "column action must be"),
    ],
)
def test_what_is_no_trace_is_refused_by_one_line(tmp_path, mapped, change, says) -> None:
    path = tmp_path / "x.trace.json"
    path.write_text(json.dumps(change(json.loads(msgspec.json.encode(mapped)))))
    with pytest.raises(TraceError) as error:
        trace.load(path)
    assert str(error.value).startswith(f"{path}: ")
    assert says in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("content", [b"", b"\xff", b"[1]", b"{" * 10_000])
def test_what_is_no_json_is_refused_by_one_line(tmp_path, content) -> None:
    path = tmp_path / "x.trace.json"
    path.write_bytes(content)
    with pytest.raises(TraceError, match=r"x.trace.json: not a trace: .*vitruvius record --out"):
        trace.load(path)
    with pytest.raises(TraceError, match=r"absent: cannot be read: No such file"):
        trace.load(tmp_path / "absent")
