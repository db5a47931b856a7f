"""Prose of a page: headings, sentences and link texts, without code, comments and pictures."""

import re
from collections.abc import Iterator

CODE = re.compile(r"^(`{3,}).*?^\1$|<!--.*?-->", re.DOTALL | re.MULTILINE)
SPAN = re.compile(r"(`+).+?\1")
LINK = re.compile(r"!?\[([^\]]*)\]\([^)]*\)")
ITEM = re.compile(r"\s*(?:[-*]|\d+\.) ")
END = re.compile(r"(?<=[.!?])[*_)\"]*\s+(?=[*_(\"]*[A-Z0-9])")


def lines(text: str) -> list[str]:
    """Return the lines of a page outside blocks of code."""
    return [line for line in CODE.sub("", text).splitlines() if not line.startswith("    ")]


def words(text: str) -> str:
    """Return the words of a text: code becomes ``CODE``, and a link its own text."""
    return SPAN.sub("CODE", LINK.sub(r"\1", text)).strip()


def headings(text: str) -> list[str]:
    """Return the headings of a page."""
    return [line.lstrip("# ") for line in lines(text) if re.match("#+ ", line)]


def links(text: str) -> list[str]:
    """Return the texts of the links of a page."""
    return [link[1] for link in LINK.finditer("\n".join(lines(text))) if not link[0].startswith("!")]


def cells(text: str) -> list[str]:
    """Return the cells of the tables of a page."""
    return [words(cell) for line in lines(text) if line.startswith("|") for cell in line.split("|")]


def paragraphs(text: str) -> Iterator[str]:
    """Yield the paragraphs and the items of lists of a page."""
    found: list[str] = []
    for line in [*lines(text), ""]:
        item = ITEM.match(line)
        if found and (item or not line.strip() or line[0] in "#|<>"):
            yield words(" ".join(found))
            found = []
        if line.strip() and line[0] not in "#|<":
            found.append(line[item.end() :] if item else line.strip("> "))


def sentences(text: str) -> list[str]:
    """Return the sentences of a page."""
    return [sentence for paragraph in paragraphs(text) for sentence in END.split(paragraph)]
