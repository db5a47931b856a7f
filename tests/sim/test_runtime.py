"""Taichi's cache of kernels, and the threads that environments are made in."""

import os
import subprocess
import sys
import time

from sim.runtime import LOCK_AGE, drop_stale_lock


def test_a_lock_that_a_killed_process_left_does_not_switch_the_kernel_cache_off(tmp_path):
    drop_stale_lock(tmp_path)  # there is none
    lock = tmp_path / "ticache.lock"
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
from sim import Config, HouseVectorEnv

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
    made = subprocess.run(
        [sys.executable, "-c", FIRST_IN_THREADS], check=False, capture_output=True, text=True, timeout=300
    )
    assert (made.stdout.strip(), made.returncode) == ("[0, 1, 2, 3] True", 0), made.stderr
