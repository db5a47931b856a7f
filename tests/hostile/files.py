"""Folders of rules with links, pipes and devices among their files, odd names of files, and encodings."""

import os
import shutil
import socket
from collections.abc import Callable
from pathlib import Path

from tests.hostile.case import ACCEPTED, HARMLESS, REFUSED, Case, Yard, grammar, titled
from vitruvius.logic.grammar import SHIPPED


def _link(name: str, target: str) -> Callable[[Yard], Path]:
    def make(yard: Yard) -> Path:
        folder = grammar(yard)
        (folder / name).unlink(missing_ok=True)
        (folder / name).symlink_to(yard.filled(target))
        return folder

    return make


def _made(name: str, make: Callable[[Path], object]) -> Callable[[Yard], Path]:
    def made(yard: Yard) -> Path:
        folder = grammar(yard)
        make(folder / name)
        return folder

    return made


def _sparse(path: Path) -> None:
    path.touch()
    os.truncate(path, 5 << 30)


def _server(path: Path) -> None:
    old = os.getcwd()
    os.chdir(path.parent)  # a socket's path is at most 108 bytes
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(path.name)
    os.chdir(old)


def _unreadable(path: Path) -> None:
    path.write_text("type(cellar).")
    path.chmod(0)


def _folder_named(name: str) -> Callable[[Yard], Path]:
    def make(yard: Yard) -> Path:
        folder = yard.input / yard.filled(name).replace("/", "")
        shutil.copytree(SHIPPED / "family", folder)
        return folder

    return make


def _file_named(name: str) -> Callable[[Yard], Path]:
    return lambda yard: _with(yard, yard.filled(name).replace("/", ""))


def _with(yard: Yard, name: str) -> Path:
    folder = grammar(yard)
    shutil.move(folder / ("rooms.lp" if name.endswith(".lp") else "sizes.pl"), folder / name)
    return folder


def _many(yard: Yard) -> Path:
    folder = grammar(yard)
    for number in range(3000):
        (folder / f"f{number}.lp").write_text("%\n")
    return folder


EVIL = ":- shell('TOUCH').\n"

ODD_FILES: dict[str, tuple[Callable[[Yard], Path], tuple[str, ...]]] = {
    "a link to a secret for rooms.lp": (_link("rooms.lp", "SECRET"), (REFUSED,)),
    "a link to a secret for sizes.pl": (_link("sizes.pl", "SECRET"), (REFUSED,)),
    "a link to a secret, more.lp": (_link("more.lp", "SECRET"), (REFUSED,)),
    "a link to a password file": (_link("more.lp", "/etc/passwd"), (REFUSED,)),
    "a link to evil rules": (_link("more.pl", "EVIL"), (REFUSED,)),
    "a link to zeros, .lp": (_link("more.lp", "/dev/zero"), HARMLESS),
    "a link to zeros, .pl": (_link("more.pl", "/dev/zero"), HARMLESS),
    "a link to standard input": (_link("more.pl", "/dev/stdin"), HARMLESS),
    "a link to nothing": (_link("more.lp", "/nowhere/more.lp"), HARMLESS),
    "a link to itself": (_link("more.pl", "more.pl"), HARMLESS),
    "a link to the folder": (_link("more.lp", "."), HARMLESS),
    "a link to a process's memory": (_link("more.lp", "/proc/self/mem"), (REFUSED,)),
    "a link to a process's environment": (_link("more.lp", "/proc/self/environ"), (REFUSED,)),
    "a pipe, .lp": (_made("more.lp", os.mkfifo), HARMLESS),
    "a pipe, .pl": (_made("more.pl", os.mkfifo), HARMLESS),
    "a socket": (_made("more.pl", _server), HARMLESS),
    "a folder named as a file, .lp": (_made("more.lp", Path.mkdir), HARMLESS),
    "a folder named as a file, .pl": (_made("more.pl", Path.mkdir), HARMLESS),
    "5 GB of nothing, .lp": (_made("more.lp", _sparse), (REFUSED,)),
    "5 GB of nothing, .pl": (_made("more.pl", _sparse), (REFUSED,)),
    "a file that may not be read": (_made("more.lp", _unreadable), HARMLESS),
    "3000 files": (_many, HARMLESS),
    "no folder": (lambda yard: yard.input / "mine", (REFUSED,)),
    "a file for a folder": (lambda yard: yard.secret, (REFUSED,)),
    "an empty folder": (lambda yard: yard.input, (REFUSED,)),
    "a name of a shipped grammar in a path": (lambda yard: yard.input / "../input/family", (REFUSED,)),
    **{
        f"{name} beside the rules": (lambda yard, name=name: grammar(yard, **{name: EVIL}), HARMLESS)
        for name in (
            *(
                ".hidden.pl",
                "init.pl~",
                "sizes.qlf",
                "swipl.rc",
                ".swiplrc",
                "prolog.ini",
                "script.lua",
                "x.so",
            ),
            *("clingo.py", "conftest.py", "__init__.py", "sitecustomize.py", "promises.json", "looks.json"),
        )
    },
    **{
        f"{name} among the rules": (lambda yard, name=name: grammar(yard, **{name: EVIL}), (REFUSED,))
        for name in (
            "core.pl",
            "lists.pl",
            "clpr.pl",
            "INDEX.pl",
            "MKINDEX.pl",
            "init.pl",
            "user.pl",
            "-g.pl",
        )
    },
}

FOLDERS = (
    "it's",
    "a'), shell('TOUCH'), b('",
    'a"b',
    "a\\",
    "a\\'b",
    "a\nb c",
    "a\n:- shell('TOUCH').\n",
    "\x1b[2J",
    "\u202eeman",
    "b\u0435d",
    "a b",
    "-g halt",
    "--help",
    "$(TOUCH)",
    "`TOUCH`",
    "%s%n",
    "a~",
    "~",
    "$HOME",
    "a*?[b]",
    "mine.pl",
    "a:1:1: error",
    "x" * 200,
)
"""Names of folders that SWI-Prolog and clingo get."""

FILE_NAMES = (
    "it's.pl",
    "a'), shell('TOUCH'), b('.pl",
    "a\\.pl",
    "a\nb.pl",
    "\x1b[2J.pl",
    "-g halt.pl",
    "%s%n.lp",
    'a"b.lp',
    "a\nb.lp",
    "-c rooms=9.lp",
    "--outf=2.lp",
    "a\\\\.lp",
    "b\u0435d.lp",
    "\u202elp.lp",
)

ENCODINGS: dict[str, tuple[str, bytes, tuple[str, ...]]] = {
    "zeros in .lp": ("rooms", b"% \0\0\0 \ntype(cellar\0).", (REFUSED,)),
    "zeros in .pl": ("sizes", b"% \0\0\0 \nroom_gap(0.6\0).", (REFUSED,)),
    "zeros in comments": ("sizes", b"% \0\0\0", HARMLESS),
    "a byte order mark in .lp": ("more.lp", b"\xef\xbb\xbf% rules", HARMLESS),
    "a byte order mark in .pl": ("more.pl", b"\xef\xbb\xbf% rules", HARMLESS),
    "UTF-16, .lp": ("more.lp", "% rules".encode("utf-16"), (REFUSED,)),
    "UTF-16, .pl": ("more.pl", "% rules".encode("utf-16"), HARMLESS),
    "bytes that are no UTF-8, .lp": ("more.lp", b"% \xff\xfe", (REFUSED,)),
    "bytes that are no UTF-8, .pl": ("more.pl", b"% \xff\xfe", HARMLESS),
    "a surrogate, .lp": ("more.lp", b"% \xed\xa0\x80", (REFUSED,)),
    "a surrogate, .pl": ("more.pl", b"% \xed\xa0\x80", HARMLESS),
    "a long form of a letter": ("more.lp", b"% \xc0\xaf", (REFUSED,)),
    "letters beyond Unicode": ("more.lp", b"% \xf7\xbf\xbf\xbf", (REFUSED,)),
    "letters from right to left": ("sizes", "% \u202e .)6.0(pag_moor\u202c".encode(), HARMLESS),
    "rules from right to left": ("sizes", "a\u202e :- b. \u202c".encode(), (REFUSED,)),
    "letters that look alike": ("sizes", "r\u043e\u043em_gap(0.6).".encode(), (REFUSED,)),
    "letters that look alike, .lp": ("rooms", "typ\u0435(cellar).".encode(), (REFUSED,)),
    "letters of no width": ("sizes", "room_\u200bgap(0.6).".encode(), (REFUSED,)),
    "wide brackets": ("sizes", "room_gap\uff080.6\uff09.".encode(), (REFUSED,)),
    "blanks that do not break": ("sizes", "room_gap(0.6)\u00a0.".encode(), HARMLESS),
    "Windows' line ends": ("sizes", b"% a\r\n% b\r\n", HARMLESS),
    "old line ends": ("sizes", b"% a\r:- shell('x').\r", HARMLESS),
    "a terminal's escapes in a comment": ("sizes", b"% \x1b[2J", HARMLESS),
    "a terminal's escapes in a name": ("sizes", b"'\x1b[2J'(1).", (REFUSED,)),
    "a terminal's escapes in a rule": ("rooms", b'x("\x1b[2J") :- y.', (REFUSED,)),
    "escapes in a quoted name": ("sizes", rb"'\x73\\x68\ell'(1).", (REFUSED,)),
    "a program": ("more.pl", b"\x7fELF\x02\x01\x01" + bytes(500), HARMLESS),
    "a zip file": ("more.lp", b"PK\x03\x04" + bytes(500), (REFUSED,)),
    "a rule that ends within a bracket": ("rooms", b":- not room(", (REFUSED,)),
    "a clause that ends within a bracket": ("sizes", b"room_gap(", (REFUSED,)),
    "a comment without an end": ("rooms", b"%* \n", (REFUSED,)),
    "one byte": ("more.pl", b"(", (REFUSED,)),
    "no byte": ("more.pl", b"", HARMLESS),
}

CASES = [
    *(Case("grammars: files", titled(title), make, answers) for title, (make, answers) in ODD_FILES.items()),
    *(Case("grammars: names of folders", titled(name), _folder_named(name), (ACCEPTED,)) for name in FOLDERS),
    *(Case("grammars: names of files", titled(name), _file_named(name), HARMLESS) for name in FILE_NAMES),
    *(
        Case(
            "grammars: letters",
            title,
            lambda yard, file=file, text=text: grammar(yard, **{file: text}),
            answers,
        )
        for title, (file, text, answers) in ENCODINGS.items()
    ),
]
