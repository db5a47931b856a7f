"""Taichi's kernel cache, records of arrays, and the threads in which environments are created."""

# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false

import os
import sys
import time
from typing import NamedTuple

import numpy as np
import pytest

from tests.programs import finished
from vitruvius.sim.runtime import Array, Launch, kernel, start, ti
from vitruvius.sim.runtime.lock import LOCK_AGE, drop_stale_lock
from vitruvius.sim.tracing import compiler

pytestmark = pytest.mark.second_part("many processes and threads")


def test_a_lock_that_a_killed_process_left_does_not_switch_the_kernel_cache_off(tmp_path):
    drop_stale_lock(tmp_path)  # no lock exists
    lock = tmp_path / compiler.LOCK
    lock.touch()
    drop_stale_lock(tmp_path)
    assert lock.exists()  # another process may be writing now
    long_ago = time.time() - LOCK_AGE - 1
    os.utime(lock, (long_ago, long_ago))
    drop_stale_lock(tmp_path)
    assert not lock.exists()


FIRST_IN_THREADS = """
from threading import Barrier, Thread
import numpy as np
from vitruvius.sim import Config, HouseVectorEnv

def trajectory(k):
    envs = HouseVectorEnv(num_envs=3, seed=k, preset=Config(sees_kind=bool(k)))
    seen = [envs.reset()[0]]
    for actions in np.random.default_rng(k).choice(3, size=(200, 3)):
        seen.append(envs.step(actions)[0])
    return np.stack(seen)

def play(k):
    together.wait()
    found[k] = trajectory(k % 2)

together, found = Barrier(4), {}
threads = [Thread(target=play, args=[k]) for k in range(4)]
[thread.start() for thread in threads]
[thread.join() for thread in threads]
alone = trajectory(0), trajectory(1)
print(sorted(found), all(np.array_equal(found[k], alone[k % 2]) for k in found))
"""


def test_first_environments_made_and_stepped_in_four_threads_at_once_do_as_those_of_one_thread():
    made = finished([sys.executable, "-c", FIRST_IN_THREADS])
    assert (made.stdout.strip(), made.returncode) == ("[0, 1, 2, 3] True", 0), made.stderr


Numbers = ti.types.ndarray(ti.f32, 1)


class Sides(NamedTuple):
    wide: Numbers
    high: Numbers


def test_a_kernel_has_arrays_together_as_a_record_and_takes_them_by_its_fields():
    start()

    @ti.func
    def area(sides: ti.template(), k):
        return sides.wide[k] * sides.high[k]

    @kernel
    def areas(scale: Numbers, sides: Sides, found: Numbers):
        """Compute the areas of boxes, all at one scale."""
        for k in range(found.shape[0]):
            found[k] = scale[0] * area(sides, k)

    values = {
        "found": np.zeros(2),
        "high": np.array([2, 3]),
        "scale": np.array([10]),
        "wide": np.array([4, 5]),
    }
    arrays = {name: Array.of(value.astype(np.float32)) for name, value in values.items()}
    launch = Launch(areas, arrays)
    assert launch.names == ["scale", "wide", "high", "found"]
    launch()
    assert arrays["found"].numpy().tolist() == [80, 150]


MANY_TABLES = """
import numpy as np
from vitruvius.sim.runtime import constants, start
from vitruvius.sim.runtime.constants import MOST_FIELDS

start("cpu")
numbers = np.arange(4.0, dtype=np.float32)
assert constants(numbers) is constants(numbers.copy())
try:
    for k in range(MOST_FIELDS):
        table = constants(numbers + k)
    assert (table.to_numpy() == numbers + k).all()
    constants(numbers - 1)
except RuntimeError as error:
    print(k, error)
"""


def test_more_kinds_of_environments_than_taichi_has_room_for_are_an_error_and_no_crash():
    done = finished([sys.executable, "-c", MANY_TABLES])
    assert done.stdout.startswith("499 this process has created environments with so many sensors that")
