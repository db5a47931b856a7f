"""Names for cached results, so that a stopped study can continue.

A name is made of everything that a result depends on.
"""

import hashlib

from benchmarks.common.pages import ROOT
from vitruvius.agent.runs.checkpoint import Checkpoint


def code() -> str:
    """Return a hash of the code of policies and environments: other code needs new results."""
    paths = sorted(path for part in ("agent", "sim") for path in (ROOT / part).rglob("*.py"))
    return hashlib.sha256(b"".join(path.read_bytes() for path in paths)).hexdigest()[:8]


def fingerprint(agent: Checkpoint) -> str:
    """Return a hash of an agent's weights."""
    parts = [value.numpy().tobytes() for value in agent.network.state_dict().values()]
    return hashlib.sha256(b"".join(parts)).hexdigest()
