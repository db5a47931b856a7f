"""Returns of options against sums that are written out, and the reward that a house makes certain."""

import numpy as np
import torch

from agent.algorithms.viewpoint_q.returns import expected_finds, option_returns

GAMMA, LAMBDA = 0.9, 0.7
T, E = 40, 6


def random_episodes() -> dict[str, torch.Tensor]:
    noise = np.random.default_rng(0)
    chose = noise.random((T, E)) < 0.2
    chose[0] = True
    length = np.array([T, T, T, 31, 7, 1])
    tensors = {
        "r": noise.random((T, E)).astype(np.float32),
        "playing": np.arange(T)[:, None] < length,
        "chose": chose & (np.arange(T)[:, None] < length),
        "v": noise.random((T, E)).astype(np.float32),
    }
    return {name: torch.from_numpy(array) for name, array in tensors.items()}


def options(chose: np.ndarray, length: int) -> list[tuple[int, int]]:
    """Where each option begins and ends."""
    starts = np.flatnonzero(chose).tolist()
    return list(zip(starts, [*starts[1:], length], strict=True))


def test_a_return_is_an_options_own_rewards_and_a_mixture_of_what_follows():
    episodes = random_episodes()
    found = option_returns(**episodes, gamma=GAMMA, q_lambda=LAMBDA)
    r, playing, chose, v = (episodes[name].numpy() for name in ("r", "playing", "chose", "v"))
    for e in range(E):
        following = None
        for start, end in reversed(options(chose[:, e], playing[:, e].sum())):
            own = sum(GAMMA**k * r[start + k, e] for k in range(end - start))
            mixed = 0.0 if following is None else LAMBDA * following + (1 - LAMBDA) * v[end, e]
            following = own + GAMMA ** (end - start) * mixed
            assert np.isclose(found[start, e], following, atol=1e-5)


def test_with_lambda_1_values_count_for_nothing_and_with_0_only_the_next_ones():
    episodes = random_episodes()
    whole = option_returns(**episodes, gamma=GAMMA, q_lambda=1.0)
    other = option_returns(**(episodes | {"v": torch.zeros(T, E)}), gamma=GAMMA, q_lambda=1.0)
    assert torch.equal(whole, other)
    far = episodes["r"].clone()
    first_two = np.flatnonzero(episodes["chose"][:, 0].numpy())[:2]
    far[first_two[1] :, 0] += 5.0
    near = option_returns(**(episodes | {"r": far}), gamma=GAMMA, q_lambda=0.0)
    assert near[0, 0] == option_returns(**episodes, gamma=GAMMA, q_lambda=0.0)[0, 0]


def test_expected_finds_add_up_as_finding_does():
    """A target in one of the spots alike is found on average as often as the reward adds up to."""
    noise, spots, steps, games = np.random.default_rng(1), 40, 12, 4000
    seen_at = noise.integers(1, steps + 8, spots)  # some are never seen
    shown = torch.tensor([[(seen_at <= t).sum()] for t in range(steps + 1)]).float().expand(-1, games)
    found_at = torch.from_numpy(seen_at[noise.integers(spots, size=games)])
    seeks = torch.arange(steps)[:, None] < found_at
    reward = expected_finds(shown[:-1], shown[1:], seeks, torch.full((games,), float(spots)))
    assert abs(reward.sum(0).mean() - (found_at <= steps).float().mean()) < 0.03


def test_a_step_pays_what_it_shows_of_the_spots_that_are_left_while_a_target_is_sought():
    """The third step picks it up: three spots near to it are none of the next target's."""
    before, after = torch.tensor([[0.0, 4.0, 3.0, 5.0]]).T, torch.tensor([[4.0, 6.0, 5.0, 10.0]]).T
    seeks = torch.tensor([[True, False, True, True]]).T
    reward = expected_finds(before, after, seeks, torch.tensor([10.0]))[:, 0]
    assert torch.allclose(reward, torch.tensor([0.4, 0.0, 2 / 7, 1.0]))
