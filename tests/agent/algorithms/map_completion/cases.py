"""Cases of map completion: see ``tests.agent.algorithms.cases``."""

from vitruvius.agent.algorithms.map_completion.config import CompletionConfig

SMALL = {
    "map-completion": CompletionConfig(
        targets="secondary", num_envs=4, num_steps=16, steps=384, channels=(4, 4)
    )
}

WRONG = [("channels", (4,)), ("kinds", tuple(map(str, range(251)))), ("restarts", 2.0), ("device", "cuda")]
