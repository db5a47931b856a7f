"""The network that weighs the viewpoints which a planner offers, and the chooser that acts by it.

Axes: B choices, K offers, F features. A choice is an option: it lasts until the next one.
"""

from typing import NamedTuple

import torch
from torch import Tensor, nn

from agent.planner import Planner
from agent.planner.offers import OF

CELLS = 50.0
"""Cells by which places and distances are divided."""

MOST_OFFERS = 12
"""Offers that a choice has at most."""

OWN, ALL = 14, 6
"""Features of an offer, and of a choice."""


class Situation(NamedTuple):
    """What choices are made among."""

    offers: Tensor
    """(B, K, ``OFFER``) float32, as ``agent.planner.offers`` lists them."""

    choice: Tensor
    """(B, ``CHOICE``) float32."""

    whole: Tensor
    """(B, 4) float32: steps so far, and since the last pick-up; targets picked up, and those in the start
    room."""

    def of(self, rows: Tensor) -> "Situation":
        """Those of some rows."""
        return Situation(*(each[rows] for each in self))


def situation(planner: Planner) -> tuple[Tensor, Situation]:
    """The environments (B,) that chose in a planner's last step, and their situations: copies."""
    envs = torch.nonzero(planner.offered[:, 0] > 1).squeeze(1)
    time, since, found, here = (planner.read(name)[envs] for name in ("time", "since", "found", "found_here"))
    whole = torch.stack([time, time - since, found, here], dim=1).float()
    return envs, Situation(planner.offers[envs], planner.offered[envs], whole)


def features(now: Situation, steps: int) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """Of each offer (B, K, OWN), of each choice (B, ALL), which offers are there (B, K) bool, and by how much
    the logarithm of their gain for their cost falls short of the first one's (B, K). Episodes have ``steps``.
    """
    of = {name: now.offers[..., k] for name, k in OF.items()}
    number, total = now.choice[:, 0], now.choice[:, 2]
    there = torch.arange(now.offers.shape[1]) < number[:, None]
    gain = of["gain"].clamp(min=1.0)
    worth = gain.log() - of["cost"].clamp(min=1.0).log()
    # The first was chosen with gains of which some were kept from before: no other counts more than it.
    short = (worth - worth[:, :1]).clamp(min=-3.0, max=0.0).masked_fill(~there, 0.0)
    time, since, found, here = now.whole.unbind(1)
    left = 1.0 - time / steps
    places = torch.stack([of["east"], of["south"]], dim=-1)
    apart = torch.cdist(places, places, compute_mode="donot_use_mm_for_euclid_dist")
    others = (gain * there)[:, None] * (1.0 - torch.eye(now.offers.shape[1]))
    near, about = ((others * torch.exp(-apart / reach)).sum(-1) for reach in (20.0, 80.0))
    first = torch.zeros_like(short)
    first[:, 0] = 1.0
    own = [
        gain.log() / 5, of["cost"].clamp(min=1.0).log() / 5, short, first, of["unseen"] / gain,
        gain / of["around"].clamp(min=1.0), gain / total[:, None].clamp(min=1.0), of["turns"] / 4, of["here"],
        (of["away"] / CELLS).clamp(max=2.0), (of["away"] < 6).float(), (near + 1).log() / 5,
        (about + 1).log() / 5, of["cost"] / (steps * left[:, None]).clamp(min=50.0),
    ]  # fmt: skip
    all_ = [
        left,
        (since / 300).clamp(max=2.0),
        (total + 1).log() / 5,
        number / 10,
        found / 20,
        here / (found + 1),
    ]
    own = torch.stack(own, dim=-1) * there[..., None]
    return own, torch.stack(all_, dim=-1), there, short


class ViewpointNetwork(nn.Module):
    """Q-values of offers: a value of the choice, and what each offer adds to it.

    That is at first a multiple of the logarithm of its gain for its cost, less the first one's: so a new
    network chooses as the planner does. The rest is a network of each offer beside the mean and the greatest
    of all (Zaheer et al. 2017, "Deep Sets", arXiv:1703.06114), whose last layer is 0 at first.
    """

    def __init__(self, steps: int, width: int = 32) -> None:
        """Draw first weights from torch's generator. Episodes have ``steps``."""
        super().__init__()
        self.steps = steps
        self.each = nn.Sequential(nn.Linear(OWN + ALL, width), nn.LayerNorm(width), nn.ReLU())
        self.judge = nn.Sequential(
            nn.Linear(3 * width, width), nn.LayerNorm(width), nn.ReLU(), nn.Linear(width, 1)
        )
        self.value = nn.Sequential(
            nn.Linear(2 * width + ALL, width), nn.LayerNorm(width), nn.ReLU(), nn.Linear(width, 1)
        )
        self.scale = nn.Parameter(torch.tensor(0.1))
        for last in (self.judge[-1], self.value[-1]):
            for weights in last.parameters():
                nn.init.zeros_(weights)

    def forward(self, now: Situation) -> Tensor:
        """Q-values (B, K), in discounted targets; minus infinity where there is no offer."""
        own, all_, there, short = features(now, self.steps)
        each = self.each(torch.cat([own, all_[:, None].expand(-1, own.shape[1], -1)], dim=-1))
        each = each * there[..., None]
        mean = each.sum(1) / there.sum(1, keepdim=True).clamp(min=1)
        pool = torch.cat([mean, each.amax(1)], dim=-1)
        rest = self.judge(torch.cat([each, pool[:, None].expand(-1, own.shape[1], -1)], dim=-1)).squeeze(-1)
        value = self.value(torch.cat([pool, all_], dim=-1))
        return (value + self.scale * short + rest).masked_fill(~there, -torch.inf)


class Chooser:
    """Takes the offer of greatest Q-value, and a share ``epsilon`` of others at random."""

    def __init__(self, network: ViewpointNetwork, generator: torch.Generator | None = None) -> None:
        """Choose by ``network``; random choices need the generator."""
        self.network, self.generator, self.epsilon = network, generator, 0.0
        self.offers, self.overruled = MOST_OFFERS, 0

    @torch.no_grad()
    def __call__(self, planner: Planner) -> tuple[Tensor, Situation, Tensor]:
        """Choose for a planner's last step, and take what was chosen. The environments (B,) that chose, their
        situations, and the offers (B,) that they took.
        """
        envs, now = situation(planner)
        picks = self.network(now).argmax(1)
        if self.epsilon > 0:
            noise = torch.rand(2, len(envs), generator=self.generator)
            random = (noise[1] * now.choice[:, 0]).long()
            picks = torch.where(noise[0] < self.epsilon, random, picks)
        self.overruled += int((picks > 0).sum())
        if (picks > 0).any():
            everywhere = torch.zeros(len(planner.advice), dtype=torch.int64)
            everywhere[envs] = picks
            planner.take(everywhere)
        return envs, now, picks
