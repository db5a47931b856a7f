"""``vitruvius bench learner``: where the time of a training step goes."""

from dataclasses import dataclass
from pathlib import Path

from benchmarks.common.measure import study


@dataclass(frozen=True)
class LearnerStudy:
    """Steps per second of each part of a training step, by number of environments."""

    out: Path = Path("runs/bench")
    """Folder for learner.json and learner.png."""

    replace: bool = False
    """Write into the folder whatever else it holds."""

    def run(self) -> None:
        """Measure and draw."""
        study(Path(__file__).with_name("test_learner.py"), self.out, needs=("sim", "torch"))
