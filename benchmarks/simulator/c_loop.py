"""The step in C (``step.c``), compiled on the spot and run on a world's own arrays."""

import ctypes
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np

from sim import HouseVectorEnv
from sim.body import SKIN
from sim.continuous.pack import CELL
from sim.rays import MARGIN, SEAM

SOURCE = Path(__file__).with_name("step.c")
FLAGS = ["-O3", "-march=native", "-ffp-contract=off", "-shared", "-fPIC", "-lm"]


class Config(ctypes.Structure):
    _fields_ = [
        *((name, ctypes.c_float) for name in "body step eye range target cell skin seam margin widest".split()),
        ("steps", ctypes.c_int),
    ]


def compiler() -> list[str]:
    """A clang: the system's, or the one in the ``ziglang`` package."""
    if shutil.which("clang"):
        return ["clang"]
    return [sys.executable, "-m", "ziglang", "cc"]


def version(command: list[str]) -> str:
    return subprocess.run([*command, "--version"], capture_output=True, text=True, check=True).stdout.split("\n")[0]


class Loop:
    """Steps a continuous world of the default kind in C, from its present state on copies of its arrays."""

    def __init__(self, envs: HouseVectorEnv, folder: Path, command: list[str] | None = None) -> None:
        library = folder / "step.so"
        subprocess.run([*(command or compiler()), *FLAGS, str(SOURCE), "-o", str(library)], check=True)
        self.library, world, config = ctypes.CDLL(str(library)), envs.world, envs.config
        rays = world.backend.rays
        self.config = Config(
            config.body[0], config.step, config.eye[0], config.range, config.target,
            CELL, SKIN, SEAM, MARGIN, rays.widest, config.steps,
        )  # fmt: skip
        count = self.count = envs.num_envs
        names = ("numbers", "indices", "places", "reals", "wholes")
        self.arrays = [rays.table.to_numpy(), *(world.arrays[name].numpy() for name in names)]
        self.observation = np.zeros((count, config.rays, 2), np.float32)
        self.reward, self.flags = np.zeros(count, np.float32), np.zeros((3, count), np.uint8)

    def step(self, action: np.ndarray) -> None:
        """One step of all environments; ``action`` (E,) int64."""
        arrays = [*self.arrays, action, self.observation, self.reward, self.flags]
        pointers = [array.ctypes.data_as(ctypes.c_void_p) for array in arrays]
        self.library.step(ctypes.byref(self.config), *pointers, ctypes.c_int(self.count))
