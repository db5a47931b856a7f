"""The film's map: its position on the house, and the agent's beliefs in it."""

import numpy as np
import pytest
import torch
from PIL import Image

from tests import sample_houses
from vitruvius.agent.learning.environments import make_envs, shield
from vitruvius.agent.policies.policies import Explorer
from vitruvius.agent.recording.film import record
from vitruvius.agent.recording.map_picture import EARLIER, KEY, LATELY, OCCUPIED, MapPicture, beside
from vitruvius.agent.runs import checkpoint
from vitruvius.sim.film import BODY, Camera, View
from vitruvius.sim.geometry import geometry

HOUSE = sample_houses.drawn(sample_houses.ONE_ROOM, cell=1.0)


@pytest.fixture(scope="module")
def envs():
    return make_envs([HOUSE], 1, "main")


@pytest.fixture(scope="module")
def explorer(envs):
    return Explorer(shield(envs))


def filmed(envs, explorer, eighth: int, steps: int = 40) -> Image.Image:
    """Return the map after some steps from a place with walls in sight, at this heading."""
    pose = [[6.0, 1.5, eighth * np.pi / 4]]
    seen, _ = envs.reset(seed=1, options={"house": [0], "pose": pose, "target": [[7.0, 0.6]]})
    explorer.begin(1)
    picture, observation, blocked = MapPicture(HOUSE, 400), torch.as_tensor(seen), torch.zeros(1).bool()
    for step in range(steps):
        actions = explorer(observation, blocked)
        if explorer.tracker.planner.read("time")[0] == 1:
            picture.begin(envs.scene(0).pose)
        if step < steps - 1:
            observation, _, _, _, info = envs.step_torch(actions)
            blocked = info["blocked"]
    return picture.drawn(explorer.tracker.planner)


def places(image: Image.Image, colour: tuple[int, int, int]) -> np.ndarray:
    """Return the places (n, 2), metres, of the picture's pixels of a colour."""
    frame = View(HOUSE, 400).frame
    rows, columns = np.nonzero((np.asarray(image) == colour).all(axis=-1))
    return (np.stack([columns, rows], axis=1) + 0.5 - [frame.left, frame.top]) / frame.scale


@pytest.mark.parametrize("eighth", range(8))
def test_the_map_lies_as_the_house_does_whatever_the_heading_at_the_start(envs, explorer, eighth) -> None:
    image = filmed(envs, explorer, eighth)
    shape, (table,) = geometry(HOUSE), HOUSE.star.rooms[0].pieces
    solid = [table.x + table.width / 2, table.y + table.height / 2, table.width / 2, table.height / 2]
    middle, half = np.split(np.vstack([shape.verticals, shape.horizontals, solid]), 2, axis=1)
    occupied = places(image, OCCUPIED)
    away = np.maximum(np.abs(occupied[:, None] - middle) - half, 0).max(axis=-1).min(axis=-1)
    assert len(occupied) > 200
    assert away.max() < 2 * explorer.tracker.planner.cell
    body = envs.scene(0).pose[:2]
    assert np.abs(places(image, BODY).mean(axis=0) - body).max() < 0.05
    assert len(places(image, LATELY)) > 2000


def test_ground_seen_before_a_pick_up_is_shown_apart(envs, explorer) -> None:
    assert not len(places(filmed(envs, explorer, 0, steps=2), EARLIER))
    later = filmed(envs, explorer, 0)
    assert envs.scene(0).found > 0
    assert len(places(later, EARLIER)) > 2000


def test_the_map_stands_beside_the_house_above_its_key(envs, explorer) -> None:
    image, house = filmed(envs, explorer, 0), Camera(envs, 0, 400).shoot()
    both = beside(house, image)
    assert both.crop((0, 0, *house.size)).tobytes() == house.tobytes()
    assert both.crop((house.width, 0, both.width, image.height)).tobytes() == image.tobytes()
    key = np.asarray(both.crop((0, image.height, both.width, both.height)))
    assert all((key == colour).all(axis=-1).any() for colour, _ in KEY)


def test_the_film_of_an_agent_with_a_map_shows_house_and_map(tmp_path) -> None:
    agent = checkpoint.load("map-completion")
    record(agent, HOUSE, tmp_path / "film.gif", targets="secondary", steps=8, width=300)
    width, height = View(HOUSE, 300).shown
    with Image.open(tmp_path / "film.gif") as image:
        assert image.n_frames == 3  # pyright: ignore[reportAttributeAccessIssue]
        assert image.width == 2 * width
        assert image.height > height
