"""Configs: values that no run can have are refused with the field's name."""

import pytest

from vitruvius.agent.algorithms.dqn.config import DQNConfig
from vitruvius.agent.algorithms.paper.config import PaperConfig
from vitruvius.agent.algorithms.pqn.config import PQNConfig
from vitruvius.agent.learning.config import differences

WRONG = {
    PQNConfig: [
        ("num_envs", 0),
        ("steps", -1),
        ("gamma", 1.5),
        ("epsilon", -0.1),
        ("seconds", 0.0),
        ("num_minibatches", 9000),
        ("half_lives", (4.0, 0.0)),
        ("num_steps", 0),
        ("q_lambda", 2.0),
        ("num_minibatches", {"network": "recurrent", "num_envs": 2}),
    ],
    DQNConfig: [
        ("num_envs", 0),
        ("gamma", 1.5),
        ("buffer_size", 10),
        ("train_frequency", -1),
        ("batch_size", 0),
        ("device", "cuda"),
    ],
    PaperConfig: [
        ("buffer_size", 10),
        ("num_minibatches", 2000),
        ("lr_decay", -1.0),
        ("batch_size", 0),
        ("device", "cuda"),
    ],
}


@pytest.mark.parametrize(
    ("kind", "field", "value"), [(kind, *each) for kind in WRONG for each in WRONG[kind]]
)
def test_a_config_that_no_run_can_have_is_refused_by_name(kind, field, value):
    with pytest.raises(ValueError, match=field):
        kind(**(value if isinstance(value, dict) else {field: value}))


def test_configs_differ_in_the_fields_that_are_not_the_same_or_in_their_algorithm():
    assert set(differences(PQNConfig(), PQNConfig(seed=1, gamma=0.9))) == {"seed", "gamma"}
    assert list(differences(PQNConfig(), DQNConfig())) == ["algorithm"]
