"""Seeds reserved for training, validation and test. The seed of a house decides its split."""

TRAINING, VALIDATION, TEST = range(10**9), range(10**9, 2 * 10**9), range(2 * 10**9, 2**31)
"""Seeds of the generator for training, for the choice of settings, and for the final evaluation alone."""

SPLITS = {"train": TRAINING, "validation": VALIDATION, "test": TEST}
"""Splits by the names that other tools use."""


def split_of(seed: int) -> str:
    """Return the split of a seed."""
    return next(name for name, seeds in SPLITS.items() if seed in seeds)
