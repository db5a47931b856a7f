"""The original's placing of rooms follows its program's law; the study continues where it stopped."""

import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import nullcontext
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.common.pages import machine
from benchmarks.paper import complexity
from benchmarks.paper.complexity import Complexity, OtherMachine, growth, table
from vitruvius.logic.placement import prolog

pytestmark = pytest.mark.second_part("each study is run in small")

SIDES = {"bedroom": (12, 17), "bathroom": (8, 12), "kitchen": (10, 15)}


def accepted(types: list[str], count: int) -> float:
    """Return the fraction of samples that the original's program accepts, computed by NumPy in feet."""
    rng, rooms = np.random.default_rng(0), len(types)
    least, most = np.array([SIDES[type_] for type_ in types]).T
    size = rng.uniform(least, most, (2, count, rooms))
    corner = rng.uniform(0, 15 + 8 * rooms - size)
    valid = np.linalg.norm(corner + size / 2 - corner.mean(axis=2, keepdims=True), axis=0) <= 10 + 3 * rooms
    valid = valid.all(axis=1)
    for i, j in combinations(range(rooms), 2):
        first, second = corner[..., i] + size[..., i] + 2.5, corner[..., j] + size[..., j] + 2.5
        valid &= ((first <= corner[..., j]) | (second <= corner[..., i])).any(axis=0)
    return float(valid.mean())


def test_as_many_samples_are_tried_as_the_original_s_constraints_ask_for() -> None:
    """The tries until the first accepted one are geometric: mean 1 / share, and about the same deviation."""
    prolog.load(Path(complexity.__file__).with_name("original_rooms.pl").resolve())
    prolog.run("set_random", prolog.Term("seed", 1), module="system")
    types = list(SIDES)
    tries = [prolog.ask("tries_until_placed", types, 10**8, module="original_rooms") for _ in range(400)]
    mean = 1 / accepted(types, 200_000)
    assert np.mean(tries) == pytest.approx(mean, abs=4 * mean / len(tries) ** 0.5)


def test_the_study_goes_on_where_it_stopped_and_says_what_the_limit_stopped(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    part = Complexity(rooms=(2,), houses=3, inferences=1_000_000, out=tmp_path)
    part.run()
    file = tmp_path / "paper-complexity.json"
    first = json.loads(file.read_bytes())["measured"]
    replace(part, rooms=(2, 8)).run()
    study = json.loads(file.read_bytes())
    assert study["measured"][:2] == first
    assert [(entry["method"], entry["rooms"], entry["made"]) for entry in study["measured"]] == [
        ("original", 2, 3),
        ("ours", 2, 3),
        ("original", 8, 0),
        ("ours", 8, 3),
    ]
    assert (tmp_path / "paper-complexity.png").read_bytes().startswith(b"\x89PNG")
    assert "| 8 | 0 of 3 | over the limit |  | 3 of 3 |" in table(study)
    assert table(study) in capsys.readouterr().out


def test_by_an_engine_each_cell_has_a_whole_machine_which_it_names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """``tests/logic/dataset/test_engine.py`` measures a cell with a real engine."""

    class Engine:
        def each(self, function: Any, items: Sequence[Any], alone: bool) -> Iterator[tuple[int, Any]]:
            assert alone
            yield from ((place, function(items[place])) for place in reversed(range(len(items))))

    monkeypatch.setattr(complexity, "engine", lambda name, address: nullcontext(Engine()))
    Complexity(rooms=(2,), houses=1, inferences=10**6, out=tmp_path, engine="ray").run()
    cells = json.loads((tmp_path / "paper-complexity.json").read_bytes())["measured"]
    assert [cell["method"] for cell in cells] == ["ours", "original"]
    assert {cell["machine"] for cell in cells} == {machine()}


def test_growth_is_a_factor_with_each_room_and_a_power_of_their_number() -> None:
    def entries(method: str, law: Callable[[int], float]) -> list[dict[str, Any]]:
        return [
            {"method": method, "rooms": n, "asked": 1, "made": 1, "cpu_seconds": [law(n)], "machine": "mine"}
            for n in (2, 4, 8)
        ]

    study = {"measured": [*entries("original", lambda n: 3.0**n), *entries("ours", lambda n: n**1.5)]}
    assert growth(study, "original")[0] == pytest.approx(3.0)
    assert growth(study, "ours")[1] == pytest.approx(1.5)
    study["measured"][1]["machine"] = "yours"
    assert growth(study, "ours")[1] == pytest.approx(1.5)
    with pytest.raises(OtherMachine, match=r"times of several machines are not of one law \(mine; yours\)"):
        growth(study, "original")
