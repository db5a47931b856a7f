"""What was played is kept under a name of all that it depends on, so that a stopped study goes on."""

import hashlib

from agent.runs.checkpoint import Checkpoint
from benchmarks.common.pages import ROOT


def code() -> str:
    """A hash of the code of policies and environments: what other code played is played again."""
    paths = sorted(path for part in ("agent", "sim") for path in (ROOT / part).rglob("*.py"))
    return hashlib.sha256(b"".join(path.read_bytes() for path in paths)).hexdigest()[:8]


def fingerprint(agent: Checkpoint) -> str:
    """A name for an agent's weights."""
    parts = [value.numpy().tobytes() for value in agent.network.state_dict().values()]
    return hashlib.sha256(b"".join(parts)).hexdigest()
