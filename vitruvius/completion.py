"""``vitruvius completion``: a script with which a shell completes commands, options and their values.

tyro writes the script from the commands' dataclasses.
"""

import pkgutil
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Union

import tyro


@dataclass(frozen=True)
class Completion:
    """Print a script with which your shell completes commands, options and their values.

    bash: add ``eval "$(vitruvius completion bash)"`` to ``~/.bashrc``.

    zsh: ``vitruvius completion zsh > ~/.zfunc/_vitruvius``, where ``fpath`` contains ``~/.zfunc``.
    """

    shell: tyro.conf.Positional[Literal["bash", "zsh"]]
    """Shell to write the script for: bash or zsh."""

    def run(self) -> int:
        """Print the script."""
        from vitruvius.cli import COMMANDS

        kinds = [
            Annotated[_kind(where), tyro.conf.subcommand(name, description=sentence)]
            for name, (where, sentence) in COMMANDS.items()
            if name != "bench"
        ]
        every: Any = Union[tuple(kinds)]  # noqa: UP007 - the number of commands is known only at run time
        tyro.cli(every, prog="vitruvius", args=["--tyro-print-completion", self.shell])
        return 0


def _kind(where: str) -> Any:
    kind = pkgutil.resolve_name(where)
    return kind[type(kind.like([]).learning)] if hasattr(kind, "like") else kind
