"""The reference page is what the rules' comments say, and complete. Its examples: test_recipes.py."""

from pathlib import Path

from logic.grammar import find, shipped
from logic.layout import CORE
from logic.reference import asp_entries, page, prolog_entries, recipes
from logic.vocabulary import words

ROOT = Path(__file__).parents[2]


def test_the_page_is_what_the_rule_files_say() -> None:
    assert (ROOT / "docs" / "rules.md").read_text() == page(), "./run rules > docs/rules.md"


def test_the_readme_names_the_page() -> None:
    assert "(docs/rules.md)" in (ROOT / "README.md").read_text()


def test_every_predicate_of_grammars_and_recipes_is_on_the_page_or_their_own() -> None:
    entries = [entry for entries in asp_entries().values() for entry in entries]
    documented = {(entry.name, len(entry.arguments)) for entry in entries}
    core = words([CORE])
    for files in [*(find(name).asp for name in shipped()), *(recipe.files[:1] for recipe in recipes())]:
        found = words(files)
        assert {*found.used, *found.derived} & {*core.used, *core.derived} <= documented, files


def test_every_predicate_has_an_example_that_uses_it() -> None:
    for entry in [*(entry for entries in asp_entries().values() for entry in entries), *prolog_entries()]:
        assert entry.name in entry.example, entry.name
