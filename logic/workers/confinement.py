"""Confinement of solver processes by the kernel, before they read the rules of a user.

=========  ==========================  ====================================================================
limits     Linux, macOS                memory, processor time; no core file; no file grows
seccomp    Linux on x86-64 and ARM64   of the system calls those of ``CALLS`` alone: no file is written, made,
                                       renamed or removed, no program started, no socket made, no other
                                       process signalled or traced
landlock   Linux 5.13, where it is on  files are read below the given folders alone, and none is written
=========  ==========================  ====================================================================

Confinement needs no root. A measure that the system lacks is left out, as ``measures`` reports (``vitruvius
--version``).
"""

import contextlib
import ctypes
import errno
import os
import platform
import struct
import sys
import time
from collections.abc import Iterable, Iterator
from math import ceil
from pathlib import Path
from typing import Any

from vitruvius.logic.errors import LimitReached

try:
    import resource
except ModuleNotFoundError:  # on Windows
    resource = None  # pyright: ignore[reportAssignmentType]

FILES = 16
"""Number of files that a solver process must be able to open at once; solver processes open up to 13."""

MEMORY = 4 << 30
"""Largest address space of a solver process, in bytes."""

CALLS = """
read 0 63            write 1 64           readv 19 65          writev 20 66         pread64 17 67
close 3 57           lseek 8 62           dup 32 23            fcntl 72 25          ioctl 16 29
open 2 -             openat 257 56        getdents64 217 61    getcwd 79 17         readlink 89 -
readlinkat 267 78    stat 4 -             lstat 6 -            fstat 5 80           newfstatat 262 79
statx 332 291        access 21 -          faccessat 269 48     faccessat2 439 439   poll 7 -
ppoll 271 73         select 23 -          pselect6 270 72      mmap 9 222           munmap 11 215
mprotect 10 226      mremap 25 216        madvise 28 233       brk 12 214           futex 202 98
clone 56 220         exit 60 93           exit_group 231 94    set_robust_list 273 99
rseq 334 293         tgkill 234 131       rt_sigaction 13 134  rt_sigprocmask 14 135
rt_sigreturn 15 139  sigaltstack 131 132  restart_syscall 219 128                   prlimit64 302 261
getpid 39 172        gettid 186 178       getppid 110 173      getuid 102 174       geteuid 107 175
getgid 104 176       getegid 108 177      uname 63 160         sysinfo 99 179       getrandom 318 278
times 100 153        getrusage 98 165     clock_gettime 228 113                     clock_getres 229 114
gettimeofday 96 169  time 201 -           nanosleep 35 101     clock_nanosleep 230 115
sched_yield 24 124   sched_getaffinity 204 123
"""
"""Permitted system calls: name, number on x86-64, number on ARM64."""

ALL, SELF = 0xFFFFFFFF, -1
WRITES = getattr(os, "O_ACCMODE", 3) | os.O_CREAT | os.O_TRUNC
THREAD, DUPLICATE, IS_TERMINAL = 0x00010000, 1030, 0x5401  # CLONE_THREAD, F_DUPFD_CLOEXEC, TCGETS

CONDITIONS = {
    "open": [(1, WRITES, 0)],
    "openat": [(2, WRITES, 0)],
    "clone": [(0, THREAD, THREAD)],
    "tgkill": [(0, ALL, SELF)],
    "prlimit64": [(0, ALL, 0)],
    "fcntl": [(1, ALL & ~3, 0), (1, ALL, DUPLICATE)],
    "ioctl": [(1, ALL, IS_TERMINAL)],
}
"""Conditions on the arguments of permitted calls: argument, mask, value.

They permit threads but no processes, and only signals to the process itself.
"""

MACHINES = {"x86_64": (1, 0xC000003E, 317), "aarch64": (2, 0xC00000B7, 277)}
"""Column of ``CALLS``, the kernel's number of the architecture, and the number of the call ``seccomp``."""

LOAD, JUMP_UNLESS_EQUAL, AND, RETURN = 0x20, 0x15, 0x54, 0x06
ALLOW, UNKNOWN = 0x7FFF0000, 0x00050000 | errno.ENOSYS
"""Results of the filter. A denied call fails as an unknown one, so that the C library tries an older call."""

CREATE_RULESET, ADD_RULE, RESTRICT_SELF = 444, 445, 446
READ = 1 << 2 | 1 << 3  # files, folders

_libc: Any = None if sys.platform == "win32" else ctypes.CDLL(None, use_errno=True)


def measures() -> dict[str, bool]:
    """Return for each of the three measures True if this system can confine solver processes with it."""
    _, _, seccomp = _machine()
    errors = ctypes.c_uint32(UNKNOWN & 0xFFFF0000)
    return {
        "limits": resource is not None,
        "seccomp": bool(seccomp) and _libc.syscall(seccomp, 2, 0, ctypes.byref(errors)) == 0,
        "landlock": _landlock_version() > 0,
    }


def summary() -> str:
    """Return the result of ``measures`` in words."""
    has = measures()
    lacks = [name for name in has if not has[name]]
    text = f"grammars are read and solved under {', '.join(name for name in has if has[name])}"
    return f"{text}; this system lacks {' and '.join(lacks)}: see SECURITY.md" if lacks else text


def confine(readable: Iterable[Path]) -> None:
    """Confine this process for good with all measures that the system has.

    ``readable``: folders whose files the process may read. Raises ``OSError`` if the kernel refuses a
    measure.
    """
    has = measures()
    if has["seccomp"] or has["landlock"]:
        _done(_libc.prctl(38, 1, 0, 0, 0))  # PR_SET_NO_NEW_PRIVS
    if has["landlock"]:
        _read_only(readable)
    if has["seccomp"]:
        _filter_calls()


def limit() -> None:
    """Limit the memory and the file sizes of this process."""
    if resource is None:
        return
    wanted = {resource.RLIMIT_AS: MEMORY, resource.RLIMIT_FSIZE: 0, resource.RLIMIT_CORE: 0}
    for which, most in wanted.items():
        hard = resource.getrlimit(which)[1]
        least = most if hard == resource.RLIM_INFINITY else min(most, hard)
        with contextlib.suppress(ValueError):  # macOS has no limit on memory.
            resource.setrlimit(which, (least, least))


def require_files() -> None:
    """Raise ``LimitReached`` if a process may open fewer files at once than the solvers need.

    The solvers report a library that they cannot open as a rule that cannot be solved.
    """
    if resource is None:
        return
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft < FILES <= hard:
        resource.setrlimit(resource.RLIMIT_NOFILE, (FILES, hard))
    elif soft < FILES:
        raise LimitReached(
            f"{soft} files may be open at once, the solvers need {FILES}: raise it by ulimit -n"
        )


def allow_seconds(seconds: float) -> None:
    """Let the kernel end this process by SIGXCPU after ``seconds`` more of processor time."""
    if resource is None:
        return
    _, hard = resource.getrlimit(resource.RLIMIT_CPU)
    most = ceil(time.process_time() + seconds)
    resource.setrlimit(
        resource.RLIMIT_CPU, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard)
    )


def require_seconds() -> None:
    """Raise ``LimitReached`` if processes have a limit on processor time from outside.

    In this case the limit, and perhaps no rule, ends the solver processes.
    """
    hard = resource.getrlimit(resource.RLIMIT_CPU)[1] if resource else None
    if resource and hard != resource.RLIM_INFINITY:
        raise LimitReached(
            f"a solver process has {hard} s of processor time here and needed more: raise it by ulimit -t"
        )


def _machine() -> tuple[int, int, int]:
    known = sys.platform == "linux" and sys.maxsize > 2**32
    return MACHINES.get(platform.machine() if known else "", (0, 0, 0))


# Landlock, https://docs.kernel.org/userspace-api/landlock.html.


def _landlock_version() -> int:
    return _libc.syscall(CREATE_RULESET, None, 0, 1) if sys.platform == "linux" else 0


def _read_only(readable: Iterable[Path]) -> None:
    """Deny all access to files, except reading below these folders, and all use of TCP."""
    version = _landlock_version()
    rights = 13 + min(version - 1, 2) + (version >= 5)
    wanted = struct.pack("QQ", (1 << rights) - 1, 3 if version >= 4 else 0)
    rules = _done(_libc.syscall(CREATE_RULESET, wanted, len(wanted), 0))
    for folder in readable:
        with contextlib.suppress(FileNotFoundError, NotADirectoryError):
            opened = os.open(folder, os.O_PATH | os.O_DIRECTORY | os.O_CLOEXEC)
            _done(_libc.syscall(ADD_RULE, rules, 1, struct.pack("=Qi", READ, opened), 0))
            os.close(opened)
    _done(_libc.syscall(RESTRICT_SELF, rules, 0))
    os.close(rules)


# Seccomp, https://docs.kernel.org/userspace-api/seccomp_filter.html.


def _filter_calls() -> None:
    """Deny all calls except those of ``CALLS``, in all threads."""
    _, _, seccomp = _machine()
    code = b"".join(struct.pack("HBBI", *each) for each in _program())
    program = ctypes.create_string_buffer(code)
    pointer = struct.pack("HP", len(code) // 8, ctypes.addressof(program))
    _done(_libc.syscall(seccomp, 1, 1, pointer))


def _program() -> Iterator[tuple[int, int, int, int]]:
    """Yield the filter's instructions: operation, jump if true, jump if false, value."""
    column, machine, _ = _machine()
    words = CALLS.split()
    yield from [(LOAD, 0, 0, 4), (JUMP_UNLESS_EQUAL, 1, 0, machine), (RETURN, 0, 0, UNKNOWN)]
    yield (LOAD, 0, 0, 0)
    for name, number in zip(words[::3], words[column::3], strict=True):
        if number == "-":
            continue
        if name not in CONDITIONS:
            yield from [(JUMP_UNLESS_EQUAL, 0, 1, int(number)), (RETURN, 0, 0, ALLOW)]
        for argument, mask, value in CONDITIONS.get(name, ()):
            yield from [
                (JUMP_UNLESS_EQUAL, 0, 5, int(number)),
                (LOAD, 0, 0, 16 + 8 * argument),
                (AND, 0, 0, mask),
                (JUMP_UNLESS_EQUAL, 0, 1, os.getpid() if value == SELF else value),
                (RETURN, 0, 0, ALLOW),
                (LOAD, 0, 0, 0),
            ]
    yield (RETURN, 0, 0, UNKNOWN)


def _done(result: int) -> int:
    """Return the result of a call of the kernel. Raises ``OSError`` if the result is an error."""
    if result < 0:
        code = ctypes.get_errno()
        raise OSError(code, f"a solver process cannot be confined: {os.strerror(code)}")
    return result
