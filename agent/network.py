"""The Q-network: what each action is worth, from one look at the rays."""

import torch
from torch import Tensor, nn


class QNetwork(nn.Module):
    """A convolution over neighbouring rays, then two layers of 128 under LayerNorm: 54,579 parameters.

    The same small filter serves every ray, as an edge looks the same wherever it stands. LayerNorm is what
    lets Q-learning be stable without a target network (Gallici et al. 2024, section 3).
    """

    def __init__(self, rays: int = 40, channels: int = 2, actions: int = 3, width: int = 128) -> None:
        """Draw first weights from torch's generator: fork and seed it around this call."""
        super().__init__()
        self.shape = (rays, channels)
        self.look = nn.Conv1d(channels, 16, kernel_size=5, stride=2)
        self.judge = nn.Sequential(
            nn.Linear(16 * ((rays - 5) // 2 + 1), width),
            nn.LayerNorm(width),
            nn.ReLU(),
            nn.Linear(width, width),
            nn.LayerNorm(width),
            nn.ReLU(),
            nn.Linear(width, actions),
        )

    def forward(self, observation: Tensor) -> Tensor:
        """Q-values (B, A), in discounted targets, of observations (B, R, C): distance/range, is_target."""
        seen = torch.relu(self.look(observation.transpose(1, 2)))
        return self.judge(seen.flatten(1))


def seeded_network(seed: int, rays: int = 40, channels: int = 2, actions: int = 3) -> QNetwork:
    """A new network whose weights are a function of the seed; torch's own generator is left as it was."""
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(seed)
        return QNetwork(rays, channels, actions)
