"""Pictures show the state; films contain every frame."""

import itertools

import imageio_ffmpeg
import numpy as np
import pytest
from msgspec import structs
from PIL import Image, ImageColor, ImageSequence

from tests import sample_houses
from vitruvius.logic.drawing.frame import drawn_extent
from vitruvius.logic.drawing.palettes import Inks
from vitruvius.logic.house.promises import Thickness
from vitruvius.logic.looks.looks import DEFAULT as LOOKS
from vitruvius.sim import DEFAULT, HouseVectorEnv
from vitruvius.sim.film import BODY, PAPER, SHARP, TARGET, Camera, View, film, framed, largest, mosaic

INKS = Inks()
HOUSE = sample_houses.drawn(sample_houses.ONE_ROOM, cell=1.0)


@pytest.fixture(scope="module")
def made():
    return HouseVectorEnv([HOUSE], num_envs=2, render_mode="rgb_array", preset=DEFAULT)


@pytest.fixture
def envs(made):
    pose = [[5.0, 1.5, 0.0], [6.0, 2.0, np.pi]]
    made.reset(seed=0, options={"house": [0, 0], "pose": pose, "target": [[7.0, 0.6], [7.3, 2.4]]})
    return made


def colour_at(image: Image.Image, x: float, y: float):
    column, row = View(HOUSE, max(image.size)).at(x, y)
    return image.getpixel((round(column / 2), round(row / 2)))


def test_a_picture_shows_body_target_walls_and_floor_in_their_places(envs):
    image = Camera(envs, 0, width=600).shoot()
    assert max(image.size) == 600
    assert colour_at(image, 4.9, 1.4) == BODY
    assert colour_at(image, 7.0, 0.6) == TARGET
    assert colour_at(image, -0.1, 0.5) == ImageColor.getrgb(INKS.wall)
    assert colour_at(image, 4.3, 2.8) == ImageColor.getrgb(INKS.paper)


def test_rooms_and_doors_have_the_colours_of_plans(envs):
    image = Camera(envs, 0, width=600).shoot()
    (room,) = HOUSE.star.rooms
    assert colour_at(image, room.x + 0.3, room.y + 0.3) == ImageColor.getrgb(LOOKS.rooms[room.type])
    door = room.door.x + room.door.width / 2, room.door.y + room.door.height / 2
    assert colour_at(image, *door) == ImageColor.getrgb(INKS.paper)


def test_every_environment_is_rendered_alone(envs):
    first, second = envs.render()
    assert first.shape == second.shape
    assert first.shape[2] == 3
    assert first.dtype == np.uint8
    assert (first != second).any()


def test_the_trail_follows_and_ends_with_the_episode(envs):
    camera = Camera(envs, 0)
    camera.shoot()
    for _ in range(5):
        envs.step([2, 0])
        camera.shoot()
    assert len(camera.trail) == 6
    envs.reset()
    camera.shoot()
    assert len(camera.trail) == 1


def test_a_film_has_all_frames_in_order(envs, tmp_path):
    camera = Camera(envs, 0, width=200)
    frames = [camera.shoot()]
    for action in ([2, 2], [0, 0], [2, 2]):
        envs.step(action)
        frames.append(camera.shoot())
    with Image.open(film(frames, tmp_path / "films" / "film.gif", fps=20)) as gif:
        times = [frame.info["duration"] for frame in ImageSequence.Iterator(gif)]
        assert times == [50, 50, 50, 1000]
        assert gif.info["loop"] == 0
        gif.seek(3)
        last = np.asarray(gif.convert("RGB"), int)
    assert np.abs(last - np.asarray(frames[3], int)).mean() < 3
    with pytest.raises(ValueError, match=r"film.avi: a film must be .gif or .mp4: use .*film.gif"):
        film(frames, tmp_path / "films" / "film.avi")
    with pytest.raises(ValueError, match="no frame"):
        film([], tmp_path / "none.gif")
    assert [path.name for path in (tmp_path / "films").iterdir()] == ["film.gif"]


def test_an_mp4_has_all_frames_in_order_and_the_last_for_a_second(tmp_path):
    colours = [(200, 40, 40), (40, 200, 40), (40, 40, 200)]
    frames = (Image.new("RGB", (61, 35), colour) for colour in colours)  # H.264 needs even sides
    path = film(frames, tmp_path / "film.mp4", fps=10)
    assert imageio_ffmpeg.count_frames_and_secs(str(path)) == (12, pytest.approx(1.2, abs=0.01))
    reader = imageio_ffmpeg.read_frames(str(path))
    about = next(reader)
    assert (about["size"], about["fps"], about["codec"]) == ((62, 36), 10, "h264")
    shown = [np.frombuffer(frame, np.uint8).reshape(36, 62, 3)[17, 30].astype(int) for frame in reader]
    for found, colour in zip(shown, [*colours, *colours[2:] * 9], strict=True):
        assert np.abs(found - colour).max() < 20
    assert [each.name for each in tmp_path.iterdir()] == ["film.mp4"]
    with pytest.raises(ValueError, match="no frame"):
        film([], tmp_path / "none.mp4")


def test_all_of_the_outer_walls_is_in_the_picture() -> None:
    """The claim holds for outer walls of half a metre and for thin ones."""
    thick = structs.replace(HOUSE, wall_thickness=Thickness(0.1, 0.5))
    for house in (HOUSE, thick):
        west, north, east, south = drawn_extent(house)
        view = View(house, 400)
        for corner in ((west, north), (east, south)):
            column, row = view.at(*corner)
            assert 0 <= column <= view.size[0]
            assert 0 <= row <= view.size[1]


def test_the_longer_side_of_a_picture_is_as_asked_and_its_lengths_are_whole_pixels() -> None:
    high = sample_houses.drawn("aaa\naAa\na+a\n...\n...\n...", cell=1.0)
    for house, width in itertools.product((HOUSE, high), (200, 600)):
        west, north, east, south = drawn_extent(house)
        view = View(house, width)
        assert max(view.shown) == width == max(view.size) / SHARP
        pixels = np.subtract(view.at(east, south), view.at(west, north)) / SHARP
        margins = np.subtract(view.shown, pixels)
        assert margins == pytest.approx([32, 62], abs=0.51)
        assert view.at(west, north) == pytest.approx((16 * SHARP, 16 * SHARP))
        assert view.box(west, north, east, south) == [*view.at(west, north), *view.at(east, south)]
        assert view.px(1.0) == round(SHARP * pixels[0] / (east - west))
        assert view.px(0.0) == 1


def test_pictures_of_one_frame_have_the_house_in_the_middle() -> None:
    frame = largest([HOUSE, structs.replace(HOUSE, wall_thickness=Thickness(0.1, 0.9))], 300)
    assert frame == tuple(np.max([View(HOUSE, 300).shown, frame], axis=0))
    whole = np.asarray(framed(Image.new("RGB", (2, 3), "black"), (6, 9)))
    assert [tuple(each) for each in np.argwhere(~whole.any(axis=2))][:: 2 * 3 - 1] == [(3, 2), (5, 3)]
    assert whole[0, 0].tolist() == [*PAPER]


def test_a_mosaic_has_pictures_in_rows_and_paper_in_the_rest() -> None:
    frames = [np.full((2, 3, 3), shade, np.uint8) for shade in range(5)]
    assert mosaic(frames)[::2, ::3, 0].tolist() == [[0, 1, 2], [3, 4, 255]]
    assert mosaic(frames, columns=2)[::2, ::3, 0].tolist() == [[0, 1], [2, 3], [4, 255]]
    assert mosaic(frames[:1]).shape == (2, 3, 3)
