"""``vitruvius demo``: its options. Cheap to import; what it does is in ``vitruvius.demo``."""

from dataclasses import dataclass
from pathlib import Path

from logic.request.request import MOST, whole


@dataclass(frozen=True)
class Demo:
    """Rules to houses to a trained agent and its report, in a few minutes."""

    out: Path = Path("runs/demo")
    """Folder for the report and all that it shows."""

    seed: int = 0
    """Seeds the houses, those to learn in and those to be measured in, and the training."""

    def run(self) -> int:
        """Do it all; 1 if the agent does not clearly beat the random walk and the paper's human's ratio."""
        from logic.house.files import require_folder
        from vitruvius.demo import demo

        whole("--seed", self.seed, 0, (MOST - 1) // 2)  # houses are made with twice the seed, and one more
        require_folder(self.out)
        return demo(self.out, self.seed)
