"""Replay buffer (Lin 1992, doi:10.1007/BF00992699): the last steps of many environments, to sample from.

A row is a step of all environments, and the states before it. Each observation is stored once: the state
after a step is in the next row. This also holds at an episode's end, as an environment then shows the last
state for one more step (NEXT_STEP autoreset), whose action it ignores.

Axes: N rows, E environments, B samples.
"""

import torch
from torch import Tensor


class ReplayBuffer:
    """Last N rows of E environments. A row's number counts from the run's beginning."""

    def __init__(self, rows: int, **example: Tensor) -> None:
        """Allocate ``rows`` rows like the example's: (E, ...) each, by name."""
        self.data = {name: row.new_zeros(rows, *row.shape) for name, row in example.items()}
        self.rows, self.num_envs, self.written = rows, len(next(iter(example.values()))), 0

    @property
    def oldest(self) -> int:
        """Number of the first row that is still stored."""
        return max(0, self.written - self.rows)

    def append(self, **row: Tensor) -> None:
        """Write a row, (E, ...) each, over the oldest one."""
        for name, data in self.data.items():
            data[self.written % self.rows] = row[name]
        self.written += 1

    def sample(self, number: int, following: int, generator: torch.Generator) -> tuple[Tensor, Tensor]:
        """Return rows and environments, (B,) int64 each, of random steps with ``following`` later rows."""
        rows = torch.randint(self.oldest, self.written - following, (number,), generator=generator)
        return rows, torch.randint(self.num_envs, (number,), generator=generator)

    def sample_valid(self, number: int, following: int, generator: torch.Generator) -> tuple[Tensor, Tensor]:
        """Return rows and environments, (B,) int64 each, of distinct random steps that are ``valid``.

        The steps have ``following`` rows after them. If there are too few, all of them repeat.
        """
        rows = torch.arange(self.oldest, self.written - following)
        found = self.data["valid"][rows % self.rows].nonzero()
        order = torch.randperm(len(found), generator=generator)
        chosen = found[order[torch.arange(number) % len(found)]]
        return rows[chosen[:, 0]], chosen[:, 1]

    def read(self, name: str, rows: Tensor, envs: Tensor) -> Tensor:
        """Return the field ``name`` of these rows (...) of these environments (...), (..., ...)."""
        return self.data[name].flatten(0, 1)[rows % self.rows * self.num_envs + envs]

    def state(self) -> dict[str, Tensor | int]:
        """Return the buffer's content; the tensors are its own."""
        return {**self.data, "written": self.written}

    def restore(self, state: dict[str, Tensor | int]) -> None:
        """Restore what ``state`` returned."""
        for name, data in self.data.items():
            data.copy_(torch.as_tensor(state[name]))
        self.written = int(state["written"])
