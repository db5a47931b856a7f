"""Options of ``vitruvius demo``. Cheap to import; ``vitruvius.demo`` does the work."""

from dataclasses import dataclass
from pathlib import Path

from vitruvius.logic.request.counts import MAX_COUNT, whole


@dataclass(frozen=True)
class Demo:
    """Generate houses, train an agent on them and write its report, in a few minutes."""

    out: Path = Path("runs/demo")
    """Folder for the report and all that it shows."""

    seed: int = 0
    """Seed of the training, of the houses to train on, and of the houses to evaluate on."""

    def run(self) -> int:
        """Run the demo; return 1 unless the agent clearly beats the random walk and the human's ratio."""
        from vitruvius.demo import demo
        from vitruvius.logic.files.writing import require_folder

        whole("--seed", self.seed, 0, (MAX_COUNT - 1) // 2)  # houses use twice the seed, and one more
        require_folder(self.out)
        return demo(self.out, self.seed)
