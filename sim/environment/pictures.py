"""Pictures of environments: returned, or shown in a window."""

from typing import TYPE_CHECKING, Any

import numpy as np

from vitruvius.logic.looks.looks import looks_of
from vitruvius.sim.environment.outputs import Outputs
from vitruvius.sim.environment.window import ScreenWindow
from vitruvius.sim.tasks.words import in_words

if TYPE_CHECKING:
    from vitruvius.sim.film import Camera, Scene


class Pictures:
    """Cameras of environments, one for each, and their pictures."""

    def __init__(self, envs: Any, window: ScreenWindow | None) -> None:
        """Take the pictures of a ``HouseVectorEnv``, and show them in ``window`` if there is one."""
        self.envs, self.window = envs, window
        self._cameras: list[Camera] | None = None

    def forget(self) -> None:
        """Discard the cameras, because the houses have changed."""
        self._cameras = None

    def taken(self) -> list[np.ndarray]:
        """Return a picture of each environment, (height, width, 3) uint8, as large as the largest house's."""
        if self._cameras is None:
            from vitruvius.sim.film import Camera, largest

            frame = largest(self.envs.houses)
            self._cameras = [Camera(self.envs, index, frame=frame) for index in range(self.envs.num_envs)]
        return [np.asarray(camera.shoot()) for camera in self._cameras]

    def show(self) -> None:
        """Show the pictures if there is a window."""
        if self.window:
            self.window.show(self.taken())

    def close(self) -> None:
        """Close the window."""
        if self.window:
            self.window.close()


def scene_of(outputs: Outputs, index: int) -> "Scene":
    """Return the scene of an environment for a picture."""
    from vitruvius.sim.film import Scene

    world, info, seen = outputs.world, outputs.info(), outputs.rays()[index]
    config, state = world.config, world.environment(index)
    house = world.houses[info["house"][index]]
    return Scene(
        house=house,
        config=config,
        pose=info["pose"][index],
        target=info["target"][index],
        distance=seen[:, config.column("distance")] * config.range,
        is_target=seen[:, -1] > 0,
        step=state["time"],
        found=state["found"] - 1,
        task=in_words(world.task, looks_of(house).name),
        over=world.drawn(index),
        others=info["targets"][index, 1:] if world.kind.at_once > 1 else np.zeros((0, 2)),
    )
