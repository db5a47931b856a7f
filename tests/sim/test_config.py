"""Limits, defaults and derived numbers of configurations and of the limits of driving bodies."""

import re
from dataclasses import fields, replace
from math import hypot, inf, nan, pi
from typing import Any

import numpy as np
import pytest

from vitruvius.sim.config import DEFAULT, PRESETS, Config
from vitruvius.sim.drive import COMMANDS, PARTS, Drive

LENGTHS = "positive lengths in metres"
PROBABILITIES = "none may be negative; dropout and slip must be at most 1"

LIMITS: dict[str, tuple[list[Any], dict[Any, str]]] = {
    "body": ([(0.1, 0.2)], {(0.1, 0.0): LENGTHS, (-0.1, 0.1): LENGTHS, (0.1, inf): LENGTHS}),
    "step": ([0.001], {0.0: LENGTHS, inf: LENGTHS, nan: LENGTHS}),
    "range": ([0.001], {0.0: LENGTHS, inf: LENGTHS}),
    "target": ([0.001], {0.0: LENGTHS, inf: LENGTHS}),
    "rays": ([1, 1024], {0: "0 rays and 1500 steps: give 1 to 1,024 rays", 1025: "1,024 rays"}),
    "steps": ([1, 2**31 - 1], {0: "0 steps: give 1 to", 2**31: "1 to 2,147,483,647 steps"}),
    "ray_spacing": ([0.01, 360], {0: "ray_spacing is 0 degrees", 360.01: "at most 360", nan: "is nan"}),
    "first_ray": ([-400.0], {inf: "first_ray inf: ", nan: "first_ray nan: "}),
    "angle_noise": ([0, 45], {-0.1: "angle_noise is -0.1 degrees", 45.1: "degrees: it must be 0 to 45"}),
    "noise": ([0, 99.0], {-0.1: "noise -0.1 m", inf: PROBABILITIES}),
    "dropout": ([0, 1], {-0.1: "dropout -0.1", 1.01: PROBABILITIES}),
    "slip": ([0, 1], {-0.1: "slip -0.1", 1.01: PROBABILITIES}),
    "latency": ([0, 255], {-1: "latency is -1 steps", 256: "latency is 256 steps: it must be 0 to 255"}),
    "drift": ([0, 9.0], {-1.0: "drift is -1.0: it must not be negative", inf: "drift is inf"}),
    "closed_doors": ([0, 255], {-1: "closed_doors is -1 steps", 256: "must be 0 to 255"}),
    "collision": (["swept", "original"], {"none": "unknown collision 'none': choose swept or original"}),
    "kinds": (
        [(), tuple(map(str, range(64)))],
        {("bed", "bed"): "kinds are bed, bed: name each once", tuple(map(str, range(65))): "at most 64"},
    ),
    "observe": (
        [("goal",), ("rays", "speed")],
        {
            ("goall",): "observe: there is no observation goall: did you mean goal?",
            (): "observe is nothing: name at least one part, and each part once",
            ("goal", "goal"): "observe is goal, goal: name at least one part, and each part once",
        },
    ),
}
"""For each field the values at its limits, and those beyond, with words of the error."""

DRIVES: dict[str, tuple[list[Any], dict[Any, str]]] = {
    "time_step": ([0.001, 1.0], {0: "time_step 0 s, speed 0.7 m/s: both must be above 0", inf: "above 0"}),
    "speed": ([0.001], {0: "speed 0 m/s: both must be above 0", inf: "speed inf m/s"}),
    "reverse": ([0, 9.0], {-1: "drive: reverse -1 m/s, sideways 0.0 m/s", inf: "reverse inf"}),
    "sideways": ([0, 9.0], {-1: "sideways -1 m/s", inf: "none may be negative"}),
    "turn_speed": ([0, 10 * pi], {-1: "turn_speed -1 rad/s", 31.5: "more than half a turn"}),
    "acceleration": ([0.01, inf], {0: "drive: acceleration 0, turn_acceleration 12.0: both must be above 0"}),
    "turn_acceleration": ([0.01, inf], {0: "turn_acceleration 0: both must be above 0"}),
    "at_contact": (["slide", "stop"], {"bounce": "drive: at_contact is 'bounce': choose slide or stop"}),
    "commands": (
        [((0.7, 3.0), (0.0, -3.0)), ((0.0, 0.0),) * 1024],
        {
            ((0.8, 0.0),): "drive: command (0.8, 0.0): (v, w) must not exceed the maximum speeds",
            ((-0.1, 0.0),): "command (-0.1, 0.0)",
            ((nan, 0.0),): "command (nan, 0.0)",
            ((0.0, 0.0, 0.0),): "command (0.0, 0.0, 0.0)",
            ((0.0, 0.0),) * 1025: "drive: 1025 commands: at most 1,024",
        },
    ),
}  # fmt: skip


@pytest.mark.parametrize(
    ("default", "name"),
    [*((DEFAULT, name) for name in LIMITS), *((DEFAULT.drive, name) for name in DRIVES)],
    ids=lambda value: value if isinstance(value, str) else type(value).__name__,
)
def test_a_value_at_its_limit_is_taken_and_one_beyond_is_refused_in_words(default, name):
    taken, refused = (LIMITS if default is DEFAULT else DRIVES)[name]
    for value in taken:
        assert getattr(replace(default, **{name: value}), name) == value
    for value, words in refused.items():
        with pytest.raises(ValueError, match=re.escape(words)):
            replace(default, **{name: value})


@pytest.mark.parametrize(
    "other", [{"collision": "original"}, {"ends_on_collision": True}, {"body": (0.2, 0.3)}], ids=str
)
def test_closed_doors_need_a_body_that_can_push_them(other):
    replace(DEFAULT, **other)
    with pytest.raises(
        ValueError, match="closed_doors needs collision 'swept', a square body, and ends_on_collision=False"
    ):
        replace(DEFAULT, closed_doors=1, **other)


def test_the_default_lengths_are_those_of_the_paper_in_pixels_of_8_5_to_a_foot():
    lengths = (*DEFAULT.body, *DEFAULT.eye, DEFAULT.step, DEFAULT.range, DEFAULT.target)
    assert np.multiply(lengths, 8.5 / 0.3048) == pytest.approx([8, 8, 4, 4, 2, 220, 15], rel=1e-12)


def test_presets_stay_as_they_are_published():
    changed = {
        name: {
            each.name: getattr(preset, each.name)
            for each in fields(Config)
            if getattr(preset, each.name) != getattr(DEFAULT, each.name)
        }
        for name, preset in PRESETS.items()
    }
    paper = changed.pop("paper")
    assert np.multiply(paper.pop("body") + paper.pop("eye"), 8.5 / 0.3048) == pytest.approx([8, 11, 4, 5])
    assert paper == {
        "collision": "original", "ends_on_collision": True, "first_ray": 60.0, "sees_angle": True,
        "random_start": False,
    }  # fmt: skip
    assert changed == {
        "default": {},
        "doors": {"closed_doors": 4, "sees_kind": True},
        "drive": {"drive": Drive(commands=COMMANDS)},
        "long": {"steps": 3000},
        "noisy": {"noise": 0.02, "dropout": 0.02, "slip": 0.01},
    }


def test_rays_are_numbered_clockwise_from_the_first():
    few = replace(DEFAULT, rays=3, first_ray=90.0, ray_spacing=45)
    assert few.ray_angles == pytest.approx([pi / 2, pi / 4, 0])
    assert DEFAULT.ray_angles == pytest.approx(-DEFAULT.ray_angles[::-1])


def test_the_columns_of_a_ray_are_in_the_order_of_their_page():
    seen = replace(DEFAULT, sees_angle=True, kinds=("bed", "desk"), sees_kind=True, closed_doors=1)
    assert seen.columns == (
        "angle", "kind bed", "kind desk", "distance", "is wall", "is piece", "is door", "is target",
    )  # fmt: skip
    assert (seen.channels, seen.column("is piece")) == (8, 5)
    assert DEFAULT.columns == ("distance", "is target")
    assert replace(DEFAULT, closed_doors=1).columns == DEFAULT.columns


def test_each_part_of_an_observation_beside_rays_begins_where_the_one_before_ends():
    every = ("bump", "last_action", "rays", "odometry", "goal", "geodesic", "speed")
    seen = replace(DEFAULT, observe=every)
    assert {name: seen.extra(name) for name in seen.extras} == {
        "bump": 0, "last_action": 1, "odometry": 4, "goal": 8, "geodesic": 10, "speed": 11,
    }  # fmt: skip
    assert seen.extra_numbers == 13
    assert replace(seen, drive=Drive(sideways=0.1)).extra_numbers == 14
    assert DEFAULT.extras == ()


@pytest.mark.parametrize(
    ("name", "without", "by"),
    [
        ("knows_distance", {}, [{"geodesic": True}, {"observe": ("geodesic",)}]),
        ("notes_hits", {"closed_doors": 1}, [{"sees_kind": True}, {"kinds": ("bed",)}]),
        ("sees_doors", {"sees_kind": True}, [{"sees_kind": True, "closed_doors": 1}]),
        ("sees_doors", {"closed_doors": 1}, [{"sees_kind": True, "closed_doors": 1}]),
    ],
)
def test_what_a_configuration_asks_for_is_known(name, without, by):
    assert getattr(replace(DEFAULT, **without), name) is False
    assert all(getattr(replace(DEFAULT, **each), name) is True for each in by)


def test_lattices_take_rays_that_divide_45_degrees_and_no_errors_of_direction():
    for spacing in (0.1, 0.9, 1, 1.5, 3, 15, 22.5, 45 / 7, 45):
        replace(DEFAULT, ray_spacing=spacing).require_few_directions()
    for spacing in (0.09, 2, 22, 46, 90):
        with pytest.raises(ValueError, match=f"ray_spacing is {spacing} degrees: it must divide 45 and"):
            replace(DEFAULT, ray_spacing=spacing).require_few_directions()
    with pytest.raises(ValueError, match="angle_noise is 1 degrees: only the backend free supports it"):
        replace(DEFAULT, angle_noise=1).require_few_directions()
    DEFAULT.require_lattice("the oracle")
    with pytest.raises(ValueError, match="the oracle counts grid steps: use the"):
        replace(DEFAULT, drives=True).require_lattice("the oracle")


def test_a_command_has_a_number_for_each_speed_within_its_limits():
    two, three = Drive(reverse=0.2), Drive(speed=0.5, reverse=0.6, sideways=0.3, turn_speed=2.0)
    assert (two.names, two.low, two.high) == ("(v, w)", (-0.2, -3.0), (0.7, 3.0))
    assert (three.names, three.low, three.high) == ("(vx, vy, w)", (-0.6, -0.3, -2.0), (0.5, 0.3, 2.0))
    assert three.part == pytest.approx(np.divide((0.6, 0.3, 2.0), PARTS), rel=1e-12)
    assert three.travel == pytest.approx(hypot(0.6, 0.3) * 0.1)
    assert two.travel == pytest.approx(0.07)
    assert two.allows((-0.2, 3.0))
    assert not any(map(two.allows, [(-0.21, 0.0), (0.0, 3.1), (0.0, inf), (0.0,)]))
    two.require_heading("the planner")
    with pytest.raises(ValueError, match="the planner drives only along its heading"):
        three.require_heading("the planner")


def test_the_commands_of_a_preset_begin_with_the_three_actions_of_the_lattice():
    assert COMMANDS == (
        (0.0, 3.0), (0.0, -3.0), (0.7, 0.0),
        (0.7, 0.4), (0.7, -0.4), (0.7, 1.0), (0.7, -1.0), (0.7, 2.0), (0.7, -2.0), (0.7, 3.0), (0.7, -3.0),
        (0.35, 3.0), (0.35, -3.0), (0.0, 1.0), (0.0, -1.0),
    )  # fmt: skip
