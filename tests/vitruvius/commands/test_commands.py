"""Commands about houses import only what generation needs."""

import os
import sys
from pathlib import Path

from tests.programs import finished

GENERATE = """
import sys
from importlib.metadata import entry_points
(vitruvius,) = entry_points(group="console_scripts", name="vitruvius")
sys.argv = ["vitruvius", "generate", "--rooms", "1"]
vitruvius.load()()
"""


def test_making_a_house_imports_nothing_of_the_simulator_or_the_agent(tmp_path: Path) -> None:
    """Modules of these names, which the command and its solver process find first, end them."""
    for library in ("torch", "taichi", "gymnasium", "matplotlib"):
        (tmp_path / f"{library}.py").write_text(f"raise SystemExit('{library} is imported')")
    path = os.pathsep.join([str(tmp_path), *filter(None, sys.path)])
    command = [sys.executable, "-c", GENERATE]
    made = finished(command, env=os.environ | {"PYTHONPATH": path})
    assert made.returncode == 0, made.stderr
    assert made.stdout.startswith('{"format"')
