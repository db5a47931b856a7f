"""Value of the parts of the view network: the inputs of a variant, and the judgement of its choices."""

from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
import torch

from benchmarks.planner import taught
from benchmarks.planner.views import (
    AGENT,
    INPUTS,
    WHOLE,
    ViewChoices,
    Views,
    collected,
    fitted,
    shares,
    without,
)
from tests.sample_houses import THREE_ROOMS
from vitruvius.agent.algorithms.map_completion.network import PIECES
from vitruvius.agent.algorithms.search.config import SearchConfig
from vitruvius.agent.algorithms.search.learner import LearnedSearch
from vitruvius.agent.algorithms.search.network import ViewNetwork
from vitruvius.agent.algorithms.search.windows import HEADINGS, LEVELS, PLACES, ViewMaps, empty
from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.agent.evaluation.episodes import reset
from vitruvius.agent.learning.environments import make_envs
from vitruvius.agent.learning.simulator import sensor
from vitruvius.agent.policies.episodes import moments
from vitruvius.logic.errors import RequestError

pytestmark = pytest.mark.second_part("each study is run in small")

HOUSES = THREE_ROOMS
PLAIN = replace(cast(SearchConfig, PRESETS[AGENT]), foresight=False, looks=False)
CONFIG = replace(cast(SearchConfig, PRESETS[AGENT]), buffer_size=130, restarts=0.1)


@pytest.fixture(scope="module")
def choices() -> ViewChoices:
    return collected(HOUSES, CONFIG)


FIELDS = {"memory": "taken", "finds": "finds", "ages": "ages", "start": "start", "scalars": "scalars"}


@pytest.mark.parametrize("part", [*FIELDS, "since"])
def test_maps_without_an_input_say_nothing_of_it_and_all_else(part: str) -> None:
    maps, other = empty(2), empty(2)
    for field in (*maps, *other):
        field.copy_(torch.randint(0, 5, field.shape))
    name = FIELDS.get(part, "blocks")
    if name == "blocks":  # the same cells, seen at other times
        kept = maps.blocks % LEVELS**2
        maps, other = (
            each._replace(blocks=kept + LEVELS**2 * (each.blocks % LEVELS)) for each in (maps, other)
        )
    other = maps._replace(**{name: getattr(other, name)})
    assert not torch.equal(getattr(maps, name), getattr(other, name))
    one, same = INPUTS[part](maps), INPUTS[part](other)
    for field in ViewMaps._fields:
        assert torch.equal(getattr(one, field), getattr(same, field))
        assert field == name or torch.equal(getattr(one, field), getattr(maps, field))


@pytest.mark.parametrize(
    ("part", "foresight"), [(WHOLE, False), ("planes", True)], ids=["foresight", "planes"]
)
def test_who_foresees_nothing_values_views_as_when_it_plays(
    choices: ViewChoices, part: str, foresight: bool
) -> None:
    network, config = ViewNetwork((2, 2), looks=True), replace(CONFIG, foresight=foresight)
    maps = ViewMaps(*(field[:8] for field in without(part, config, choices)))
    with torch.inference_mode():
        assert torch.equal(network(maps), network(network.foresee(maps)))
    foreseen = torch.randint(0, 256, choices.maps.foreseen.shape, dtype=torch.uint8)
    other = choices._replace(maps=choices.maps._replace(foreseen=foreseen))
    assert torch.equal(without(part, config, other).foreseen[:8], maps.foreseen)


def test_choices_are_of_all_houses_and_of_maps_of_all_ages(choices: ViewChoices) -> None:
    maps, _, house = choices
    assert set(house) == set(range(len(HOUSES)))
    assert (maps.worth.float().flatten(1).amax(1) > 0).all()
    assert (maps.blocks // LEVELS**2).float().mean(dim=(1, 2)).std() > 0


class Told(torch.nn.Module):
    """A network that knows the values of views, or their opposite."""

    def __init__(self, sign: int) -> None:
        super().__init__()
        self.sign = sign

    def forward(self, maps: ViewMaps) -> torch.Tensor:
        return self.sign * maps.worth.float()


def test_who_knows_what_views_are_worth_has_all_of_it(choices: ViewChoices) -> None:
    maps = choices[0]._replace(taken=torch.zeros_like(choices[0].taken))
    assert maps.worth.shape[1:] == (HEADINGS, PLACES, PLACES)
    assert (shares(cast(Any, Told(1)), maps) == 1).all()
    assert (shares(cast(Any, Told(-1)), maps) == 0).all()


def test_a_network_learns_by_so_many_updates_ever_slower(
    choices: ViewChoices, monkeypatch: pytest.MonkeyPatch
) -> None:
    rates = []

    def noted(learner: LearnedSearch, loss: torch.Tensor, most: float) -> torch.Tensor:
        rates.append(learner.optimizer.param_groups[0]["lr"])
        return loss.detach()

    monkeypatch.setattr(LearnedSearch, "descend", noted)
    fitted(replace(PLAIN, channels=(2, 2)), HOUSES[:1], choices[0], 23)
    assert len(rates) == 23
    assert rates == sorted(rates, reverse=True)
    assert rates[0] == CONFIG.learning_rate
    assert rates[-1] < 0.1 * CONFIG.learning_rate


def test_the_table_has_a_row_of_each_part_less_the_whole(
    tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    names = "foresight", "truth"
    study = Views(names, houses=3, choices=140, updates=2, seeds=2, out=tmp_path / "out")
    for _ in range(2):  # the second time from kept results
        study.run()
        rows = [line.split(" | ") for line in capsys.readouterr().out.splitlines() if line.startswith("| ")]
        assert [row[0].removeprefix("| ") for row in rows[-5:]] == [
            *("untrained", f"{WHOLE}, seed 0", f"{WHOLE}, seed 1"),
            *(f"without {name}" for name in names),
        ]
        assert all("±" in column for row in rows[-3:] for column in row[3:])
    assert len(list((tmp_path / "out").glob("*.safetensors"))) == 2 + len(names)


def test_so_few_choices_that_nothing_is_learnt_are_refused(tmp_path: Path) -> None:
    with pytest.raises(RequestError, match="--choices 128 or more"):
        Views(choices=127, out=tmp_path).run()


def test_a_part_that_there_is_not_is_named(tmp_path: Path) -> None:
    with pytest.raises(RequestError, match="no part memoir: did you mean memory"):
        Views(("memoir",), out=tmp_path).run()


@pytest.mark.parametrize("maker", [taught.any_task, taught.habit])
def test_the_released_network_plays_a_task_that_it_was_not_taught(maker: Any) -> None:
    """The network plays with its own predictions, and with those of the task, which read furniture."""
    config = getattr(maker, "config", None)
    envs = make_envs(HOUSES, len(HOUSES), "habit", preset=sensor(config) if config else "default")
    policy = maker(envs)
    for _ in moments(envs, policy, reset(envs, 0, np.arange(len(HOUSES))), 100):
        pass
    planner, marks = policy.tracker.planner, getattr(policy.tracker.chooser, "marks", None)
    assert (planner.seen > 100).all()
    assert (marks is not None) == (config is not None)
    assert marks is None or (marks.blocks[:, PIECES] > 0).sum() > 20
