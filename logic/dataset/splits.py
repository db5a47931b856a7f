"""Seeds that are set apart for training, validation and test: by its seed, a house is of one of them."""

TRAINING, VALIDATION, TEST = range(10**9), range(10**9, 2 * 10**9), range(2 * 10**9, 2**31)
"""Seeds of the generator: to learn from, to choose settings by, and to be measured by alone."""

SPLITS = {"train": TRAINING, "validation": VALIDATION, "test": TEST}
"""By the names that other tools have for them."""


def split_of(seed: int) -> str:
    """The split that a seed is reserved for."""
    return next(name for name, seeds in SPLITS.items() if seed in seeds)
