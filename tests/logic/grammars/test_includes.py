"""Includes of rule files: a grammar may include its own files and the shipped ones, each once."""

import asyncio
import itertools
import os
import re
import shutil
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import pytest

from tests.logic.language.test_mistakes import MISTAKES, linted
from tests.logic.workers import in_process
from tests.programs import PATIENCE
from vitruvius.logic import GrammarError, House
from vitruvius.logic.browser.watch.session import Rules, Session
from vitruvius.logic.errors import Unsatisfiable
from vitruvius.logic.grammar import SHIPPED, find

LP, PL = '#include "{}".', ":- include('{}')."

WRONG: dict[str, tuple[dict[str, str], str, str]] = {
    "a misspelt file": (
        {"a.lp": LP.format("home/furnitur.lp")},
        "a.lp:1:1",
        "did you mean home/furniture.lp?",
    ),
    "a misspelt grammar": (
        {"a.pl": PL.format("hom/lengths.pl")},
        "a.pl:1:1",
        "did you mean home/lengths.pl?",
    ),
    "no file": ({"a.lp": LP.format("x.lp")}, "a.lp:1:1", "no file x.lp: neither beside this file nor"),
    "a folder": ({"a.lp": LP.format("parts"), "parts/b.lp": ""}, "a.lp:1:1", "there is no file parts"),
    "a folder's name": ({"a.lp": LP.format("home"), "b.lp/c.lp": ""}, "a.lp:1:1", "there is no file home"),
    "no name": ({"a.lp": "% one\n\n   " + LP.format("")}, "a.lp:3:4", "there is no file"),
    "a name without end": ({"a.lp": LP.format("x" * 5000 + ".lp")}, "a.lp:1:1", "there is no file"),
    "itself": ({"a.lp": LP.format("a.lp")}, "a.lp:1:1", "a circle: a.lp includes itself"),
    "a circle": (
        {"a.lp": LP.format("parts/b.lp"), "parts/b.lp": LP.format("c.lp"), "parts/c.lp": LP.format("b.lp")},
        "parts/c.lp:1:1",
        "a circle: parts/b.lp includes itself by way of parts/c.lp",
    ),
    "a circle of lengths": (
        {"a.pl": PL.format("parts/b.pl"), "parts/b.pl": PL.format("b.pl")},
        "parts/b.pl:1:1",
        "a circle: parts/b.pl includes itself",
    ),
    "a file twice": (
        {"a.lp": LP.format("home/furniture.lp") + "\n" + LP.format("home/furniture.lp")},
        "a.lp:2:1",
        "home/furniture.lp is included already, at a.lp:1: leave one of them out",
    ),
    "a file by two files": (
        {"a.pl": PL.format("home/lengths.pl"), "b.pl": "\n" + PL.format("apartments/sizes.pl")},
        "apartments/sizes.pl:2:1",
        "home/lengths.pl is included already, at a.pl:1",
    ),
    "a file of the folder": (
        {"a.lp": LP.format("rooms.lp")},
        "a.lp:1:1",
        "rooms.lp is read anyway, as all files of the grammar's folder are: leave this out",
    ),
    "a file above": (
        {"a.lp": LP.format("../mine/rooms.lp")},
        "a.lp:1:1",
        "lies outside: an include names a file",
    ),
    "a file of the system": ({"a.lp": LP.format("/etc/passwd")}, "a.lp:1:1", "/etc/passwd lies outside"),
    "a way out of a shipped grammar": ({"a.pl": PL.format("home/../../x.pl")}, "a.pl:1:1", "lies outside"),
    "the core": ({"a.lp": LP.format("../rules/core.lp")}, "a.lp:1:1", "lies outside"),
    "lengths among rules": (
        {"a.lp": LP.format("home/sizes.pl")},
        "a.lp:1:1",
        "a .lp file includes only .lp files",
    ),
    "rules among lengths": (
        {"a.pl": PL.format("home/rooms.lp")},
        "a.pl:1:1",
        "a .pl file includes only .pl files",
    ),
    "a name that moves a cursor": ({"a.lp": LP.format("\x1b[2J.lp")}, "a.lp:1:1", r"no file \x1b[2J.lp"),
}


def grammar(folder: Path, files: dict[str, str]) -> Path:
    """Write a copy of the smallest grammar, with more files."""
    shutil.copytree(SHIPPED / "paper", folder)
    for name, text in files.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text)
    return folder


@pytest.mark.parametrize("title", WRONG)
def test_an_include_that_is_wrong_is_one_error_at_its_place(title: str, tmp_path: Path) -> None:
    files, place, says = WRONG[title]
    folder = grammar(tmp_path / "mine", files)
    with pytest.raises(GrammarError) as caught:
        find(folder)
    file, line, column = place.split(":")
    where = (folder if (folder / file).exists() else SHIPPED) / file
    error = caught.value
    assert (str(error.file), error.line, error.column) == (str(where), int(line), int(column))
    assert says in error.message
    assert error.message.isprintable()


def test_a_link_leads_no_include_out_of_the_folder(tmp_path: Path) -> None:
    """The file behind the link is not even opened, so that its size stays secret."""
    (tmp_path / "secret.lp").write_text("secret(1).")
    for number, (link, leads) in enumerate((("parts/b.lp", "secret.lp"), ("parts", "."), ("b", "."))):
        name = link if link.endswith(".lp") else f"{link}/secret.lp"
        folder = grammar(tmp_path / str(number), {"a.lp": LP.format(name)})
        (folder / link).parent.mkdir(exist_ok=True)
        (folder / link).symlink_to(tmp_path / leads)
        with pytest.raises(GrammarError, match="lies outside"):
            find(folder)
    inside = grammar(tmp_path / "inside", {"a.lp": LP.format("parts/b.lp"), "more/c.lp": "c(1)."})
    (inside / "parts").mkdir()
    (inside / "parts" / "b.lp").symlink_to(inside / "more" / "c.lp")
    assert inside.resolve() / "more" / "c.lp" in find(inside).own


ELSEWHERE = {
    "below a rule": ("a.lp", f"basic(hall).\n{LP}", 2),
    "in a comment below a rule": ("a.lp", f"basic(hall).\n% {LP}", 2),
    "below a comment of several lines": ("a.lp", f"%* one\ntwo *%\n{LP}", 3),
    "within a comment of several lines": ("a.lp", f"%*\n{LP}\n*%", 2),
    "two on a line": ("a.lp", f"{LP} {LP}", 1),
    "a rule after it": ("a.lp", f"{LP} basic(hall).", 1),
    "no full stop": ("a.lp", LP[:-1], 1),
    "in angle brackets": ("a.lp", "#include <home/furniture.lp>.", 1),
    "below a clause": ("a.pl", f"room_gap(1.0).\n{PL}", 2),
    "below a comment of several lines of Prolog": ("a.pl", f"/* one\ntwo */\n{PL}", 3),
    "with a comment in it": ("a.pl", ":- /* */ include('home/lengths.pl').", 1),
    "a path that is no text": ("a.pl", ":- include(home/lengths).", 1),
    "as SWI-Prolog loads": ("a.pl", ":- consult('home/lengths.pl').", 1),
    "as a list": ("a.pl", ":- ['home/lengths.pl'].", 1),
}


def test_an_include_that_stands_elsewhere_is_refused_where_it_stands(
    solver: ProcessPoolExecutor, tmp_path: Path
) -> None:
    for suffix, path in ((".lp", "home/arrangement.lp"), (".pl", "home/lengths.pl")):
        cases = [
            (text.replace("{}", path), line) for name, text, line in ELSEWHERE.values() if suffix in name
        ]
        # No file is a copy of another one.
        others = ["".join(f"\nother{letter}({n})." for letter in "abcd") for n in range(len(cases))]
        files = {f"{n}{suffix}": text + others[n] for n, (text, _) in enumerate(cases)}
        folder = grammar(tmp_path / suffix, files)
        found, _ = solver.submit(linted, folder).result(timeout=PATIENCE)
        why = "an include must be at the top of its file, alone on its line"
        said = {(each.file, each.line) for each in found if why in each.text}
        assert said == {(str(folder / f"{n}{suffix}"), line) for n, (_, line) in enumerate(cases)}


def cut(folder: Path, whole: Path) -> Path:
    """Write the same rules with each file in a subfolder, included by the first file of its kind."""
    (folder / "parts" / "more").mkdir(parents=True)
    for suffix, include in ((".lp", LP), (".pl", PL)):
        first, *others = sorted(whole.glob(f"*{suffix}"))
        lines = [f"%  {suffix} files of others"]
        for number, file in enumerate(others):
            place = Path("parts", *["more"] * (number % 2), file.name)
            shutil.copy(file, folder / place)
            lines += ["", include.format(place) + " % one more"]
        (folder / first.name).write_text("\n".join([*lines, first.read_text()]))
    return folder


def unfurnished(house: House) -> dict[str, object]:
    """Return the record of a house without its provenance."""
    return {name: value for name, value in house.to_dict().items() if name != "provenance"}


@pytest.mark.parametrize(("name", "rooms"), [("family", 3), ("clinic", 2)])
def test_rules_cut_into_files_that_include_each_other_make_the_same_houses(
    name: str, rooms: int, tmp_path: Path
) -> None:
    parts = cut(tmp_path / name, SHIPPED / name)
    assert len(list(parts.glob("*.[lp][lp]"))) == 2
    whole, other = (
        [unfurnished(house) for house in in_process.generate(rooms, grammar=each, seed=1, count=3)]
        for each in (name, parts)
    )
    assert whole == other


def test_a_proof_names_the_rule_of_an_included_file_by_its_place(tmp_path: Path) -> None:
    parts = cut(tmp_path / "mine", SHIPPED / "family")
    for each, top in (("family", SHIPPED / "family"), (parts, parts)):
        with pytest.raises(Unsatisfiable) as caught:
            next(in_process.generate(3, grammar=each, types={"bathroom": 3}))
        (found,) = (reason for reason in caught.value.reasons if "basic(T)" in reason.text)
        file = Path(str(found.file))
        assert top in file.parents
        assert file.read_text().split("\n")[(found.line or 0) - 1] == found.text
    assert file.parent.name in ("parts", "more")


SAMPLE = sorted(
    title
    for title, each in MISTAKES.items()
    if each.grammar == "family" and not re.search(r" line |p:\d", each.says)
)[::15]


def test_mistakes_below_an_include_of_an_included_file_are_found_at_their_places(
    solver: ProcessPoolExecutor, tmp_path: Path
) -> None:
    for number, title in enumerate(SAMPLE):
        mistake = MISTAKES[title]
        folder = Path(shutil.copytree(SHIPPED / "family", tmp_path / str(number)))
        file = folder / mistake.file
        include = LP if file.suffix == ".lp" else PL
        moved, empty = folder / "parts" / file.name, folder / "parts" / f"empty{file.suffix}"
        moved.parent.mkdir()
        empty.write_text("% nothing\n")
        before, after = (
            file.read_text().split(mistake.old) if mistake.old else (f"{file.read_text()}\n", "\n")
        )
        before = f"\n{include.format(empty.name)}\n{before}"
        moved.write_text(before + mistake.new + after)
        file.write_text(include.format(f"parts/{file.name}"))
        findings, _ = solver.submit(linted, folder).result(timeout=PATIENCE)
        found = [(each.file, each.line, each.column) for each in findings if mistake.says in each.text]
        lines = (before + mistake.new[: mistake.new.index(mistake.at)]).split("\n")
        assert found[:1] == [(str(moved), len(lines), len(lines[-1]) + 1)], (title, findings)


def test_a_shipped_file_that_a_grammar_includes_may_name_what_the_grammar_lacks(
    solver: ProcessPoolExecutor, tmp_path: Path
) -> None:
    """The arrangement of ``home`` asks where one dines: ``taken(dining)``."""
    folder = Path(shutil.copytree(SHIPPED / "home", tmp_path / "mine"))
    for file in folder.glob("*.[lp][lp]"):
        own = re.sub(r"^one_room\(.*$", "", file.read_text(), flags=re.MULTILINE)
        file.write_text(re.sub(r"\bdining\b", "mess", own))
    (folder / "arrangement.lp").write_text(LP.format("home/arrangement.lp"))
    findings, _ = solver.submit(linted, folder).result(timeout=PATIENCE)
    assert findings == []


def test_a_row_of_many_includes_is_read_once_and_belongs_to_the_hash(tmp_path: Path) -> None:
    many = 1100  # more than Python's stack is deep
    files = {f"parts/{n}.lp": LP.format(f"{n + 1}.lp") for n in range(many)} | {f"parts/{many}.lp": "% end"}
    folder = grammar(tmp_path / "mine", files | {"a.lp": LP.format("parts/0.lp")})
    before = find(folder)
    assert len(before.own) == len(find("paper").own) + many + 2
    assert before.own.index(folder / f"parts/{many}.lp") < before.own.index(folder / "a.lp")
    (folder / f"parts/{many}.lp").write_text("% END")
    assert find(folder).hash != before.hash


def test_the_bytes_of_included_files_count(tmp_path: Path) -> None:
    folder = grammar(tmp_path / "mine", {"a.pl": PL.format("parts/b.pl"), "parts/b.pl": ""})
    os.truncate(folder / "parts" / "b.pl", 5 << 30)
    with pytest.raises(GrammarError, match="holds more than 16 MiB: it is not read") as caught:
        find(folder)
    assert caught.value.file == folder / "parts" / "b.pl"


def test_shipped_grammars_share_no_file_by_copy() -> None:
    texts: dict[str, Path] = {}
    for file in sorted(SHIPPED.glob("*/*.[lp][lp]")):
        rules = "\n".join(line for line in file.read_text().split("\n") if line and line[0] != "%")
        assert rules not in texts, (file, texts.get(rules))
        texts[rules] = file


def test_what_contradicts_an_included_file_names_it_with_its_folder(
    solver: ProcessPoolExecutor, tmp_path: Path
) -> None:
    folder = grammar(
        tmp_path / "mine", {"parts/sizes.pl": "room_gap(1.0).", "a.pl": PL.format("parts/sizes.pl")}
    )
    ((found, *_), _) = solver.submit(linted, folder).result(timeout=PATIENCE)
    assert (found.file, found.line) == (str(folder / "sizes.pl"), 4)
    assert "the first is in line 1 of parts/sizes.pl" in found.text


def test_a_file_has_one_name_in_whatever_is_said_of_its_lengths(
    solver: ProcessPoolExecutor, tmp_path: Path
) -> None:
    """The name is the path in the grammar's folder, for a file at the top and one two folders below."""
    clauses = {"wide(W) :- { W >= 9.0 }.": "W >= 9.0", "wide(W) :- wide(W).": "wide/1 calls itself"}
    hall = "\nroom_size(hall, W, D) :- wide(W), { W =< 5.0, D >= 2.0, D =< 3.0 }."
    for number, ((clause, said), (top, below)) in enumerate(
        itertools.product(clauses.items(), itertools.permutations([0, 1]))
    ):
        texts = [clause, hall][top], [clause, hall][below]
        names = "a.pl", "parts/more/b.pl"
        folder = grammar(
            tmp_path / str(number),
            {"a.pl": f"{PL.format('parts/b.pl')} % more\n{texts[0]}", "parts/b.pl": PL.format("more/b.pl")},
        )
        (folder / "parts" / "more").mkdir()
        (folder / names[1]).write_text(f"\n{texts[1]}")
        sizes = folder / "sizes.pl"
        sizes.write_text(re.sub(r"room_size\(hall.*\n", "", sizes.read_text()))
        found, _ = solver.submit(linted, folder).result(timeout=PATIENCE)
        name = names[texts.index(clause)]
        line = (folder / name).read_text().split("\n").index(clause) + 1
        assert any(said in each.text and f"line {line} of {name}" in each.text for each in found), found


@pytest.mark.parametrize("own", ["a", "z"])  # before and after the file that includes
def test_what_contradicts_a_file_of_a_shipped_grammar_is_to_be_mended_in_ones_own(
    own: str, solver: ProcessPoolExecutor, tmp_path: Path
) -> None:
    for rule, suffix, place in (
        ("may(bedroom,bed,3,4).", ".lp", "at family/furniture.lp:3:1"),
        ("room_gap(9.0).", ".pl", "in line 7 of family/sizes.pl"),
    ):
        folder = tmp_path / suffix
        folder.mkdir()
        names = ("arrangement", "furniture", "rooms")
        (folder / "m.lp").write_text("".join(LP.format(f"family/{name}.lp") + "\n" for name in names))
        (folder / "m.pl").write_text(PL.format("family/sizes.pl"))
        (folder / f"{own}{suffix}").write_text(f"\n{rule}")
        ((found,), _) = solver.submit(linted, folder).result(timeout=PATIENCE)
        assert (found.file, found.line) == (str(folder / f"{own}{suffix}"), 2)
        assert place in found.text


def test_a_copy_of_a_grammar_that_includes_another_one_is_read_wherever_it_lies(tmp_path: Path) -> None:
    copy = Path(shutil.copytree(SHIPPED / "apartments", tmp_path / "deep" / "flats"))
    assert find(copy).hash == find("apartments").hash
    assert {find(copy).name_of(file) for file in find(copy).own} == {
        "home/furniture.lp",
        "home/arrangement.lp",
        "rooms.lp",
    }


def test_watch_notices_that_an_included_file_changes_goes_and_comes_back(tmp_path: Path) -> None:
    folder = grammar(
        tmp_path / "mine", {"a.lp": LP.format("parts/b.lp") + "\n", "parts/b.lp": "% one\n"}
    ).resolve()
    included = folder / "parts" / "b.lp"

    def shown(rules: Rules) -> str | None:
        return {file["name"]: file["text"] for file in rules.files}.get("parts/b.lp")

    async def watched() -> list[str | None]:
        session = Session(folder, "mine", PATIENCE)
        session.begin()
        seen = []
        versions = session.versions()
        for act in (
            lambda: included.write_text("% two\n"),
            included.unlink,
            lambda: included.write_text("% three\n"),
        ):
            seen.append(shown(await asyncio.wait_for(anext(versions), PATIENCE)))
            act()
        seen.append(shown(await asyncio.wait_for(anext(versions), PATIENCE)))
        session.end()
        return seen

    assert asyncio.run(watched()) == ["% one\n", "% two\n", None, "% three\n"]
