"""Figures of the answers to many random inputs: number of each answer, time, memory and failures."""

import resource
import time
from collections import Counter
from dataclasses import dataclass, field


@dataclass
class AnswerFigures:
    """The answers to random inputs."""

    answers: Counter[str] = field(default_factory=Counter)
    seconds: float = 0.0
    """Seconds of the whole study."""
    slowest: float = 0.0
    """Seconds of processor time of the slowest answer."""
    memory: int = 0
    """Peak memory of the process that answers, in MiB."""
    failures: dict[str, str] = field(default_factory=dict)
    """File or folder that keeps the input of each kind of failure."""

    def count(self, answer: str, seconds: float) -> None:
        """Count an answer that took ``seconds`` of processor time."""
        self.answers[answer] += 1
        self.slowest = max(self.slowest, seconds)

    def measure(self, begun: float) -> None:
        """Note the seconds since ``begun`` and the peak memory of this process."""
        self.seconds = time.monotonic() - begun
        self.memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss >> 10

    def add(self, other: "AnswerFigures") -> None:
        """Add the figures of another process."""
        self.answers += other.answers
        self.seconds += other.seconds
        self.slowest, self.memory = max(self.slowest, other.slowest), max(self.memory, other.memory)
        self.failures |= other.failures

    def report(self, name: str) -> int:
        """Print the figures and the failures; return 1 if there is a failure."""
        answers = ", ".join(f"{number:,} {answer}" for answer, number in sorted(self.answers.items()))
        most = f"slowest {self.slowest:.2f} s, {self.memory} MiB; {len(self.failures)} failures"
        print(f"{name}: {self.answers.total():,} in {self.seconds:.0f} s: {answers}; {most}", flush=True)
        for kind, kept in self.failures.items():
            print(f"  {kind}: {kept}", flush=True)
        return int(bool(self.failures))
