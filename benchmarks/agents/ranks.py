"""``vitruvius bench ranks``: what training by 1, 2 and 4 ranks of ``torchrun`` costs, over gloo, here.

Each rank has as many environments as the preset, so twice as many ranks make twice as many steps. Rounds take
each number of ranks in turn. Beside the clock stands the processor time of all ranks, which says what it
costs that they are several, also where other work or too few processors take the clock's time. A round is of
rollouts and updates alone, after the first ones: no start.
"""

import json
import os
import sys
from argparse import ArgumentParser
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import median
from time import perf_counter, process_time
from typing import Any

from agent.algorithms.table import PRESETS
from benchmarks.common.pages import machine, table_rows, write
from benchmarks.common.processes import ONE_THREAD, output, say
from logic.errors import RequestError
from logic.house.files import write_whole

HEAD = """\
| ranks | steps per second | of ranks x one | processor time a step | one's, of it |
|---|---|---|---|---|"""


@dataclass(frozen=True)
class Ranks:
    """Steps per second and processor time a step of training by several ranks, beside one."""

    preset: str = "pqn"
    """What is trained, in the houses that come with Vitruvius."""

    ranks: tuple[int, ...] = (1, 2, 4)
    """Numbers of processes, 1 among them."""

    rounds: int = 5
    """How often each is measured."""

    iterations: int = 30
    """Rollouts, each with its updates, of a round."""

    out: Path = Path("runs/ranks")
    """Folder for ranks.json and ranks.md."""

    replace: bool = False
    """Write into the folder whatever else it holds."""

    def run(self) -> None:
        """Measure, and print the table."""
        if self.preset not in PRESETS or not PRESETS[self.preset].parallel:
            known = ", ".join(name for name, config in PRESETS.items() if config.parallel)
            raise RequestError(f"--preset {self.preset}: none that several can train: {known}")
        if 1 not in self.ranks or min(self.ranks) < 1 or self.rounds < 1 or self.iterations < 1:
            raise RequestError("--ranks must have a 1, --rounds and --iterations must be 1 or more")
        rounds = list[dict[int, dict[str, Any]]]()
        for number in range(self.rounds):
            order = self.ranks[:: -1 if number % 2 else 1]
            rounds.append({ranks: self._round(ranks) for ranks in order})
            say(f"round {number + 1}: {json.dumps(rounds[-1])}")
        loads = [each["load"] for found in rounds for each in found.values()]
        head = (
            f"`{self.preset}`, {PRESETS[self.preset].num_envs} environments a rank, {self.rounds} rounds of "
            f"{self.iterations} rollouts; medians, the least and the most. {machine()}, of whose cores "
            f"{len(os.sched_getaffinity(0))} are ours; load average {min(loads):.1f} to {max(loads):.1f}."
        )
        page = f"{head}\n\n{HEAD}\n{table_rows(row(ranks, rounds) for ranks in self.ranks)}\n"
        write_whole(self.out / "ranks.json", json.dumps(rounds, indent=1).encode())
        write({"ranks.md": page.encode()}, self.out)
        print(page)

    def _round(self, ranks: int) -> dict[str, Any]:
        """What so many ranks did, and the load average as they began."""
        load = os.getloadavg()[0]
        command = [sys.executable, "-m", "torch.distributed.run", "--standalone", "--nproc-per-node"]
        command += [str(ranks), "-m", "benchmarks.agents.ranks", self.preset, str(self.iterations)]
        return json.loads(output(command, **ONE_THREAD).splitlines()[-1]) | {"load": load}


def row(ranks: int, rounds: list[dict[int, dict[str, Any]]]) -> list[str]:
    """A row of the table; what is compared with one rank is so within each round."""
    rates = [_rate(each[ranks]) for each in rounds]
    costs = [_cost(each[ranks]) for each in rounds]
    of_one = [_rate(each[ranks]) / (ranks * _rate(each[1])) for each in rounds]
    efficiency = [_cost(each[1]) / _cost(each[ranks]) for each in rounds]
    times = f"{_spread([1e6 * cost for cost in costs], '.1f')} µs"
    return [str(ranks), _spread(rates, ",.0f"), _spread(of_one, ".2f"), times, _spread(efficiency, ".2f")]


def _rate(found: dict[str, Any]) -> float:
    return found["steps"] / found["seconds"]


def _cost(found: dict[str, Any]) -> float:
    return found["processor_seconds"] / found["steps"]


def _spread(values: list[float], form: str) -> str:
    return f"{median(values):{form}} ({min(values):{form}} to {max(values):{form}})"


def learn(preset: str, iterations: int) -> None:
    """What each rank does; the first one prints steps, seconds and processor seconds of all."""
    import torch

    from agent.algorithms.build import learner_of
    from agent.learning import ranks
    from agent.learning.environments import make_envs
    from agent.learning.simulator import simulator
    from sim.environment.arguments import BANK, house_list

    torch.set_num_threads(1)
    with ranks.joined():
        own = PRESETS[preset]
        config = replace(own, num_envs=ranks.size() * own.num_envs, steps=10**9)
        envs = make_envs(house_list(BANK), own.num_envs, config.targets, preset=simulator(config))
        learner = learner_of(config, envs)
        before = [learner.iterate() for _ in range(2)][-1].steps
        ranks.total([0])  # all begin together
        began, processor = perf_counter(), process_time()
        steps = [learner.iterate() for _ in range(iterations)][-1].steps - before
        ranks.total([0])
        seconds = perf_counter() - began
        [spent] = ranks.total([process_time() - processor])
        if not ranks.rank():
            print(json.dumps({"steps": steps, "seconds": seconds, "processor_seconds": spent}), flush=True)


if __name__ == "__main__":
    parser = ArgumentParser(description="One rank, as torchrun starts it.")
    parser.add_argument("preset", choices=PRESETS)
    parser.add_argument("iterations", type=int)
    asked = parser.parse_args()
    learn(asked.preset, asked.iterations)
