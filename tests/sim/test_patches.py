"""Patches of Taichi's internals: their switch, and the check of its version."""

import os
import sys

from tests.programs import finished
from vitruvius.sim.tracing import VARIABLE

from vitruvius.sim.compiler.patches import SWITCH, untested  # isort: skip - tracing sets up Taichi's import

TRACED = """
import warnings
warnings.simplefilter("error", RuntimeWarning)
import numpy as np
from vitruvius.sim.compiler import patches
from vitruvius.sim.runtime import Array, Floats, Launch, kernel, start, ti
from taichi.lang import kernel_impl
start()

@kernel
def double(numbers: Floats):
    for k in range(numbers.shape[0]):
        numbers[k] *= 2.0

numbers = Array.of(np.ones(3, np.float32))
Launch(double, {"numbers": numbers})()
print(numbers.numpy().tolist(), kernel_impl.textwrap.__class__.__name__)
"""


def test_the_patches_of_taichi_can_be_turned_off(tmp_path) -> None:
    program = tmp_path / "traced.py"
    program.write_text(TRACED)
    for switch, module in (("on", "SimpleNamespace"), ("off", "module")):
        done = finished([sys.executable, program], env=os.environ | {VARIABLE: "taichi", SWITCH: switch})
        assert (done.stdout, done.returncode) == (f"[2.0, 2.0, 2.0] {module}\n", 0), done.stderr


def test_a_version_of_taichi_that_was_not_tested_is_named_with_what_to_do() -> None:
    said = untested((9, 8, 7))
    assert said.startswith("Taichi is 9.8.7: Vitruvius patches its internals")
    assert "tested only with 1.7.4. If kernels fail to compile" in said
    assert f"set {SWITCH}=off" in said
