"""Commands of docs/scale.md for many machines, run with stubs that record them."""

import os
import re
import shlex
from pathlib import Path

import pytest
import yaml

from tests.docs.reader import ROOT
from tests.programs import finished
from vitruvius.cli import parse

pytestmark = pytest.mark.second_part("all commands of pages are run, and the site is opened in a browser")

TEXT = (ROOT / "docs" / "scale.md").read_text()
BLOCKS = re.findall(r"^```\n(.*?)^```", TEXT, re.MULTILINE | re.DOTALL)

NOTE = """#!/bin/bash
printf '%s\\t%s\\n' "${ON:-one}" "$(basename "$0") $*" >> "$NOTES"
"""
"""Script that records the machine and the command."""

STUBS = {
    "vitruvius": NOTE,
    "ray": NOTE
    + """
if [ "$1" = symmetric-run ] && [ "$ON" = m1 ]; then
    while [ "$1" != -- ]; do shift; done
    "${@:2}"
fi
""",
    "ssh": """#!/bin/bash
ON=$1 exec "${@:2}"
""",
    "scontrol": """#!/bin/bash
[ "$*" = "show hostnames m[1-4]" ] && printf 'm%s\\n' 1 2 3 4
""",
    "srun": """#!/bin/bash
[[ $1 = --* ]] && shift
for each in m1 m2 m3 m4; do ON=$each "$@"; done
""",
    "sbatch": """#!/bin/bash
[ "$1 $2" = "--array=0-399 --wrap" ] || exit
for number in 0 7 399; do SLURM_ARRAY_TASK_ID=$number bash -c "$3"; done
""",
    "parallel": """#!/bin/bash
shift 2
while read -r number; do "${@//\\{\\}/$number}"; done
""",
}
"""Stubs of the programs; those for several machines run the command here and record its machine."""


def typed(script: str, folder: Path) -> list[tuple[str, str]]:
    """Return the commands that a script runs, each with its machine."""
    for name, content in STUBS.items():
        (folder / name).write_text(content)
        (folder / name).chmod(0o755)
    (folder / "machines").write_text("two\nthree\n")
    slurm = {"SLURM_JOB_NODELIST": "m[1-4]", "SLURM_JOB_NUM_NODES": "4", "SCRATCH": "/scratch"}
    where = {"PATH": f"{folder}:{os.environ['PATH']}", "NOTES": str(folder / "notes")}
    ended = finished(["bash", "-euc", script], cwd=folder, env=os.environ | slurm | where)
    assert (ended.returncode, ended.stderr) == (0, "")
    lines = (folder / "notes").read_text().splitlines()
    return [(line.partition("\t")[0], line.partition("\t")[2]) for line in lines]


def block(word: str) -> str:
    [found] = [each for each in BLOCKS if word in each]
    return found


def make_sense(*commands: str) -> None:
    """Parse commands as vitruvius and Ray do. Ray is not run: ``ray stop`` ends all of Ray here."""
    for each in commands:
        program, *words = shlex.split(each)
        if program == "vitruvius":
            parse(words)
            continue
        cli = pytest.importorskip("ray.scripts.scripts").cli
        cli.commands[words[0]].make_context(words[0], words[1:])


def test_a_cluster_over_ssh_is_started_used_and_ended(tmp_path: Path) -> None:
    head, *others, made, stop, stop_two, stop_three = typed(block("ray start --head"), tmp_path)
    assert head[0] == "one"
    assert "--head --port 6379 " in head[1]
    joined = "ray start --address one:6379 --object-store-memory 80000000"
    assert others == [("two", joined), ("three", joined)]
    assert made[0] == "one"
    assert made[1].endswith("--out /shared/homes --engine ray --address auto")
    assert [stop, stop_two, stop_three] == [(each, "ray stop") for each in ("one", "two", "three")]
    make_sense(head[1], joined, made[1], stop[1])


def test_a_job_of_slurm_starts_ray_on_each_machine_and_the_command_on_the_first(tmp_path: Path) -> None:
    first, made, *others = typed(block("#SBATCH"), tmp_path)
    assert [machine for machine, _ in (first, *others)] == ["m1", "m2", "m3", "m4"]
    assert {said for _, said in others} == {first[1]}
    start, _, command = first[1].partition(" -- ")
    assert start == "ray symmetric-run --address m1:6379 --min-nodes 4"
    assert made == ("m1", command)
    assert "--out /scratch/homes --engine ray --address auto" in command
    make_sense(first[1], command)


def test_a_job_array_and_parallel_make_each_shard_once(tmp_path: Path) -> None:
    by_parallel, array = block("sbatch --array").splitlines()
    made = [said for _, said in typed(f"{by_parallel}\n{array}", tmp_path)]
    numbers = [re.findall(r" --shard (\d+)/400 ", each) for each in made]
    assert numbers == [[str(number)] for number in (*range(400), 0, 7, 399)]
    make_sense(made[0], made[-1])


def test_a_job_of_kubernetes_has_one_template_for_all_pods_and_the_command() -> None:
    job = yaml.safe_load(block("kind: RayJob"))
    head, [workers] = (job["spec"]["rayClusterSpec"][each] for each in ("headGroupSpec", "workerGroupSpecs"))
    assert head["template"] == workers["template"]
    [container], [volume] = (head["template"]["spec"][each] for each in ("containers", "volumes"))
    [mounted] = container["volumeMounts"]
    assert mounted["name"] == volume["name"]
    assert f"--out {mounted['mountPath']}/" in job["spec"]["entrypoint"]
    make_sense(job["spec"]["entrypoint"])
