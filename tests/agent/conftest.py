"""What torch keeps for the whole process is the same before each test."""

import pytest
import torch


@pytest.fixture(autouse=True)
def torch_settings() -> None:
    """One thread, as batches are small; products of float32 matrices in full precision."""
    torch.set_num_threads(1)
    torch.set_float32_matmul_precision("highest")
