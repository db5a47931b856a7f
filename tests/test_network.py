"""Nothing that Vitruvius runs uses a network: its processes are watched while they work."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.programs import PATIENCE

pytestmark = pytest.mark.second_part("all processes of generation, training and evaluation are watched")

WATCH = """
import json, os, sys
log = os.open(os.environ["WATCHED"], os.O_WRONLY | os.O_APPEND)
os.write(log, b'["start"]\\n')
asked = {"socket.connect", "socket.getaddrinfo", "socket.gethostbyname", "socket.sendto", "urllib.Request"}

def note(event, arguments):
    if event in asked:
        os.write(log, json.dumps([event, *map(str, arguments)]).encode() + b"\\n")

sys.addaudithook(note)
"""
"""Module that Python imports in each process of the environment; it records requests to a network."""

WORK = """
import sys
from vitruvius.agent.runs import checkpoint
from vitruvius.cli import main
from vitruvius.agent.evaluation.protocol import measure
from vitruvius.logic import load

for command in (
    "generate --rooms 1 --count 2 --out houses.jsonl",
    "draw houses.jsonl --out plans",
    "train houses.jsonl --steps 256 --num-envs 8 --num-steps 16 --sim steps=9 --out run",
):
    sys.argv = ["vitruvius", *command.split()]
    try:
        main()
    except SystemExit as end:
        assert not end.code, command
agents = {"agent": [checkpoint.load("run/agent.safetensors")]}
for _ in measure(agents, load("houses.jsonl"), ["main"], baselines=["oracle"]):
    pass
"""
"""Program that runs the commands, and plays as ``evaluate`` does with one baseline: each takes a second to
compile."""

ASKS = """
import subprocess, sys
ask = "import socket; socket.socket(socket.AF_INET, socket.SOCK_DGRAM).connect(('192.0.2.1', 9))"
subprocess.run([sys.executable, "-c", ask])
"""
"""Program whose child process asks for an address that no computer has."""


def asked_of_a_network(program: str, folder: Path) -> list[str]:
    """Return the network requests of a program and its processes, in a folder.

    The program runs without a network if that is permitted. The requests are Python's calls and, if strace
    exists, connections of any library, except those within the machine.
    """
    log, calls, site = folder / "watched.jsonl", folder / "strace.txt", folder / "site"
    site.mkdir()
    (site / "sitecustomize.py").write_text(WATCH)
    log.touch()
    calls.touch()
    command = [sys.executable, "-c", program]
    if shutil.which("strace"):
        traced = ["-e", "trace=connect,sendto,sendmsg,sendmmsg", "-o", str(calls)]
        command = ["strace", "-f", "-qq", "--seccomp-bpf", *traced, *command]
    if subprocess.run(["unshare", "-rn", "true"], check=False, capture_output=True).returncode == 0:
        command = ["unshare", "-rn", *command]
    kernels = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "taichi/ticache"
    environment = {name: value for name, value in os.environ.items() if not name.startswith("TI_")}
    environment |= {"WATCHED": str(log), "PYTHONPATH": os.pathsep.join([str(site), *filter(None, sys.path)])}
    # A new home has no record of an earlier request.
    environment |= {
        "HOME": str(folder),
        "XDG_CACHE_HOME": str(folder),
        "TI_OFFLINE_CACHE_FILE_PATH": str(kernels),
    }
    subprocess.run(command, check=True, cwd=folder, env=environment, timeout=PATIENCE)
    notes = [json.loads(line) for line in log.read_text().splitlines()]
    assert notes.count(["start"]) > 1, "processes are watched"
    outside = [line for line in calls.read_text().splitlines() if "AF_INET" in line]
    return [str(note) for note in notes if note != ["start"]] + outside


def test_houses_pictures_training_and_evaluation_ask_nothing_of_a_network(tmp_path: Path) -> None:
    assert asked_of_a_network(WORK, tmp_path) == []


def test_a_process_that_asks_of_a_network_is_seen(tmp_path: Path) -> None:
    assert "192.0.2.1" in str(asked_of_a_network(ASKS, tmp_path))
