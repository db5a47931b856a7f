"""The ``vitruvius`` command: each sub-command is a dataclass whose fields are its options.

Torch, Taichi and the solvers are imported inside the commands that need them, so that help comes at once.
"""

import sys
import traceback
from typing import Any

import tyro

from agent.bench import Bench
from agent.commands import Export, Train
from agent.config import PQNConfig
from agent.evaluation.commands import Demo, Evaluate, Record
from logic.commands import Check, Draw, Explain, Generate, Lint, say
from logic.errors import VitruviusError

COMMANDS: dict[str, Any] = {
    "generate": Generate,
    "explain": Explain,
    "lint": Lint,
    "check": Check,
    "draw": Draw,
    "train": Train[PQNConfig],
    "evaluate": Evaluate,
    "record": Record,
    "export": Export,
    "demo": Demo,
    "bench": Bench,
}


def main(arguments: list[str] | None = None) -> None:
    """Run a command and exit with its code; errors are one line on stderr (see ``logic.errors``)."""
    sys.exit(_exit_code(sys.argv[1:] if arguments is None else arguments))


def parse(arguments: list[str]) -> Any:
    """The command that the arguments ask for, or the end of the process by their help or an error."""
    if arguments[:1] == ["train"]:  # its defaults are a preset's
        rest = arguments[1:]
        like = Train.like(rest)
        kind: Any = Train[type(like.config)]
        return tyro.cli(kind, prog="vitruvius train", args=rest, default=like)
    return tyro.extras.subcommand_cli_from_dict(
        COMMANDS,
        prog="vitruvius",
        description="Furnished houses from rules, simulated by thousands, an agent that learns in them.",
        args=arguments,
    )


def _exit_code(arguments: list[str]) -> int:
    try:
        return parse(arguments).run()
    except VitruviusError as error:
        if error.exit_code == VitruviusError.exit_code:
            say(f"error, a fault of ours, please report it: {error}")
        else:
            say(f"error: {error}")
        return error.exit_code
    except KeyboardInterrupt:
        say("interrupted")
        return 130
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
