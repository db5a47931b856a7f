"""Standard streams of a command: a closed or full stream is an error if it would lose an answer."""

import codecs
import contextlib
import io
import os
import sys
from collections.abc import Iterator


class _Output(io.TextIOWrapper):
    """Standard output that records its own errors: other system calls name no file either."""

    error: OSError | None = None

    def write(self, text: str, /) -> int:
        """Write a text."""
        with self._noted():
            return super().write(text)

    def flush(self) -> None:
        """Write the rest of the buffer."""
        with self._noted():
            super().flush()

    @contextlib.contextmanager
    def _noted(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            self.error = error
            raise


class _Unheard(io.TextIOWrapper):
    """Standard error that drops what cannot be written: the exit code tells how the work ended."""

    def write(self, text: str, /) -> int:
        """Write a text, or nothing."""
        with contextlib.suppress(OSError):
            super().write(text)
        return len(text)

    def flush(self) -> None:
        """Write the rest of the buffer, or nothing."""
        with contextlib.suppress(OSError):
            super().flush()


def prepare() -> None:
    """Reserve the file descriptor of each closed stream, so that the next opened file does not get it.

    Services may start a program with closed streams. A closed standard input is empty, and a closed standard
    error discards its lines. Writing to a closed standard output fails, because the answer would be lost.
    Characters outside the terminal's encoding are escaped as in Python.
    """
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            number = os.open(os.devnull, os.O_RDONLY if name == "stdout" else os.O_RDWR)
            setattr(sys, name, os.fdopen(number, mode, encoding="utf-8", closefd=False))
            setattr(sys, f"__{name}__", getattr(sys, name))
    for name, kind in (("stdout", _Output), ("stderr", _Unheard)):
        stream = getattr(sys, name)
        if stream is getattr(sys, f"__{name}__"):  # not one that a caller of ours has set
            stream.flush()
            file = io.BufferedWriter(io.FileIO(stream.fileno(), "w", closefd=False))
            lines = stream.line_buffering or stream.write_through
            made = kind(file, stream.encoding, "backslashreplace", line_buffering=lines)
            setattr(sys, name, made)


def is_of_output(error: OSError) -> bool:
    """Return True if the error is that the standard output could not be written."""
    own = not isinstance(sys.stdout, _Output) and error.filename is None
    return own or getattr(sys.stdout, "error", None) is error


def read_utf8() -> None:
    """Restart in Python's UTF-8 mode if names of files would be read as ASCII.

    This is so with ``LC_ALL=C`` and ``PYTHONUTF8=0``. House files and rules are UTF-8, and so are their
    names.
    """
    if codecs.lookup(sys.getfilesystemencoding()).name == "ascii":
        os.environ["PYTHONUTF8"] = "1"
        os.execv(sys.executable, [sys.executable, *sys.orig_argv[1:]])
