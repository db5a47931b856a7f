"""Files of scores: they read back unchanged, and scores that cannot be compared are refused."""

import json
from pathlib import Path

import numpy as np
import pytest

from tests.agent.evaluation.cases import result, scores
from tests.sample_houses import random_house
from vitruvius.agent.banks import bank_hash
from vitruvius.agent.evaluation.result import Result
from vitruvius.agent.evaluation.scores import (
    ScoredBank,
    ScoreError,
    ScoreFile,
    external,
    joined,
    load,
    modes_of,
    result_of,
)

HOUSES = [random_house(seed) for seed in range(2)]
RESULT = result(scores([5, 7], [30, np.inf]), scores([6, 8]), mode="main", others={"script": scores([1, 2])})


def written(path: Path, one: Result = RESULT) -> Path:
    """Write a file of this result, measured in ``HOUSES``."""
    path.write_bytes(ScoreFile(ScoredBank(bank_hash(HOUSES)), 0, modes_of([one])).json())
    return path


def test_a_result_reads_back_as_it_was(tmp_path):
    again = result_of(load(written(tmp_path / "scores.json")).targets["main"], "main")
    assert list(again.policies) == list(RESULT.policies)
    for name in RESULT.policies:
        assert again.figures(name) == RESULT.figures(name)
        assert again.by_rooms(name) == RESULT.by_rooms(name)
        for one, other in zip(again.policies[name], RESULT.policies[name], strict=True):
            assert all(np.array_equal(value, getattr(other, key)) for key, value in vars(one).items())


def test_a_file_has_every_figure_with_its_interval_and_what_it_means(tmp_path):
    content = json.loads(written(tmp_path / "scores.json").read_text())
    for policy in content["targets"]["main"]["policies"].values():
        assert set(policy["figures"]) | {"first_find"} == set(content["definitions"])
        assert all(set(figure) == {"value", "low", "high"} for figure in policy["figures"].values())


def test_the_external_agents_of_a_file_are_all_that_are_no_references(tmp_path):
    found = external(written(tmp_path / "scores.json"), HOUSES, ["main", "mixed"])
    assert {mode: list(policies) for mode, policies in found.items()} == {"main": ["agent"]}
    assert [run.targets.tolist() for run in found["main"]["agent"]] == [[5, 7], [6, 8]]
    assert found["main"]["agent"][0].first.tolist() == [30, np.inf]


def test_external_agents_join_above_the_references_and_never_replace_an_agent():
    theirs, path = {"agent": (scores([1, 1]),)}, Path("folder/other.json")
    one = joined(joined(RESULT, theirs, path), theirs, path)
    assert list(one.policies) == ["agent", "agent (other)", f"agent ({path})", "script", "oracle"]
    assert one.policies["agent"] == RESULT.policies["agent"]
    assert one.policies["agent (other)"] == theirs["agent"]


def agent_run(file) -> dict:
    return file["targets"]["main"]["policies"]["agent"]["runs"][0]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda file: file["bank"].update(hash="0" * 64), "evaluated with houses of hash 000000000000, not"),
        (lambda file: file.update(seed=1), "0: the scores are not comparable"),
        (lambda file: file.update(backend="grid"), "backend grid, not continuous"),
        (lambda file: file.update(world="paper"), "world paper, not default"),
        (lambda file: file.update(episodes=2), "episodes 2, not 1"),
        (lambda file: file["targets"].update(mixed=file["targets"].pop("main")), "are mixed, not main"),
        (lambda file: file.pop("targets"), "missing required field `targets`"),
        (lambda file: agent_run(file).update(rooms=[1]), "agent needs one value for each of 2 episodes"),
        (lambda file: agent_run(file).update(first=["soon", 1]), "Expected `int | null`, got `str`"),
    ],
)
def test_scores_that_cannot_be_compared_are_refused_in_one_line(change, message, tmp_path):
    path = written(tmp_path / "scores.json")
    file = json.loads(path.read_text())
    change(file)
    path.write_text(json.dumps(file))
    with pytest.raises(ScoreError) as refusal:
        external(path, HOUSES, ["main"])
    assert str(refusal.value).startswith(f"{path}: ")
    assert message in str(refusal.value)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize("content", [b"", b"[]", b"\xff", None])
def test_a_file_that_holds_no_scores_is_refused(content, tmp_path):
    path = tmp_path / "scores.json"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(ScoreError, match=r"not scores|cannot be read"):
        external(path, HOUSES, ["main"])


def test_what_another_library_must_write_is_little(tmp_path):
    """The file needs the bank, the seed and the runs; figures are computed from these."""
    path = written(tmp_path / "scores.json")
    file = json.loads(path.read_text())
    runs = {"agent": {"runs": file["targets"]["main"]["policies"]["agent"]["runs"]}}
    least = {"bank": {"hash": bank_hash(HOUSES)}, "seed": 0, "targets": {"main": {"policies": runs}}}
    path.write_text(json.dumps(least))
    assert list(external(path, HOUSES, ["main"])["main"]) == ["agent"]
