"""Reader who follows a page: runs its commands, saves its files, and compares its output.

- ``sh``: commands, one after the other, each of which must succeed.
- ``text`` right after it: their output, where ``...`` stands for anything. Then they may fail.
- A block whose first line is a comment with a path is saved there. Other ``python`` blocks run, sharing
  names.
"""

import io
import re
import runpy
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import NamedTuple

import pytest

from vitruvius.cli import main

ROOT = Path(__file__).parents[2]
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
FILE = re.compile(r"[#%] ([\w/.-]+\.(?:py|lp|pl|json|toml))$")
RUN = f"""#!/bin/sh
export PYTHONPATH={ROOT}${{PYTHONPATH:+:$PYTHONPATH}}
case $1 in python) shift; exec {sys.executable} "$@" ;; *) exec {sys.executable} -Pm vitruvius.cli "$@";; esac
"""
"""Replacement of ``./run`` if a shell is needed: pipes, redirections, variables."""


PICTURE = re.compile(r"^<!-- from (\S+) -->\n!\[[^]]*\]\((\S+)\)", re.MULTILINE)
"""Picture, and the reader's file of which it is a copy."""


class Block(NamedTuple):
    """Block of code of a page."""

    language: str
    text: str
    shown: str | None
    """Output that the page shows."""
    line: int

    @property
    def file(self) -> Path | None:
        """Path where the page says to save the block."""
        named = FILE.match(self.text.partition("\n")[0])
        return Path(named[1]) if named else None


def blocks(text: str) -> Iterator[Block]:
    """Yield the blocks of a page, in order, each with the output that is shown right after it."""
    found = list(BLOCK.finditer(text))
    for block, after in zip(found, [*found[1:], None], strict=False):
        shows = after and after[1] == "text" and not text[block.end() : after.start()].strip()
        line = text.count("\n", 0, block.start()) + 1
        yield Block(block[1], block[2], after[2] if after and shows else None, line)


def pictures(page: Path) -> dict[Path, Path]:
    """Return the pictures of a page, by the reader's files of which they are copies."""
    return {Path(file): page.parent / picture for file, picture in PICTURE.findall(page.read_text())}


def commands(text: str) -> list[str]:
    """Return the commands of a shell block, without comments; a command over several lines is one."""
    lines = text.replace("\\\n", " ").splitlines()
    return [line for line in (re.sub(r"(^|\s+)#( .*)?$", "", line) for line in lines) if line]


class Reader:
    """Reader that follows a page in a folder that looks like a checkout."""

    def __init__(self, folder: Path, patch: pytest.MonkeyPatch) -> None:
        """Begin in an empty folder."""
        self.folder, self.names = folder, {"__name__": "__main__"}
        for name in ("vitruvius", "logic", "agent", "examples", "benchmarks"):
            (folder / name).symlink_to(ROOT / name)
        (folder / "run").write_text(RUN)
        (folder / "run").chmod(0o755)
        patch.chdir(folder)
        patch.setattr(sys, "path", [*sys.path, str(folder)])  # last: its links lead to loaded modules

    def follow(self, page: Path) -> None:
        """Follow a page; fail with the line of the page that does not hold."""
        for block in blocks(page.read_text()):
            try:
                code, said = self.do(block)
            except Exception as error:
                raise AssertionError(f"{page.name}:{block.line}: {error}") from error
            if block.shown is None:
                assert not code, f"{page.name}:{block.line}: exit code {code}\n{said}"
            else:
                assert self.matches(block.shown, said), f"{page.name}:{block.line}: it says\n{said}"

    def do(self, block: Block) -> tuple[int, str]:
        """Follow a block; return its largest exit code, and its output."""
        if block.file:
            block.file.parent.mkdir(parents=True, exist_ok=True)
            block.file.write_text(block.text)
        elif block.language == "sh":
            ended = [self.run(command) for command in commands(block.text)]
            return max(code for code, _ in ended), "".join(said for _, said in ended)
        elif block.language == "python":
            return self.python(block.text)
        return 0, ""

    def run(self, command: str) -> tuple[int, str]:
        """Run a command; ours runs in this process, so that torch loads once, unless it needs a shell."""
        program, *words = shlex.split(command.removeprefix("PYTHONPATH=. "))  # it is in the path
        if program != "./run" or set("|><&;") & set(command):
            ended = subprocess.run(command, shell=True, capture_output=True, text=True, check=False)
            return ended.returncode, ended.stdout + ended.stderr
        said = io.StringIO()
        with redirect_stdout(said), redirect_stderr(said), pytest.MonkeyPatch.context() as patch:
            try:
                if words[0] == "python":
                    patch.setattr(sys, "argv", words[1:])
                    runpy.run_path(words[1], run_name="__main__")
                else:
                    main(words)
            except SystemExit as end:
                return int(end.code or 0), said.getvalue()
        return 0, said.getvalue()

    def python(self, text: str) -> tuple[int, str]:
        """Run Python with the names of the blocks before it."""
        said = io.StringIO()
        with redirect_stdout(said):
            exec(compile(text, "<page>", "exec"), self.names)
        return 0, said.getvalue()

    def matches(self, shown: str, said: str) -> bool:
        """Return True if a command's output matches the page's, without our paths and line endings."""
        said = said.replace(f"{ROOT}/", "").replace(f"{self.folder}/", "")
        lines = "\n".join(line.rstrip() for line in said.strip().splitlines())
        pattern = ".*".join(map(re.escape, shown.strip().split("...")))
        return re.fullmatch(pattern, lines, re.DOTALL) is not None


def draw_again() -> None:
    """Replace the pictures of all pages by those that their commands make now."""
    for page in sorted((ROOT / "docs").rglob("*.md")):
        if pictures(page):
            with tempfile.TemporaryDirectory() as name, pytest.MonkeyPatch.context() as patch:
                Reader(Path(name), patch).follow(page)
                for file, picture in pictures(page).items():
                    shutil.copy(file, picture)


if __name__ == "__main__":
    draw_again()
