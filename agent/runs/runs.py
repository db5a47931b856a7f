"""A training run in its folder. The run saves its state regularly, and a killed run can resume.

| file | |
|---|---|
| ``agent.safetensors`` | the network, saved every half minute: for ``vitruvius evaluate`` |
| ``config.json`` | the settings, the houses, the command and the versions |
| ``metrics.jsonl`` | a line for each report: ``agent.learning.learner.Progress`` |
| ``tensorboard/`` | the same for TensorBoard |
| ``best.safetensors`` | the network with the best evaluation in held-out houses, with ``evaluate_every`` |
| ``checkpoints/`` | networks named by their steps, with ``keep_every`` |
| ``state.pt.gz`` | the complete state of the run: for ``--resume`` |
"""

import gzip
import io
import json
import platform
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from math import inf
from pathlib import Path
from time import perf_counter
from typing import Any

import msgspec
import torch

from vitruvius.agent.algorithms.build import learner_of
from vitruvius.agent.banks import bank_hash, house_key, require_training_seeds
from vitruvius.agent.learning import ranks
from vitruvius.agent.learning.allocation import keep_freed_memory
from vitruvius.agent.learning.config import TrainConfig
from vitruvius.agent.learning.environments import make_envs
from vitruvius.agent.learning.learner import Diverged, Learner, Progress
from vitruvius.agent.learning.precision import set_precision
from vitruvius.agent.learning.simulator import simulator
from vitruvius.agent.progress import progress
from vitruvius.agent.runs import checkpoint
from vitruvius.agent.runs.checkpoint import Checkpoint
from vitruvius.agent.runs.released import CheckpointError
from vitruvius.agent.runs.watching import RunWatcher, Watching
from vitruvius.logic import House, HouseSet, HouseStream
from vitruvius.logic.errors import RequestError, VitruviusError
from vitruvius.logic.files.replacing import lock_alone
from vitruvius.logic.files.writing import write_whole
from vitruvius.logic.opener import archive_of, content_of, opened, reason
from vitruvius.logic.spelling import keywords
from vitruvius.logic.stopping import Terminated, at_signals
from vitruvius.sim import HouseRotation

NOTHING = Watching()
"""Options of a run without evaluation, checkpoints and hook."""

SAVE_SECONDS = 30.0
"""Seconds between two checkpoints."""

MAX_MORE_STATE_BYTES, MAX_METRICS_BYTES, MAX_TENSORS = 1 << 24, 1 << 28, 1 << 16
"""Bounds of a run's files: bytes by which the uncompressed state may exceed twice the state of a new run,
bytes of the reports, and number of tensors."""


@dataclass(frozen=True)
class Folder:
    """Paths of a run's files."""

    path: Path

    @property
    def agent(self) -> Path:
        """Checkpoint of the agent."""
        return self.path / "agent.safetensors"

    @property
    def config(self) -> Path:
        """Settings of the run."""
        return self.path / "config.json"

    @property
    def metrics(self) -> Path:
        """Reports of the run."""
        return self.path / "metrics.jsonl"

    @property
    def state(self) -> Path:
        """State from which the run can continue."""
        return self.path / "state.pt.gz"

    @property
    def tensorboard(self) -> Path:
        """Reports for TensorBoard."""
        return self.path / "tensorboard"

    @property
    def lock(self) -> Path:
        """Empty file, locked by the run at work."""
        return self.path / ".lock"

    def _require_own(self) -> None:
        for path in (self.agent, self.config, self.metrics, self.state, self.lock, self.tensorboard):
            is_own = path.is_dir() if path == self.tensorboard else path.is_file()
            if path.is_symlink() or (path.exists() and not is_own):
                kind = "folder" if path == self.tensorboard else "file"
                raise CheckpointError(f"{path}: is not a regular {kind}, so no run can be resumed here")

    @contextmanager
    def alone(self, resume: bool) -> Iterator[None]:
        """Hold the folder while the block runs.

        Raises ``RequestError`` if another run holds the folder, or if the folder has a run and ``resume`` is
        False. Raises ``CheckpointError`` for a path in the folder that is not a file of the run: writing
        to a link would write outside the folder.
        """
        self.path.mkdir(parents=True, exist_ok=True)
        self._require_own()
        with self.lock.open("a") as file:
            busy = f"{self.path}: another run is active in this folder: choose another --out folder"
            lock_alone(file.fileno(), busy)
            if not resume and any(
                path.exists() for path in (self.config, self.agent, self.metrics, self.state)
            ):
                raise RequestError(
                    f"{self.path}: already holds a run. Continue it with --resume, or choose another --out "
                    "folder"
                )
            yield


@keywords(preset="config", out="path", folder="path")
def run(
    houses: Sequence[House] | HouseRotation,
    config: TrainConfig,
    path: str | Path,
    *,
    name: str = "agent",
    command: str = "",
    resume: bool = False,
    every: float | None = None,
    watching: Watching = NOTHING,
) -> tuple[Checkpoint, list[Progress]]:
    """Train an agent in the houses to the end of its run, with the run's files in the folder ``path``.

    The houses of a ``HouseSet`` or a ``HouseStream`` rotate: see ``sim.HouseRotation``. With ``resume``, a
    run in the folder continues from its last saved state, bit for bit on the CPU; in an empty folder a new
    run begins. ``every`` is the number of seconds between two lines of progress, if the output is a pipe;
    None: no lines. ``watching`` has the options for evaluation, checkpoints and the hook.

    Raises ``RequestError`` for a folder in use or with another run; ``Diverged`` if the loss is NaN or
    explodes, and keeps the last good checkpoint. After a signal, saves the run and raises the signal's error
    (``logic.stopping``).
    """
    with ranks.joined(), torch_threads(config.threads):
        folder = Folder(Path(path))
        if ranks.rank():  # the first rank alone writes
            learner = _learner(houses, config)
            return _learn(learner, folder, name, command, resume, every, watching)
        with folder.alone(resume):
            return _learn(_learner(houses, config), folder, name, command, resume, every, watching)


@contextmanager
def torch_threads(number: int) -> Iterator[None]:
    """Let torch use this many threads within the block.

    A second thread slows down small batches, such as those of playing policies, above all on a busy machine.
    """
    before = torch.get_num_threads()
    torch.set_num_threads(number)
    try:
        yield
    finally:
        torch.set_num_threads(before)


def _learner(houses: Sequence[House] | HouseRotation, config: TrainConfig) -> Learner:
    """Return a learner for a new run, in this rank's share of new environments. Sets and streams rotate."""
    if isinstance(houses, HouseSet | HouseStream):
        houses = HouseRotation(houses)
    known = houses.houses if isinstance(houses, HouseRotation) else houses
    if isinstance(known, HouseSet | HouseStream):
        require_training_seeds(known)
    if isinstance(houses, HouseRotation) and config.reads_maps:
        raise RequestError(
            f"{config.algorithm} cannot train on rotating houses: give a house file, not a set"
        )
    share, left = divmod(config.num_envs, ranks.size())
    if left:
        raise RequestError(f"num_envs must be a multiple of the {ranks.size()} ranks, not {config.num_envs}")
    if ranks.size() > 1 and not config.parallel:
        raise RequestError(f"{config.algorithm} runs only in one process")
    if config.device == "cuda" and not torch.cuda.is_available():
        raise RequestError("device cuda is not available: torch finds no GPU here. Leave out --device")
    keep_freed_memory()
    set_precision(config.precision, config.device)
    world, where = simulator(config), {"backend": config.backend, "device": config.device}
    envs = make_envs(houses, share, config.targets, preset=world, **where)
    return learner_of(config, envs)


def _learn(
    learner: Learner,
    folder: Folder,
    name: str,
    command: str,
    resume: bool,
    every: float | None,
    watching: Watching,
) -> tuple[Checkpoint, list[Progress]]:
    """Train to the end, or to the first report after a signal. Save the run then, and every half minute."""
    config, houses = learner.config, learner.houses
    history = _resumed(learner, folder) if resume and folder.state.exists() else []
    # A checkpoint lists no houses of a set or a stream: none of them is reserved for evaluation.
    unnamed = isinstance(houses, HouseSet | HouseStream)
    learnt_in = frozenset[int]() if unnamed else frozenset(map(house_key, houses))
    made = Checkpoint(learner.network, config, 0, name, bank_hash(houses), command, learnt_in)
    watching.require(config, learnt_in)
    watcher = RunWatcher(watching, made, folder.path, history) if not ranks.rank() else None
    writer = _Writer(folder, history) if not ranks.rank() else None
    if writer:
        write_whole(folder.config, _described(made, learner).encode())
    saved, ends = perf_counter(), list[KeyboardInterrupt]()
    with progress("training", every if not ranks.rank() else None) as tell, at_signals(ends.append):
        try:
            for report in learner.train():
                now = watcher.look(report) if watcher else report
                history.append(now)
                rate = now.steps / max(now.seconds, 1e-9)
                words = f"{now.steps / 1e6:.2f} M steps, {rate:,.0f}/s, {now.targets:.1f} targets"
                tell(now.fraction, words)
                if writer:
                    writer.write(now)
                age = ranks.first(inf if ends else perf_counter() - saved)
                if age > SAVE_SECONDS:
                    _keep(learner, replace(made, steps=now.steps), folder)
                    saved = perf_counter()
                if age == inf:
                    raise ends[0] if ends else Terminated
        except Diverged as error:
            kept = (
                f"{folder.agent} is the last good checkpoint"
                if folder.agent.exists()
                else ("no checkpoint was saved before")
            )
            raise Diverged(f"{error}: {kept}. Try a lower --learning-rate") from None
        finally:
            learner.envs.close()  # otherwise the process waits for houses in generation
            if writer and watcher:
                writer.close()
                watcher.close()
    result = replace(made, network=learner.network.eval(), steps=learner.steps)
    _keep(learner, result, folder)
    return result, history


def _keep(learner: Learner, made: Checkpoint, folder: Folder) -> None:
    """Write the state of all ranks, then the agent."""
    parts = ranks.gathered(_saved(learner.state()))
    if not ranks.rank():
        states = [torch.load(io.BytesIO(part), weights_only=True) for part in parts]
        write_whole(folder.state, gzip.compress(_saved(states), compresslevel=1, mtime=0))
        checkpoint.save(made, folder.agent)


def _saved(value: Any) -> bytes:
    """Return a value as torch writes it."""
    content = io.BytesIO()
    torch.save(value, content)
    return content.getvalue()


def _resumed(learner: Learner, folder: Folder) -> list[Progress]:
    """Restore the last saved state. Return the reports up to this state."""
    try:
        most = ranks.size() * 2 * len(_saved(learner.state())) + MAX_MORE_STATE_BYTES
        content = content_of(folder.state, most)
        archive_of(content, most, MAX_TENSORS)  # torch unpacks compressed files of any size
        states = torch.load(io.BytesIO(content), weights_only=True)
        if len(states) != ranks.size():
            raise RequestError(
                f"{folder.path}: the run has {len(states)} ranks, not {ranks.size()}: start "
                f"it with {len(states)}"
            )
        with warnings.catch_warnings(action="ignore"):  # torch warns of values that are no state
            learner.restore(states[ranks.rank()])
    except VitruviusError:
        raise
    except Exception as error:  # damaged files raise many kinds of errors
        raise CheckpointError(f"{folder.state}: cannot be read: {reason(error)}") from None
    history = []
    with opened(folder.metrics, MAX_METRICS_BYTES, unpack=False) as file:
        for line in io.BytesIO(file.read(MAX_METRICS_BYTES)):
            try:
                now = msgspec.json.decode(line, type=Progress)
            except ValueError:
                continue  # a kill may tear the last line
            if now.steps <= learner.steps:
                history.append(now)
    if not history:
        raise CheckpointError(
            f"{folder.metrics}: lacks the reports up to step {learner.steps:,}, at which the run was saved"
        )
    return history


def _described(made: Checkpoint, learner: Learner) -> str:
    """Return what a reader must know to repeat the run."""
    record: dict[str, Any] = {
        "preset": made.name,
        "algorithm": made.config.algorithm,
        "config": asdict(made.config),
        "houses": {"number": len(learner.houses), "hash": made.houses},
        "command": made.command,
        "ranks": ranks.size(),
        "python": platform.python_version(),
        "torch": torch.__version__,
        "machine": platform.platform(),
    }
    return json.dumps(record, indent=2) + "\n"


class _Writer:
    """Writer of each report to ``metrics.jsonl`` and for TensorBoard."""

    def __init__(self, folder: Folder, history: list[Progress]) -> None:
        """Continue after the reports of ``history``. The resumed run makes later reports again."""
        from torch.utils.tensorboard import SummaryWriter  # half a second to import

        lines = "".join(json.dumps(asdict(one)) + "\n" for one in history)
        write_whole(folder.metrics, lines.encode())
        self.lines = folder.metrics.open("a")
        self.board = SummaryWriter(folder.tensorboard, purge_step=history[-1].steps + 1 if history else None)

    def write(self, now: Progress) -> None:
        """Write a report at once."""
        values = asdict(now)
        self.lines.write(json.dumps(values) + "\n")
        self.lines.flush()
        for name, value in values.items():
            if value is not None and name != "steps":
                self.board.add_scalar(name, value, now.steps)

    def close(self) -> None:
        """Close both files."""
        self.lines.close()
        self.board.close()
