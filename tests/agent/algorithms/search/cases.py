"""Cases of the network that searches: see ``tests.agent.algorithms.cases``."""

from vitruvius.agent.algorithms.search.config import SearchConfig

SMALL = {
    "search": SearchConfig(
        targets="secondary",
        num_envs=4,
        num_steps=16,
        steps=384,
        channels=(4, 4),
        buffer_size=16,
        batch_size=2,
        passes=2.0,
    )
}

WRONG = [("channels", (4,) * 5), ("heat", 0.0), ("guided", -0.1), ("device", "cuda")]
