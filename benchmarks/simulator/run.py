"""``vitruvius bench simulator``: the study of the speed of a step."""

from dataclasses import dataclass
from functools import partial
from pathlib import Path

from benchmarks import SECTIONS
from benchmarks.common.measure import study
from benchmarks.simulator.page import simulator_page
from benchmarks.simulator.peers.run import Peers
from vitruvius.agent.report.folder import write_report


@dataclass(frozen=True)
class Simulator:
    """Cost of a step by environments, houses, segments, rays and processors, compared with a step in C."""

    peers: bool = False
    """Also measure other simulators, each in an environment that uv creates (3 GB to download once)."""

    out: Path = Path("runs/bench")
    """Folder for simulator.json, report.html, simulator.png and simulator.md."""

    replace: bool = False
    """Write into the folder even if it holds other files."""

    publish: bool = False
    """Copy the page, with its pictures and data, into docs."""

    def run(self) -> None:
        """Measure, draw and write the page."""
        peers = Peers(self.out / "peers.json").measured() if self.peers else None
        script = Path(__file__).with_name("test_simulator.py")
        page = partial(simulator_page, peers=peers)
        study(script, self.out, page, needs=("sim", "torch"), publish=self.publish)
        print(write_report(self.out, studies=SECTIONS))
