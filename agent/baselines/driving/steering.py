"""Steering of bodies that drive: a rule that turns the heading error into (v, w)."""

import numpy as np

from vitruvius.sim.drive import Drive


def steered(drive: Drive, off: np.ndarray, room: np.ndarray | float = np.inf) -> np.ndarray:
    """Return (v, w) (E, 2) float32, or the numbers (E,) int64 of the nearest commands.

    ``off`` (E,): heading errors in radians. ``room`` (E,): distance after which bodies must stand, in metres.
    Bodies turn as fast as they can still stop turning, and drive faster with a smaller error.
    """
    off = np.angle(np.exp(1j * off))
    stops = np.sqrt(2 * min(drive.turn_acceleration, 1e9) * np.abs(off))
    turn = np.minimum(np.minimum(stops, np.abs(off) / drive.time_step), drive.turn_speed)
    speed = drive.speed * np.clip(2 * np.cos(off), 0, 1)
    speed = np.minimum(speed, np.sqrt(2 * min(drive.acceleration, 1e9) * room))
    wanted = np.column_stack([speed, np.sign(off) * turn])
    if not drive.commands:
        return wanted.astype(np.float32)
    scale = np.array([drive.speed, max(drive.turn_speed, 1e-9)])
    apart = (wanted[:, None] - np.array(drive.commands)) / scale
    return (apart**2).sum(axis=-1).argmin(axis=1)
