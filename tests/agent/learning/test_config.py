"""Configs: values that no run can have are refused with the field's name."""

import pytest

from tests.agent.algorithms.cases import WRONG
from vitruvius.agent.algorithms.dqn.config import DQNConfig
from vitruvius.agent.algorithms.pqn.config import PQNConfig
from vitruvius.agent.learning.config import differences


@pytest.mark.parametrize(("kind", "field", "value"), WRONG)
def test_a_config_that_no_run_can_have_is_refused_by_name(kind, field, value):
    with pytest.raises(ValueError, match=field):
        kind(**(value if isinstance(value, dict) else {field: value}))


def test_configs_differ_in_the_fields_that_are_not_the_same_or_in_their_algorithm():
    assert set(differences(PQNConfig(), PQNConfig(seed=1, gamma=0.9))) == {"seed", "gamma"}
    assert list(differences(PQNConfig(), DQNConfig())) == ["algorithm"]
