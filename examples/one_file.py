"""An agent in one file, in the manner of CleanRL: PQN (Gallici et al. 2024, arXiv:2407.04811) in plain torch.

./run python examples/one_file.py houses.jsonl --avoid
"""

from dataclasses import dataclass

import torch
import tyro
from task import Task
from torch import Tensor, nn


@dataclass(frozen=True)
class Example(Task):
    """Train an agent by parallel Q-learning and measure it beside the oracle."""

    rollout: int = 32
    """Steps of every environment between two updates."""

    discount: float = 0.99
    """Worth of a reward one step later (gamma)."""

    trace: float = 0.75
    """How far returns run along the path taken before they trust the network (lambda)."""

    def run(self) -> None:
        """Learn from all the steps, then play."""
        torch.manual_seed(self.seed)
        envs, size = self.make_envs(), (self.rollout, self.environments)
        network = nn.Sequential(
            *(nn.Flatten(), nn.Linear(80, 128), nn.LayerNorm(128), nn.ReLU()),
            *(nn.Linear(128, 128), nn.LayerNorm(128), nn.ReLU(), nn.Linear(128, 3)),
        )
        optimizer = torch.optim.RAdam(network.parameters(), lr=1e-3)
        s, a = torch.empty(*size, 40, 2), torch.empty(size, dtype=torch.int64)
        r, v, returns, over = torch.empty(size), torch.empty(size), torch.empty(size), torch.empty(size)

        def act(observation: Tensor, epsilon: float = 0.05) -> Tensor:
            """Q-values, and in a share of the rows noise in their place; mostly a step forward."""
            chosen = torch.rand(len(observation), 1) < epsilon
            noise = torch.rand(len(observation), 3) + torch.tensor([0.0, 0.0, 0.5])
            return torch.where(chosen, noise, network(observation))

        observation = torch.from_numpy(envs.reset()[0])
        updates = max(1, self.steps // (self.rollout * self.environments))
        for update in range(updates):
            epsilon = max(0.05, 1 - 3 * update / updates)
            for t in range(self.rollout):
                with torch.no_grad():
                    s[t], a[t] = observation, act(observation, epsilon).argmax(1)
                    after, reward, terminated, truncated, info = envs.step(a[t].numpy())
                    ended = torch.from_numpy(terminated | truncated)
                    observation = torch.from_numpy(after)
                    # Time ran out, so the episode would have gone on from where it was.
                    last = torch.from_numpy(info["final_obs"]) if ended.any() else observation
                    v[t] = network(torch.where(ended[:, None, None], last, observation)).amax(1)
                    r[t], over[t] = torch.from_numpy(reward), ended

            returns[-1] = r[-1] + self.discount * v[-1]
            for t in range(self.rollout - 2, -1, -1):
                beyond = torch.lerp(v[t], returns[t + 1], self.trace * (1 - over[t]))
                returns[t] = r[t] + self.discount * beyond

            for _ in range(2):
                for part in torch.randperm(a.numel()).chunk(4):
                    q = network(s.flatten(0, 1)[part]).gather(1, a.flatten()[part, None])
                    loss = (q.squeeze(1) - returns.flatten()[part]).square().mean()
                    optimizer.zero_grad()
                    loss.backward()
                    nn.utils.clip_grad_norm_(network.parameters(), 10.0)
                    optimizer.step()

        self.score("PQN in one file", act)


if __name__ == "__main__":
    tyro.cli(Example).run()
