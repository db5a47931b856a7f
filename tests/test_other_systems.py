"""The base where modules and names of POSIX are absent, as on Windows."""

import os
import sys
from pathlib import Path

import pytest

from tests.programs import finished

HOUSES = Path(__file__).parent / "fixtures/houses.jsonl"

NO_MODULES = """
import sys
from importlib.abc import MetaPathFinder

class Absent(MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name in {"fcntl", "grp", "pwd", "resource", "syslog", "termios"}:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Absent())
"""
NO_NAMES = """
import os, signal
for name in ("O_ACCMODE", "O_CLOEXEC", "O_NOCTTY", "O_NONBLOCK", "geteuid", "getuid", "killpg",
             "register_at_fork", "sched_getaffinity", "sched_setaffinity"):
    delattr(os, name)
for name in ("SIGALRM", "SIGHUP", "SIGXCPU", "setitimer"):
    delattr(signal, name)
"""
"""Module ``sitecustomize``, which Python imports as it starts: removes what a system without POSIX lacks."""

COMMANDS = f"""
from vitruvius.cli import main
for words in ("check {HOUSES}", "draw {HOUSES}", "info {HOUSES}", "convert {HOUSES} --to ros --out maps",
              "generate --rooms 1 --out made.jsonl"):
    try:
        main(words.split())
    except SystemExit as end:
        print(words.split()[0], end.code or 0)
"""


@pytest.mark.parametrize(("lacks", "generate"), [(NO_MODULES, 0), (NO_MODULES + NO_NAMES, 69)])
def test_the_base_runs_without_modules_of_posix_and_generation_names_wsl_without_processes(
    tmp_path: Path, lacks: str, generate: int
) -> None:
    (tmp_path / "sitecustomize.py").write_text(lacks)
    path = os.pathsep.join([str(tmp_path), *filter(None, [os.environ.get("PYTHONPATH")])])
    environment = os.environ | {"PYTHONPATH": path}
    ended = finished([sys.executable, "-c", COMMANDS], cwd=tmp_path, env=environment)
    codes = dict(line.split() for line in ended.stdout.splitlines() if len(line.split()) == 2)
    assert [codes.get(name) for name in ("check", "draw", "info", "convert")] == ["0"] * 4, ended.stderr
    assert int(codes["generate"]) == generate
    assert ("WSL 2" in ended.stderr.splitlines()[-1]) == bool(generate)
