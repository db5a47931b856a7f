"""Checks of each autoreset mode after the end of an episode; all three modes give the same episodes."""

from collections.abc import Callable, Iterator
from copy import deepcopy
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv

from tests.sim.conformance.trial import (
    FAR,
    ConformanceError,
    StepResult,
    Trial,
    brief,
    difference,
    fingerprint,
    hold,
    shared,
)


def check_autoreset_modes(
    make: Callable[[AutoresetMode], VectorEnv], *, steps: int = 1000, seed: int = 0
) -> None:
    """Raise ``ConformanceError`` unless the three modes give the same episodes, each in its own way.

    ``make`` creates the environments in a mode. With the same seed, and in each environment the same actions
    in all steps that count, the last observations, rewards, flags and next episodes must be the same.
    """
    episodes: dict[AutoresetMode, list[list[dict[str, Any]]]] = {}
    for mode in AutoresetMode:
        envs = make(mode)
        trial = Trial(envs, steps, seed)
        hold(mode.name, trial, autoreset)
        episodes[mode] = _events(trial)
        envs.close()
    first, *others = episodes
    for mode in others:
        for index, (ours, theirs) in enumerate(zip(episodes[first], episodes[mode], strict=True)):
            for k, (one, other) in enumerate(zip(ours, theirs, strict=False)):
                if one != other:
                    what = next(key for key in one | other if one.get(key) != other.get(key))
                    raise ConformanceError(
                        f"environment {index}, event {k} of its episodes: another {what} in {mode.name} "
                        f"than in {first.name}, expected the same episodes"
                    )


def autoreset(trial: Trial) -> None:
    """Check the end of an episode in the environment's own mode."""
    trial.first_end()
    MODES[trial.mode](trial)


def refusals(trial: Trial) -> None:
    """Check that calls that a mode forbids raise an error; only the mode ``DISABLED`` forbids any."""
    if trial.mode is not AutoresetMode.DISABLED:
        return
    count, size = trial.first_end(), trial.envs.num_envs
    trial.at(count)
    trial.refused("a step of ended environments", lambda: trial.envs.step(trial.action(count)))
    for mask in (np.ones(size + 1, bool), np.ones((size, 1), bool), np.ones(size, np.int64)):
        asked = {"reset_mask": mask}
        trial.reset(trial.seed)
        trial.refused(
            f"a reset_mask {mask.shape} of {mask.dtype}",
            lambda asked=asked: trial.envs.reset(options=asked),
        )


def _next_step(trial: Trial) -> None:
    before, fresh = None, False
    for now in trial.play(trial.steps):
        if before is not None and before.ended.any():
            over = before.ended
            if now.reward[over].any():
                trial.fail(f"reward is {now.reward}: expected 0 in the step after an end, where {over}")
            if now.ended[over].any():
                trial.fail(f"flags are set: expected none in the step after an end, where {over}")
            fresh |= _changed(trial, over, before.observation, now.observation)
        before = now
    if not fresh:
        trial.fail("no step after an end changed the observation: expected the next episode's first")
    count = trial.first_end()
    over, usual = trial.at(count).ended, trial.action(count)
    expected = fingerprint(trial.step(usual).observation)
    for k in range(count + 1, count + 11):
        pairs = zip(over, trial.split(trial.action(k)), trial.split(usual), strict=True)
        actions = trial.batch([other if end else same for end, other, same in pairs])
        trial.at(count)
        if fingerprint(trial.step(actions).observation) != expected:
            trial.fail(f"the action made a difference: expected it to be ignored after an end, where {over}")


def _same_step(trial: Trial) -> None:
    fresh = False
    for now in trial.play(trial.steps):
        over = now.ended
        for key in ("final_obs", "final_info"):
            mask = now.info.get(f"_{key}", np.zeros_like(over))
            if (over.any() and key not in now.info) or (mask != over).any():
                trial.fail(f"{key} is there for {mask}: expected it where episodes ended, {over}")
        if over.any():
            if not isinstance(now.info["final_info"], dict):
                trial.fail(f"final_info is {brief(now.info['final_info'])}: expected a dict")
            final, after = _final(trial, now), trial.each(now.observation)
            for index in np.flatnonzero(over):
                trial.fits(f"final_obs[{index}]", final[index], trial.envs.single_observation_space)
            if shared(now.observation, now.info["final_obs"]):
                trial.fail("final_obs shares memory with the observation: expected a copy")
            fresh |= any(
                trial.fingerprint(final[k]) != trial.fingerprint(after[k]) for k in np.flatnonzero(over)
            )
    if not fresh:
        trial.fail("final_obs is always the observation itself: expected the next episode's observation")


def _disabled(trial: Trial) -> None:
    before, fresh, size = None, False, trial.envs.num_envs
    for now in trial.play(trial.steps):
        if before is not None and before.ended.any():
            if _changed(trial, ~before.ended, before.observation, now.observation):
                trial.fail("changed an observation outside its mask: expected it back as it was")
            fresh |= _changed(trial, before.ended, before.observation, now.observation)
        before = now
    if not fresh:
        trial.fail("no reset by mask changed an observation: expected the next episode's first")

    count = trial.first_end()

    def others(now: StepResult) -> dict[str, Any]:
        flags = [array[1:] for array in (now.reward, now.terminated, now.truncated)]
        return fingerprint([trial.each(now.observation)[1:], *flags])

    trial.at(count)
    trial.reset()
    trial.step(trial.action(0))
    usual = [others(now) for now in trial.play(count)]
    alone, half = np.arange(size) == 0, count // 2
    expected = trial.each(trial.reset(trial.seed + FAR).observation)[0]
    trial.at(half)
    now = trial.reset(trial.seed + FAR, alone)
    if difference(expected, trial.each(now.observation)[0]):
        trial.fail("environment 0 is not as this seed has it after a reset of all")
    for k in range(half, count):
        if not now.ended[0]:
            now = trial.step(trial.action(k))
            if others(now) != usual[k + 1]:
                trial.fail("other environments went on differently, though environment 0 alone was reset")


def _changed(trial: Trial, where: np.ndarray, before: Any, after: Any) -> bool:
    """Return True if the observation of any of the environments ``where`` has changed."""
    pairs = list(zip(trial.each(before), trial.each(after), strict=True))
    return any(difference(*pairs[index]) for index in np.flatnonzero(where))


def _final(trial: Trial, now: StepResult) -> list[Any]:
    """Return the last observation of each environment, from an array of objects or a dense batch."""
    final = now.info["final_obs"]
    return list(final) if isinstance(final, np.ndarray) else trial.each(final)


def _events(trial: Trial) -> list[list[dict[str, Any]]]:
    """Return the events of each environment, independent of the mode: resets, and steps that count."""

    def plan(seed: int) -> Iterator[Any]:
        space = deepcopy(trial.envs.single_action_space)
        space.seed(seed)
        while True:
            yield space.sample()

    def begins(observation: Any) -> dict[str, Any]:
        return {"event": "reset", "observation": trial.fingerprint(observation)}

    size, mode = trial.envs.num_envs, trial.mode
    plans, idle = [plan(trial.seed + index) for index in range(size)], trial.split(trial.action(0))
    events = [[begins(one)] for one in trial.each(trial.reset(trial.seed).observation)]
    over = np.zeros(size, bool)
    for _ in range(trial.steps):
        if mode is AutoresetMode.DISABLED and over.any():
            first = trial.each(trial.reset(mask=over).observation)
            for index in np.flatnonzero(over):
                events[index].append(begins(first[index]))
            over = np.zeros(size, bool)
        now = trial.step(trial.batch([idle[i] if over[i] else next(plans[i]) for i in range(size)]))
        seen, ended = trial.each(now.observation), now.ended
        final = _final(trial, now) if mode is AutoresetMode.SAME_STEP and ended.any() else seen
        for index in range(size):
            if over[index]:
                events[index].append(begins(seen[index]))
                continue
            event = {
                "event": "step",
                "observation": trial.fingerprint((final if ended[index] else seen)[index]),
            }
            flags = {name: vars(now)[name][index].item() for name in ("reward", "terminated", "truncated")}
            events[index].append(event | flags)
            if mode is AutoresetMode.SAME_STEP and ended[index]:
                events[index].append(begins(seen[index]))
        over = ended & (mode is not AutoresetMode.SAME_STEP)
    return events


MODES = {
    AutoresetMode.NEXT_STEP: _next_step,
    AutoresetMode.SAME_STEP: _same_step,
    AutoresetMode.DISABLED: _disabled,
}
