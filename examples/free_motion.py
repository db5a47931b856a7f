"""Continuous control: SAC or PPO of Stable-Baselines3 drives a body by its speeds, in the backend free.

./run python examples/free_motion.py houses.jsonl --algorithm ppo --steps 3000000

What is measured are targets an episode in held-out houses, the same starts and targets for all, beside a
body that is told speeds at random and one that pursues what its rays show, by rules.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal

import gymnasium
import numpy as np
import tyro
from gymnasium.wrappers.vector import RescaleAction
from stable_baselines3 import PPO, SAC

from agent import banks
from logic import load
from sim import DEFAULT
from sim.adapters.stable_baselines import StableBaselinesVecEnv

CONFIG = replace(DEFAULT, observe=("rays", "speed"), flat=True)
"""It sees 40 rays and knows how fast it is."""

Act = Callable[[np.ndarray], np.ndarray]
"""From observations (E, 82) to actions (E, 2) in [-1, 1]."""


@dataclass(frozen=True)
class Example:
    """Train an agent and measure it beside two baselines."""

    houses: Annotated[Path, tyro.conf.Positional]
    """House file to learn in: vitruvius generate makes one."""

    held_out: Path = Path(banks.NAME)
    """House file to be measured in, or a frozen bank: test-v1, home-test-v1."""

    algorithm: Literal["ppo", "sac"] = "ppo"
    """How it learns."""

    targets: str = "main"
    """Where targets lie."""

    steps: int = 3_000_000
    """Environment steps to learn from."""

    environments: int = 256
    """Environments stepped at once."""

    seed: int = 0
    """Of the training. Starts and targets that are measured with do not depend on it."""

    def run(self) -> dict[str, float]:
        """Learn from all the steps, then play; targets an episode of each."""
        banks.require_training(load(self.houses), self.houses)
        envs = StableBaselinesVecEnv(self.make_envs(str(self.houses), self.environments))
        policy = {"net_arch": [128, 128]}
        if self.algorithm == "sac":
            model: Any = SAC(
                "MlpPolicy", envs, learning_rate=1e-3, buffer_size=300_000, batch_size=512,
                learning_starts=min(20_000, self.steps // 10), gradient_steps=max(1, self.environments // 64),
                gamma=0.98, policy_kwargs=policy, seed=self.seed, device="cpu",
            )  # fmt: skip
        else:
            model = PPO(
                "MlpPolicy", envs, n_steps=max(2, min(64, self.steps // self.environments)), batch_size=2048,
                n_epochs=4, learning_rate=1e-3, gamma=0.98, ent_coef=0.003, policy_kwargs=policy,
                seed=self.seed, device="cpu",
            )  # fmt: skip
        model.learn(self.steps)
        rng = np.random.default_rng(0)
        agents: dict[str, Act] = {
            f"SB3 {self.algorithm.upper()}": lambda seen: model.predict(seen, deterministic=False)[0],
            "pursuit": pursue,
            "random": lambda seen: rng.uniform(-1, 1, (len(seen), 2)).astype(np.float32),
        }
        found = {name: self.play(act) for name, act in agents.items()}
        for name, targets in found.items():
            error = 1.96 * targets.std() / len(targets) ** 0.5
            print(
                f"{name}: {targets.mean():.2f} ± {error:.2f} targets, {self.targets}, {len(targets)} houses"
            )
        return {name: float(targets.mean()) for name, targets in found.items()}

    def make_envs(self, houses: Any, number: int) -> gymnasium.vector.VectorEnv:
        """Environments whose actions are from -1 to 1."""
        envs = gymnasium.make_vec(
            "sim:Vitruvius/House-v0", num_envs=number, houses=houses, targets=self.targets, backend="free",
            preset=CONFIG, seed=self.seed, autoreset_mode="SameStep",
        )  # fmt: skip
        return RescaleAction(envs, np.full(2, -1, np.float32), np.full(2, 1, np.float32))

    def play(self, act: Act) -> np.ndarray:
        """Targets (H,) that are picked up in an episode of each held-out house."""
        houses = banks.named(self.held_out)
        envs = self.make_envs(houses, len(houses))
        seen, _ = envs.reset(seed=0, options={"house": np.arange(len(houses))})
        found = np.zeros(len(houses))
        for _ in range(CONFIG.steps):
            seen, reward, *_ = envs.step(np.clip(act(seen), -1, 1))
            found += reward
        return found


def pursue(seen: np.ndarray) -> np.ndarray:
    """Towards the target, where a ray ends on it; else where rays go furthest, and around before walls."""
    rays = seen[:, :80].reshape(-1, 40, 2)
    shown = rays[..., 1] > 0
    sees, open_ = shown.any(axis=1), rays[:, 10:30, 0].min(axis=1) * CONFIG.range > 0.4
    middle = (shown * CONFIG.ray_angles).sum(axis=1) / np.maximum(1, shown.sum(axis=1))
    furthest = CONFIG.ray_angles[rays[..., 0].argmax(axis=1)]
    turn = np.where(sees, 4 * middle, np.where(open_, furthest, CONFIG.drive.turn_speed))
    fast = np.where(sees, np.abs(middle) < 0.5, open_)
    turn = np.clip(turn / CONFIG.drive.turn_speed, -1, 1)
    return np.column_stack([np.where(fast, 1.0, -1.0), turn]).astype(np.float32)


if __name__ == "__main__":
    tyro.cli(Example).run()
