"""``vitruvius bench gpu``: what a GPU changes: steps per second, outcomes, and how fast an agent learns."""

import json
import sys
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import starmap
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.common.pages import machine, table_rows, versions, write
from benchmarks.common.processes import CLI, output, say
from benchmarks.simulator.on_device import ROUNDS, STEPS, TRAIL, TRAILED
from logic.errors import RequestError

BANK = Path(__file__).parents[1] / "houses" / "test-v1.jsonl.gz"
TRAININGS = (
    ("pqn", "cpu", 512),
    ("pqn", "cuda", 512),
    ("pqn", "cuda", 4096),
    ("pqn", "cuda", 16384),
    ("pqn-recurrent", "cpu", 512),
    ("pqn-recurrent", "cuda", 512),
    ("pqn-recurrent", "cuda", 4096),
    ("pqn-free", "cpu", 512),
    ("pqn-free", "cuda", 512),
    ("pqn-free", "cuda", 4096),
)
"""Preset, device and environments of each training."""
SCORED = ("pqn-cpu-512", "pqn-cuda-512", "pqn-cuda-4096")
"""Those whose agents are measured."""

PAGE = Path(__file__).with_name("gpu.md")


@dataclass(frozen=True)
class GPU:
    """Simulator and learner on the CPU and on an NVIDIA GPU of this machine, into gpu.md and gpu.json."""

    steps: int = 1_000_000
    """Of each training."""

    out: Path = Path("runs/gpu")
    """Folder for the trained agents, gpu.json and gpu.md."""

    replace: bool = False
    """Write into the folder whatever else it holds."""

    publish: bool = False
    """Put the page into docs too."""

    def run(self) -> None:
        """Measure both devices in turn and write the page."""
        import torch

        if not torch.cuda.is_available():
            raise RequestError("bench gpu compares the CPU with an NVIDIA GPU: none was found here")
        self.out.mkdir(parents=True, exist_ok=True)
        record: dict[str, Any] = {device: self.device(device) for device in ("cpu", "cuda")}
        record["gpu"] = torch.cuda.get_device_name()
        trails = [np.load(self.out / f"{name}.npz") for name in ("cpu", "cuda")]
        record["outcomes"], record["advice"] = compared(*trails), parted(*trails)
        record["trainings"] = [self.training(*each) for each in TRAININGS]
        record["scores"] = self.scores()
        page = self.page(record)
        write({"gpu.json": json.dumps(record, indent=1).encode()}, self.out)
        write({"gpu.md": page.encode()}, self.out, self.publish)
        print(page)

    def device(self, device: str) -> dict[str, list[dict[str, Any]]]:
        """A device's rates, of each backend and of planners."""
        say(f"steps on {device}")
        command = [sys.executable, "-m", "benchmarks.simulator.on_device", device]
        return json.loads(output([*command, str(self.out / f"{device}.npz")]))

    def training(self, preset: str, device: str, environments: int) -> dict[str, Any]:
        """A training's last report."""
        name = named(preset, device, environments)
        say(f"training {name}")
        command = [*CLI, "train", "--preset", preset, "--device", device, "--num-envs", str(environments)]
        command += [
            "--steps",
            str(self.steps),
            "--name",
            name,
            "--out",
            str(self.out / name),
            "--json",
            "--resume",
        ]
        last = json.loads(output(command))["answer"]
        return last | {"name": name, "preset": preset, "device": device, "environments": environments}

    def scores(self) -> dict[str, str]:
        """The figures of the agents in the benchmark bank."""
        from agent.evaluation.protocol import measure
        from agent.runs.checkpoint import load as load_agent
        from logic import load

        say("measuring agents")
        agents = {name: [load_agent(self.out / name / "agent.safetensors")] for name in SCORED}
        (result,) = measure(agents, load(BANK), ["main"], baselines=["oracle"])
        return {name: result.figures(name)["ratio"].text() for name in SCORED}

    def page(self, record: dict[str, Any]) -> str:
        """The page of what was measured."""
        return PAGE.read_text().format(
            date=f"{datetime.now(UTC):%Y-%m-%d}",
            machine=machine(),
            gpu=record["gpu"],
            versions=versions("taichi", "torch", "numpy", "gymnasium"),
            rounds=ROUNDS,
            steps=STEPS,
            continuous=self.rates(record, "continuous"),
            free=self.rates(record, "free"),
            planner=self.rates(record, "planner"),
            same=TRAILED - record["advice"],
            trailed=TRAILED,
            trail=TRAIL,
            outcomes=table_rows(starmap(outcome_row, record["outcomes"].items())),
            trained=self.steps,
            trainings=table_rows(training_row(each, record["scores"]) for each in record["trainings"]),
        )

    def rates(self, record: dict[str, Any], part: str) -> str:
        """The rows of both devices' rates of a part."""
        return table_rows(map(rate_row, record["cpu"][part], record["cuda"][part]))


def rate_row(cpu: dict[str, Any], gpu: dict[str, Any]) -> list[str]:
    """Both devices' rates of a number of environments."""
    row = [f"{cpu['environments']:,}"]
    for what in ("kernel", "step_torch", "planner"):
        if what in cpu:
            row += [rate(*cpu[what]), rate(*gpu[what]), f"{gpu[what][1] / cpu[what][1]:.2g}"]
    return row


def rate(low: float, median: float, high: float) -> str:
    """Millions of steps per second, or steps where they are few, with quartiles."""
    if median < 1e6:
        return f"{median:,.0f} [{low:,.0f}, {high:,.0f}]"
    return f"{median / 1e6:.3g} M [{low / 1e6:.3g}, {high / 1e6:.3g}]"


def outcome_row(preset: str, apart: dict[str, float]) -> list[str]:
    """How outcomes differ."""
    events = "all equal" if not apart["events"] else f"{apart['events']:.2g} differ"
    lengths = (f"{apart[name]:.1g}" for name in ("places", "distances"))
    return [preset, events, *lengths, f"{apart['elsewhere']:.1g}"]


def training_row(each: dict[str, Any], scores: dict[str, str]) -> list[str]:
    """A training's speed, and its agent's score."""
    whole = each["steps"] / each["seconds"]
    rates = (f"{rate:,.0f}" for rate in (whole, each["simulator"], each["learner"]))
    return [each["preset"], each["device"], f"{each['environments']:,}", *rates, scores.get(each["name"], "")]


def named(preset: str, device: str, environments: int) -> str:
    """A training's name."""
    return f"{preset}-{device}-{environments}"


def compared(one: Any, other: Any) -> dict[str, dict[str, float]]:
    """How the outcomes on two devices differ, by preset."""
    presets = dict.fromkeys(name.partition("/")[0] for name in one if "/" in name)
    differences = {}
    for preset in presets:
        names = (f"{preset}/{part}" for part in ("events", "places", "seen"))
        (events, theirs), places, seen = ((one[name], other[name]) for name in names)
        apart = np.abs(seen[0] - seen[1])
        elsewhere = apart.max(axis=-1) > 1e-4
        differences[preset] = {
            "events": float((events != theirs).mean()),
            "places": float(np.abs(places[0] - places[1]).max()),
            "distances": float(apart[~elsewhere].max()),
            "elsewhere": float(elsewhere.mean()),
        }
    return differences


def parted(one: Any, other: Any) -> int:
    """In how many environments planners advised differently at any time, on two devices."""
    return int((one["advice"] != other["advice"]).any(axis=0).sum())
