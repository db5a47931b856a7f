"""Many houses at once: a Gymnasium ``VectorEnv``."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium import spaces
from gymnasium.error import ResetNeeded
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from logic import House, load
from sim.config import PRESETS, Config
from sim.continuous import Continuous
from sim.places import TARGETS
from sim.runtime import start
from sim.world import BLOCKED, TERMINATED, TRUNCATED, World

if TYPE_CHECKING:
    import torch

    from sim.film import Camera, Scene

Houses = str | Path | Sequence[House] | dict[str, Any]

BACKENDS = {"continuous": Continuous}

ACTIONS = 3
"""Turn left, turn right, forward."""

METADATA = {"render_modes": ["rgb_array"], "render_fps": 30}


class HouseVectorEnv(VectorEnv):
    """Bodies with 40 rays look for targets in furnished houses, all stepped by one kernel.

    ## Description
    Each environment draws a house of the bank at the start of each episode. A body walks in it and picks up
    targets: square areas that appear one after the other. Metres, x east and y south; headings turn
    counter-clockwise from east.

    ## Action Space
    ``Discrete(3)``: 0 turns left by 45 degrees, 1 turns right, 2 goes one step (0.0717 m) forward along
    an axis, or as far along both on a diagonal. A step into something is blocked: it is not made.

    ## Observation Space
    ``Box(0, 1, (40, 2), float32)``, a row for each ray from left to right:

    | column | means | unit |
    |---|---|---|
    | distance | to the nearest wall, piece or target; 1 if there is none within the range | 7.89 m |
    | is target | 1 where that is the target | |

    Ray i looks 58.5 - 3 i degrees counter-clockwise from the heading. The ``paper`` preset looks at 60 - 3 i
    and puts a column before the others: the ray's absolute angle, in units of 359 degrees.

    ## Rewards
    1 for each target picked up, by the body's overlapping it after the action; else 0. The next one is drawn
    at once, at least 0.82 m from it along one axis (where the house allows), so none falls in one's lap.

    ## Starting State
    Anywhere free in the main room, at any of the eight headings, not on the first target. ``paper``: at the
    free place nearest to the main room's middle, heading north.

    ## Episode End
    Truncated after 1500 steps; ``paper`` also terminates at a collision.

    ## Info
    Arrays by environment: ``pose`` (E, 3) of the eye (x, y, heading: metres, radians), ``blocked`` (E,),
    ``house`` (E,) its number in the bank, ``target`` (E, 2) its centre in metres.

    ## Random numbers
    They are keyed by (seed + i, episode, counter) for environment i, as in ``SyncVectorEnv``. A trajectory
    does not depend on the number of environments, and an episode's k-th target is a function of seed + i,
    episode, house and k: it never depends on the agent. So to measure agents on the same tasks, give house i
    to environment i by ``reset(seed=0, options={"house": np.arange(n)})`` and step one episode: each agent
    meets the same starts and the same targets in the same order.

    ## Arguments
    ``houses``: a file's path, a list of ``House``, or a request for ``logic.generate``, such as
    ``{"rooms": 4, "count": 64}``. ``targets``: where they lie, ``main`` room, ``secondary`` rooms or
    ``mixed``. ``preset``: ``default``, ``paper`` or a ``sim.Config``. ``max_episode_steps``: in place of the
    preset's. ``seed``: of the first reset, if that is given none.
    """

    def __init__(
        self,
        houses: Houses,
        num_envs: int = 1,
        *,
        backend: str = "continuous",
        targets: str = "main",
        preset: str | Config = "default",
        seed: int | None = None,
        max_episode_steps: int | None = None,
        render_mode: str | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
    ) -> None:
        """Pack the houses and compile. ``ValueError`` says what is wrong with an argument or a house."""
        if num_envs < 1:
            raise ValueError(f"num_envs is {num_envs}: at least one environment")
        _require("backend", backend, BACKENDS)
        _require("targets", targets, TARGETS)
        if not isinstance(preset, Config):
            _require("preset", preset, PRESETS)
            preset = PRESETS[preset]
        if max_episode_steps is not None:
            if max_episode_steps < 1:
                raise ValueError(f"max_episode_steps is {max_episode_steps}: at least one step")
            preset = replace(preset, steps=max_episode_steps)
        if render_mode not in (None, *METADATA["render_modes"]):
            raise ValueError(f"unknown render_mode {render_mode!r}: try {METADATA['render_modes'][0]!r}")
        if AutoresetMode(autoreset_mode) is not AutoresetMode.NEXT_STEP:
            raise ValueError(f"autoreset_mode {autoreset_mode} is not there yet: use AutoresetMode.NEXT_STEP")
        self.autoreset_mode = AutoresetMode.NEXT_STEP
        self.metadata = METADATA | {"autoreset_mode": self.autoreset_mode}
        self.render_mode, self.num_envs, self.config = render_mode, num_envs, preset
        self.houses = _bank(houses)

        start()
        self.world = World(preset, BACKENDS[backend](preset), self.houses, targets, num_envs)

        self.single_action_space = spaces.Discrete(ACTIONS)
        shape = (preset.rays, preset.channels)
        # An angle of 359.5 degrees would be more than 1 in units of 359: the original's unit is kept.
        high = np.broadcast_to(np.array([360 / 359, 1, 1][-preset.channels :], np.float32), shape)
        self.single_observation_space = spaces.Box(np.zeros(shape, np.float32), high, shape, np.float32)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)

        self._seed, self._ready = seed, False
        self._observation = np.zeros((num_envs, *shape), np.float32)
        self._reward = np.zeros(num_envs, np.float32)
        self._flags = np.zeros((3, num_envs), np.uint8)
        self._tensors: tuple[Any, ...] | None = None
        self._cameras: list[Camera] | None = None

    def reset(
        self, *, seed: int | Sequence[int] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin a new episode everywhere. With a seed, environment i has ``seed + i`` and episode 0.

        ``options``: ``house`` (E,) int, each environment's house for this episode; ``pose`` (E, 3) and
        ``target`` (E, 2) in metres and radians, in place of those drawn. ``ValueError`` for wrong ones.
        """
        house, origin, cell, target = self._read(options or {})
        if seed is None and not self._ready:
            seed = self._seed if self._seed is not None else int(self.np_random.integers(2**63))
        if seed is not None:
            if isinstance(seed, int | np.integer):
                seed = range(int(seed), int(seed) + self.num_envs)
            if len(seed) != self.num_envs:
                raise ValueError(f"{len(seed)} seeds for {self.num_envs} environments")
            super().reset(seed=int(seed[0]))
            self.world.sow(np.array([one % 2**64 for one in seed], np.uint64))
        self.world.reset(house, origin, cell, target, self._observation)
        self._flags[:] = 0
        self._ready = True
        return self._observation.copy(), self._info()

    def step(self, actions: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """One action (E,) for each environment; fresh arrays come back.

        The step after an episode's end ignores its action and begins the next episode: reward 0, no flags.
        Raises ``ValueError``, before anything is changed, for actions of another shape, kind or range.
        """
        actions = np.asarray(actions)
        if not np.issubdtype(actions.dtype, np.integer):
            raise ValueError(f"actions must be integers 0, 1 or 2, not {actions.dtype}")
        self._advance(np.ascontiguousarray(actions, np.int64))
        flags = self._flags.view(bool).copy()
        observation, reward = self._observation.copy(), self._reward.copy()
        return observation, reward, flags[TERMINATED], flags[TRUNCATED], self._info()

    def step_torch(
        self, actions: "torch.Tensor"
    ) -> tuple["torch.Tensor", "torch.Tensor", "torch.Tensor", "torch.Tensor", dict[str, "torch.Tensor"]]:
        """``step`` with tensors and without copies: the batched path.

        ``actions`` is (E,) int64 on the CPU. What comes back (observations, rewards, terminated, truncated,
        and of the info ``blocked``) is the same memory at each call: clone what must outlive the next one.
        """
        import torch

        if actions.dtype != torch.int64 or actions.device.type != "cpu" or not actions.is_contiguous():
            raise ValueError("actions must be a contiguous int64 tensor on the CPU")
        self._advance(actions.numpy())
        if self._tensors is None:
            flags = torch.from_numpy(self._flags.view(bool))
            views = torch.from_numpy(self._observation), torch.from_numpy(self._reward)
            self._tensors = (*views, flags[TERMINATED], flags[TRUNCATED], {"blocked": flags[BLOCKED]})
        return self._tensors

    def render(self) -> tuple[np.ndarray, ...] | None:
        """A picture of each environment, (height, width, 3) uint8, where ``render_mode`` is ``rgb_array``."""
        if self.render_mode is None:
            return None
        if not self._ready:
            raise ResetNeeded("call reset() before render()")
        if self._cameras is None:
            from sim.film import Camera

            self._cameras = [Camera(self, index) for index in range(self.num_envs)]
        return tuple(np.asarray(camera.shoot()) for camera in self._cameras)

    def scene(self, index: int) -> "Scene":
        """What there is to see of one environment, for ``sim.film``."""
        from sim.film import Scene

        info, seen = self._info(), self._observation[index, :, -2:]
        return Scene(
            house=self.houses[info["house"][index]],
            config=self.config,
            pose=info["pose"][index],
            target=info["target"][index],
            distance=seen[:, 0] * self.config.range,
            is_target=seen[:, 1] > 0,
            step=int(self.world.time.to_numpy()[index]),
            found=int(self.world.count.to_numpy()[index]) - 1,
        )

    def _advance(self, actions: np.ndarray) -> None:
        if not self._ready:
            raise ResetNeeded("call reset() before step()")
        if actions.shape != (self.num_envs,):
            raise ValueError(
                f"actions have shape {actions.shape}: one for each of {self.num_envs} environments"
            )
        if actions.min() < 0 or actions.max() >= ACTIONS:
            raise ValueError(f"actions go from 0 to 2, found {actions.min()} to {actions.max()}")
        self.world.step(actions, self._observation, self._reward, self._flags)

    def _info(self) -> dict[str, np.ndarray]:
        pose = np.empty((self.num_envs, 3), np.float32)
        target = np.empty((self.num_envs, 2), np.float32)
        house = np.empty(self.num_envs, np.int32)
        self.world.describe(pose, target, house)
        blocked = self._flags[BLOCKED].astype(bool)
        return {"pose": pose, "blocked": blocked, "house": house, "target": target}

    def _read(self, options: dict[str, Any]) -> tuple[np.ndarray, ...]:
        """Options as ``World.reset`` takes them: -1 and NaN where it should draw."""
        unknown = set(options) - {"house", "pose", "target"}
        if unknown:
            raise ValueError(f"unknown reset option {min(unknown)!r}: there are house, pose and target")
        count = self.num_envs
        house, cell = np.full(count, -1, np.int32), np.zeros((count, 3), np.int32)
        origin, target = np.full((2, count, 2), np.nan, np.float32)
        if options.get("house") is not None:
            given = np.asarray(options["house"])
            if given.shape != (count,) or not np.issubdtype(given.dtype, np.integer):
                raise ValueError(f"option house: {count} integers, found {given.dtype} {given.shape}")
            if given.min() < 0 or given.max() >= len(self.houses):
                raise ValueError(f"option house: the bank has houses 0 to {len(self.houses) - 1}")
            house = given.astype(np.int32)
        if options.get("pose") is not None:
            if options.get("house") is None:
                raise ValueError("option pose: say in which houses, by option house")
            origin, cell = self.world.backend.place(house, _floats("pose", options["pose"], (count, 3)))
        if options.get("target") is not None:
            target = _floats("target", options["target"], (count, 2)).astype(np.float32)
        return house, origin, cell, target


def _bank(houses: Houses) -> list[House]:
    if isinstance(houses, dict):
        from logic import generate

        houses = list(generate(**houses))
    elif isinstance(houses, str | Path):
        houses = load(houses)
    houses = list(houses)
    if not houses:
        raise ValueError("no house to simulate: the bank is empty")
    strange = next((h for h in houses if not isinstance(h, House)), None)
    if strange is not None:
        raise ValueError(
            f"houses must be a path, a request or a list of House, not of {type(strange).__name__}"
        )
    return houses


def _floats(name: str, value: Any, shape: tuple[int, ...]) -> np.ndarray:
    array = np.asarray(value, np.float64)
    if array.shape != shape or not np.isfinite(array).all():
        raise ValueError(f"option {name}: finite numbers of shape {shape}, found shape {array.shape}")
    return array


def _require(name: str, value: Any, known: Any) -> None:
    if value not in known:
        raise ValueError(f"unknown {name} {value!r}: there are {', '.join(known)}")
