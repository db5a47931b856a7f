"""Which tests are of the second part: what takes long, and seldom finds what the first part does not.

``./run test`` runs the first part; ``./run test --all`` both, as ``.ci/run`` does. A file or folder of the
second part that is named on the command line runs as any other does.
"""

SECOND_PART: dict[str, str] = {}
"""By path below ``tests``, of a folder, a file or a test: what it does that takes long."""


def of_second_part(test: str) -> bool:
    """Whether a test, as ``logic/browser/test_watch.py::test_it[1]``, is one of them."""
    bare = test.partition("[")[0]
    return any(bare == part or bare.startswith((f"{part}/", f"{part}::")) for part in SECOND_PART)
