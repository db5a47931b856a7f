"""What the numbers of an agent's map are worth: ``python -m benchmarks.explorers --set THOUGHT=48``.

The explorer (``agent.policies.Explorer``) plays four episodes in each of 320 houses of validation
seeds, as it is and with other numbers in ``agent.planner``: each ``--set`` is a variant, of one
number or of several (``--set DEPTH=4,PLENTY=300``). Tables tell what share of the oracle's targets each
picks up, and what that differs, house by house, from the explorer as it is. Houses and scores are kept, so
that a run that was stopped goes on where it was; scores by the sources that made them.
"""

import hashlib
import inspect
import io
import signal
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from multiprocessing import get_context
from pathlib import Path
from time import process_time
from typing import Literal

import numpy as np
import torch
import tyro
from torch import Tensor

from agent import avoidance, policies
from agent.banks import VALIDATION, bank_hash
from agent.config import TargetMode
from agent.evaluation.baselines import BASELINES
from agent.evaluation.episodes import reset
from agent.evaluation.statistics import interquartile_mean
from agent.evaluation.tables import Table
from agent.planner import Planner
from agent.policies import Explorer, Policy, Tracker
from agent.world import make_worlds, shield
from benchmarks import told
from benchmarks.common.houses import ROOMS
from benchmarks.common.processes import LIBC, say
from benchmarks.constants import MODULES, change, constants
from logic import House, generate, load, save
from logic.errors import RequestError, VitruviusError
from logic.files import write_whole
from sim import HouseVectorEnv, oracle, searcher
from sim.config import DEFAULT

SEED = VALIDATION[len(VALIDATION) // 2]
"""Houses with r rooms are of seed ``SEED + r``: other studies take theirs from where the range begins."""

THIRDS = ("first third", "second", "last")
AS_IS, ORACLE, SEARCHER = "as it is", "oracle", "searcher"

SOURCES = {ORACLE: [oracle], SEARCHER: [searcher]}
"""What a score depends on besides the world, which tests hold to what it is; an explorer's on its map's."""


def _told(what: str) -> str:
    return f"told {what}"


TELLERS = {_told(what): what for what in told.TOLD}


class PlayerFailed(VitruviusError):
    """A player's process ended before its scores were written."""

    exit_code = 1


@dataclass(frozen=True)
class Explorers:
    """Measure the explorer, and variants of it, in houses of validation seeds."""

    targets: tuple[TargetMode, ...] = ("secondary",)
    """Where targets lie: two tables for each."""

    set: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """A variant: NAME=NUMBER, or several with commas between them. Repeat for other variants."""

    searcher: bool = False
    """The searcher too, which knows the house, and where in it a target may still be."""

    told: tyro.conf.UseAppendAction[tuple[Literal["floor", "rooms", "walls"], ...]] = ()
    """An explorer that is told what it could not know: which unseen ground is floor; also in which rooms
    targets lie; also where walls and furniture stand. Repeat for several."""

    houses: int = 64
    """Houses of each number of rooms, 2 to 6."""

    episodes: int = 4
    """Episodes in each house, with other targets each: with one, differences below 0.01 are noise."""

    steps: int = DEFAULT.steps
    """Of an episode that are played."""

    out: Path = Path("runs/explorers")
    """Folder for houses, scores and explorers.md."""

    def run(self) -> None:
        """Play what was not played yet, each player in a process of its own; print the tables."""
        if min(self.houses, self.episodes) < 1 or not len(THIRDS) <= self.steps <= DEFAULT.steps:
            lengths = f"--steps {len(THIRDS)} to {DEFAULT.steps}"
            raise RequestError(f"--houses and --episodes must be 1 or more, {lengths}")
        for text in self.set:
            constants(text)
        players = list(dict.fromkeys((AS_IS, *self.set, *map(_told, self.told), *[SEARCHER] * self.searcher)))
        for player in (ORACLE, *players):
            if not all(self.path(mode, player).exists() for mode in self.targets):
                # A kernel keeps the numbers that it was compiled with, as long as its process lives.
                process = get_context("spawn").Process(target=_play, args=(self, player))
                process.start()
                process.join()
                if process.exitcode:
                    raise PlayerFailed(f"{player}: its process ended with {process.exitcode}, see above")
        rooms, page = np.array([len(house.rooms) for house in self.bank]), []
        for mode in self.targets:
            kept = {player: np.load(self.path(mode, player)) for player in (ORACLE, *players)}
            # Where the oracle finds none, as if it found one in all of the episodes.
            most = np.maximum(kept.pop(ORACLE)["targets"].sum(axis=0), 1 / self.episodes)
            page += [sheet.markdown() for sheet in sheets(mode, kept, most, rooms)]
        write_whole(self.out / "explorers.md", "\n\n".join([*page, ""]).encode())
        print("\n\n".join(page))

    @cached_property
    def bank(self) -> list[House]:
        """The houses, made once."""
        path = self.out / f"houses-{self.houses}.jsonl"
        if not path.exists():
            series = (generate(rooms, seed=SEED + rooms, count=self.houses) for rooms in ROOMS)
            save([house for houses in series for house in houses], path)
        return load(path)

    def path(self, mode: str, player: str) -> Path:
        """Where what a player did is kept: its targets (3, H) of each third of an episode in each house, on
        average, and microseconds of the map for a step of one environment.
        """
        known, name = [bank_hash(self.bank), self.episodes, self.steps], player
        if player not in SOURCES:
            known, name = [*known, sorted(changed(player).items())], "explorer"
        sources = SOURCES.get(player, [*MODULES.values(), policies, avoidance])
        if player in TELLERS:
            known, name, sources = [*known, player], player.replace(" ", "-"), [*sources, told]
        key = hashlib.sha256(repr([*known, *map(inspect.getsource, sources)]).encode()).hexdigest()
        return self.out / f"{mode}-{name}-{key[:12]}.npz"

    def play(self, player: str) -> None:
        """Play in the modes that are missing. A variant's numbers hold in this process from now on."""
        torch.set_num_threads(1)
        change(changed(player))
        for mode in self.targets:
            path, content = self.path(mode, player), io.BytesIO()
            if not path.exists():
                envs = make_worlds(self.bank, self.episodes * len(self.bank), mode)
                what = TELLERS.get(player)
                tracker = told.Teller(envs, what) if what else Clock(envs.config)
                policy = BASELINES[player](envs, 0) if player in SOURCES else explorer(envs, tracker)
                if isinstance(tracker, told.Teller) and what == told.WALLS:
                    episode(envs, policy, self.steps, len(self.bank))
                    tracker.remember()
                targets = episode(envs, policy, self.steps, len(self.bank))
                targets = targets.reshape(len(THIRDS), self.episodes, -1).mean(axis=1)
                np.savez(content, targets=targets, microseconds=tracker.microseconds)
                write_whole(path, content.getvalue())
                say(f"{mode}, {player}: {targets.sum() / len(self.bank):.2f} targets an episode")


class Clock(Tracker):
    """Keeps maps, and the seconds that they took of processors, whatever else these do."""

    seconds: tuple[float, ...] = ()

    def look(self, observation: Tensor, blocked: Tensor) -> Planner:
        """The maps, with what the last actions led to."""
        began = process_time()
        found = super().look(observation, blocked)
        self.seconds += (process_time() - began,)
        return found

    @property
    def microseconds(self) -> float:
        """Of a map's step, but for the first, which compiles; not a number where there was none."""
        return 1e6 * float(np.mean(self.seconds[1:])) / len(self.actions) if self.seconds else np.nan


def changed(player: str) -> dict[str, float]:
    """The numbers that a player's map has in place of its own."""
    return {} if player in (AS_IS, *SOURCES, *TELLERS) else constants(player)


def explorer(envs: HouseVectorEnv, tracker: Tracker) -> Policy:
    """An explorer for these environments, with what keeps its maps."""
    policy = Explorer(shield(envs), envs.config)
    policy.tracker = tracker
    return policy


def episode(envs: HouseVectorEnv, policy: Policy, steps: int, houses: int) -> np.ndarray:
    """Targets (3, E) that a policy picks up in each third of so many steps, environment i in house i modulo
    ``houses``.
    """
    observation = reset(envs, 0, np.arange(envs.num_envs) % houses)
    blocked = torch.zeros(envs.num_envs, dtype=torch.bool)
    policy.begin(envs.num_envs)
    targets = np.zeros((len(THIRDS), envs.num_envs))
    for step in range(steps):
        observation, reward, _, _, info = envs.step_torch(policy(observation, blocked))
        blocked = info["blocked"]
        targets[len(THIRDS) * step // steps] += reward.numpy()
    return targets


def sheets(mode: str, kept: dict, most: np.ndarray, rooms: np.ndarray) -> Iterator[Table]:
    """A mode's tables, of what players did in houses of so many ``rooms`` (H,) where the oracle picks up
    ``most`` (H,).
    """
    shares = {player: cuts(each["targets"] / most, rooms) for player, each in kept.items()}
    names = shares[AS_IS]
    yield Table(
        f"Share of the oracle's targets, {mode}, {len(rooms)} houses",
        ("player", "iqm", *names, "µs of the map"),
        [
            (
                player,
                f"{interquartile_mean(each['mean']).value:.3f}",
                *(f"{share.mean():.3f}" for share in each.values()),
                f"{float(kept[player]['microseconds']):.1f}".replace("nan", "-"),
            )
            for player, each in shares.items()
        ],
    )
    if len(shares) == 1:
        return
    yield Table(
        f"The same less that of the explorer as it is, {mode}, and the difference's standard error",
        ("player", *names),
        [
            (player, *(difference(each[name] - names[name]) for name in names))
            for player, each in shares.items()
            if player != AS_IS
        ],
    )


def cuts(shares: np.ndarray, rooms: np.ndarray) -> dict[str, np.ndarray]:
    """Shares (3, H) of all houses, of those with so many ``rooms`` (H,), and in each third as a whole."""
    by_rooms = {f"{number} rooms": shares.sum(axis=0)[rooms == number] for number in np.unique(rooms)}
    return {"mean": shares.sum(axis=0)} | by_rooms | dict(zip(THIRDS, len(THIRDS) * shares, strict=True))


def difference(pairs: np.ndarray) -> str:
    """A mean difference over houses (H,), with its standard error."""
    return f"{pairs.mean():+.3f} ± {pairs.std() / max(len(pairs) - 1, 1) ** 0.5:.3f}"


def _play(study: Explorers, player: str) -> None:
    LIBC.prctl(1, signal.SIGTERM)  # PR_SET_PDEATHSIG: end if the study is killed
    study.play(player)


if __name__ == "__main__":
    try:
        tyro.cli(Explorers).run()
    except VitruviusError as error:
        say(f"error: {error}")
        sys.exit(error.exit_code)
