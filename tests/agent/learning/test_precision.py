"""A precision below the highest is refused if the processor cannot run it."""

import subprocess

import pytest
import torch

from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.agent.learning import precision
from vitruvius.logic.errors import RequestError

TRAPPED = "import os, signal; os.kill(os.getpid(), signal.SIGILL)"


def test_a_precision_that_would_end_the_process_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(precision, "TRIAL", TRAPPED)
    with pytest.raises(RequestError, match=r"precision medium: .*AMX.* Use precision highest"):
        precision.set_precision("medium")
    assert torch.get_float32_matmul_precision() == "highest"


def test_a_precision_that_runs_is_set(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(precision, "TRIAL", "pass")
    precision.set_precision("medium")
    assert torch.get_float32_matmul_precision() == "medium"


def test_the_highest_precision_needs_no_trial(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr(subprocess, "run")
    precision.set_precision("highest")
    assert torch.get_float32_matmul_precision() == "highest"


@pytest.mark.parametrize("preset", PRESETS)
def test_presets_run_on_every_processor(preset: str) -> None:
    assert PRESETS[preset].precision == "highest"
