"""The ``vitruvius`` command gathers those of ``logic`` and ``agent``, and the studies of ``benchmarks``.

A command is a dataclass whose fields are its options, with a ``run``. It is imported when it is asked for:
making a house needs no simulator, and help comes at once.
"""

import pkgutil
import sys
import traceback
from collections.abc import Mapping, Sequence
from dataclasses import fields
from importlib.metadata import version
from typing import Any

import tyro

from benchmarks import STUDIES
from logic import confinement
from logic.commands import say
from logic.errors import MissingProgram, RequestError, VitruviusError
from logic.spelling import closest, unknown
from logic.stopping import at_sigterm, terminate

COMMANDS = {
    "generate": ("logic.commands.generate:Generate", "Make houses from rules."),
    "explain": (
        "logic.commands.rules:Explain",
        "Why no house satisfies a request, or why a house is as it is.",
    ),
    "rules": ("logic.reference:Rules", "Print the reference of the rule language, with recipes."),
    "lint": (
        "logic.commands.rules:Lint",
        "Find the mistakes in rule files that clingo and Prolog pass over.",
    ),
    "check": (
        "logic.commands.houses:Check",
        "Check houses by plain geometry, apart from the rules that made them.",
    ),
    "draw": ("logic.commands.houses:Draw", "Draw plans of houses and a contact sheet."),
    "convert": ("logic.commands.houses:Convert", "Write a house file of any format as one of today's."),
    "schema": ("logic.commands.houses:Schema", "Print the JSON Schema of a house."),
    "train": ("agent.commands:Train", "Train an agent in houses."),
    "evaluate": ("agent.evaluation.commands:Evaluate", "Measure agents in houses that they have not seen."),
    "report": ("agent.report.commands:Report", "Write a run as one HTML file, with episodes to play."),
    "record": ("agent.evaluation.commands:Record", "Film an agent in a house, with its rays and trail."),
    "play": ("agent.play.commands:Play", "Drive the robot by the keyboard, and race an agent."),
    "export": ("agent.commands:Export", "Write an agent's network as an ONNX file."),
    "import-keras": ("agent.commands:ImportKeras", "Take the weights of the paper's original program."),
    "demo": ("agent.evaluation.commands:Demo", "Houses, an agent that learns in them, a report: in minutes."),
    "bench": ("benchmarks:STUDIES", "The studies: solve time, speed of a step, how well agents do."),
}
"""By name: where the command is, ``module:Class``, and what it does."""

EXTRAS = {
    "bench": ("cpuinfo", "pytest", "pytest_benchmark", "scipy"),
    "sim": ("gymnasium", "taichi"),
    "agent": ("safetensors", "scipy", "tensorboard", "torch"),
    "keras": ("h5py",),
    "export": ("pxr", "trimesh"),
    "play": ("pygame",),
    "film": ("imageio_ffmpeg",),
}
"""Modules that the base does not install, by the extras of ``pyproject.toml`` that do."""


def main(arguments: list[str] | None = None) -> None:
    """Run a command and exit with its code; errors are one line on stderr (see ``logic.errors``)."""
    sys.exit(_exit_code(sys.argv[1:] if arguments is None else arguments))


def parse(arguments: list[str]) -> Any:
    """The command that the arguments ask for, or the end of the process by their help or an error."""
    prog, table = "vitruvius", COMMANDS
    if arguments[:1] == ["bench"]:
        prog, table, arguments = "vitruvius bench", STUDIES, arguments[1:]
    if not arguments or arguments[0] in ("-h", "--help"):
        return tyro.extras.subcommand_cli_from_dict(
            _help_of(table), prog=prog, description=ABOUT, args=arguments
        )
    name, *rest = arguments
    if name not in table:
        raise RequestError(f"{prog}: {unknown('command' if table is COMMANDS else 'study', name, table)}")
    kind, prog = pkgutil.resolve_name(table[name][0]), f"{prog} {name}"
    if name == "train":  # its defaults are a preset's
        like = kind.like(rest)
        _require_options(prog, rest, like, like.config)
        return tyro.cli(kind[type(like.config)], default=like, prog=prog, args=rest)
    _require_options(prog, rest, kind)
    return tyro.cli(kind, prog=prog, args=rest)


def _require_options(prog: str, arguments: Sequence[str], *options: Any) -> None:
    """Raise ``RequestError`` for an option that these dataclasses lack: tyro says what is missing instead."""
    names = [field.name.replace("_", "-") for each in options for field in fields(each)]
    known = {"", "help", *names, *(f"no-{name}" for name in names)}
    for argument in arguments:
        option = argument.partition("=")[0].replace("_", "-").removeprefix("--")
        if argument.startswith("--") and option not in known:
            close = closest(option, known)
            hint = f"did you mean --{close}?" if close else f"see {prog} --help"
            raise RequestError(f"{prog}: there is no option --{option}: {hint}")


ABOUT = "Furnished houses from rules, simulated thousands at a time, explored by agents that plan and learn."


def _help_of(table: Mapping[str, tuple[str, str]]) -> dict[str, Any]:
    """Commands of which nothing is known but their names and sentences."""

    def stub(sentence: str) -> Any:
        def command() -> None: ...

        command.__doc__ = sentence
        return command

    return {name: stub(sentence) for name, (_, sentence) in table.items()}


def _run(arguments: list[str]) -> int:
    """Run the command. Raises ``MissingProgram`` where it lacks a module that an extra installs."""
    if arguments == ["--version"]:
        print(f"vitruvius {version('vitruvius')}: {confinement.summary()}")
        return 0
    try:
        return parse(arguments).run() or 0
    except ModuleNotFoundError as error:
        study, module = arguments[0] == "bench", (error.name or "").partition(".")[0]
        extras = [extra for extra, modules in EXTRAS.items() if module in modules]
        if not extras:
            raise
        words = " ".join(arguments[: 1 + study])
        # The agent's brings the simulator.
        extra = extras[0] if study or extras[0] in {"keras", "export", "play", "film"} else "agent"
        raise MissingProgram(f"vitruvius {words} needs {module}: pip install vitruvius[{extra}]") from error


def _exit_code(arguments: list[str]) -> int:
    try:
        with at_sigterm(terminate):
            return _run(arguments)
    except VitruviusError as error:
        if error.exit_code == VitruviusError.exit_code:
            say(f"error, a fault of ours, please report it: {error}")
        else:
            say(f"error: {error}")
        return error.exit_code
    except KeyboardInterrupt as end:
        say(str(end) or "interrupted")
        return getattr(end, "exit_code", 130)
    except OSError as error:
        if not isinstance(error, BrokenPipeError):
            say(f"error: {error.filename or 'a file'}: {error.strerror}")
            return 5
        # The reader of our output is gone, as in `vitruvius generate ... | head`.
        sys.stdout = None
        return 0
    except Exception:
        traceback.print_exc()
        say("error, a fault of ours: please report it with the lines above")
        return 70


if __name__ == "__main__":
    main()
