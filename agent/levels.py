"""Which houses to learn in next: those in which there is most to learn.

Prioritised level replay (Jiang, Grefenstette, Rocktaeschel 2021, arXiv:2010.03934). A house is seen once an
episode has begun in it. Of H houses, seen or not, one is dealt with

    P(house) = 1 / H                                              where it is not seen
             = share seen x ((1 - rho) P_score + rho P_stale)     where it is

that is, as in the paper, with one of those seen as often as houses are seen, else with one of the others.
``P_score`` goes with 1 / rank ** (1 / beta) of a house's score, ``P_stale`` with how long it was not played.

    levels = Levels(len(envs.houses), envs.num_envs)
    envs.assign(levels.deal(envs.num_envs, generator))
    envs.reset(seed=0)
    for each rollout:
        ...  # note info["house"] of each step, beside its reward
        levels.update(house, error, ended, valid)
        envs.assign(levels.deal(envs.num_envs, generator))  # for episodes that begin in the next rollout
"""

from collections.abc import Mapping
from itertools import pairwise

import torch
from torch import Tensor

from logic.errors import RequestError


class Levels:
    """What is known of how much there is to learn in each of H houses, from what E environments play.

    A house's score is the mean |TD error| over the steps of the last episode that ended in it (with errors of
    Q(lambda) returns that is the paper's "L1 value loss"); 0 until one has.
    """

    def __init__(self, houses: int, environments: int, *, beta: float = 1.0, rho: float = 0.1) -> None:
        """``beta``: temperature; the smaller, the more the first ranks get. ``rho``: how often a house is
        chosen for its staleness. Raises ``RequestError`` for values that cannot be.

        The paper's beta is 0.1, which gives nine of ten episodes to a single house: good for actors that end
        one by one, not for hundreds that end together. At 1 the first of 1,024 houses gets an eighth.
        """
        if houses < 1 or environments < 1:
            raise RequestError(f"{houses} houses and {environments} environments: at least one of each")
        if not beta > 0:
            raise RequestError(f"beta must be above 0, not {beta}")
        if not 0 <= rho <= 1:
            raise RequestError(f"rho must lie between 0 and 1, not {rho}")
        self.beta, self.rho = beta, rho
        self._score = torch.zeros(houses, dtype=torch.float64)
        self._played = torch.full((houses,), -1)  # the update that it was last played before; -1: never
        self._now = torch.zeros((), dtype=torch.int64)  # updates so far
        self._error = torch.zeros(environments, dtype=torch.float64)  # of each environment's episode so far
        self._steps = torch.zeros(environments, dtype=torch.int64)

    def update(self, house: Tensor, error: Tensor, ended: Tensor, valid: Tensor) -> None:
        """Take in T steps of all environments, each (T, E): the house it was made in (whole numbers), its TD
        error, whether it ended the episode (bool) and whether it counts (bool: not a step after an end).

        Episodes go on from one call to the next. Raises ``ValueError`` for other shapes.
        """
        shapes = {tuple(some.shape) for some in (house, error, ended, valid)}
        if len(shapes) > 1 or error.dim() != 2 or error.shape[1] != len(self._error):
            raise ValueError(f"steps (T, {len(self._error)}) are needed four times over, found {shapes}")
        house, error, ended, valid = (some.detach().cpu() for some in (house.long(), error, ended, valid))
        error = torch.where(valid, error.abs().double(), 0.0)
        self._now += 1
        self._played[house[valid]] = self._now
        cuts = (ended.any(1).nonzero().flatten() + 1).tolist()
        for first, last in pairwise([0, *cuts, len(error)]):
            self._error += error[first:last].sum(0)
            self._steps += valid[first:last].sum(0)
            over = ended[last - 1] & (self._steps > 0)
            self._note(house[last - 1, over], (self._error / self._steps)[over])
            self._error[over], self._steps[over] = 0.0, 0

    def _note(self, house: Tensor, score: Tensor) -> None:
        """Let houses (n,) have these scores (n,); one that is there more than once gets the mean."""
        total = torch.zeros_like(self._score).index_add_(0, house, score)
        count = torch.bincount(house, minlength=len(total))
        self._score = torch.where(count > 0, total / count.clamp(min=1), self._score)

    @property
    def probabilities(self) -> Tensor:
        """How likely each house is to be dealt (H,) float64: they sum to 1."""
        seen = self._played >= 0
        return torch.where(seen, self.seen * self._replay(), 1 / len(seen))

    def _replay(self) -> Tensor:
        """How likely each house is among those seen (H,); where none is, all are alike."""
        seen = self._played >= 0
        if not seen.any():
            return torch.full_like(self._score, 1 / len(seen))
        rank = torch.empty_like(self._score)
        order = torch.where(seen, self._score, -torch.inf).argsort(descending=True, stable=True)
        rank[order] = torch.arange(1, len(rank) + 1, dtype=rank.dtype)
        by_score = torch.where(seen, rank ** (-1 / self.beta), 0.0)
        by_age = torch.where(seen, self._now - self._played, 0).double()
        if not by_age.any():  # all are in play
            by_age = seen.double()
        return (1 - self.rho) * by_score / by_score.sum() + self.rho * by_age / by_age.sum()

    def deal(self, number: int, generator: torch.Generator) -> Tensor:
        """Houses (number,) int64 to play next, each as ``probabilities`` has it, but that no unseen house
        comes twice. Nothing changes but the generator: what is dealt and not played does not count.
        """
        unseen = (self._played < 0).nonzero().flatten()
        fresh = (
            (torch.rand(number, generator=generator, dtype=torch.float64) >= self.seen).nonzero().flatten()
        )
        fresh = fresh[: len(unseen)]
        houses = torch.multinomial(self._replay(), number, replacement=True, generator=generator)
        houses[fresh] = unseen[torch.randperm(len(unseen), generator=generator)[: len(fresh)]]
        return houses

    @property
    def seen(self) -> float:
        """Share of the houses that an episode has begun in."""
        return float((self._played >= 0).double().mean())

    def state(self) -> dict[str, Tensor]:
        """All that updates and deals depend on, but for the generator: copies, plain tensors."""
        return {name: getattr(self, f"_{name}").clone() for name in STATE}

    def restore(self, state: Mapping[str, Tensor]) -> None:
        """Go on from a state, bit for bit. Raises ``ValueError`` for one of other kinds or shapes."""
        kinds = {name: (tensor.dtype, tuple(tensor.shape)) for name, tensor in self.state().items()}
        if {name: (tensor.dtype, tuple(tensor.shape)) for name, tensor in state.items()} != kinds:
            raise ValueError(f"a state of other houses or environments: here they are {kinds}")
        for name in STATE:
            setattr(self, f"_{name}", state[name].clone())


STATE = ("score", "played", "now", "error", "steps")
