"""Each hostile input is refused, ends at a stated limit or is data, and none has an effect.

``./run test -m hostile tests/hostile`` runs them, and prints a table by kind at its end.
"""

import os
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from tests.hostile import answer_sets, bombs, checkpoints, files, folders, houses, plans, prolog, subjects
from tests.hostile.case import SECRET, Case, Yard
from tests.hostile.subjects import Answer, Reader
from tests.hostile.watch import Ear, forget_peak, peak, watched

pytestmark = pytest.mark.hostile

MEMORY = 1 << 30
"""Largest memory, in bytes, that reading an input may take besides the program's own."""


@dataclass(frozen=True)
class Subject:
    """Reader of some inputs, in a process that has imported these modules."""

    read: Callable[..., Answer]
    cases: Sequence[Case]
    modules: tuple[str, ...] = ("pyswip", "vitruvius.logic.generation.builder")
    address_space: int = subjects.MEMORY

    @property
    def process(self) -> tuple[tuple[str, ...], int]:
        """Properties of its process: readers with the same properties share one."""
        return self.modules, self.address_space


TORCH = ("pyswip", "vitruvius.agent.runs.runs", "torch.utils.tensorboard")
SUBJECTS = (
    Subject(subjects.rules, [*prolog.CASES, *answer_sets.CASES, *files.CASES, *bombs.READ]),
    Subject(subjects.bomb, bombs.ENDED),
    Subject(houses.shown, houses.CASES, ("vitruvius.cli", "vitruvius.logic.drawing.draw", "matplotlib")),
    Subject(plans.read, plans.CASES, ("pyswip", "vitruvius.logic.request.given_plan", "tests.hostile.plans")),
    Subject(checkpoints.loaded, checkpoints.CASES, TORCH, 32 << 30),
    Subject(folders.resumed, folders.CASES, TORCH, 32 << 30),
)
CASES = {str(case): (case, subject) for subject in SUBJECTS for case in subject.cases}


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Yield the folder of the yards of all cases, the current folder, and the user's home."""
    root = tmp_path_factory.mktemp("hostile")
    (root / "home").mkdir()
    (root / "here").mkdir()
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(root / "here")
        # Kernels and the compiled core of SWI-Prolog are no effects of an input: they stay in the real cache.
        patch.setenv("XDG_CACHE_HOME", os.environ.get("XDG_CACHE_HOME", str(Path.home() / ".cache")))
        patch.setenv("HOME", str(root / "home"))
        yield root


@pytest.fixture(scope="module")
def readers(root: Path) -> Iterator[dict[Any, Reader]]:
    """Yield the processes that read."""
    readers = {each.process: Reader(*each.modules, memory=each.address_space) for each in SUBJECTS}
    yield readers
    for reader in readers.values():
        reader.end()


@pytest.fixture(scope="module")
def ear() -> Ear:
    """Return a server that must get no connection."""
    return Ear()


@pytest.mark.parametrize("title", CASES)
def test_a_hostile_input_is_answered_and_has_no_effect(
    title: str,
    root: Path,
    readers: dict[Any, Reader],
    ear: Ear,
    record_property: Callable[[str, object], None],
) -> None:
    case, subject = CASES[title]
    reader = readers[subject.process]
    process = reader.ready()
    if subject.read is houses.shown and not (root / "plans").exists():
        assert reader.answer(houses.shown, houses.good(root), root / "plans").answer == "accepted"
    if subject.read is folders.resumed and not (root / "run").exists():
        assert reader.answer(folders.trained, root / "run").answer == "accepted"
    yard = Yard(root / "yard", ear.port)
    yard.lay_out()
    try:
        path = case.make(yard)
        forget_peak(process)
        before = peak(process)
        with watched(root, yard.out, ear, process) as effects:
            answer = reader.answer(
                subject.read, *((path, yard.out) if subject.read is houses.shown else (path,))
            )
            took = peak(process) - before if reader.is_alive() else 0
    finally:
        yard.clear()
    if subject.read is subjects.bomb:  # its own solver process may wait for the next house
        effects.found = [each for each in effects.found if "processes" not in each]
    effects.found += [event for event in answer.events if str(yard.out) not in event]
    record_property("hostile", (case.kind, answer.answer, len(effects.found)))
    assert not effects.found
    assert answer.answer in case.answers, answer.text
    assert case.says in answer.text
    assert SECRET not in answer.text
    assert took < MEMORY


def test_there_are_many_of_each_kind() -> None:
    numbers = Counter(case.kind.partition(":")[0] for case, _ in CASES.values())
    assert numbers["Prolog"] + numbers["clingo"] + numbers["grammars"] >= 120
    assert numbers["houses"] >= 60
    assert numbers["checkpoints"] + numbers["run folders"] >= 40
    assert len(CASES) == sum(len(subject.cases) for subject in SUBJECTS)
    assert len(bombs.ENDED) == len(bombs.ENDING)
