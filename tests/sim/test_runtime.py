"""Taichi's cache of kernels."""

import os
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
