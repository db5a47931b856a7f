"""Replay DQN: targets against numbers worked out by hand, the memory, the same run again, learning."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from agent.actions import FORWARD, LEFT, RIGHT
from agent.avoidance import PaperRule
from agent.build import PaperNetwork, network_of
from agent.config import PRESETS as ALL
from agent.config import DQNConfig
from agent.dqn import DQN, Replay, n_step_returns, q_targets
from agent.evaluation.episodes import play
from agent.policies import QPolicy, RandomPolicy
from agent.world import shield
from logic import House, Rect
from sim import HouseVectorEnv
from tests.worlds import random_house

E = 8
PRESETS = {name: config for name, config in ALL.items() if isinstance(config, DQNConfig)}
SMALL = replace(
    PRESETS["dqn"], environments=E, steps=3000, memory=2048, warm_up=256, every=4, batch=64, horizon=3
)


@pytest.fixture(scope="module")
def envs() -> HouseVectorEnv:
    """One world for all tests, as each compiles its kernels; episodes of 100 steps, so that many end."""
    torch.set_num_threads(1)
    return HouseVectorEnv([random_house(seed) for seed in range(4)], E, max_episode_steps=100)


def flags(*at: int, steps: int = 3) -> torch.Tensor:
    """Ends (n, 1) at these steps."""
    return torch.tensor([[step in at] for step in range(steps)])


def returned(terminated=(), truncated=(), r=(1.0, 2.0, 4.0)) -> list[float]:
    """What three steps of these rewards give at a discount of a half: g, ahead, worth."""
    given = torch.tensor(r)[:, None], flags(*terminated), flags(*truncated)
    return [float(part) for part in n_step_returns(*given, discount=0.5)]


def test_n_steps_add_up_and_then_trust_the_state_they_lead_to():
    assert returned() == [1 + 2 / 2 + 4 / 4, 3, 1 / 8]


def test_a_terminal_state_is_worth_nothing_and_a_timeout_what_it_led_to():
    assert returned(terminated=[1]) == [1 + 2 / 2, 2, 0]
    assert returned(truncated=[1]) == [1 + 2 / 2, 2, 1 / 4]
    assert returned(terminated=[2]) == [1 + 2 / 2 + 4 / 4, 3, 0]
    assert returned(truncated=[0]) == [1, 1, 1 / 2]
    assert returned(terminated=[0], truncated=[0]) == [1, 1, 0]


@pytest.mark.parametrize("end", ["terminated", "truncated"])
def test_nothing_after_an_end_counts(end):
    assert returned(**{end: [0]}) == returned(**{end: [0]}, r=(1, 99, -99)) == returned(**{end: [0, 1]})[:3]
    assert returned(terminated=[2], truncated=[0]) == returned(truncated=[0])


def test_double_q_judges_the_action_that_the_network_chose_among_those_allowed():
    judged, chosen = torch.tensor([[1.0, 8.0, 4.0]] * 2), torch.tensor([[3.0, 2.0, 9.0]] * 2)
    allowed = torch.tensor([[True, True, True], [True, True, False]])
    g, worth = torch.tensor([10.0, 10.0]), torch.tensor([0.5, 0.5])
    assert q_targets(g, worth, judged, chosen, allowed).tolist() == [10 + 4 / 2, 10 + 1 / 2]
    assert q_targets(g, worth, judged, None, allowed).tolist() == [10 + 8 / 2] * 2
    assert q_targets(g, 0 * worth, judged, chosen, allowed).tolist() == [10.0, 10.0]


def lived(rows: int, kept: int) -> Replay:
    """A memory of two worlds that has seen so many rows; an observation tells its row's number and world.

    World 0's episodes are 7 rows long and world 1's are 5, and each ends by the time; the next row is the one
    that the world ignores. Rewards tell the number of the episode.
    """
    replay = Replay(kept, torch.zeros(2, 4, 2), torch.zeros(2, 1, 6))
    for row in range(rows):
        place = [(row // (length + 1), row % (length + 1)) for length in (7, 5)]
        replay.append(
            s=torch.tensor([[[float(row), world]] * 4 for world in range(2)]),
            m=torch.full((2, 1, 6), float(row)),
            allowed=torch.ones(2, 3, dtype=torch.bool),
            a=torch.tensor([row % 3] * 2),
            r=torch.tensor([float(episode + 1) * (time > 0) for episode, time in place]),
            terminated=torch.zeros(2, dtype=torch.bool),
            truncated=torch.tensor([place[0][1] == 7, place[1][1] == 5]),
            valid=torch.tensor([time > 0 for _, time in place]),
        )
    return replay


@pytest.mark.parametrize("rows", [20, 50, 99])
def test_replay_never_mixes_episodes_nor_worlds_nor_rows_that_were_overwritten(rows):
    replay, horizon = lived(rows, kept=30), 3
    drawn, worlds = replay.draw(2000, horizon, torch.Generator().manual_seed(0))
    assert drawn.min() == max(0, rows - 30)
    assert drawn.max() == rows - horizon - 1
    assert set(worlds.tolist()) == {0, 1}
    batch = replay.batch(drawn, worlds, horizon, discount=1.0)
    assert torch.equal(batch.s_tm1[:, 0].long(), torch.stack([drawn, worlds], dim=1))
    assert torch.equal(batch.m_tm1[:, 0, 0].long(), drawn)
    assert torch.equal(batch.a_tm1, drawn % 3)
    length = torch.tensor([7, 5])[worlds]
    time, episode = drawn % (length + 1), drawn // (length + 1)
    assert torch.equal(batch.valid, time > 0)  # the ignored rows are known as such
    taught = batch.valid
    steps = (length + 1 - time).clamp(max=horizon)[taught]
    assert torch.equal(batch.g[taught], (steps * (episode + 1)[taught]).float())
    assert torch.equal(batch.s_t[taught][:, 0, 0].long(), drawn[taught] + steps)
    assert torch.equal(batch.s_t[:, 0, 1].long(), worlds)
    assert torch.equal(batch.worth[taught], torch.ones(int(taught.sum())))


def test_the_rewarded_steps_of_an_episode_are_found():
    replay = lived(40, kept=30)
    assert replay.rewarded(0, 16, 24).tolist() == list(range(17, 24))
    assert replay.rewarded(1, 6, 12).tolist() == [10, 11]  # the others were overwritten


def test_the_mirror_exchanges_left_and_right_of_all_that_is_learnt_from():
    replay = lived(20, kept=30)
    replay.kept["allowed"][..., LEFT] = False
    batch = replay.batch(torch.tensor([9, 10, 11]), torch.zeros(3, dtype=torch.int64), 2, 0.9)
    batch = batch._replace(s_t=torch.rand(3, 4, 2))
    other = batch.seen_in_the_mirror()
    assert batch.a_tm1.tolist() == [LEFT, RIGHT, FORWARD]
    assert other.a_tm1.tolist() == [RIGHT, LEFT, FORWARD]
    assert other.allowed_t.tolist() == [[True, False, True]] * 3
    assert torch.equal(other.s_t, batch.s_t.flip(1))
    for one, same in zip(batch, other.seen_in_the_mirror(), strict=True):
        assert torch.equal(one, same)


def test_steps_that_the_world_ignored_teach_nothing(envs):
    learner = DQN(replace(SMALL, clip=1e9), envs)
    for _ in range(8):
        learner.act()
    learner.replay.kept["valid"][:] = False
    learner.update(learner.sample(*learner.replay.draw(16, 3, learner.generator)))
    assert float(learner.losses[-1]) == 0
    assert all(float(weight.grad.abs().max()) == 0 for weight in learner.network.parameters())


def test_what_is_remembered_is_what_was_done_and_seen(envs):
    learner = DQN(SMALL, envs)
    rule, told = PaperRule(learner.generator, threshold=2.0), []
    learner.avoidance = lambda observation, blocked: told.append(rule(observation, blocked)) or told[-1]
    seen = [learner.s]
    for _ in range(250):
        learner.act()
        seen.append(learner.s)
    kept = learner.replay.kept
    done = kept["a"][:250]
    assert torch.equal(done, torch.stack(told).long().argmax(-1))  # one rotation alone was allowed
    assert learner.overruled > 100 * E
    assert torch.equal(kept["allowed"][:250], torch.stack(told))
    assert torch.equal(kept["s"][:250], torch.stack(seen[:250]).half())
    # Episodes of 100 steps: rows 100 and 201 are the ignored ones, and 99 and 200 the last ones.
    steps = torch.arange(250)
    assert torch.equal(kept["valid"][:250], ((steps != 100) & (steps != 201))[:, None].expand(-1, E))
    assert torch.equal(kept["truncated"][:250], ((steps == 99) | (steps == 200))[:, None].expand(-1, E))
    assert learner.counted == 248 * E


def run(envs, config=SMALL, steps=None) -> DQN:
    """A run to its end, or to the first report after so many steps."""
    learner = DQN(config, envs)
    for now in learner.train():
        if steps and now.steps >= steps:
            break
    return learner


def weights(learner: DQN) -> torch.Tensor:
    return torch.cat(
        [w.detach().flatten() for w in [*learner.network.parameters(), *learner.target.parameters()]]
    )


def test_a_run_is_a_function_of_config_houses_and_seed(envs):
    one, same, other = (run(envs, replace(SMALL, seed=seed)) for seed in (1, 1, 2))
    assert one.updates == same.updates > 50
    assert torch.equal(weights(one), weights(same))
    assert not torch.equal(weights(one), weights(other))


@pytest.mark.parametrize("preset", ["dqn", "paper"])
def test_a_run_that_was_stopped_goes_on_bit_for_bit(envs, tmp_path, preset):
    small = {"environments": E, "steps": 3000, "memory": 2048, "warm_up": 256, "seed": 5}
    config = replace(PRESETS[preset], **small, batch=64, minibatches=4)
    if preset == "paper":  # its learning in the world at hand
        config = replace(config, world="default", network="traces")
    torch.save(run(envs, config, steps=2000).state(), tmp_path / "run.pt")
    whole, resumed = run(envs, config), DQN(config, envs)
    resumed.restore(torch.load(tmp_path / "run.pt", weights_only=True))
    assert 2000 <= resumed.steps < 3000
    ends = [now.targets for now in resumed.train()]
    assert ends
    assert (resumed.steps, resumed.updates, resumed.episodes) == (whole.steps, whole.updates, whole.episodes)
    assert torch.equal(weights(resumed), weights(whole))
    assert torch.equal(resumed.replay.kept["s"], whole.replay.kept["s"])
    assert list(resumed.recent) == list(whole.recent)


def test_another_config_or_other_houses_cannot_go_on(envs):
    learner = DQN(SMALL, envs)
    state = learner.state()
    with pytest.raises(ValueError, match="horizon"):
        DQN(replace(SMALL, horizon=2), envs).restore(state)
    with pytest.raises(ValueError, match="other houses"):
        learner.restore(state | {"houses": "others"})
    longer = DQN(replace(SMALL, steps=8192), envs)
    longer.restore(state)


def test_the_papers_rate_and_epsilon_fall_as_theirs_did(envs):
    config = replace(PRESETS["paper"], world="default", network="traces", environments=E)
    learner = DQN(config, envs)
    assert learner.epsilon == 1.0
    learner.episodes, learner.updates = 1000, 499_999
    assert learner.epsilon == 0.025
    for _ in range(8):
        learner.act()
    learner.update(learner.sample(*learner.replay.draw(1, 1, learner.generator)))
    assert learner.optimizer.param_groups[0]["lr"] == pytest.approx(2e-6, rel=1e-3)


def test_the_paper_replays_once_after_each_episode_with_all_that_brought_reward(envs, monkeypatch):
    config = replace(PRESETS["paper"], world="default", network="traces", environments=E, minibatches=1)
    learner, replayed = DQN(config, envs), []
    sample = learner.sample
    monkeypatch.setattr(learner, "sample", lambda *at: replayed.append(at) or sample(*at))
    for _ in range(205):
        learner.step()
    assert learner.episodes == len(replayed) == 2 * E
    for index, (rows, worlds) in enumerate(replayed):
        world, begin = index % E, 101 * (index // E)
        rewards = learner.replay.kept["r"][begin + (begin > 0) : begin + 101, world]
        wanted = {begin + (begin > 0) + int(row) for row in rewards.nonzero()}
        assert len(rows) == 500
        assert wanted <= set(rows[worlds == world].tolist())
    assert learner.replay.kept["r"].sum() > 0


def test_exploring_goes_forward_where_the_middle_rays_see_the_target(envs):
    learner = DQN(replace(SMALL, homing=True, forward=1e-6), envs)
    learner.s = torch.zeros_like(learner.s)
    learner.s[: E // 2, 19, -1] = 1
    wanted = learner.explore(torch.zeros(E, 3)).argmax(-1)
    assert wanted[: E // 2].tolist() == [FORWARD] * (E // 2)
    assert (wanted[E // 2 :] != FORWARD).all()


def test_the_papers_network_has_its_size_and_a_softmax():
    network = PaperNetwork()
    assert sum(weight.numel() for weight in network.parameters()) == 61_653
    values = network(torch.rand(7, 40, 3), network.memory.empty(7))
    torch.testing.assert_close(values.sum(-1), torch.ones(7))
    one, same = (network_of(PRESETS["paper"]).layers[0].weight for _ in range(2))
    assert torch.equal(one, same)


def test_the_paper_preset_runs_in_its_world():
    config = replace(PRESETS["paper"], environments=2, steps=3000, minibatches=10)
    envs = HouseVectorEnv([random_house(0)], 2, preset=config.world, max_episode_steps=200)
    learner = run(envs, config)
    assert learner.episodes >= 10
    assert learner.updates >= 100
    assert torch.isfinite(weights(learner)).all()


@pytest.mark.parametrize(
    ("field", "value"),
    [("environments", 0), ("discount", 1.5), ("memory", 10), ("every", -1), ("minibatches", 2000)],
)
def test_a_config_that_no_run_can_have_is_refused_by_name(field, value):
    with pytest.raises(ValueError, match=field):
        DQNConfig(**{field: value})
    with pytest.raises(ValueError, match="mirror"):
        DQNConfig(world="paper")


def test_in_an_empty_room_it_learns_to_find_more_than_a_random_walk(envs):
    """By 40 times as much; a run of seconds."""
    envs = HouseVectorEnv([House(Rect(0, 0, 4, 4), ())], 32, max_episode_steps=300)
    config = replace(
        PRESETS["dqn"], environments=32, steps=32_000, memory=32_000, warm_up=2000, every=2, batch=256
    )
    learner = run(envs, config)
    chance, first = torch.Generator().manual_seed(0), np.zeros(32, int)
    agent = play(envs, QPolicy(learner.network, shield(envs), chance), 7, houses=first)
    walk = play(envs, RandomPolicy(PaperRule(chance), chance), 7, houses=first)
    assert agent.targets.mean() > 3 * walk.targets.mean() + 1
