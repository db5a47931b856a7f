"""Claims that a vector environment must meet, in its own autoreset mode.

Gymnasium's own ``check_env`` is for single environments. The claims are those that ``SyncVectorEnv`` of
Gymnasium 1.4 meets, that the documentation makes about vector environments, and that wrappers rely on.
"""

from collections.abc import Callable, Collection, Iterator
from copy import deepcopy
from itertools import combinations
from typing import Any

import numpy as np
from gymnasium.envs.registration import EnvSpec
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from tests.sim.conformance.autoreset import autoreset, refusals
from tests.sim.conformance.trial import (
    FAR,
    StepResult,
    Trial,
    brief,
    difference,
    fingerprint,
    hold,
    leaves,
    shared,
)

CALLS = 10
"""Number of successive calls that are checked for shared memory."""


def check_vector_env(
    envs: VectorEnv,
    *,
    steps: int = 1000,
    seed: int = 0,
    options: dict[str, Any] | None = None,
    skip: Collection[str] = (),
) -> None:
    """Raise ``ConformanceError`` (an ``AssertionError``) for the first of these claims that does not hold.

    | claim | says |
    |---|---|
    | attributes | sizes, spaces, render mode and metadata are there and agree |
    | spec | can be set, as ``make_vec`` does, and comes back from JSON as it was |
    | returns | results of ``reset`` and ``step`` have the types, shapes, dtypes and bounds of the spaces |
    | determinism | the same seed and actions give the same observations, rewards and flags |
    | infos | the same seed and actions also give the same infos |
    | memory | the caller owns the results: no later call changes them, and writing on them changes nothing |
    | distinct | environments, seeds and successive resets differ |
    | seeds | a list gives each environment its seed; ``seed=s`` means ``s + i`` for environment i |
    | options | ``reset`` leaves the dict of options as it was |
    | autoreset | the behaviour after an end is that of ``metadata["autoreset_mode"]`` |
    | refusals | if autoreset is disabled: steps of ended environments and wrong ``reset_mask``s are errors |
    | render | if ``rgb_array``: a picture (height, width, 3) uint8 for each environment, all of one size |
    | close | can be called twice; it is the last claim, since the environment is closed then |

    The check makes ``steps`` random actions. An episode must end within them, so give more for long episodes.
    ``options``: argument of ``reset`` under the claim of that name. ``skip``: claims not to check, such as
    ``distinct`` if nothing is random. Environments of JAX or torch are checked under Gymnasium's wrappers to
    NumPy. Raises ``ValueError`` if ``skip`` names an unknown claim.
    """
    unknown = set(skip) - set(CLAIMS)
    if unknown:
        raise ValueError(f"no claim is named {min(unknown)!r}: there are {', '.join(CLAIMS)}")
    trial = Trial(envs, steps, seed, options)
    for name, claim in CLAIMS.items():
        if name not in skip:
            hold(name, trial, claim)


def _attributes(trial: Trial) -> None:
    envs = trial.envs
    if not isinstance(envs.num_envs, int | np.integer) or envs.num_envs < 1:
        trial.fail(f"num_envs is {envs.num_envs!r}: expected a positive number")
    for name in ("observation", "action"):
        single, batch = getattr(envs, f"single_{name}_space"), getattr(envs, f"{name}_space")
        if batch != batch_space(single, envs.num_envs):
            trial.fail(f"{name}_space is {batch}: expected batch_space(single_{name}_space, num_envs)")
    metadata = envs.metadata
    missing = {"render_modes", "render_fps", "autoreset_mode"} - set(metadata)
    if missing:
        trial.fail(f"metadata has no {min(missing)!r}")
    if not isinstance(trial.mode, AutoresetMode):
        trial.fail(f"metadata['autoreset_mode'] is {trial.mode!r}: expected an AutoresetMode")
    # TorchRL reads this attribute; Gymnasium's own environments need not have it.
    if getattr(envs, "autoreset_mode", trial.mode) != trial.mode:
        trial.fail(f"autoreset_mode is not that of the metadata: expected {trial.mode}")
    if envs.render_mode not in (None, *metadata["render_modes"]):
        trial.fail(f"render_mode is {envs.render_mode!r}: expected one of {metadata['render_modes']}")


def _spec(trial: Trial) -> None:
    unwrapped, trial.where = trial.envs.unwrapped, "spec"
    unwrapped.spec = unwrapped.spec
    if unwrapped.spec is not None and EnvSpec.from_json(unwrapped.spec.to_json()) != unwrapped.spec:
        trial.fail("another one comes back from to_json: expected arguments that JSON keeps")


def _returns(trial: Trial) -> None:
    trial.reset()
    for _ in trial.play(trial.steps):
        pass


def _determinism(trial: Trial) -> None:
    _same_twice(trial, "observation", "reward", "terminated", "truncated")


def _infos(trial: Trial) -> None:
    _same_twice(trial, "info")


def _same_twice(trial: Trial, *parts: str) -> None:
    def prints(now: StepResult) -> dict[str, Any]:
        return fingerprint({part: vars(now)[part] for part in parts})

    first = [prints(now) for now in trial.play(trial.steps)]
    for before, now in zip(first, trial.play(trial.steps), strict=False):
        if prints(now) != before:
            what = next(path for path in before | prints(now) if before.get(path) != prints(now).get(path))
            trial.fail(f"{what} is another the second time: expected the same for seed and actions")


def _memory(trial: Trial) -> None:
    calls = [(trial.where, now, deepcopy(now)) for now in trial.play(CALLS)]
    for (where, one, before), (trial.where, other, _) in combinations(calls, 2):
        if what := shared(vars(one), vars(other)):
            trial.fail(f"{what} is the same memory as in {where}: expected a fresh array")
        if what := difference(vars(before), vars(one)):
            trial.fail(f"{what} of {where} has changed since: expected it to be left alone")
    for now, (_, _, before) in zip(trial.play(CALLS), calls, strict=True):
        if what := difference(vars(before), vars(now)):
            trial.fail(f"{what} depends on what a caller wrote on arrays returned earlier")
        for _, leaf in leaves(vars(now)):
            if isinstance(leaf, np.ndarray) and leaf.flags.writeable and leaf.dtype.kind in "biuf":
                leaf.fill(1)


def _distinct(trial: Trial) -> None:
    size = trial.envs.num_envs

    def run(seed: int | None) -> Iterator[list[Any]]:
        """Yield each environment's fingerprints until an episode ends, with the same action for all."""
        now = trial.reset(seed)
        yield [fingerprint(one) for one in trial.each(now.observation)]
        for k in range(trial.steps):
            if now.ended.any():
                return
            now = trial.step(trial.batch(trial.split(trial.action(k))[:1] * size))
            yield [fingerprint(one) for one in trial.each(now.observation)]

    first = list(run(trial.seed))
    if size > 1 and all(other == batch[0] for batch in first for other in batch[1:]):
        trial.fail("all environments are the same: expected each to have its own random numbers")
    if list(run(trial.seed + FAR)) == first:
        trial.fail(f"the same as with seed={trial.seed}: expected another seed to make a difference")
    trial.reset(trial.seed)
    if list(run(None)) == first:
        trial.fail(f"the same as with seed={trial.seed}: expected the random numbers to go on")


def _seeds(trial: Trial) -> None:
    listed = [trial.seed + i for i in range(trial.envs.num_envs)]
    first = [fingerprint(now.observation) for now in trial.play(CALLS)]
    if [fingerprint(now.observation) for now in trial.play(CALLS, listed)] != first:
        trial.fail(f"not the same as with seed={trial.seed}: expected seed + i for environment i")
    forth, back = (
        [fingerprint(one) for one in trial.each(trial.reset(seeds).observation)]
        for seeds in (listed, listed[::-1])
    )
    if forth[::-1] != back:
        trial.fail("the environments did not follow their seeds to other places")
    trial.refused("a list of too many seeds", lambda: trial.envs.reset(seed=[*listed, 0]))  # pyright: ignore[reportArgumentType]


def _options(trial: Trial) -> None:
    trial.reset(trial.seed)
    given = dict(trial.options)
    if trial.mode is AutoresetMode.DISABLED:
        given["reset_mask"] = np.arange(trial.envs.num_envs) == 0
    trial.where, before = f"reset(options={given})", deepcopy(given)
    trial.envs.reset(options=given)
    if difference(before, given):
        trial.fail(f"left them as {given}: expected them untouched, as wrappers read them afterwards")


def _render(trial: Trial) -> None:
    if trial.envs.render_mode != "rgb_array":
        return
    trial.reset(trial.seed)
    shown = []
    for k in range(2):
        trial.step(trial.action(k))
        trial.where, frames = "render()", trial.envs.render()
        if not isinstance(frames, tuple | list) or len(frames) != trial.envs.num_envs:
            trial.fail(f"returned {brief(frames)}: expected a tuple, a picture for each environment")
        for frame in frames:
            if not isinstance(frame, np.ndarray) or frame.dtype != np.uint8 or frame.shape[2:] != (3,):
                trial.fail(f"a picture is {brief(frame)}: expected (height, width, 3) uint8")
        shown.append(frames)
    if shared(*shown):
        trial.fail("pictures share memory with earlier ones: a film would show the last one throughout")
    sizes = {frame.shape for frames in shown for frame in frames}
    if len(sizes) > 1:
        trial.fail(f"pictures have sizes {sizes}: expected one, as RecordVideo tiles them")


def _close(trial: Trial) -> None:
    for trial.where in ("close()", "the second close()"):
        trial.envs.close()


CLAIMS: dict[str, Callable[[Trial], None]] = {
    "attributes": _attributes,
    "spec": _spec,
    "returns": _returns,
    "determinism": _determinism,
    "infos": _infos,
    "memory": _memory,
    "distinct": _distinct,
    "seeds": _seeds,
    "options": _options,
    "autoreset": autoreset,
    "refusals": refusals,
    "render": _render,
    "close": _close,
}
