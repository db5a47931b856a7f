"""Prioritised level replay: scores and probabilities of houses against numbers worked out by hand."""

import re
from collections.abc import Iterator

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from agent.curriculum import emptied
from agent.levels import Levels
from logic import House, Rect
from logic.errors import RequestError
from sim import HouseVectorEnv
from tests import worlds

BANK = [*worlds.RANDOM, worlds.drawn(worlds.ONE_ROOM)]


def play(levels: Levels, *episodes: tuple[int, list[float]]) -> None:
    """One update in which each environment plays a whole episode: a house and its errors, equally many."""
    house, errors = zip(*episodes, strict=True)
    error = torch.tensor(errors).T
    ended = torch.zeros(error.shape, dtype=torch.bool)
    ended[-1] = True
    levels.update(torch.tensor(house).expand(error.shape), error, ended, torch.ones_like(ended))


def taught(**options: float) -> Levels:
    """Of four houses, 0, 1 and 2 were played one after the other, with scores 0.2, 0.8 and 0.4."""
    levels = Levels(4, 1, **options)
    play(levels, (0, [0.25, -0.15]))
    play(levels, (1, [1.0, 0.6]))
    play(levels, (2, [-0.4, -0.4]))
    return levels


def test_the_probabilities_of_four_houses_are_those_worked_out_by_hand():
    # Ranks of 0, 1, 2: 3, 1, 2.   1 / rank: 1/3, 1, 1/2, in all 11/6     -> P_score 2/11, 6/11, 3/11
    # Updates since they were played: 2, 1, 0, in all 3                   -> P_stale 2/3,  1/3,  0
    # Half of each: 28/66, 29/66, 9/66; three of four are seen            -> x 3/4; the fourth has 1/4
    expected = [28 / 88, 29 / 88, 9 / 88, 22 / 88]
    assert taught(beta=1, rho=0.5).probabilities.tolist() == pytest.approx(expected, abs=1e-12)


def test_a_lower_temperature_favours_the_first_ranks_as_worked_out_by_hand():
    # beta 1/2: 1 / rank ** 2 = 1/9, 1, 1/4, in all 49/36 -> 4/49, 36/49, 9/49
    levels = taught(beta=0.5, rho=0)
    assert levels.probabilities.tolist() == pytest.approx([3 / 49, 27 / 49, 27 / 196, 1 / 4], abs=1e-12)
    play(levels, (3, [0.0, 0.0]))  # all are seen: 1, 1/4, 1/9, 1/16, in all 205/144
    assert levels.probabilities.tolist() == pytest.approx([16 / 205, 144 / 205, 36 / 205, 9 / 205], abs=1e-12)


def test_a_house_not_seen_takes_no_rank():
    levels = Levels(4, 2, beta=1, rho=0)
    play(levels, (2, [1.0]), (3, [0.0]))  # ranks 1 and 2: 2/3 and 1/3, of the half that is seen
    assert levels.probabilities.tolist() == pytest.approx([1 / 4, 1 / 4, 1 / 3, 1 / 6], abs=1e-12)


def test_two_that_end_together_in_a_house_give_it_their_mean_and_later_ones_their_own():
    levels = Levels(2, 2)
    play(levels, (1, [2.0, 4.0]), (1, [1.0, 1.0]))
    assert levels.state()["score"].tolist() == [0, 2]
    play(levels, (1, [7.0]), (0, [3.0]))
    assert levels.state()["score"].tolist() == [3, 7]


def test_with_rho_1_only_the_time_since_a_house_was_played_counts():
    levels = taught(rho=1)
    assert levels.probabilities.tolist() == pytest.approx([1 / 2, 1 / 4, 0, 1 / 4], abs=1e-12)
    play(levels, (3, [9.0]))
    assert levels.probabilities.tolist() == pytest.approx([3 / 6, 2 / 6, 1 / 6, 0], abs=1e-12)


def test_where_all_houses_are_in_play_none_is_stale_and_all_are_alike():
    levels = Levels(2, 2, rho=1)
    play(levels, (0, [1.0]), (1, [2.0]))
    assert levels.probabilities.tolist() == [0.5, 0.5]


def test_before_anything_is_seen_all_houses_are_alike():
    levels = Levels(5, 2)
    assert levels.probabilities.tolist() == pytest.approx([0.2] * 5)
    assert levels.seen == 0


HISTORIES = st.lists(st.tuples(st.integers(0, 7), st.floats(0, 100)), max_size=20)
OPTIONS = st.fixed_dictionaries({"beta": st.floats(0.05, 20), "rho": st.floats(0, 1)})


@given(HISTORIES, OPTIONS)
def test_probabilities_sum_to_1_and_each_unseen_house_has_its_equal_share(history, options):
    levels = Levels(8, 1, **options)
    for house, error in history:
        play(levels, (house, [error]))
    p, unseen = levels.probabilities, sorted(set(range(8)) - {house for house, _ in history})
    assert float(p.sum()) == pytest.approx(1, abs=1e-12)
    assert (p >= 0).all()
    assert p[unseen].tolist() == [1 / 8] * len(unseen)
    assert levels.seen == 1 - len(unseen) / 8


@given(HISTORIES, st.floats(0.05, 20))
def test_a_higher_score_is_never_less_likely(history, beta):
    levels, scores = Levels(8, 1, beta=beta, rho=0), {}
    for house, error in history:
        play(levels, (house, [error]))
        scores[house] = float(np.float32(error))
    p = levels.probabilities.tolist()
    assert all(p[a] >= p[b] for a in scores for b in scores if scores[a] > scores[b])


def steps(levels: Levels, count: int, seed: int) -> Iterator[tuple[torch.Tensor, ...]]:
    """Random steps of two environments, as NEXT_STEP tells them: the step after an end does not count."""
    rng = np.random.default_rng(seed)
    house, over = rng.integers(0, len(levels.probabilities), 2), np.zeros(2, bool)
    for _ in range(count):
        house = np.where(over, rng.integers(0, len(levels.probabilities), 2), house)
        valid, over = ~over, ~over & (rng.random(2) < 0.2)
        yield tuple(torch.tensor(row) for row in (house, rng.normal(size=2), over, valid))


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 1000), st.integers(1, 60))
def test_scores_are_the_mean_errors_of_whole_episodes_however_the_steps_are_cut(seed, rollout):
    levels, expected = Levels(5, 2), dict.fromkeys(range(5), 0.0)
    told = list(steps(levels, 60, seed))
    errors: list[list[float]] = [[], []]
    for house, error, ended, valid in told:
        finished: dict[int, list[float]] = {}
        for e in range(2):
            if valid[e]:
                errors[e].append(abs(float(error[e])))
            if ended[e]:
                finished.setdefault(int(house[e]), []).append(float(np.mean(errors[e])))
                errors[e] = []
        expected |= {house: float(np.mean(scores)) for house, scores in finished.items()}
    for first in range(0, len(told), rollout):
        levels.update(*(torch.stack(some) for some in zip(*told[first : first + rollout], strict=True)))
    assert levels.state()["score"].tolist() == pytest.approx(list(expected.values()))


def test_a_house_that_was_only_looked_at_after_an_end_is_not_seen():
    levels = Levels(2, 1)
    house, error = torch.tensor([[0], [1]]), torch.tensor([[1.0], [5.0]])
    levels.update(house, error, torch.tensor([[True], [False]]), torch.tensor([[True], [False]]))
    assert levels.seen == 0.5
    assert levels.state()["score"].tolist() == [1, 0]


def seeded(seed: int) -> torch.Generator:
    return torch.Generator().manual_seed(seed)


def test_houses_come_as_often_as_their_probabilities_say():
    levels, generator = taught(beta=1, rho=0.5), seeded(0)
    dealt = torch.cat([levels.deal(1, generator) for _ in range(2000)])
    found = torch.bincount(dealt, minlength=4) / len(dealt)
    torch.testing.assert_close(found, levels.probabilities.float(), atol=0.04, rtol=0)  # 4 deviations


@pytest.mark.parametrize("number", [1, 5, 12, 30])
def test_unseen_houses_come_first_and_none_of_them_twice(number):
    dealt = Levels(12, 3).deal(number, seeded(1)).tolist()
    assert len(dealt) == number
    assert len(set(dealt)) == min(number, 12)


def test_all_houses_are_seen_in_the_end_and_then_the_scores_decide():
    levels, generator = Levels(40, 4, beta=0.2, rho=0.1), seeded(2)
    shares = []
    for _ in range(100):
        house = levels.deal(4, generator).tolist()
        play(levels, *((h, [float(h == 17)]) for h in house))
        shares.append(levels.seen)
    assert shares == sorted(shares)
    assert shares[-1] == 1
    assert int(levels.probabilities.argmax()) == 17
    assert levels.probabilities.max() > 4 / 40


def test_a_deal_changes_nothing_but_the_generator():
    levels, generator = taught(), seeded(0)
    before, chance = levels.state(), generator.get_state()
    levels.deal(3, generator)
    assert all(torch.equal(before[name], tensor) for name, tensor in levels.state().items())
    assert not torch.equal(chance, generator.get_state())


def test_a_state_saved_and_restored_goes_on_with_the_same_draws(tmp_path):
    levels, generator = Levels(5, 2), seeded(3)
    told = list(steps(levels, 40, 0))

    def rest(levels: Levels, generator: torch.Generator) -> list[torch.Tensor]:
        dealt = []
        for step in told[15:]:
            levels.update(*(some[None] for some in step))
            dealt.append(levels.deal(7, generator))
        return [*dealt, *levels.state().values()]

    for step in told[:15]:
        levels.update(*(some[None] for some in step))
    levels.deal(2, generator)
    torch.save({"levels": levels.state(), "chance": generator.get_state()}, tmp_path / "state.pt")
    expected = rest(levels, generator)
    saved = torch.load(tmp_path / "state.pt", weights_only=True)
    other, chance = Levels(5, 2), torch.Generator()
    for _ in range(2):  # twice: what is restored is a copy
        other.restore(saved["levels"])
        chance.set_state(saved["chance"])
        assert all(torch.equal(*pair) for pair in zip(rest(other, chance), expected, strict=True))


def test_a_state_of_another_bank_is_refused_and_changes_nothing():
    levels = taught()
    before = levels.state()
    for wrong in (Levels(5, 1).state(), Levels(4, 2).state(), {"score": before["score"]}):
        with pytest.raises(ValueError, match="a state of other houses or environments"):
            levels.restore(wrong)
    assert all(torch.equal(before[name], tensor) for name, tensor in levels.state().items())


@pytest.mark.parametrize(
    ("message", "wrong"),
    [
        ("0 houses and 2 environments: at least one of each", {"houses": 0}),
        ("beta must be above 0, not 0", {"beta": 0}),
        ("rho must lie between 0 and 1, not 1.1", {"rho": 1.1}),
    ],
)
def test_levels_that_cannot_be_are_refused(message, wrong):
    with pytest.raises(RequestError, match=re.escape(message)):
        Levels(**({"houses": 3, "environments": 2} | wrong))


def test_steps_of_another_shape_are_refused():
    levels, good = Levels(3, 2), torch.zeros(4, 2)
    for error in (torch.zeros(4, 3), torch.zeros(2), torch.zeros(5, 2)):
        with pytest.raises(ValueError, match=r"steps \(T, 2\) are needed"):
            levels.update(good.long(), error, good.bool(), good.bool())


def test_a_learner_that_deals_is_a_function_of_its_seeds_and_sees_the_whole_bank():
    bank = [emptied(house) if k % 2 else house for k, house in enumerate(BANK)]
    bank.append(House(Rect(0, 0, 3, 3), ()))

    def run() -> list[torch.Tensor]:
        count, generator = 4, seeded(5)
        envs = HouseVectorEnv(bank, num_envs=count, max_episode_steps=10)
        levels, over, shares = Levels(len(bank), count), torch.zeros(count, dtype=torch.bool), []
        envs.assign(levels.deal(count, generator))
        envs.reset(seed=0)
        for _ in range(12):
            rows = []
            for _ in range(8):
                action = torch.randint(3, (count,), generator=generator)
                _, reward, terminated, truncated, info = envs.step_torch(action)
                valid, over = ~over, terminated | truncated
                rows.append((info["house"].clone(), reward.clone(), over, valid))
            levels.update(*(torch.stack(some) for some in zip(*rows, strict=True)))
            envs.assign(levels.deal(count, generator))
            shares.append(levels.seen)
        assert shares[-1] == 1
        return [levels.probabilities, *levels.state().values()]

    for one, other in zip(run(), run(), strict=True):
        assert torch.equal(one, other)
