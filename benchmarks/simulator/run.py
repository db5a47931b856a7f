"""``vitruvius bench simulator``: the study of how fast a step is."""

from dataclasses import dataclass
from functools import partial
from pathlib import Path

from agent.report.folder import write_report
from benchmarks.common.measure import study
from benchmarks.sections import SECTIONS
from benchmarks.simulator.page import simulator_page
from benchmarks.simulator.peers.run import Peers


@dataclass(frozen=True)
class Simulator:
    """What a step costs: by environments, houses, segments, rays, processors, beside the same step in C."""

    peers: bool = False
    """Measure other simulators beside ours, each in an environment that uv makes (3 GB to download once)."""

    out: Path = Path("runs/bench")
    """Folder for simulator.json, report.html, simulator.png and simulator.md."""

    replace: bool = False
    """Write into the folder whatever else it holds."""

    publish: bool = False
    """Put the page and its plot into docs too."""

    def run(self) -> None:
        """Measure, draw and write the page."""
        peers = Peers(self.out / "peers.json").measured() if self.peers else None
        script = Path(__file__).with_name("test_simulator.py")
        page = partial(simulator_page, peers=peers)
        study(script, self.out, page, needs=("sim", "torch"), publish=self.publish)
        print(write_report(self.out, studies=SECTIONS))
