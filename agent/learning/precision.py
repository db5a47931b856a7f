"""Precision of matrix products, with a trial before a run depends on it."""

import subprocess
import sys
from functools import cache

import torch

from vitruvius.logic.errors import RequestError

TRIAL = """
import torch
torch.set_float32_matmul_precision("medium")
torch.rand(256, 128) @ torch.rand(128, 128)
"""
"""Program with a product like those of a network."""


def set_precision(precision: str, device: str = "cpu") -> None:
    """Let torch multiply float32 matrices in this precision from now on: highest, high or medium.

    Raises ``RequestError`` if the processor cannot multiply in less than the highest one.
    """
    if precision != "highest" and device == "cpu" and not _survives(TRIAL):
        raise RequestError(
            f"precision {precision}: this machine reports AMX instructions that it cannot run. Use "
            "precision highest, or set ONEDNN_MAX_CPU_ISA=AVX512_CORE_BF16"
        )
    torch.set_float32_matmul_precision(precision)


@cache
def _survives(program: str) -> bool:
    """Return True if a Python program ends without an error.

    The program runs in a process of its own. Some virtual machines have an instruction that the kernel grants
    but the host does not run: it ends the process, and no flag tells of it.
    """
    return subprocess.run([sys.executable, "-c", program], capture_output=True, check=False).returncode == 0
