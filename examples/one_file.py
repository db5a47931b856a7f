"""Agent in one file that learns what to remember: recurrent PQN (Gallici et al. 2024, arXiv:2407.04811).

./run python examples/one_file.py houses.jsonl --avoid --observe rays bump last_action
"""

import torch
import tyro
from task import Task
from torch import Tensor, nn

ROLLOUT, DISCOUNT, TRACE, HIDDEN = 32, 0.99, 0.75, 128  # steps of an update, gamma, lambda, hidden units


class Network(nn.Module):
    """Network of Q-values, from an observation and a hidden state."""

    def __init__(self, numbers: int) -> None:
        super().__init__()
        self.see = nn.Sequential(nn.Linear(numbers, HIDDEN), nn.LayerNorm(HIDDEN), nn.ReLU())
        self.cell, self.value = nn.GRUCell(HIDDEN, HIDDEN), nn.Linear(2 * HIDDEN, 3)

    def forward(self, s: Tensor, h: Tensor, over: Tensor) -> tuple[Tensor, Tensor]:
        """Return Q-values (T, E, 3) of observations (T, E, n), and states (E, H), which ``over`` resets."""
        seen, hidden = self.see(s), []
        for x, end in zip(seen, over, strict=True):
            hidden.append(self.cell(x, h))
            h = hidden[-1] * (1 - end[:, None])
        return self.value(torch.cat([seen, torch.stack(hidden)], dim=2)), h

    def begin(self, environments: int) -> None:
        """Reset the hidden states: episodes begin."""
        self.h = torch.zeros(environments, HIDDEN)

    @torch.no_grad()
    def act(self, seen: Tensor, epsilon: float = 0.05) -> Tensor:
        """Return Q-values (E, 3) of observations (E, n); some rows are noise, mostly a step forward."""
        q, self.h = self(seen[None], self.h, torch.zeros(1, len(seen)))
        noise = torch.rand(len(seen), 3) + torch.tensor([0.0, 0.0, 0.5])
        return torch.where(torch.rand(len(seen), 1) < epsilon, noise, q[0])


class Example(Task):
    """Train an agent by parallel Q-learning and compare it with the oracle."""

    def run(self) -> None:
        """Train for all steps, then evaluate."""
        torch.manual_seed(self.seed)
        envs, size = self.make_envs(), (ROLLOUT, self.environments)
        observation = torch.from_numpy(envs.reset()[0])
        network = Network(self.numbers)
        optimizer = torch.optim.RAdam(network.parameters(), lr=1e-3)
        s, a = torch.empty(*size, self.numbers), torch.empty(size, dtype=torch.int64)
        r, v, returns, over = torch.empty(size), torch.empty(size), torch.empty(size), torch.empty(size)
        network.begin(self.environments)
        for update in range(updates := max(1, self.steps // a.numel())):
            first, epsilon = network.h, max(0.05, 1 - 3 * update / updates)
            for t in range(ROLLOUT):
                s[t], a[t] = observation, network.act(observation, epsilon).argmax(1)
                after, reward, terminated, truncated, info = envs.step(a[t].numpy())
                r[t], over[t] = torch.from_numpy(reward), torch.from_numpy(terminated | truncated)
                observation, ended = torch.from_numpy(after), over[t, :, None] > 0
                # The time ran out, so the episode could have gone on from its last state.
                last = torch.where(ended, torch.from_numpy(info.get("final_obs", after)), observation)
                v[t] = network(last[None], network.h, over[None, t])[0].amax(2).detach()
                network.h = network.h.masked_fill(ended, 0)
            returns[-1] = r[-1] + DISCOUNT * v[-1]
            for t in range(ROLLOUT - 2, -1, -1):
                returns[t] = r[t] + DISCOUNT * torch.lerp(v[t], returns[t + 1], TRACE * (1 - over[t]))
            for part in [part for _ in range(2) for part in torch.randperm(self.environments).chunk(4)]:
                q, _ = network(s[:, part], first[part], over[:, part])
                loss = (q.gather(2, a[:, part, None]).squeeze(2) - returns[:, part]).square().mean()
                optimizer.zero_grad()
                loss.backward()
                nn.utils.clip_grad_norm_(network.parameters(), 10.0)
                optimizer.step()
        self.score("Recurrent PQN in one file", network.act, network.begin)


if __name__ == "__main__":
    tyro.cli(Example).run()
