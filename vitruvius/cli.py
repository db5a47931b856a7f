"""The ``vitruvius`` command: it gathers the commands, and the studies of a checkout.

A command is a dataclass whose fields are its options, with a method ``run``. The module of a command is
imported only when the command is used: generation needs no simulator, and help is fast.
"""

import contextlib
import io
import os
import pkgutil
import re
import sys
import tempfile
import traceback
from collections.abc import Collection, Sequence
from errno import EBADF
from typing import Any

from vitruvius import help, streams
from vitruvius.studies import study_table

COMMANDS = {
    "generate": ("vitruvius.commands.generate:Generate", "Make houses from rules."),
    "regenerate": (
        "vitruvius.commands.regenerate:Regenerate",
        "Regenerate rows of a dataset of houses and compare their hashes.",
    ),
    "check": (
        "vitruvius.commands.houses:Check",
        "Check houses by geometry, independently of the rules that made them.",
    ),
    "draw": ("vitruvius.commands.houses:Draw", "Draw plans of houses and a contact sheet."),
    "convert": (
        "vitruvius.commands.houses:Convert",
        "Write houses in the current format, or for another tool.",
    ),
    "info": (
        "vitruvius.commands.info:Info",
        "Describe a file or folder: houses, a grammar, an agent, a run.",
    ),
    "explain": (
        "vitruvius.commands.rules:Explain",
        "Explain why no house satisfies a request, or why a house is as it is.",
    ),
    "lint": (
        "vitruvius.commands.rules:Lint",
        "Find mistakes in rule files that clingo and Prolog do not report.",
    ),
    "rules": (
        "vitruvius.logic.language.reference:Rules",
        "Print the reference of the rule language, with recipes.",
    ),
    "watch": (
        "vitruvius.commands.watch:Watch",
        "Show houses of a grammar in a browser, redrawn at each save.",
    ),
    "playground": (
        "vitruvius.commands.playground:Playground",
        "Open a page that generates houses in the browser.",
    ),
    "train": ("vitruvius.commands.train:Train", "Train an agent in houses."),
    "evaluate": ("vitruvius.commands.evaluate:Evaluate", "Evaluate agents on held-out houses."),
    "export": ("vitruvius.commands.train:Export", "Write an agent's network as an ONNX file."),
    "play": ("vitruvius.commands.play:Play", "Drive the robot by the keyboard, and race an agent."),
    "record": ("vitruvius.commands.record:Record", "Film an agent in a house, with its rays and trail."),
    "report": ("vitruvius.commands.report:Report", "Write a run as one HTML file with playable episodes."),
    "demo": (
        "vitruvius.commands.demo:Demo",
        "Generate houses, train an agent on them and write a report, in minutes.",
    ),
    "bench": (
        "vitruvius.studies:study_table",
        "Run a study of a checkout: solve time, simulator speed, agents' scores.",
    ),
    "doctor": (
        "vitruvius.commands.doctor:Doctor",
        "Check what is installed, and print commands that install the rest.",
    ),
    "schema": (
        "vitruvius.answers.agents:Schema",
        "Print the JSON Schema of a house, or of answers of --json.",
    ),
    "completion": ("vitruvius.completion:Completion", "Print a completion script for your shell."),
}
"""Commands by name: class of the command, ``module:Class``, and its description. Groups begin at those of
``GROUPS``."""

GROUPS = {
    "generate": "Houses",
    "explain": "Rules",
    "train": "Learning",
    "play": "Seeing",
    "demo": "Studies",
    "doctor": "Setup, programs and shells",
}
"""Titles of the groups in help, by the first command of each."""

NO_MEMORY = re.compile(
    r"out of memory|(failed|can't|[Cc]annot) (to )?(allocate|map)|allocation .{0,99}failed"
)
"""Messages of the system, torch and Taichi if they get no memory."""

ABOUT = "Furnished houses from rules, simulated thousands at a time, explored by agents that plan and learn."

ENDINGS = """\
Exit codes: 0 done; 1 a check, lint or measurement says no; 2 wrong usage;
3 proved unsatisfiable; 4 a limit was reached; 5 a file is absent or wrong;
69 a program or library is missing; 70 a bug in Vitruvius; 130 Ctrl-C; 143 SIGTERM.
With --json a command prints one JSON object, errors included.
docs/command-line.md has all of it."""


def main(arguments: list[str] | None = None) -> None:
    """Run a command and exit with its code; errors are one line on stderr (see ``logic.errors``)."""
    if arguments is None:
        streams.read_utf8()
    streams.prepare()
    sys.exit(_exit_code(sys.argv[1:] if arguments is None else arguments))


def top(width: int | None = None) -> str:
    """Return the help of ``vitruvius``, as wide as the terminal or as given."""
    return help.of_table("vitruvius", ABOUT, COMMANDS, GROUPS, ENDINGS, width)


def studies(width: int | None = None) -> str:
    """Return the help of ``vitruvius bench``."""
    about = COMMANDS["bench"][1]
    return help.of_table("vitruvius bench", about, study_table(), study_table("GROUPS"), width=width)


def command_help(words: Sequence[str], arguments: Sequence[str] = (), width: int | None = None) -> str:
    """Return the help of a command, ``["generate"]`` or ``["bench", "generator"]``, with these arguments."""
    from vitruvius.options import options_of

    table = study_table() if words[0] == "bench" else COMMANDS
    kind = pkgutil.resolve_name(table[words[-1]][0])
    options = options_of(kind.like(arguments) if words[0] == "train" else kind)
    # PYTHONOPTIMIZE=2 removes docstrings: a dataclass has a list of its fields' types there.
    about = table[words[-1]][1] if sys.flags.optimize > 1 else kind.__doc__
    return help.of_command(f"vitruvius {' '.join(words)}", about, options, width)


def parse(arguments: list[str]) -> Any:
    """Return the command that the arguments ask for, or end the process with help.

    Raises ``RequestError`` for wrong arguments.
    """
    prog, table, words = "vitruvius", COMMANDS, list[str]()
    if arguments[0] == "bench":
        prog, table, words, arguments = "vitruvius bench", study_table(), ["bench"], arguments[1:]
        if arguments in ([], ["-h"], ["--help"]):
            _print_and_end(studies())
    from vitruvius.logic.errors import RequestError
    from vitruvius.options import options_of, require

    name, *rest = arguments
    if name not in table:
        raise RequestError(f"{prog}: {_no_command(prog, arguments, table)}")
    if "-h" in rest or "--help" in rest:
        _print_and_end(command_help([*words, name], rest))
    kind, prog = pkgutil.resolve_name(table[name][0]), f"{prog} {name}"
    like = kind.like(rest) if name == "train" else None  # its defaults come from a preset or a file
    require(prog, rest, options_of(like or kind))
    return _parsed(kind[type(like.learning)] if like else kind, like, prog, rest)


def _no_command(prog: str, arguments: Sequence[str], table: Collection[str]) -> str:
    """Return the message for a first word that is no command of the table."""
    from vitruvius.logic.spelling import closest, quoted, unknown

    name, *rest = arguments
    if name.startswith("-"):
        command = next((word for word in rest if word in table), "")
        others = [quoted(word) for word in arguments if word != command]
        first = (
            f": {' '.join([prog, command, *others])}"
            if command
            else f", as in {prog} {next(iter(table))} --help"
        )
        return f"{name} comes after a command{first}"
    if f"--{name}" == closest(name, [*table, "--version", "--help"]):
        return f"there is no command {name}: did you mean --{name}?"
    return unknown("command" if table is COMMANDS else "study", name, table)


def _parsed(kind: Any, like: Any, prog: str, arguments: list[str]) -> Any:
    """Return the command that tyro parses. Raises ``RequestError`` with tyro's message."""
    import tyro

    from vitruvius.logic.errors import RequestError

    said = io.StringIO()
    try:
        with contextlib.redirect_stderr(said):
            return tyro.cli(kind, prog=prog, args=arguments, **({"default": like} if like else {}))
    except SystemExit:
        words = re.sub(r"[╭╮╰╯│─]+", " ", said.getvalue().partition("─\n│ ──")[0].partition("For full")[0])
        words = " ".join(words.split()).removeprefix("Parsing error ")
        raise RequestError(f"{prog}: {words}: see {prog} --help") from None


def _print_and_end(text: str) -> None:
    print(text, flush=True)
    sys.exit()


def _run(arguments: list[str]) -> int:
    """Run the command. Raises ``MissingProgram`` if it lacks a module that an extra installs."""
    from vitruvius.logic.errors import MissingProgram

    try:
        command = parse(arguments)
        if arguments[0] != "bench" or not hasattr(command, "out"):
            return command.run() or 0
        from vitruvius.logic.files.replacing import study_folder

        with study_folder(command.out, command.replace):
            return command.run() or 0
    except ModuleNotFoundError as error:
        from vitruvius.logic.installation import extra_of, install_command

        study, extra = arguments[0] == "bench", extra_of(error.name)
        if extra is None:
            raise
        if not study and extra in {"bench", "sim"}:
            extra = "agent"  # It includes the simulator.
        words, module = " ".join(arguments[: 1 + study]), (error.name or "").partition(".")[0]
        raise MissingProgram(f"vitruvius {words} needs {module}: {install_command(extra)}") from error


def _quick(arguments: list[str]) -> str | None:
    """Return the text for help that lists commands, or for the version; None for other arguments."""
    if arguments in ([], ["-h"], ["--help"]):
        return top()
    if arguments == ["--version"]:
        from importlib.metadata import version

        from vitruvius.logic.workers import confinement

        return f"vitruvius {version('vitruvius')}: {confinement.summary()}"
    return None


def _exit_code(arguments: list[str]) -> int:
    if arguments[:1] == ["help"] or arguments[:2] == ["bench", "help"]:
        arguments = [*(word for word in arguments[:2] if word != "help"), *arguments[2:], "--help"]
    if text := _quick(arguments):
        try:
            print(text, flush=True)
        except OSError as error:
            return _unwritten(error)
        return 0
    from vitruvius.logic.errors import GrammarWarning, PlanWarning, VitruviusError
    from vitruvius.logic.stopping import at_signals, end
    from vitruvius.logic.terminal import say

    def failed(error: BaseException, code: int, words: str) -> int:
        """Print an error, and with --json also answer with it."""
        say(words)
        if "--json" in arguments:
            from vitruvius.answers.houses import encoded, failure

            named = arguments[: 1 + (arguments[0] == "bench")]
            try:
                print(encoded(" ".join(named), code, error=failure(error)), flush=True)
            except OSError:  # the first error is printed already
                sys.stdout = None
        return code

    try:
        with at_signals(end):
            code = _run(arguments)
    except VitruviusError as error:
        fault = error.exit_code == VitruviusError.exit_code
        what = "error, a bug in Vitruvius, please report it" if fault else "error"
        code = failed(error, error.exit_code, f"{what}: {error}")
    except (GrammarWarning, PlanWarning) as warning:
        code = failed(warning, 5, f"error: {warning}: PYTHONWARNINGS makes this warning an error")
    except KeyboardInterrupt as end:
        code = failed(end, getattr(end, "exit_code", 130), str(end) or "interrupted")
    except OSError as error:
        if streams.is_of_output(error):
            return _unwritten(error)
        code = failed(error, 5, f"error: {error.filename or _what_fails()}: {error.strerror or error}")
    except Exception as error:
        if isinstance(error, MemoryError) or NO_MEMORY.search(str(error)):
            reason = " ".join(str(error).split("\n")[0].split()) or "none is left"
            return failed(error, 4, f"error: out of memory (this machine, or ulimit -v): {reason}")
        traceback.print_exc()
        code = failed(error, 70, "error, a bug in Vitruvius: please report it with the lines above")
    return code


def _what_fails() -> str:
    """Return the likely reason for an error of the system that names no file."""
    try:
        os.getcwd()
    except OSError:
        return "the current folder was deleted: change to another"
    try:
        tempfile.TemporaryFile().close()
    except OSError:
        return "cannot create a temporary file: name a writable folder by TMPDIR"
    return "the system"


def _unwritten(error: OSError) -> int:
    """Return the exit code after the output cannot be written.

    Nothing is written after it, even as Python ends.
    """
    sys.stdout = None
    if isinstance(error, BrokenPipeError):  # The reader is gone, as in `vitruvius generate ... | head`.
        return 0
    from vitruvius.logic.terminal import say

    say(f"error: the standard output: {'it is closed' if error.errno == EBADF else error.strerror}")
    return 5


if __name__ == "__main__":
    main()
