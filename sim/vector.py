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
from sim.backend import METHODS, Backend
from sim.config import PRESETS, Config
from sim.episodes import HOUSE
from sim.geometry import Geometry
from sim.runtime import start
from sim.tasks import Targets, named
from sim.world import (
    BLOCKED,
    DISABLED,
    KEEP,
    NEXT_STEP,
    SAME_STEP,
    SAMPLE,
    TABLES,
    TERMINATED,
    TRUNCATED,
    World,
)

if TYPE_CHECKING:
    import torch

    from sim.film import Camera, Scene

Houses = str | Path | Sequence[House] | dict[str, Any]

BACKENDS = {"continuous": "sim.continuous:Continuous", "grid": "sim.grid:Grid"}
DEVICES = ("cpu", "cuda")
MODES = {
    AutoresetMode.NEXT_STEP: NEXT_STEP,
    AutoresetMode.SAME_STEP: SAME_STEP,
    AutoresetMode.DISABLED: DISABLED,
}

ACTIONS = 3
"""Turn left, turn right, forward."""

METADATA = {"render_modes": ["rgb_array"], "render_fps": 30}


class HouseVectorEnv(VectorEnv):
    """Bodies with 40 rays look for targets in furnished houses, all stepped by one kernel.

    ## Description
    Each environment samples a house of the bank at the start of each episode. A body walks in it and picks up
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
    1 for each target picked up, by the body's overlapping it after the action; else 0. The next one is
    sampled at once, at least 0.82 m from it along one axis where the house allows.

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
    meets the same starts and the same targets in the same order, those that ``targets`` lists.

    ## Houses
    Each episode samples its house, unless ``assign`` has set one: so a learner can choose the houses in which
    there is most to learn. Targets and starts are sampled as always.

    ## Arguments
    ``houses``: a file's path, a list of ``House``, or a request for ``logic.generate``, such as
    ``{"rooms": 4, "count": 64}``. ``targets``: where they lie, ``main`` room, ``secondary`` rooms or
    ``mixed``, or another task, such as ``{"task": "reach", "room": "kitchen"}``: see ``sim.tasks``.
    ``preset``: ``default``, ``paper`` or a ``sim.Config``. ``max_episode_steps``: in place of the preset's.
    ``seed``: of the first reset, if that is given none.
    """

    def __init__(
        self,
        houses: Houses,
        num_envs: int = 1,
        *,
        backend: str = "continuous",
        targets: Targets = "main",
        preset: str | Config = "default",
        seed: int | None = None,
        max_episode_steps: int | None = None,
        render_mode: str | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        device: str = "cpu",
        by_ray: bool | None = None,
    ) -> None:
        """Pack the houses and compile. ``ValueError`` says what is wrong with an argument or a house."""
        if num_envs < 1:
            raise ValueError(f"num_envs is {num_envs}: at least one environment")
        _require("device", device, DEVICES)
        if not isinstance(preset, Config):
            _require("preset", preset, PRESETS)
            preset = PRESETS[preset]
        if max_episode_steps is not None:
            if max_episode_steps < 1:
                raise ValueError(f"max_episode_steps is {max_episode_steps}: at least one step")
            preset = replace(preset, steps=max_episode_steps)
        if render_mode not in (None, *METADATA["render_modes"]):
            raise ValueError(f"unknown render_mode {render_mode!r}: try {METADATA['render_modes'][0]!r}")
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        self.metadata = METADATA | {"autoreset_mode": self.autoreset_mode}
        self.render_mode, self.num_envs, self.device = render_mode, num_envs, device

        make = _backend(backend)
        start(device)
        self.world = World(
            preset,
            make,
            _bank(houses),
            targets,
            num_envs,
            mode=MODES[self.autoreset_mode],
            by_ray=device != "cpu" if by_ray is None else by_ray,
        )
        self.config = config = self.world.config

        self.single_action_space = spaces.Discrete(ACTIONS)
        shape = (config.rays, config.channels)
        # An angle of 359.5 degrees would be more than 1 in units of 359: the original's unit is kept.
        high = np.ones(shape, np.float32)
        if config.sees_angle:
            high[:, 0] = 360 / 359
        self.single_observation_space = spaces.Box(np.zeros(shape, np.float32), high, shape, np.float32)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)

        self._seed, self._ready = seed, False
        self._tensors: tuple[Any, tuple[Any, ...]] | None = None
        self._cameras: list[Camera] | None = None

    @property
    def houses(self) -> list[House]:
        """The bank that episodes sample from."""
        return self.world.houses

    @property
    def geometries(self) -> list[Geometry]:
        """The boxes of each house of the bank, metres."""
        return self.world.bank.geometries

    @property
    def backend(self) -> Backend:
        """What moves bodies and casts rays."""
        return self.world.backend

    def assign(self, houses: Any) -> None:
        """Set the houses (E,) of the bank in which the next episodes take place, -1 for one that is sampled.

        It holds for each environment's next episode, however it begins, and for all after it, until the next
        ``assign``. A reset's option ``house`` overrides it for one episode, and another bank clears it.
        Episodes under way go on as they are. Raises ``ValueError``, and changes nothing, for other shapes,
        kinds or numbers.
        """
        self.world.arrays["assigned"].fill(self._numbers("assign", houses, SAMPLE))

    def set_houses(self, houses: Houses, targets: Targets | None = None) -> None:
        """Take another bank in place of this one, with targets where they were or elsewhere; then ``reset``.
        Nothing is compiled anew.

        Raises ``ValueError``, and changes nothing, where a house or a target cannot be had.
        """
        self.world.load(_bank(houses), targets)
        self._ready, self._cameras = False, None

    def reset(
        self, *, seed: int | Sequence[int] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin a new episode everywhere. With a seed, environment i has ``seed + i`` and episode 0.

        ``options``: ``house`` (E,) int, each environment's house for this episode; ``pose`` (E, 3) and
        ``target`` (E, 2) in metres and radians, in place of those sampled or assigned; ``reset_mask`` (E,)
        bool, those environments that begin a new episode, all but the first time. ``ValueError`` for wrong
        ones, before anything is changed.
        """
        mask, option_wholes, option_reals = self._read(options or {})
        if seed is None and not self._ready:
            seed = self._seed if self._seed is not None else int(self.np_random.integers(2**63))
        if seed is not None:
            if isinstance(seed, int | np.integer):
                seed = range(int(seed), int(seed) + self.num_envs)
            if len(seed) != self.num_envs:
                raise ValueError(f"{len(seed)} seeds for {self.num_envs} environments")
            words = np.array([int(one) % 2**64 for one in seed], np.uint64)
            super().reset(seed=int(seed[0]))
            self.world.seed(words, mask)
        self.world.reset(option_wholes, option_reals)
        flags = self._flags()
        flags[:, mask] = False
        self.world.arrays["flags"].fill(flags.view(np.uint8).ravel())
        self._ready = True
        return self._seen(), self._info(flags)

    def step(self, actions: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """One action (E,) for each environment; fresh arrays come back.

        What follows an episode's end is the ``autoreset_mode``'s: by default the step after it ignores its
        action and begins the next episode, with reward 0 and no flags. In ``SAME_STEP`` the info has
        ``final_obs`` (E, R, C) and ``final_info``, valid where ``_final_obs`` is True. In ``DISABLED`` it is
        an error to step an environment that has ended.
        Raises ``ValueError``, before anything is changed, for actions of another shape, kind or range.
        """
        actions = np.asarray(actions)
        if not np.issubdtype(actions.dtype, np.integer):
            raise ValueError(f"actions must be integers 0, 1 or 2, not {actions.dtype}")
        self._check(actions)
        self.world.arrays["action"].fill(actions)
        self.world.run("step")
        flags, observation, reward = self._flags(), self._seen(), self.world.arrays["reward"].numpy()
        info = self._info(flags)
        if self.autoreset_mode is AutoresetMode.SAME_STEP:
            self._tell_finals(flags[TERMINATED] | flags[TRUNCATED], info)
        return observation, reward, flags[TERMINATED], flags[TRUNCATED], info

    def step_torch(
        self, actions: "torch.Tensor"
    ) -> tuple["torch.Tensor", "torch.Tensor", "torch.Tensor", "torch.Tensor", dict[str, "torch.Tensor"]]:
        """``step`` with tensors and without copies: the batched path.

        ``actions`` is (E,) int64 on the environments' device. What comes back (observations, rewards,
        terminated, truncated, and of the info ``blocked`` and ``house`` (int32), and ``final_obs`` where the
        mode is ``SAME_STEP``) is the same memory at each call: clone what must outlive the next one.
        """
        import torch

        if actions.dtype != torch.int64 or actions.device.type != self.device:
            raise ValueError(f"actions must be an int64 tensor on the device {self.device!r}")
        # By NumPy where that can be: torch's threads would stay awake, and in the way of those that step.
        given: Any = actions.numpy() if self.device == "cpu" else actions
        self._check(given)
        if self._tensors is None:
            self._tensors = self._shared()
        action, told = self._tensors
        action[:] = given
        self.world.run("step")
        return told

    def _shared(self) -> tuple[Any, tuple[Any, ...]]:
        """The actions, and what ``step_torch`` gives, in the world's own memory."""
        arrays, count = self.world.arrays, self.num_envs
        shape = count, self.config.rays, self.config.channels
        flags = arrays["flags"].tensor(np.bool_, (3, count))
        wholes = arrays["wholes"].tensor(np.int32, arrays["wholes"].shape)
        info = {"blocked": flags[BLOCKED], "house": wholes[:, HOUSE]}
        if self.autoreset_mode is AutoresetMode.SAME_STEP:
            info["final_obs"] = arrays["final"].tensor(np.float32, shape)
        observation, reward = (
            arrays["observation"].tensor(np.float32, shape),
            arrays["reward"].tensor(np.float32, (count,)),
        )
        told = observation, reward, flags[TERMINATED], flags[TRUNCATED], info
        action = arrays["action"]
        return action.view() if self.device == "cpu" else action.tensor(np.int64, (count,)), told

    def launch(self, actions: np.ndarray) -> None:
        """Run the step's kernel alone on actions (E,) int64: for measurements, only on the CPU.

        Nothing is checked or returned; its outputs are in the memory that ``step_torch`` returns.
        """
        self.world.arrays["action"].view()[:] = actions
        self.world.run("step")

    def info(self) -> dict[str, np.ndarray]:
        """The info of the environments as they are now: copies, as ``step`` returns them."""
        return self._info()

    def tables(self) -> dict[str, np.ndarray]:
        """What kernels read of the bank, copies: ``numbers`` (n,) float32 and ``indices`` (m,) int32, laid
        out as the backend's ``pack.py`` says, and ``places`` (p,) int32, as ``sim.world`` says.
        """
        return {name: self.world.arrays[name].numpy() for name in TABLES}

    def targets(self, count: int) -> np.ndarray:
        """Each environment's target and those that follow it in this episode, (E, count, 2), metres.

        After a reset: what an episode brings in order, whatever the agent does.
        """
        if not self._ready:
            raise ResetNeeded("call reset() before targets()")
        return self.world.targets(count)

    @property
    def state(self) -> dict[str, np.ndarray]:
        """All that the next steps depend on, but for the houses: copies, to be given back another time.

        With them every environment goes on bit for bit, in this or another environment of the same
        arguments.
        """
        return self.world.state | {"flags": self._flags(), "observation": self._seen()}

    @state.setter
    def state(self, state: dict[str, np.ndarray]) -> None:
        kinds = {name: (array.dtype.str, array.shape) for name, array in self.state.items()}
        if {name: (array.dtype.str, array.shape) for name, array in state.items()} != kinds:
            raise ValueError(f"a state of other kinds or shapes: here they are {kinds}")
        house, assigned = int(state["wholes"][:, HOUSE].max()), int(state["assigned"].max())
        if max(house, assigned) >= len(self.houses):
            where = f"a body is in house {house}" if house > assigned else f"house {assigned} is assigned"
            raise ValueError(f"a state of another bank: {where} of {len(self.houses)}")
        self.world.state = state
        for name in ("flags", "observation"):
            array = self.world.arrays[name]
            array.fill(np.ascontiguousarray(state[name]).view(array.dtype).ravel())
        self._ready = True

    def render(self) -> tuple[np.ndarray, ...] | None:
        """A picture of each environment, (height, width, 3) uint8, all as large as the largest house's.

        ``None`` where ``render_mode`` is. ``sim.film.mosaic`` makes one picture of them.
        """
        if self.render_mode is None:
            return None
        if not self._ready:
            raise ResetNeeded("call reset() before render()")
        if self._cameras is None:
            from sim.film import Camera, largest

            frame = largest(self.houses)
            self._cameras = [Camera(self, index, frame=frame) for index in range(self.num_envs)]
        return tuple(np.asarray(camera.shoot()) for camera in self._cameras)

    def scene(self, index: int) -> "Scene":
        """What there is to see of one environment, for ``sim.film``."""
        from sim.film import Scene

        info, column = self._info(), int(self.config.sees_angle)
        seen, state = self._seen()[index], self.world.environment(index)
        return Scene(
            house=self.houses[info["house"][index]],
            config=self.config,
            pose=info["pose"][index],
            target=info["target"][index],
            distance=seen[:, column] * self.config.range,
            is_target=seen[:, -1] > 0,
            step=state["time"],
            found=state["found"] - 1,
        )

    def _check(self, actions: Any) -> None:
        """Raise an error if these actions, an array or a tensor, cannot be done now."""
        if not self._ready:
            raise ResetNeeded("call reset() before step()")
        if actions.shape != (self.num_envs,):
            raise ValueError(
                f"actions have shape {tuple(actions.shape)}: one for each of {self.num_envs} environments"
            )
        least, greatest = int(actions.min()), int(actions.max())
        if least < 0 or greatest >= ACTIONS:
            raise ValueError(f"actions go from 0 to 2, found {least} to {greatest}")
        if self.autoreset_mode is AutoresetMode.DISABLED:
            flags = self._flags()
            over = flags[TERMINATED] | flags[TRUNCATED]
            if over.any():
                raise ResetNeeded(
                    f"the episode of environment {int(over.argmax())} has ended: reset it by "
                    'reset(options={"reset_mask": ...})'
                )

    def _seen(self, name: str = "observation") -> np.ndarray:
        """Observations (E, R, C) float32: a copy."""
        return self.world.arrays[name].numpy().view(np.float32).reshape(self.observation_space.shape)

    def _flags(self) -> np.ndarray:
        """Which environments terminated, were truncated, were blocked (3, E) bool: a copy."""
        return self.world.arrays["flags"].numpy().view(bool).reshape(3, self.num_envs)

    def _info(self, flags: np.ndarray | None = None, last: bool = False) -> dict[str, np.ndarray]:
        pose, target, house = self.world.describe(last)
        flags = self._flags() if flags is None else flags
        return {"pose": pose, "blocked": flags[BLOCKED].copy(), "house": house, "target": target}

    def _tell_finals(self, ended: np.ndarray, info: dict[str, Any]) -> None:
        """Add to an info what was seen last in the episodes that ended in this step."""
        if not ended.any():
            return
        final = self._seen("final")
        final[~ended] = 0
        told = self._info(last=True)
        masks = {f"_{name}": ended.copy() for name in told}
        info["blocked"][ended] = False
        info |= {"final_obs": final, "_final_obs": ended, "final_info": told | masks}
        info["_final_info"] = ended.copy()

    def _read(self, options: dict[str, Any]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Options as ``World.reset`` takes them, and who begins an episode: (E,) bool."""
        known = ("house", "pose", "target", "reset_mask")
        unknown = set(options) - set(known)
        if unknown:
            raise ValueError(f"unknown reset option {min(unknown)!r}: there are {', '.join(known)}")
        count = self.num_envs
        mask = np.ones(count, bool)
        option_wholes, option_reals = np.zeros((count, 4), np.int32), np.full((count, 4), np.nan, np.float32)
        option_wholes[:, 0] = self.world.arrays["assigned"].numpy()
        if options.get("reset_mask") is not None:
            mask = np.asarray(options["reset_mask"])
            if mask.shape != (count,) or mask.dtype != bool:
                raise ValueError(f"option reset_mask: {count} bools, found {mask.dtype} {mask.shape}")
            if not mask.any():
                raise ValueError("option reset_mask: it is False everywhere, so there is nothing to reset")
            if not self._ready and not mask.all():
                raise ResetNeeded("the first reset is everywhere's: leave out reset_mask")
        if options.get("house") is not None:
            option_wholes[:, 0] = self._numbers("option house", options["house"], 0)
        if options.get("pose") is not None:
            if options.get("house") is None:
                raise ValueError("option pose: say in which houses, by option house")
            poses = _floats("pose", options["pose"], (count, 3))
            option_reals[:, :2], option_wholes[:, 1:] = self.world.place(option_wholes[:, 0], poses)
        if options.get("target") is not None:
            option_reals[:, 2:] = _floats("target", options["target"], (count, 2))
        option_wholes[~mask, 0] = KEEP
        return mask, option_wholes, option_reals

    def _numbers(self, name: str, value: Any, least: int) -> np.ndarray:
        """Numbers (E,) of houses in the bank, from ``least`` on."""
        given = np.asarray(value)
        if given.shape != (self.num_envs,) or not np.issubdtype(given.dtype, np.integer):
            raise ValueError(f"{name}: {self.num_envs} integers, found {given.dtype} {given.shape}")
        if given.min() < least or given.max() >= len(self.houses):
            sampled = ", or -1 to sample one" if least == SAMPLE else ""
            raise ValueError(f"{name}: the bank has houses 0 to {len(self.houses) - 1}{sampled}")
        return given


def _backend(name: str) -> type[Backend]:
    """A backend of ours by name, or another's as ``module:Class``."""
    if name in BACKENDS:
        name = BACKENDS[name]
    elif ":" not in name:
        raise ValueError(f"unknown backend {name!r}: there are {', '.join(BACKENDS)}, or module:Class")
    try:
        make = named(name)
    except (ImportError, AttributeError, TypeError, ValueError) as error:
        raise ValueError(f"backend {name!r} cannot be had: {error}") from None
    if not isinstance(make, type):
        raise ValueError(f"backend {name!r} cannot be had: it is no class")
    lacking = next((method for method in METHODS if not callable(getattr(make, method, None))), None)
    if lacking:
        raise ValueError(f"backend {name!r} cannot be had: it has no {lacking}(), see sim.backend.Backend")
    return make


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
        found = f"shape {array.shape}" if array.shape != shape else "some that are not finite"
        raise ValueError(f"option {name}: finite numbers of shape {shape}, found {found}")
    return array


def _require(name: str, value: Any, known: Any) -> None:
    if value not in known:
        raise ValueError(f"unknown {name} {value!r}: there are {', '.join(known)}")
