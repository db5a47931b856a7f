"""The one place that imports Taichi and starts it, so that a maintained fork can take its place here.

Taichi greets on standard output, which belongs to the program that imports us: both greetings are dropped.
"""

import contextlib
import io
import os

os.environ.setdefault("ENABLE_TAICHI_HEADER_PRINT", "0")
# Else Taichi takes the redirection for a notebook's, says so, and wraps each launch to print through it.
os.environ.setdefault("TI_ENABLE_PYBUF", "0")
with contextlib.redirect_stdout(io.StringIO()):
    import taichi as ti
    from taichi.lang import impl

__all__ = ["start", "ti"]


def start(threads: int | None = None) -> None:
    """Start Taichi on the CPU, once: a Taichi that runs already, ours or the caller's, is left as it is.

    ``threads`` bounds its workers (all cores by default). Call it in the main thread: kernels compile there.
    """
    if impl.get_runtime().prog is not None:
        return
    # Without fast_math a hit is decided alike on every machine. Taichi's own control-flow passes do nothing
    # for kernels that LLVM optimises again, and take half of the time to compile.
    options = {"arch": ti.cpu, "fast_math": False, "cfg_optimization": False, "log_level": ti.ERROR}
    if threads is not None:
        options["cpu_max_num_threads"] = threads
    with contextlib.redirect_stdout(io.StringIO()):
        ti.init(**options)
