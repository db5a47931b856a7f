"""Check of derivations against the rules in files."""

from collections.abc import Iterable
from pathlib import Path

from vitruvius.logic.why.answer import Derivation


def require_whole(nodes: Iterable[Derivation], target: str) -> None:
    """Check that each atom is derived, by a rule that is at its stated place."""
    found = list(nodes)
    derived = {node.atom for node in found if node.rule}
    for node in found:
        assert node.atom in derived, (target, node.atom)
        if node.rule:
            text = Path(node.rule.file or "").read_text().split("\n")[(node.rule.line or 0) - 1]
            assert text[(node.rule.column or 0) - 1 :].startswith(node.rule.text.split()[0])
