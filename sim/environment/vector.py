"""Many environments at once: a Gymnasium ``VectorEnv``."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium.error import ClosedEnvironmentError, ResetNeeded
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from vitruvius.logic import House
from vitruvius.logic.spelling import keywords, unknown
from vitruvius.sim.allowed import allow, class_names
from vitruvius.sim.backends.backend import Backend
from vitruvius.sim.environment.arguments import (
    BANK,
    METADATA_OF_MANY,
    MOST_ENVIRONMENTS,
    Houses,
    Preset,
    house_list,
    read_arguments,
    whole,
)
from vitruvius.sim.environment.kept import KeepsState
from vitruvius.sim.environment.observed import single_spaces
from vitruvius.sim.environment.options import read_options, read_seeds, require_mapping
from vitruvius.sim.environment.outputs import Outputs
from vitruvius.sim.environment.passing import passing
from vitruvius.sim.environment.pictures import Pictures, scene_of
from vitruvius.sim.environment.rotation import HouseRotation, require_next_step
from vitruvius.sim.environment.specs import KeepsSpec
from vitruvius.sim.environment.steps import orders, require_going_on
from vitruvius.sim.environment.window import ScreenWindow
from vitruvius.sim.geometry import Geometry
from vitruvius.sim.runtime import start
from vitruvius.sim.tasks.tasks import Targets
from vitruvius.sim.world.arrays import DISABLED, NEXT_STEP, SAME_STEP
from vitruvius.sim.world.phases import TERMINATED, TRUNCATED
from vitruvius.sim.world.world import TABLES, World

if TYPE_CHECKING:
    import torch

    from vitruvius.sim.film import Scene

MODES = {
    AutoresetMode.NEXT_STEP: NEXT_STEP,
    AutoresetMode.SAME_STEP: SAME_STEP,
    AutoresetMode.DISABLED: DISABLED,
}


MOST_TARGETS = 1 << 16
"""Largest number of targets that ``targets`` returns for an episode."""


class HouseVectorEnv(KeepsState, KeepsSpec, VectorEnv):  # pyright: ignore[reportIncompatibleVariableOverride]
    """Vector environment: bodies with 40 rays search furnished houses for targets; one kernel steps them all.

    ## Description
    Each environment samples a house of the bank at the start of each episode. A body walks in the house and
    picks up targets: square areas that appear one after the other. Coordinates are metres, x east and y
    south; headings are counter-clockwise from east.

    ## Action Space
    ``Discrete(3)``: 0 turns left by 45 degrees, 1 turns right, 2 goes one step (0.0717 m) forward along
    an axis, or as far along both axes on a diagonal. A step into an obstacle is blocked: the body stays.
    In the backend ``free``, a ``Box`` (2,) of the forward speed and the turn rate to the left, m/s and rad/s.
    If bodies drive sideways, a ``Box`` (3,); if ``Config.drive`` has commands, ``Discrete``.

    ## Observation Space
    ``Box(0, 1, (40, 2), float32)``, a row for each ray from left to right:

    | column | means | unit |
    |---|---|---|
    | distance | to the nearest wall, furniture or target; 1 if none is within the range | 7.89 m |
    | is target | 1 if the ray ends on the target | |

    ``Config.kinds`` adds columns before the distance, one for each kind: 1 if the ray ends on such furniture.
    Ray i points 58.5 - 3 i degrees counter-clockwise from the heading; in the ``paper`` preset, 60 - 3 i
    degrees. That preset's first column is the ray's absolute angle, in units of 359 degrees.
    ``Config.observe`` can add the parts that ``vitruvius.sim.parts`` lists, such as ``bump`` or ``odometry``.
    The space is then a ``Dict`` of the parts, in the order of ``observe``, or with ``Config.flat`` a ``Box``
    (n,) of all their numbers.

    ## Rewards
    1 for each target that the body overlaps after the action; else 0. The simulator samples the next target
    at once, if possible at least 0.82 m away along one axis.

    ## Starting State
    A random free place in the main room, not on the first target, and a random heading out of eight.
    The task may choose other rooms, as in ``{"task": "main", "starts": ["bedroom"]}`` or ``"starts": "all"``,
    and ``set_next`` other poses. ``paper``: the free place nearest to the middle of the main room, heading
    north.

    ## Episode End
    Truncated after 1500 steps; ``paper`` also terminates at a collision.

    ## Info
    | key | shape | meaning |
    |---|---|---|
    | pose | (E, 3) | x, y and heading of the eye, metres and radians |
    | blocked | (E,) | True if the last move was blocked |
    | house | (E,) | number of the house in the bank |
    | target | (E, 2) | centre of the target, metres |
    | distance | (E,) int32 | with ``Config.geodesic``: fewest actions to the target, -1 without a path |
    | memory | (E, n) float32 | for terms with a memory: the numbers that they keep |
    | targets | (E, n, 2) | for several targets at once: all centres, ``target`` first |

    ## Random numbers
    Random numbers of environment i have the key (seed + i, episode, counter), as in ``SyncVectorEnv``. A
    trajectory does not depend on the number of environments. An episode's k-th target is a function of seed +
    i, episode, house and k, and never depends on the agent. To compare agents on the same tasks, assign house
    i to environment i with ``reset(seed=0, options={"house": np.arange(n)})`` and step one episode: each
    agent then meets the same starts and the same targets in the same order. The method ``targets`` lists the
    targets.

    ## Arguments
    ``houses``: a file's path, a list of ``House``, or a request for ``vitruvius.generate``, such as
    ``{"rooms": 4, "count": 64}``; by default 32 houses of 4 rooms that come with the package.
    ``targets``: the task, by the places of its targets: ``main`` room (or hub), ``secondary`` rooms, ``all``,
    rooms of some types, ``{"rooms": ["bedroom"]}``, or given points, ``{"points": [[2.5, 3.0], [4.0, 1.5]],
    "start": [1.0, 2.0, 0.0]}``. Other tasks are ``habit``, ``{"task": "object", "piece": "bed"}``,
    ``{"task": "reach", "room": "hall"}``, ``visit``, ``battery``, or your own ``module:Class``: see
    ``sim.tasks.tasks``.
    The paper's tasks are ``paper-main``, ``paper-secondary`` and ``paper-mixed`` in the house
    ``paper-house``: ``gymnasium.make_vec("vitruvius:Vitruvius/Paper-v0", targets="paper-main")``.
    ``preset``: ``default``, ``doors``, ``drive``, ``long``, ``noisy``, ``paper``, a ``sim.Config``, or a
    dictionary of its fields, ``{"rays": 20, "observe": ["rays", "goal"]}``.
    ``max_episode_steps``: replaces the preset's length of episodes; the ``spec`` states it.
    ``seed``: seed of the first reset, unless ``reset`` gets one.
    ``render_mode``: ``rgb_array``, or ``human``, which shows each step in a window (pygame).
    """

    @keywords(config="preset", bank="houses", task="targets", n_envs="num_envs")
    def __init__(
        self,
        houses: Houses = BANK,
        num_envs: int = 1,
        *,
        backend: str = "continuous",
        targets: Targets = "main",
        preset: Preset = "default",
        seed: int | None = None,
        max_episode_steps: int | None = None,
        render_mode: str | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        device: str = "cpu",
        by_ray: bool | None = None,
    ) -> None:
        """Pack the houses and compile the kernels.

        Raises ``ValueError`` that names the wrong argument or house.
        """
        num_envs = whole("num_envs", num_envs, MOST_ENVIRONMENTS)
        if seed is not None:
            read_seeds(seed, num_envs)
        asked = read_arguments(
            houses, backend, targets, preset, max_episode_steps, render_mode, device, METADATA_OF_MANY
        )
        known = [mode.value for mode in AutoresetMode]
        if autoreset_mode not in (*AutoresetMode, *known):
            raise ValueError(unknown("autoreset_mode", autoreset_mode, known))
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        require_next_step(houses, self.autoreset_mode)
        self.metadata = METADATA_OF_MANY | {"autoreset_mode": self.autoreset_mode}
        self.render_mode, self.num_envs, self.device = render_mode, num_envs, asked.device

        start(self.device)
        self.world = World(
            asked.config,
            asked.backend,
            asked.houses,
            asked.task,
            num_envs,
            mode=MODES[self.autoreset_mode],
            by_ray=self.device != "cpu" if by_ray is None else bool(by_ray),
        )
        self.config, self.episode_steps = self.world.config, self.world.config.steps

        self.single_observation_space, self.single_action_space = single_spaces(self.config)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)

        self._arguments = {
            "num_envs": num_envs,
            "backend": backend,
            "preset": preset,
            "seed": seed,
            "max_episode_steps": max_episode_steps,
            "render_mode": render_mode,
            "autoreset_mode": self.autoreset_mode,
            "device": device,
            "by_ray": by_ray,
        }
        self._passing = passing(self.world, houses)
        self._outputs, self._orders = Outputs(self.world), orders(self.single_action_space, self.config.drive)
        self._seed, self._ready = seed, False
        self._tensors: tuple[Any, tuple[Any, ...]] | None = None
        window = ScreenWindow(METADATA_OF_MANY["render_fps"]) if render_mode == "human" else None
        self._pictures = Pictures(self, window)

    @property
    def houses(self) -> list[House]:
        """The bank that episodes sample from."""
        return self.world.houses

    @property
    def rotation(self) -> HouseRotation | None:
        """Rotation of the houses, or ``None``."""
        return self._passing.rotation

    @property
    def geometries(self) -> list[Geometry]:
        """Boxes of each house of the bank, metres."""
        return self.world.bank.geometries

    @property
    def backend(self) -> Backend:
        """Backend that moves bodies and casts rays."""
        return self.world.backend

    def set_houses(self, houses: Houses, targets: Targets | None = None) -> None:
        """Replace the bank, and the task if ``targets`` names one; then call ``reset``. Nothing is compiled.

        Raises ``ValueError``, and changes nothing, if a house or a target cannot be used.
        """
        self._require_open()
        require_next_step(houses, self.autoreset_mode)
        allow(*class_names(targets))
        self.world.load(house_list(houses), targets)
        self._passing.close()
        self._passing = passing(self.world, houses)
        self._ready = False
        self._pictures.forget()

    def _run_step(self) -> None:
        if self._passing.step():
            self._pictures.forget()

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begin a new episode everywhere. With a seed, environment i has ``seed + i`` and episode 0.

        ``options`` may have ``house`` (E,) int, each environment's house for this episode; ``pose`` (E, 3)
        and ``target`` (E, 2), in metres and radians, which replace the sampled values (a target is at most
        100 m from its house); and ``reset_mask`` (E,) bool, the environments that begin a new episode, which
        must be all environments at the first reset. Raises ``ValueError`` for invalid options before any
        change.
        """
        self._require_open()
        given = require_mapping(options)
        seeds = None if seed is None else read_seeds(seed, self.num_envs)
        with self._passing.unless_refused():
            if seeds and "reset_mask" not in given and self._passing.go_to(0):
                self._pictures.forget()
            asked = read_options(given, self.world, first=not self._ready)
        if seeds is None and not self._ready:
            seeds = read_seeds(
                int(self.np_random.integers(2**63)) if self._seed is None else self._seed, self.num_envs
            )
        if seeds is not None:
            self._take_seeds(seeds, asked.mask)
        self.world.reset(asked.wholes, asked.reals)
        flags = self._outputs.flags()
        flags[:, asked.mask] = False
        self.world.arrays["flags"].fill(flags.view(np.uint8).ravel())
        self._ready = True
        self._pictures.show()
        return self._outputs.observation(), self._outputs.info(flags)

    def _take_seeds(self, seeds: Sequence[int | None], mask: np.ndarray) -> None:
        """Set the seeds of the environments in a mask (E,) bool.

        Environments without a new seed keep their seed, or begin with a random one.
        """
        if seeds[0] is not None:
            super().reset(seed=seeds[0])
        given = np.array([seed is not None for seed in seeds])
        numbers = [int(self.np_random.integers(2**63)) if seed is None else seed for seed in seeds]
        self.world.seed(np.array(numbers, np.uint64), mask & (given | (not self._ready)))

    def set_next(self, options: dict[str, Any] | None) -> None:
        """Set the options for all episodes that begin automatically after the end of another episode.

        The options are ``house``, ``pose`` and ``target`` as in ``reset``; ``None`` restores the default. A
        curriculum may change them between any two steps. Loading other houses discards the options. The first
        call compiles the step again.

        Raises ``ValueError``, and changes nothing, for invalid options, in a mode without automatic resets,
        and for houses that rotate.
        """
        self._require_open()
        if self.rotation or self.autoreset_mode is AutoresetMode.DISABLED:
            raise ValueError("options for next episodes need automatic resets, and houses that do not rotate")
        given = require_mapping(options)
        if "reset_mask" in given:
            raise ValueError("options for next episodes: only reset() takes reset_mask")
        asked = read_options(given, self.world, first=False)
        self.world.guide(asked.wholes, asked.reals)

    def step(self, actions: Any) -> tuple[Any, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """Step each environment with one action (E,). The returned arrays are new.

        ``autoreset_mode`` defines what follows an episode's end. By default, the step after the end ignores
        its action and begins the next episode, with reward 0 and no flags. In ``SAME_STEP`` the info has
        ``final_obs`` (E, R, C) and ``final_info``, valid where ``_final_obs`` is True. In ``DISABLED`` it is
        an error to step an environment whose episode has ended. Raises ``ValueError``, before any change, for
        actions of another shape, type or range.
        """
        actions = self._orders.read(actions)
        self._check(actions)
        self.world.arrays["action"].fill(self._orders.given(actions))
        self._run_step()
        flags, observation = self._outputs.flags(), self._outputs.observation()
        info = self._outputs.info(flags, stepped=not self.rotation)
        reward = self.world.arrays["reward"].numpy()
        if self.autoreset_mode is AutoresetMode.SAME_STEP:
            info |= self._outputs.finals(flags[TERMINATED] | flags[TRUNCATED])
        self._pictures.show()
        return observation, reward, flags[TERMINATED], flags[TRUNCATED], info

    def step_torch(
        self, actions: "torch.Tensor"
    ) -> tuple[Any, "torch.Tensor", "torch.Tensor", "torch.Tensor", dict[str, Any]]:
        """Step each environment, as ``step`` does, with tensors and without copies.

        ``actions`` is (E,) int64 on the environments' device. Returns observations, rewards, terminated,
        truncated, and an info with ``blocked`` and ``house`` (int32). All calls return the same memory, so
        clone any tensor that you need after the next call. In ``SAME_STEP``, the info also has ``final_obs``,
        and ``final_info`` with ``blocked``, which are valid for environments whose episode ended.
        """
        given = self._orders.read_tensor(actions, self.device)
        self._check(given)
        if self._tensors is None:
            self._tensors = self._outputs.tensors(self.device)
        action, outputs = self._tensors
        action[:] = self._orders.given(given)
        self._run_step()
        if self.config.flat:
            self._outputs.join()
        return outputs

    def launch(self, actions: np.ndarray) -> None:
        """Run only the step's kernel, on actions (E,) int64 or (E, 2) float32: for measurements on the CPU.

        Nothing is checked or returned. The outputs are in the memory that ``step_torch`` returns.
        """
        self.world.arrays["action"].view()[:] = self._orders.given(actions)
        self._run_step()

    def info(self) -> dict[str, np.ndarray]:
        """Return copies of the environments' current info, in the form that ``step`` returns."""
        return self._outputs.info()

    def tables(self) -> dict[str, np.ndarray]:
        """Return copies of the bank's arrays for kernels.

        They are ``numbers`` (n,) float32 and ``indices`` (m,) int32, which the backend's ``pack.py``
        explains, and ``places`` (p,) int32, which ``sim.world.place_table`` explains.
        """
        return {name: self.world.arrays[name].numpy() for name in TABLES}

    def targets(self, count: int) -> np.ndarray:
        """Return each environment's target and the next ones of its episode, (E, count, 2), metres.

        After a reset, these are the episode's targets in order, whatever the agent does.
        """
        self._require_ready("targets")
        return self.world.targets(whole("count", count, MOST_TARGETS))

    def render(self) -> tuple[np.ndarray, ...] | None:
        """Return a picture of each environment, (height, width, 3) uint8, each as large as the largest house.

        The result is ``None`` if ``render_mode`` is ``None``, and if it is ``human``: then ``reset`` and
        ``step`` show the pictures in a window. ``sim.film.mosaic`` joins the pictures.
        """
        self._require_open()
        if self.render_mode is None:
            return None
        self._require_ready("render")
        if self._pictures.window:
            self._pictures.show()
            return None
        return tuple(self._pictures.taken())

    def close_extras(self, **kwargs: Any) -> None:
        """Close the window, if there is one, and stop packing houses."""
        self._passing.close()
        self._pictures.close()

    def scene(self, index: int) -> "Scene":
        """Return the scene of one environment, for ``sim.film``."""
        return scene_of(self._outputs, index)

    def _require_open(self) -> None:
        if self.closed:
            raise ClosedEnvironmentError("these environments were closed: make new ones")

    def _require_ready(self, call: str) -> None:
        self._require_open()
        if not self._ready:
            raise ResetNeeded(f"call reset() before {call}()")

    def _check(self, actions: Any) -> None:
        """Raise an error if these actions, an array or a tensor, are not possible now."""
        self._require_ready("step")
        self._orders.require(actions, self.num_envs)
        if self.autoreset_mode is AutoresetMode.DISABLED:
            require_going_on(self._outputs.flags())
