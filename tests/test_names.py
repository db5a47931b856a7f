"""Names in the code: one for each thing, and the field's terms."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

PARALLEL = {"Motion", "Relevance", "Sight"}
"""Classes with one name in both backends, which are read side by side."""

TERMS = {
    "lookout": "coverage",
    "seer": "truth",
    "toll": "cost",
    "haste": "viewpoint_cost",
    "seam": "overlap",
    "slant": "diagonal",
    "bend": "upper_bound",
    "brim": "lower_bound",
    "bare": "unfurnished",
}
"""Terms of the field, by the private word that each replaces."""

WRITTEN = {".py", ".lp", ".pl", ".js"}


def test_a_class_has_a_name_of_its_own_in_all_packages() -> None:
    """So a name means one thing to a reader, in every place."""
    where: dict[str, list[str]] = {}
    for package in ("logic", "sim", "agent", "benchmarks"):
        for path in sorted((ROOT / package).rglob("*.py")):
            for each in ast.parse(path.read_text()).body:
                if isinstance(each, ast.ClassDef):
                    where.setdefault(each.name, []).append(str(path.relative_to(ROOT)))
    twice = {name: paths for name, paths in where.items() if len(paths) > 1 and name not in PARALLEL}
    assert {name: paths for name, paths in twice.items() if {path[:5] for path in paths} != {"logic"}} == {}


@pytest.mark.parametrize("package", ["logic", "sim", "agent", "benchmarks", "vitruvius"])
def test_no_name_is_a_private_word(package: str) -> None:
    """The test covers identifiers and prose, also in rules and pages."""
    private = re.compile(rf"\b_*({'|'.join(TERMS)})s?\b", re.IGNORECASE)
    found = {
        str(path.relative_to(ROOT)): [f"{word}: {TERMS[word]}" for word in map(str.lower, said)]
        for path in sorted((ROOT / package).rglob("*.*"))
        if path.suffix in WRITTEN and (said := private.findall(path.read_text()))
    }
    assert found == {}
