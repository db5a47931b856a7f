"""Stable-Baselines3 in Vitruvius: its DQN or PPO, with one observation or a stack of the last ones.

./run python examples/stable_baselines.py houses.jsonl --algorithm dqn --avoid --stack 4 \
    --observe rays bump last_action
"""

from dataclasses import dataclass
from typing import Literal

import torch
import tyro
from stable_baselines3 import DQN, PPO
from stable_baselines3.common.vec_env import VecEnv, VecFrameStack
from task import Frames, Task
from torch import Tensor
from torch.nn.functional import one_hot

from vitruvius.sim.adapters.stable_baselines import StableBaselinesVecEnv


@dataclass(frozen=True)
class Example(Task):
    """Train an agent of Stable-Baselines3 and compare it with the oracle."""

    algorithm: Literal["dqn", "ppo"] = "ppo"
    """Algorithm of the training."""

    stack: int = 1
    """Number of last observations that the agent sees."""

    def run(self) -> None:
        """Train for all steps, then evaluate."""
        envs: VecEnv = StableBaselinesVecEnv(self.make_envs())
        frames, seed = Frames(self.stack, self.numbers), self.seed
        if self.stack > 1:
            envs = VecFrameStack(envs, self.stack)
        if self.algorithm == "dqn":
            # One batch for every 16 steps: so each step is used 16 times on average.
            model = DQN(
                "MlpPolicy",
                envs,
                learning_rate=1e-3,
                buffer_size=200_000,
                learning_starts=min(10_000, self.steps // 10),
                batch_size=256,
                train_freq=1,
                gradient_steps=max(1, self.environments // 16),
                target_update_interval=2_000,
                exploration_fraction=0.3,
                policy_kwargs={"net_arch": [128, 128]},
                seed=seed,
                device="cpu",
            )
        else:
            model = PPO(
                "MlpPolicy",
                envs,
                n_steps=max(2, min(64, self.steps // self.environments)),
                batch_size=1024,
                n_epochs=4,
                learning_rate=1e-3,
                ent_coef=0.01,
                policy_kwargs={"net_arch": [128, 128]},
                seed=seed,
                device="cpu",
            )
        model.learn(self.steps)

        def act(observation: Tensor) -> Tensor:
            """Return sampled actions, one-hot: a robot without a memory would turn back and forth."""
            actions, _ = model.predict(frames(observation).numpy(), deterministic=False)
            return one_hot(torch.from_numpy(actions), 3).float()

        self.score(f"SB3 {self.algorithm.upper()}", act, frames.begin)


if __name__ == "__main__":
    tyro.cli(Example).run()
