"""Pictures of an environment from above, and films of it."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from io import BytesIO
from itertools import chain
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, cast

import numpy as np
from gymnasium.vector import VectorEnv
from PIL import Image, ImageDraw, ImageFont

from vitruvius.logic import House
from vitruvius.logic.drawing.canvas import DENSITY, Drawing, png
from vitruvius.logic.drawing.frame import Frame, drawn_extent
from vitruvius.logic.drawing.labels import background
from vitruvius.logic.drawing.palettes import Inks
from vitruvius.logic.files.writing import write_whole
from vitruvius.logic.installation import required_by
from vitruvius.logic.spelling import numbered
from vitruvius.sim.config import Config

PAPER = (255, 255, 255)
BODY, TRAIL, RAY = (31, 94, 168), (31, 94, 168), (110, 130, 155)
TARGET, TARGET_EDGE, TARGET_RAY = (245, 178, 45), (183, 118, 8), (224, 122, 20)

THING, THIN = (122, 84, 44), 0.02
"""Colour of the things of overlays, and margin by which they are drawn larger than their boxes, metres."""

SHARP = DENSITY
"""Factor by which everything is drawn larger before it is reduced, so that lines are smooth."""

LEAST_NAME = 9.0
"""Smallest height of a room's name, in pixels. A room that is too small for such a name shows none."""

MARGIN, CAPTION = 16, 30
"""Margin around the house and height of the caption below it, in pixels."""

FILMS = (".gif", ".mp4")
"""File name endings of films."""

WIDTH = 720
"""Default longer side of a picture, in pixels."""


@dataclass(frozen=True)
class Scene:
    """Contents of a picture. Metres and radians."""

    house: House
    config: Config
    pose: np.ndarray
    """(3,) x, y and heading of the eye."""
    target: np.ndarray
    """(2,) centre of the target."""
    distance: np.ndarray
    """(R,) length of each ray."""
    is_target: np.ndarray
    """(R,) bool: True for rays that end on the target."""
    step: int
    found: int
    """Number of targets picked up in this episode."""
    task: str
    """The task in words, with the house's names of rooms and furniture."""
    others: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    """Centres of the other targets, (n, 2), metres."""
    over: np.ndarray = field(default_factory=lambda: np.zeros((0, 4)))
    """Boxes of the things of overlays, such as closed doors, (n, 4): west, north, east, south, metres."""


class Camera:
    """Camera for one environment: ``shoot`` draws its state, with the path since the first picture."""

    def __init__(
        self, envs: VectorEnv, index: int = 0, width: int = WIDTH, frame: tuple[int, int] | None = None
    ) -> None:
        """Take pictures of environment ``index`` of a ``HouseVectorEnv``.

        The longer side of a picture is ``width`` pixels. With a ``frame`` (width, height) in pixels, all
        pictures have this size, with the house in the middle.
        """
        self.envs, self.index, self.width, self.frame = envs, index, width, frame
        self.trail: list[tuple[float, float]] = []
        self._plan: tuple[House, Image.Image] | None = None

    def shoot(self) -> Image.Image:
        """Draw the environment. A new episode begins a new trail."""
        scene: Scene = cast(Any, self.envs.unwrapped).scene(self.index)
        if scene.step == 0:
            self.trail.clear()
        self.trail.append((float(scene.pose[0]), float(scene.pose[1])))
        if self._plan is None or self._plan[0] is not scene.house:
            self._plan = scene.house, plan(scene.house, self.width)
        shot = picture(scene, self.trail, self._plan[1])
        return shot if self.frame is None else framed(shot, self.frame)


def caption(scene: Scene) -> str:
    """Return the caption of a picture. The task is last, because a narrow picture cuts off the end."""
    counts = f"step {scene.step} of {scene.config.steps}    {numbered(scene.found, 'target')}"
    return f"{counts}    {scene.task}"


def picture(scene: Scene, trail: Sequence[tuple[float, float]], background: Image.Image) -> Image.Image:
    """Draw a scene on its house's ``plan``: target, trail, rays and body."""
    view = View(scene.house, max(background.size) // SHARP)
    image = background.copy()
    draw = ImageDraw.Draw(image, "RGBA")
    half = scene.config.target / 2
    for target in (*scene.others, scene.target):
        corners = view.box(*(target - half), *(target + half))
        draw.rounded_rectangle(corners, view.px(0.05), TARGET, TARGET_EDGE, view.px(0.025))

    for west, north, east, south in scene.over:
        thing = view.box(west - THIN, north - THIN, east + THIN, south + THIN)
        draw.rectangle(thing, THING)

    points = [view.at(x, y) for x, y in trail]
    recent = len(points)
    for k in range(recent - 1):  # old parts of the trail fade, but stay visible
        strength = 60 + int(150 * max(0.0, 1 - (recent - k) / 400))
        draw.line([points[k], points[k + 1]], (*TRAIL, strength), max(SHARP, view.px(0.035)))

    x, y, heading = scene.pose
    eye = view.at(x, y)
    angle = heading + scene.config.ray_angles
    lengths = np.asarray(scene.distance)
    ends = np.column_stack([x + np.cos(angle) * lengths, y - np.sin(angle) * lengths])
    fan = [eye, *(view.at(*end) for end in ends)]
    draw.polygon(fan, (*RAY, 26))
    for end, hit, distance in zip(fan[1:], scene.is_target, lengths, strict=True):
        draw.line([eye, end], (*TARGET_RAY, 230) if hit else (*RAY, 110), view.px(0.022 if hit else 0.012))
        if distance < scene.config.range:
            (a, b), r = end, view.px(0.03)
            draw.ellipse([a - r, b - r, a + r, b + r], TARGET_RAY if hit else (*RAY, 190))

    _draw_body(draw, view, scene)
    below = SHARP * MARGIN, image.height - SHARP * (MARGIN + CAPTION) // 2
    draw.text(below, caption(scene), Inks().ink, ImageFont.load_default(SHARP * 16), anchor="lm")
    return image.reduce(SHARP)


def largest(houses: Sequence[House], width: int = WIDTH) -> tuple[int, int]:
    """Return the width and height, in pixels, of a frame that contains the pictures of all these houses."""
    across, along = np.max([View(house, width).shown for house in houses], axis=0)
    return int(across), int(along)


def framed(image: Image.Image, size: tuple[int, int]) -> Image.Image:
    """Return a picture of ``size`` (width, height) with a smaller picture in its middle."""
    whole = Image.new("RGB", size, PAPER)
    whole.paste(image, ((size[0] - image.width) // 2, (size[1] - image.height) // 2))
    return whole


def mosaic(frames: Sequence[np.ndarray], columns: int | None = None) -> np.ndarray:
    """Return pictures of one size side by side in rows, (height, width, 3) uint8.

    By default there are about as many rows as columns.
    """
    columns = columns or int(np.ceil(np.sqrt(len(frames))))
    rows = -(-len(frames) // columns)
    whole = np.full((rows, columns, *frames[0].shape), PAPER, np.uint8)
    whole.reshape(-1, *frames[0].shape)[: len(frames)] = frames
    return whole.swapaxes(1, 2).reshape(rows * frames[0].shape[0], -1, 3)


def _draw_body(draw: ImageDraw.ImageDraw, view: "View", scene: Scene) -> None:
    """Draw the body, a square or a disc, with an arrow in the direction of its heading."""
    heading = float(scene.pose[2])
    diagonal = round(heading / (np.pi / 4)) % 2
    corner, side = scene.pose[:2] - scene.config.eye[diagonal], scene.config.body[diagonal]
    if scene.config.drives:
        corner = scene.pose[:2] - side / 2
    rounding = side / 2 if scene.config.drives else 0.05
    draw.rounded_rectangle(
        view.box(*corner, *(corner + side)), view.px(rounding), BODY, "white", view.px(0.02)
    )
    arrow = side * np.array([(0.4, 0.0), (-0.25, 0.3), (-0.25, -0.3)])
    turn = np.array([(np.cos(heading), -np.sin(heading)), (-np.sin(heading), -np.cos(heading))])
    draw.polygon([view.at(*point) for point in corner + side / 2 + arrow @ turn.T], "white")


def plan(house: House, size: int) -> Image.Image:
    """Draw the floor plan of a house, ``SHARP`` times larger than shown, without the leaves of doors."""
    view = View(house, size)
    width, height = view.shown
    drawing = Drawing(width, height, background(house, view.frame, LEAST_NAME))
    return png([((0, 0), drawing)], width, height)


def require_film(path: str | Path) -> None:
    """Raise ``ValueError`` unless the file name ends in one of ``FILMS``.

    Raises ``ModuleNotFoundError`` for an MP4 if the extra ``film`` is not installed.
    """
    if Path(path).suffix.lower() not in FILMS:
        example = Path(path).with_suffix(".gif") if Path(path).name else Path(path, "film.gif")
        raise ValueError(f"{path}: a film must be .gif or .mp4: use {example}")
    if Path(path).suffix.lower() == FILMS[1]:
        with required_by("a film as MP4"):
            import_module("imageio_ffmpeg")


def film(frames: Iterable[Image.Image | np.ndarray], path: str | Path, fps: int = 25) -> Path:
    """Write frames of one size as a looping animated GIF or as an MP4 (H.264).

    The last frame stays for a second. All frames of a GIF share one palette, so the function keeps them in
    memory; it does not keep those of an MP4. Raises ``ValueError`` if there is no frame or for another file
    type, and ``ModuleNotFoundError`` for an MP4 if the extra ``film`` is not installed.
    """
    require_film(path)
    pictures = (frame if isinstance(frame, Image.Image) else Image.fromarray(frame) for frame in frames)
    first = next(pictures, None)
    if first is None:
        raise ValueError(f"{path}: there is no frame to film")
    write = _mp4 if Path(path).suffix.lower() == ".mp4" else _gif
    write_whole(path, write(chain([first], pictures), fps))
    return Path(path)


def _gif(frames: Iterable[Image.Image], fps: int) -> bytes:
    pictures = list(frames)
    sample = pictures[:: max(1, len(pictures) // 8)]
    strip = np.concatenate([np.asarray(frame.convert("RGB")) for frame in sample], axis=1)
    palette = Image.fromarray(strip).quantize(255, Image.Quantize.MEDIANCUT)
    few = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in pictures]
    times, content = [1000 // fps] * (len(few) - 1) + [1000], BytesIO()
    few[0].save(content, "GIF", save_all=True, append_images=few[1:], duration=times, loop=0)
    return content.getvalue()


def _mp4(frames: Iterator[Image.Image], fps: int) -> bytes:
    from imageio_ffmpeg import write_frames

    first = next(frames)
    size = first.width + first.width % 2, first.height + first.height % 2  # H.264 needs even sides
    with TemporaryDirectory() as folder:
        file = Path(folder) / "film.mp4"
        options = ["-movflags", "+faststart", "-fflags", "+bitexact"]
        writer = write_frames(
            str(file), size, fps=fps, codec="libx264", quality=6, macro_block_size=2, output_params=options
        )
        writer.send(None)
        content = b""
        try:
            for frame in chain([first], frames):
                content = framed(frame, size).tobytes()
                writer.send(content)
            for _ in range(fps - 1):
                writer.send(content)
        finally:
            writer.close()
        return file.read_bytes()


class View:
    """Conversion of metres to the pixels of a picture that contains the whole house."""

    def __init__(self, house: House, size: int) -> None:
        """Prepare a picture whose longer side is ``size`` pixels, drawn ``SHARP`` times larger."""
        west, north, east, south = drawn_extent(house)
        width, height = east - west, south - north
        scale = min((size - 2 * MARGIN) / width, (size - 2 * MARGIN - CAPTION) / height)
        self.frame = Frame(scale, MARGIN - scale * west, MARGIN - scale * north)
        self.shown = round(scale * width + 2 * MARGIN), round(scale * height + 2 * MARGIN + CAPTION)
        self.size = SHARP * self.shown[0], SHARP * self.shown[1]

    def at(self, x: float, y: float) -> tuple[float, float]:
        """Return the pixel coordinates of a point."""
        across, down = self.frame.at(float(x), float(y))
        return SHARP * across, SHARP * down

    def box(self, west: float, north: float, east: float, south: float) -> list[float]:
        """Return the pixel coordinates of a box."""
        return [*self.at(west, north), *self.at(east, south)]

    def px(self, metres: float) -> int:
        """Return a length in whole pixels, at least one."""
        return max(1, round(SHARP * metres * self.frame.scale))
