"""Checkpoints of other people: pickles, torn headers, numbers that are too large, malformed files."""

import gzip
import io
import json
import os
import pickle
import struct
import zipfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from tests.hostile.case import ACCEPTED, REFUSED, Case, Yard
from tests.hostile.houses import bomb
from tests.hostile.subjects import Answer
from vitruvius.agent.runs import released
from vitruvius.logic.errors import VitruviusError

GOOD = Path(released.__file__).with_name("paper.safetensors").read_bytes()
LENGTH = struct.unpack("<Q", GOOD[:8])[0]
HEADER: dict[str, Any] = json.loads(GOOD[8 : 8 + LENGTH])
WEIGHTS = GOOD[8 + LENGTH :]
FIRST = next(name for name in HEADER if name not in ("__metadata__", released.LEARNT_IN))


def packed(header: Any, data: bytes = WEIGHTS, length: int | None = None) -> bytes:
    """Return a safetensors file of a header and data; ``length`` may differ from the true length."""
    text = header if isinstance(header, bytes) else json.dumps(header).encode()
    return struct.pack("<Q", len(text) if length is None else length) + text + data


def tensor(**changes: Any) -> bytes:
    """Return a checkpoint whose first tensor has other entries in the header."""
    return packed(HEADER | {FIRST: HEADER[FIRST] | changes})


def told(**changes: Any) -> bytes:
    """Return a checkpoint whose record has other entries; None removes one."""
    record = {name: text for name, text in (HEADER["__metadata__"] | changes).items() if text is not None}
    return packed(HEADER | {"__metadata__": record})


def asked(**changes: Any) -> bytes:
    """Return a checkpoint whose config has other values."""
    return told(config=json.dumps(json.loads(HEADER["__metadata__"]["config"]) | changes))


def weights(*values: float) -> bytes:
    """Return a checkpoint whose first weights are these numbers."""
    first, begin = struct.pack(f"<{len(values)}f", *values), HEADER[FIRST]["data_offsets"][0]
    return packed(HEADER, WEIGHTS[:begin] + first + WEIGHTS[begin + len(first) :])


class Shell:
    """Object that runs a program when it is unpickled."""

    def __init__(self, words: str) -> None:
        """Keep the words."""
        self.words = words

    def __reduce__(self) -> tuple[Any, ...]:
        """Return the call that unpickles the object."""
        return os.system, (self.words,)


def pickled(yard: Yard, protocol: int = 2) -> bytes:
    """Return a pickle that runs a program."""
    return pickle.dumps({"state_dict": Shell(yard.words["TOUCH"])}, protocol)


def archived(pickle_: bytes, extra: bytes = b"") -> bytes:
    """Return the file that ``torch.save`` would write for this pickle."""
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("archive/data.pkl", pickle_)
        file.writestr("archive/version", "3\n")
        file.writestr("archive/byteorder", "little")
        if extra:
            file.writestr("archive/data/0", extra)
    return content.getvalue()


HEADERS: dict[str, Callable[[], bytes]] = {
    "empty": lambda: b"",
    "seven bytes": lambda: bytes(7),
    "zeros": lambda: bytes(1 << 20),
    "a header of no length": lambda: packed(HEADER, length=0),
    "a header longer than the file": lambda: packed(HEADER, length=1 << 40),
    "a header of 2 to the 63": lambda: packed(HEADER, length=1 << 63),
    "a header of 2 to the 64": lambda: packed(HEADER, length=(1 << 64) - 1),
    "a header of 99 MB": lambda: packed(b" " * 99_000_000 + json.dumps(HEADER).encode()),
    "a header of blanks": lambda: packed(b" " * 1000),
    "a header that is a list": lambda: packed([]),
    "a header of deep lists": lambda: packed(b"[" * 500_000 + b"]" * 500_000),
    "a header of deep objects": lambda: packed(b'{"a":' * 150_000),
    "a header that is no UTF-8": lambda: packed(b"\xff\xfe{}"),
    "a hundred thousand tensors": lambda: packed(
        {f"t{n}": {"dtype": "F32", "shape": [0], "data_offsets": [0, 0]} for n in range(15_000)}, b""
    ),
    "an unknown kind": lambda: tensor(dtype="F1024"),
    "a kind that is a number": lambda: tensor(dtype=32),
    "offsets before the beginning": lambda: tensor(data_offsets=[-4, 0]),
    "offsets past the end": lambda: tensor(data_offsets=[0, 1 << 62]),
    "offsets the wrong way round": lambda: tensor(data_offsets=HEADER[FIRST]["data_offsets"][::-1]),
    "offsets that overflow": lambda: tensor(data_offsets=[(1 << 64) - 4, 1 << 64]),
    "offsets that overlap": lambda: tensor(data_offsets=[4, HEADER[FIRST]["data_offsets"][1] + 4]),
    "offsets that are fractions": lambda: tensor(data_offsets=[0.5, 1.5]),
    "a shape that overflows": lambda: tensor(shape=[1 << 32, 1 << 32]),
    "a shape of 2 to the 62": lambda: tensor(shape=[1 << 62]),
    "a shape below zero": lambda: tensor(shape=[-1, -1]),
    "a shape of nothing": lambda: tensor(shape=[0]),
    "a shape of ten thousand dimensions": lambda: tensor(shape=10_000 * [1]),
    "a shape that is a text": lambda: tensor(shape="4"),
    "weights cut short": lambda: GOOD[:-4],
    "weights with a tail": lambda: GOOD + b"tail",
    "a tensor too many": lambda: packed(
        HEADER | {"../../shell": {"dtype": "F32", "shape": [0], "data_offsets": 2 * [len(WEIGHTS)]}}
    ),
    "a tensor too few": lambda: packed({name: value for name, value in HEADER.items() if name != FIRST}),
    "tensors by other names": lambda: packed({f"__{name}__": value for name, value in HEADER.items()}),
    "half the precision": lambda: tensor(dtype="F16"),
    "NaN": lambda: weights(float("nan")),
    "an infinite weight": lambda: weights(float("-inf")),
    "no record": lambda: packed({name: value for name, value in HEADER.items() if name != "__metadata__"}),
    "a record of numbers": lambda: packed(HEADER | {"__metadata__": {"format": 3}}),
    "a record that is a text": lambda: packed(HEADER | {"__metadata__": "vitruvius"}),
    "another format": lambda: told(format="vitruvius-agent-9"),
    "no format": lambda: told(format=None),
    "no algorithm": lambda: told(algorithm=None),
    "an algorithm that is a module": lambda: told(algorithm="os.system"),
    "no config": lambda: told(config=None),
    "a config that is no JSON": lambda: told(config="Config()"),
    "a config that is a list": lambda: told(config="[1]"),
    "a config that is null": lambda: told(config="null"),
    "a config of deep lists": lambda: told(config="[" * 300_000),
    "a config of a long number": lambda: told(config=f'{{"steps": {"9" * 300_000}}}'),
    "steps that are a fraction": lambda: told(steps="0.5"),
    "steps that are a long number": lambda: told(steps="9" * 300_000),
    "steps that are a word": lambda: told(steps="__import__('os')"),
    "an unknown field": lambda: asked(__class__="os.system"),
    "a field of another kind": lambda: asked(seed="one"),
    "a hidden layer of 10 to the 12": lambda: asked(hidden=10**12),
    "10 to the 12 environments": lambda: asked(num_envs=10**12),
    "no environments": lambda: asked(num_envs=0),
    "a rate that is NaN": lambda: asked(learning_rate=float("nan")),
    "a discount above one": lambda: asked(gamma=1e300),
    "steps below zero": lambda: asked(steps=-1),
    "a device that is a path": lambda: asked(device="/dev/zero"),
    "a simulator with 10 to the 9 rays": lambda: asked(sim=["rays=1000000000"]),
    "a simulator with a NaN": lambda: asked(sim=["step=NaN"]),
    "a simulator with an unknown field": lambda: asked(sim=["__class__=1"]),
    "a simulator of code": lambda: asked(sim=["rays=__import__('os').system('TOUCH')"]),
    "a simulator of 100,000 fields": lambda: asked(sim=50_000 * ["rays=1"]),
}
"""Files named ``agent.safetensors`` that are refused."""

READ: dict[str, Callable[[], bytes]] = {
    "as it was": lambda: GOOD,
    "a name of control characters": lambda: told(name="\x1b[2J\x07\u202e"),
    "a name that is a path": lambda: told(name="../../../etc/passwd"),
    "a name of markup": lambda: told(name="<script>alert(1)</script>"),
    "a name of 100,000 letters": lambda: told(name="a" * 100_000),
    "a command for a shell": lambda: told(command="$(touch TRACE); rm -rf /"),
    "all weights zero": lambda: packed(HEADER, bytes(len(WEIGHTS))),
    "the largest weights": lambda: weights(3e38, -3e38),
    "weights that are denormal": lambda: weights(1e-45),
    "steps below zero": lambda: told(steps="-1"),
    "a buffer of 10 to the 15": lambda: asked(buffer_size=10**15),
    "a rate that is infinite": lambda: asked(learning_rate=1e999),
    "a task that is a path": lambda: asked(targets="../../etc/passwd"),
    "a task of deep lists": lambda: asked(targets="[" * 100_000),
    "a header with a tensor twice": lambda: packed(
        json.dumps(HEADER).encode()[:-1] + f', "{FIRST}": {json.dumps(HEADER[FIRST])}}}'.encode()
    ),
    "more in the record": lambda: told(__class__="os.system", auto_map="evil.py"),
}
"""Files that are read, as text and numbers."""

PICKLES: dict[str, Callable[[Yard], bytes]] = {
    "a pickle": pickled,
    "a pickle of protocol 0": lambda yard: pickled(yard, 0),
    "a pickle of protocol 5": lambda yard: pickled(yard, 5),
    "a pickle after a good header": lambda yard: packed(HEADER, pickled(yard)),
    "a torch file": lambda yard: archived(pickled(yard)),
    "a torch file in gzip": lambda yard: gzip.compress(archived(pickled(yard))),
    "a zip bomb": lambda yard: archived(pickled(yard), bytes(200_000_000)),
    "a gzip bomb": lambda yard: bomb(1 << 28),
    "a numpy file of objects": lambda yard: (
        b"\x93NUMPY\x01\x00v\x00"
        + b"{'descr': '|O', 'fortran_order': False, 'shape': (1,), }".ljust(117)
        + b"\n"
        + pickled(yard)
    ),
    "a script": lambda yard: f"#!/bin/sh\n{yard.words['TOUCH']}\n".encode(),
}


def _file(content: Callable[[Yard], bytes], name: str = "agent.safetensors") -> Callable[[Yard], Path]:
    def make(yard: Yard) -> Path:
        path = yard.input / name
        path.write_bytes(content(yard))
        return path

    return make


def _sparse(yard: Yard) -> Path:
    path = _file(lambda _: GOOD)(yard)
    os.truncate(path, 5 << 30)
    return path


def _pipe(yard: Yard) -> Path:
    os.mkfifo(yard.input / "agent.safetensors")
    return yard.input / "agent.safetensors"


def _folder(yard: Yard) -> Path:
    (yard.input / "agent.safetensors").mkdir()
    return yard.input / "agent.safetensors"


def _link(target: str) -> Callable[[Yard], Path]:
    def make(yard: Yard) -> Path:
        (yard.input / "agent.safetensors").symlink_to(yard.filled(target))
        return yard.input / "agent.safetensors"

    return make


FILES: dict[str, Callable[[Yard], Path]] = {
    "absent": lambda yard: yard.input / "agent.safetensors",
    "a pipe": _pipe,
    "a folder": _folder,
    "5 GB of nothing": _sparse,
    "a link to zeros": _link("/dev/zero"),
    "a link to a terminal": _link("/dev/tty"),
    "a link to itself": _link("agent.safetensors"),
    "a link to nothing": _link("/nowhere"),
    "a link to a secret": _link("SECRET"),
    "a link to a process's memory": _link("/proc/self/mem"),
    "the name of a preset in a path": lambda yard: yard.input / "../input/paper",
}


def loaded(path: Path) -> Answer:
    """Return the answer of a checkpoint's reader; a network that was read evaluates an observation."""
    import torch

    from vitruvius.agent.runs.checkpoint import load
    from vitruvius.info.recognise import recognised

    with suppress(VitruviusError):
        recognised(str(path))
    found = load(path)
    with torch.no_grad():
        found.network(torch.rand(1, *found.network.shape[:2]), found.network.memory.empty(1))
    return Answer(ACCEPTED, f"{found.name} {found.command} {found.steps}")


CASES = [
    *(
        Case("checkpoints: contents", title, _file(lambda _, make=make: make()), (REFUSED,))
        for title, make in HEADERS.items()
    ),
    *(
        Case("checkpoints: names and weights", title, _file(lambda _, make=make: make()), (ACCEPTED,))
        for title, make in READ.items()
    ),
    *(Case("checkpoints: pickles", title, _file(make), (REFUSED,)) for title, make in PICKLES.items()),
    *(
        Case("checkpoints: pickles", f"{title} as agent{end}", _file(make, f"agent{end}"), (REFUSED,))
        for title, make in PICKLES.items()
        for end in (".pt", ".pth")
        if "bomb" not in title
    ),
    *(Case("checkpoints: files", title, make, (REFUSED,)) for title, make in FILES.items()),
]
