"""The reference page agrees with the rules' comments, and is complete.

For its examples see test_recipes.py.
"""

import re
from collections.abc import Iterable
from pathlib import Path

from vitruvius.logic.grammar import RULES, find, shipped
from vitruvius.logic.language.reference import asp_entries, page, prolog_entries, recipes

ROOT = Path(__file__).parents[3]


def test_the_page_is_what_the_rule_files_say() -> None:
    assert (ROOT / "docs" / "rules.md").read_text() == page(), "./run rules > docs/rules.md"


def test_the_readme_names_the_page() -> None:
    assert "(docs/rules.md)" in (ROOT / "README.md").read_text()


def predicates(files: Iterable[Path]) -> set[str]:
    """Return the names before a parenthesis, without comments."""
    code = "\n".join(re.sub("%.*", "", file.read_text()) for file in files)
    return set(re.findall(r"\b([a-z]\w*)\(", code))


def test_what_grammars_and_recipes_use_of_the_core_is_on_the_page() -> None:
    documented = {entry.name for entries in asp_entries().values() for entry in entries}
    for files in [*(find(name).own for name in shipped()), *(recipe.files[:1] for recipe in recipes())]:
        assert predicates(files) & predicates(RULES.rglob("*.lp")) <= documented, files


def test_the_index_names_every_predicate() -> None:
    index = page().partition("## Index by purpose")[2].partition("\n## ")[0]
    entries = [*(entry for entries in asp_entries().values() for entry in entries), *prolog_entries()]
    names = {f"{each.name}/{len(each.arguments)}" if each.arguments else each.name for each in entries}
    assert names == {*re.findall(r"`(\w+(?:/\d)?)`", index)} - {"outside"}


def test_every_predicate_has_an_example_that_uses_it() -> None:
    for entry in [*(entry for entries in asp_entries().values() for entry in entries), *prolog_entries()]:
        assert entry.name in entry.example, entry.name
