"""The compiled core in the user's cache: made once, by several processes at once too, and loaded whole."""

import hashlib
import sys
from pathlib import Path

import pytest

from tests.programs import finished
from vitruvius.logic.grammar import SHIPPED
from vitruvius.logic.placement import compiled
from vitruvius.logic.workers.messages import Prepare
from vitruvius.logic.workers.solver import Solver


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the folder of compiled files in an empty cache."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    assert compiled.compiled() is None
    return tmp_path / "cache" / "vitruvius" / "core"


def test_solver_processes_at_once_compile_the_core_and_the_next_process_loads_it(folder: Path) -> None:
    solvers = [Solver(Prepare(grammar=str(SHIPPED / "family"))) for _ in range(2)]
    for solver in solvers:
        solver.prepared()
        solver.end()
    assert {file.suffix for file in folder.iterdir()} == {".qlf"}
    code = (
        "from vitruvius.logic.placement import compiled, prolog; compiled.load_core(); "
        f"prolog.run('module_property', 'core', prolog.Term('file', {str(folder / 'core.pl')!r}), "
        "module='system')"
    )
    assert finished([sys.executable, "-P", "-c", code]).returncode == 0


def test_only_a_whole_file_in_a_folder_of_the_user_alone_is_loaded(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    content = b"a compiled core"
    file = folder / f"{compiled._key()}-{hashlib.sha256(content).hexdigest()}.qlf"
    file.write_bytes(content)
    assert compiled.compiled() == file
    folder.chmod(0o770)
    assert compiled.compiled() is None
    folder.chmod(0o700)
    file.write_bytes(content[:-1])
    assert compiled.compiled() is None
    file.write_bytes(content)
    monkeypatch.chdir(folder.parents[1])
    monkeypatch.setenv("XDG_CACHE_HOME", ".")
    assert compiled.compiled() is None
