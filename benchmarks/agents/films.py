"""``vitruvius bench films AGENT --house 25``: films of an agent beside its map.

The house is of the benchmark bank, and the episode that of an evaluation with seed 0. On the map black is
known to be occupied, white was seen since the last pick-up, blue before that; the rest is unknown. The blue
dot is the body, orange the target that is known, violet the place that is to be looked at next.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
import tyro
from PIL import Image, ImageDraw

from agent import checkpoint
from agent.banks import benchmark
from agent.build import policy_of
from agent.config import TargetMode
from agent.planner import Planner
from agent.planner.occupancy import BITS
from agent.planner.state import NONE, TARGET
from agent.world import make_envs
from logic import House
from sim.film import MARGIN, PAPER, SHARP, Camera, View, film
from sim.geometry import geometry

FREE, OLD, TAKEN = (255, 255, 255), (178, 205, 232), (51, 58, 69)
BODY, KNOWN, NEXT = (31, 94, 168), (224, 122, 20), (140, 70, 160)


@dataclass(frozen=True)
class Film:
    """Film an agent that has a map in a house of the benchmark bank."""

    agent: tyro.conf.Positional[Path]
    """Checkpoint."""

    house: int = 0
    """Which house."""

    targets: TargetMode = "secondary"
    """Where targets lie."""

    out: Path = Path("runs/film.gif")
    """The film."""

    stride: int = 6
    """Steps between frames."""

    width: int = 420
    """Pixels of the house and of the map."""

    def run(self) -> None:
        """Play and write."""
        torch.set_num_threads(1)
        house = benchmark()[self.house]
        envs, found = make_envs([house], 1, self.targets), checkpoint.load(self.agent)
        seen, info = envs.reset(seed=self.house, options={"house": np.zeros(1, int)})
        policy = policy_of(found.network, found.config, envs, 0)
        policy.begin(1)
        if policy.tracker is None:
            raise SystemExit(f"{self.agent}: has no map")
        observation, blocked = torch.as_tensor(seen), torch.zeros(1, dtype=torch.bool)
        window, camera, frames = Window(house, self.width, info["pose"][0]), Camera(envs, 0, self.width), []
        for step in range(envs.config.steps):
            actions = policy(observation, blocked)
            if step % self.stride == 0:
                frames.append(side_by_side(camera.shoot(), window.drawn(policy.tracker.planner)))
            observation, _, _, _, info = envs.step_torch(actions)
            blocked = info["blocked"]
        film(frames, self.out)
        print(f"{self.out}: {self.out.stat().st_size / 1e6:.1f} MB")


class Window:
    """Draws maps to lie as the house does: the film knows where the episode began, the agent does not."""

    def __init__(self, house: House, width: int, start: np.ndarray) -> None:
        """For pictures of the house of this width, and an episode that began at the pose ``start`` (3,)."""
        shape = geometry(house)
        view = View(shape, width)
        self.size = view.size[0] // SHARP, view.size[1] // SHARP
        scale = view.scale / SHARP
        corner = np.array(shape.bounds[:2]) - MARGIN / scale - start[:2]
        self.box = np.concatenate([corner, corner + np.array(self.size) / scale])  # metres from the start
        self.quarters = round(float(start[2]) / (np.pi / 4)) // 2

    def drawn(self, planner: Planner) -> Image.Image:
        """The first environment's planner."""
        side = 1 << BITS
        states, kind, since = planner.occupancy(0), planner.read("kind")[0], int(planner.read("since")[0])
        image = np.full((side, side, 3), PAPER, np.uint8)
        image[states == 1] = OLD
        image[(states == 1) & (planner.last_seen(0) >= since)] = FREE
        image[states == 2] = TAKEN
        box = self.box / planner.cell + side // 2
        whole = Image.fromarray(np.ascontiguousarray(np.rot90(image, self.quarters)))
        picture = whole.resize(self.size, Image.Resampling.NEAREST, box=tuple(np.clip(box, 0, side)))
        draw, scale = ImageDraw.Draw(picture), self.size[0] / (box[2] - box[0])
        spots = [(np.array(planner.pose(0)[:2]), BODY)]
        if kind != NONE:
            goal = np.array(divmod(int(planner.read("goal")[0]), side)[::-1])
            colour = KNOWN if kind == TARGET else NEXT
            spots.insert(0, ((goal + side // 2) % side - side // 2, colour))
        # Counter-clockwise, south being down: (east, south) becomes (south, -east).
        turn = np.linalg.matrix_power(np.array([[0, 1], [-1, 0]]), self.quarters)
        for place, colour in spots:
            a, b = (turn @ place + side // 2 - box[:2]) * scale
            draw.ellipse([a - 6, b - 6, a + 6, b + 6], colour)
        return picture


def side_by_side(one: Image.Image, other: Image.Image) -> Image.Image:
    """Both pictures, on paper."""
    whole = Image.new("RGB", (one.width + other.width, max(one.height, other.height)), PAPER)
    whole.paste(one, (0, 0))
    whole.paste(other, (one.width, 0))
    return whole
