"""Settings of torch that hold for the whole process, the same before each test."""

import pytest
import torch


@pytest.fixture(autouse=True)
def torch_settings() -> None:
    """Set one thread, as batches are small, and full precision of products of float32 matrices."""
    torch.set_num_threads(1)
    torch.set_float32_matmul_precision("highest")
