"""Plain English of pages: the rules of CONTRIBUTING.md."""

import re

import pytest

from tests.docs.prose import cells, headings, links, paragraphs, sentences
from tests.docs.reader import ROOT

pytestmark = pytest.mark.second_part("all commands of pages are run, and the site is opened in a browser")

MAX_WORDS = 35
"""Largest number of words of a sentence."""

OPENING = re.compile(r"(What|Whether|Where|Which|Who|How|Of|That|If)\b")
PAGES = [ROOT / f"{name}.md" for name in ("README", "ARCHITECTURE", "CONTRIBUTING", "SECURITY")]
PAGES += sorted((ROOT / "docs").rglob("*.md"))
NAMES = [page.relative_to(ROOT).as_posix() for page in PAGES]


def banned() -> list[str]:
    """Return the words in the first column of CONTRIBUTING.md's table."""
    _, _, table = (ROOT / "CONTRIBUTING.md").read_text().partition("| instead of | write |\n|---|---|\n")
    rows = table.partition("\n\n")[0].splitlines()
    return [word for row in rows for word in row.split("|")[1].strip().split(", ")]


BANNED = re.compile(rf"\b({'|'.join(banned())})\b", re.IGNORECASE)


@pytest.mark.parametrize("name", NAMES)
def test_a_page_reads_as_plain_english(name: str) -> None:
    text = (ROOT / name).read_text()
    prose = text.partition("| instead of | write |")[0] if name == "CONTRIBUTING.md" else text
    assert [heading for heading in headings(text) if OPENING.match(heading)] == []
    assert [sentence for sentence in sentences(text) if len(sentence.split()) > MAX_WORDS] == []
    assert [link for link in links(text) if link.endswith(".md")] == []
    assert [words for words in [*paragraphs(prose), *cells(prose)] if BANNED.search(words)] == []


def test_the_list_of_banned_words_is_in_the_page_for_contributors() -> None:
    assert "learnt" in banned()
    assert BANNED.search("The policy was measured in houses that it had never seen.")


def test_a_sentence_ends_at_its_full_stop_and_code_is_one_word() -> None:
    assert sentences("One `a b c` two. Three\nfour.\n\n- Five ([Six](six.md)).\n") == [
        "One CODE two.",
        "Three four.",
        "Five (Six).",
    ]
    assert not [*paragraphs("```sh\nlearnt\n```\n\n    learnt\n")]
    assert (headings("## If so\n"), links("[a.md](a.md)")) == (["If so"], ["a.md"])
