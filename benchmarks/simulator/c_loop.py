"""The step in C (``step.c``, ``free.c``), compiled when needed and run on a world's own arrays."""

import ctypes
import shutil
import subprocess
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.backends.blocks import CELL
from vitruvius.sim.backends.body import SKIN
from vitruvius.sim.backends.continuous import Continuous
from vitruvius.sim.backends.free import FreeMotion
from vitruvius.sim.backends.free.contact import NEVER
from vitruvius.sim.backends.free.move import CORNER
from vitruvius.sim.backends.rays import MARGIN, OVERLAP

SOURCES = {Continuous: Path(__file__).with_name("step.c"), FreeMotion: Path(__file__).with_name("free.c")}
ROOT = Path(__file__).parents[2]
FLAGS = ["-O3", "-march=native", "-ffp-contract=off", "-shared", "-fPIC", "-lm"]
LENGTHS = ("body", "step", "eye", "range", "target", "cell", "skin", "overlap", "margin", "widest")


class LoopConfig(ctypes.Structure):
    """Lengths in metres, in the layout of ``step.c``, and the steps of an episode."""

    _fields_ = [*((name, ctypes.c_float) for name in LENGTHS), ("steps", ctypes.c_int)]


class LoopDrive(ctypes.Structure):
    """Limits of a body that drives, in the layout of ``free.c``: seconds, metres, radians."""

    _fields_ = [
        ("step", ctypes.c_float),
        ("changes", ctypes.c_float * 2),
        ("low", ctypes.c_float * 2),
        ("high", ctypes.c_float * 2),
        ("corner", ctypes.c_float),
        ("never", ctypes.c_float),
    ]


def compiler() -> list[str] | None:
    """Return the command of a clang: the system's, or the one from the package ``ziglang`` by uv."""
    if shutil.which("clang"):
        return ["clang"]
    uv = shutil.which("uv") or shutil.which("uv", path=ROOT / ".local/uv/bin")
    if not uv:
        return None
    return [
        uv,
        "run",
        "--quiet",
        "--no-project",
        "--with",
        "ziglang==0.17.0",
        "python",
        "-m",
        "ziglang",
        "cc",
    ]


def version(command: list[str]) -> str:
    """Return the name and version that a compiler prints."""
    done = subprocess.run([*command, "--version"], capture_output=True, text=True, check=True)
    return done.stdout.split("\n")[0]


class Loop:
    """Steps in C of a continuous or a free world of the default kind.

    They continue from the world's present state, on copies of its arrays.
    """

    def __init__(self, envs: HouseVectorEnv, folder: Path, command: list[str]) -> None:
        """Compile into ``folder`` with a compiler's ``command``."""
        config, backend = envs.config, envs.backend
        assert isinstance(backend, Continuous | FreeMotion), "there is a step in C of these backends alone"
        source, library = SOURCES[type(backend)], folder / "step.so"
        subprocess.run([*command, *FLAGS, str(source), "-o", str(library)], check=True)
        self.library, rays = ctypes.CDLL(str(library)), backend.rays
        self.config = LoopConfig(
            config.body[0], config.step, config.eye[0], config.range, config.target,
            CELL, SKIN, OVERLAP, MARGIN, rays.widest, config.steps,
        )  # fmt: skip
        self.configs: list[ctypes.Structure] = [self.config]
        if isinstance(backend, FreeMotion):
            drive = config.drive
            self.configs.append(
                LoopDrive(drive.time_step, backend.changes, drive.low, drive.high, CORNER, NEVER)
            )
        count = self.count = envs.num_envs
        tables, state = envs.tables(), envs.state
        bank = (tables[name] for name in ("numbers", "indices", "places"))
        self.arrays = [rays.table.to_numpy(), *bank, state["reals"], state["wholes"]]
        if isinstance(backend, FreeMotion):
            self.arrays.append(state["speeds"])
        self.observation = np.zeros((count, config.rays, 2), np.float32)
        self.reward, self.flags = np.zeros(count, np.float32), np.zeros((3, count), np.uint8)
        # Bound once, because ctypes takes 4 us for each array.
        self.configured = [ctypes.byref(each) for each in self.configs]
        self.bound, self.written = map(_pointers, (self.arrays, (self.observation, self.reward, self.flags)))

    def step(self, action: np.ndarray) -> None:
        """Step all environments; ``action`` is (E,) int64, or (E, 2) float32 for bodies that drive."""
        pointer = ctypes.c_void_p(action.ctypes.data)
        self.library.step(*self.configured, *self.bound, pointer, *self.written, ctypes.c_int(self.count))


def _pointers(arrays: Iterable[np.ndarray]) -> list[ctypes.c_void_p]:
    """Return pointers to arrays, which the caller must keep alive."""
    return [ctypes.c_void_p(array.ctypes.data) for array in arrays]
