"""Cases of the paper's agent: see ``tests.agent.algorithms.cases``."""

from dataclasses import replace

from vitruvius.agent.algorithms.table import PRESETS

SMALL = {
    "paper": replace(
        PRESETS["paper"], targets="main", steps=400, sim=("steps=50",), batch_size=20, num_minibatches=4
    )
}

WRONG = [
    ("buffer_size", 10),
    ("num_minibatches", 2000),
    ("lr_decay", -1.0),
    ("batch_size", 0),
    ("device", "cuda"),
]

QUICK = {"buffer_size": 8000, "batch_size": 100, "num_minibatches": 5}
