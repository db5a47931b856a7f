"""The Q-network: what each action is worth, from one look at the rays and the last few actions."""

import torch
from torch import Tensor, nn

from agent.pqn import ACTIONS, NONE


class QNetwork(nn.Module):
    """A convolution over neighbouring rays, then two layers of 128 under LayerNorm: about 58,000 parameters.

    The same small filter serves every ray, as an edge looks the same wherever it stands. LayerNorm is what
    lets Q-learning be stable without a target network (Gallici et al. 2024, section 3). The last actions are
    the least memory that helps: without any, a body that sees no target turns to and fro for ever, as left
    and right are worth the same; with it, it goes on as it began and knows when it has looked all round.
    """

    def __init__(self, rays: int = 40, channels: int = 2, recall: int = 8, width: int = 128) -> None:
        """Draw first weights from torch's generator: fork and seed it around this call."""
        super().__init__()
        self.shape = (rays, channels, recall)
        self.look = nn.Conv1d(channels, 16, kernel_size=5, stride=2)
        self.see = nn.Linear(16 * ((rays - 5) // 2 + 1), width)
        self.recall = nn.Linear(recall * (NONE + 1), width, bias=False)
        self.judge = nn.Sequential(
            nn.LayerNorm(width),
            nn.ReLU(),
            nn.Linear(width, width),
            nn.LayerNorm(width),
            nn.ReLU(),
            nn.Linear(width, ACTIONS),
        )

    def forward(self, observation: Tensor, past: Tensor) -> Tensor:
        """Q-values (B, A), in discounted targets.

        Reads observations (B, R, C), distance/range and is_target, and the last actions (B, K) int64, the
        latest first, NONE before the episode began.
        """
        seen = torch.relu(self.look(observation.transpose(1, 2))).flatten(1)
        done = nn.functional.one_hot(past, NONE + 1).flatten(1).to(seen.dtype)
        return self.judge(self.see(seen) + self.recall(done))


def seeded_network(seed: int, rays: int = 40, channels: int = 2, recall: int = 8) -> QNetwork:
    """A new network whose weights are a function of the seed; torch's own generator is left as it was."""
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(seed)
        return QNetwork(rays, channels, recall)
