"""Pictures of an environment from above, and films of them."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np
from gymnasium.vector import VectorEnv
from PIL import Image, ImageDraw, ImageFont

from logic import House
from sim.config import Config
from sim.geometry import Geometry, geometry

Colour = tuple[int, int, int]
Box = tuple[float, float, float, float]

PAPER, FLOOR, ROOM = (238, 237, 233), (251, 250, 246), (226, 234, 242)
INK, FAINT = (51, 58, 69), (139, 146, 156)
PIECE, PIECE_EDGE, PIECE_INK, THRESHOLD = (255, 255, 255), (154, 161, 171), (125, 131, 140), (217, 190, 150)
BODY, TRAIL, RAY = (31, 94, 168), (31, 94, 168), (110, 130, 155)
TARGET, TARGET_EDGE, TARGET_RAY = (245, 178, 45), (183, 118, 8), (224, 122, 20)


@dataclass(frozen=True)
class Style:
    """A text's height in metres, and its colour."""

    size: float
    colour: Colour


ROOM_LABEL, PIECE_LABEL = Style(0.26, FAINT), Style(0.2, PIECE_INK)

SHARP = 2
"""Everything is drawn this much larger and then reduced: smooth lines."""

MARGIN, CAPTION = 16, 30
"""Pixels around the house, and for the line of text below it."""


WIDTH = 720
"""Pixels of a picture's longer side."""


@dataclass(frozen=True)
class Scene:
    """All that a picture shows. Metres and radians."""

    house: House
    config: Config
    pose: np.ndarray
    """(3,) x, y and heading of the eye."""
    target: np.ndarray
    """(2,) its centre."""
    distance: np.ndarray
    """(R,) how far each ray goes."""
    is_target: np.ndarray
    """(R,) bool: whether it ends on the target."""
    step: int
    found: int
    """Targets picked up in this episode."""


class Camera:
    """Looks at one environment: each ``shoot`` draws it as it is, and the way it has come since the first."""

    def __init__(
        self, envs: VectorEnv, index: int = 0, width: int = WIDTH, frame: tuple[int, int] | None = None
    ) -> None:
        """Look at a ``HouseVectorEnv``. Pictures are ``width`` pixels wide, those of high houses as high; a
        ``frame`` (width, height) in pixels holds them all, with the house in its middle.
        """
        self.envs, self.index, self.width, self.frame = envs, index, width, frame
        self.trail: list[tuple[float, float]] = []
        self._plan: tuple[House, Image.Image] | None = None

    def shoot(self) -> Image.Image:
        """Draw the environment; a new episode begins a new trail."""
        scene: Scene = cast(Any, self.envs.unwrapped).scene(self.index)
        if scene.step == 0:
            self.trail.clear()
        self.trail.append((float(scene.pose[0]), float(scene.pose[1])))
        if self._plan is None or self._plan[0] is not scene.house:
            self._plan = scene.house, plan(scene.house, self.width)
        shot = picture(scene, self.trail, self._plan[1])
        return shot if self.frame is None else framed(shot, self.frame)


def picture(scene: Scene, trail: Sequence[tuple[float, float]], background: Image.Image) -> Image.Image:
    """Draw a scene on its house's ``plan``: target, trail, rays and body."""
    view = View(geometry(scene.house), max(background.size) // SHARP)
    image = background.copy()
    draw = ImageDraw.Draw(image, "RGBA")
    half = scene.config.target / 2
    corners = view.box(*(scene.target - half), *(scene.target + half))
    draw.rounded_rectangle(corners, view.px(0.05), TARGET, TARGET_EDGE, view.px(0.025))

    points = [view.at(x, y) for x, y in trail]
    recent = len(points)
    for k in range(recent - 1):  # the way fades as it gets old, but never away
        strength = 60 + int(150 * max(0.0, 1 - (recent - k) / 400))
        draw.line([points[k], points[k + 1]], (*TRAIL, strength), max(SHARP, view.px(0.035)))

    x, y, heading = scene.pose
    eye = view.at(x, y)
    angle = heading + scene.config.ray_angles
    reach = np.asarray(scene.distance)
    ends = np.column_stack([x + np.cos(angle) * reach, y - np.sin(angle) * reach])
    fan = [eye, *(view.at(*end) for end in ends)]
    draw.polygon(fan, (*RAY, 26))
    for end, hit, distance in zip(fan[1:], scene.is_target, reach, strict=True):
        draw.line([eye, end], (*TARGET_RAY, 230) if hit else (*RAY, 110), view.px(0.022 if hit else 0.012))
        if distance < scene.config.range:
            (a, b), r = end, view.px(0.03)
            draw.ellipse([a - r, b - r, a + r, b + r], TARGET_RAY if hit else (*RAY, 190))

    _draw_body(draw, view, scene)
    targets = "1 target" if scene.found == 1 else f"{scene.found} targets"
    text = f"step {scene.step} of {scene.config.steps}    {targets}"
    below = SHARP * MARGIN, image.height - SHARP * (MARGIN + CAPTION) // 2
    draw.text(below, text, INK, ImageFont.load_default(SHARP * 16), anchor="lm")
    return image.reduce(SHARP)


def largest(houses: Sequence[House], width: int = WIDTH) -> tuple[int, int]:
    """Width and height in pixels of a frame that holds the pictures of all these houses."""
    across, along = np.max([View(geometry(house), width).size for house in houses], axis=0) // SHARP
    return int(across), int(along)


def framed(image: Image.Image, size: tuple[int, int]) -> Image.Image:
    """A picture in the middle of a larger one of ``size`` (width, height)."""
    whole = Image.new("RGB", size, PAPER)
    whole.paste(image, ((size[0] - image.width) // 2, (size[1] - image.height) // 2))
    return whole


def mosaic(frames: Sequence[np.ndarray], columns: int | None = None) -> np.ndarray:
    """Pictures of one size side by side in rows, (height, width, 3) uint8; about as many rows as columns."""
    columns = columns or int(np.ceil(np.sqrt(len(frames))))
    rows = -(-len(frames) // columns)
    whole = np.full((rows, columns, *frames[0].shape), PAPER, np.uint8)
    whole.reshape(-1, *frames[0].shape)[: len(frames)] = frames
    return whole.swapaxes(1, 2).reshape(rows * frames[0].shape[0], -1, 3)


def _draw_body(draw: ImageDraw.ImageDraw, view: "View", scene: Scene) -> None:
    """The square body, with an arrow that points where it heads."""
    heading = float(scene.pose[2])
    diagonal = round(heading / (np.pi / 4)) % 2
    corner, side = scene.pose[:2] - scene.config.eye[diagonal], scene.config.body[diagonal]
    draw.rounded_rectangle(view.box(*corner, *(corner + side)), view.px(0.05), BODY, "white", view.px(0.02))
    arrow = side * np.array([(0.4, 0.0), (-0.25, 0.3), (-0.25, -0.3)])
    turn = np.array([(np.cos(heading), -np.sin(heading)), (-np.sin(heading), -np.cos(heading))])
    draw.polygon([view.at(*point) for point in corner + side / 2 + arrow @ turn.T], "white")


def plan(house: House, size: int) -> Image.Image:
    """Draw a house from above, ``SHARP`` times larger than it will be shown: floors, pieces, walls, doors."""
    shape = geometry(house)
    view = View(shape, size)
    image = Image.new("RGB", view.size, PAPER)
    draw = ImageDraw.Draw(image)
    draw.rectangle(view.box(*house.floor.box), FLOOR)
    for room in house.rooms:
        draw.rectangle(view.box(*room.box), ROOM)
    for room in house.rooms:
        for piece in room.pieces:
            draw.rounded_rectangle(view.box(*piece.box), view.px(0.04), PIECE, PIECE_EDGE, view.px(0.02))
            across, along = view.extent(piece.type, PIECE_LABEL)
            if 2 * across < piece.width and 2 * along < piece.height:
                middle = (piece.x + piece.width / 2, piece.y + piece.height / 2)
                view.label(draw, piece.type, middle, PIECE_LABEL)
        spot = _free_spot(room.box, (piece.box for piece in room.pieces), view.extent(room.type, ROOM_LABEL))
        if spot is not None:
            view.label(draw, room.type, spot, ROOM_LABEL)
        draw.line([view.at(*room.door.box[:2]), view.at(*room.door.box[2:])], THRESHOLD, view.px(0.05))
    thick = view.px(0.07)
    for x, y, across, along in np.vstack([shape.verticals, shape.horizontals]):
        west, north, east, south = view.box(x - across, y - along, x + across, y + along)
        draw.rectangle([west - thick / 2, north - thick / 2, east + thick / 2, south + thick / 2], INK)
    return image


def film(frames: Iterable[Image.Image | np.ndarray], path: str | Path, fps: int = 25) -> Path:
    """Write frames of one size as an animated GIF that loops; the last one stays for a second.

    Raises ``ValueError`` where there is no frame. One palette serves them all.
    """
    pictures = [frame if isinstance(frame, Image.Image) else Image.fromarray(frame) for frame in frames]
    if not pictures:
        raise ValueError(f"{path}: no frame to make a film of")
    sample = pictures[:: max(1, len(pictures) // 8)]
    strip = np.concatenate([np.asarray(frame.convert("RGB")) for frame in sample], axis=1)
    palette = Image.fromarray(strip).quantize(255, Image.Quantize.MEDIANCUT)
    few = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in pictures]
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_name(f".{path.name}")
    times = [1000 // fps] * (len(few) - 1) + [1000]
    few[0].save(beside, "GIF", save_all=True, append_images=few[1:], duration=times, loop=0)
    beside.replace(path)
    return path


class View:
    """From metres to the pixels of a picture that holds the whole house."""

    def __init__(self, shape: Geometry, size: int) -> None:
        """A picture whose longer side is ``size`` pixels, drawn ``SHARP`` times larger."""
        self.west, self.north, east, south = shape.bounds
        width, height = east - self.west, south - self.north
        scale = min((size - 2 * MARGIN) / width, (size - 2 * MARGIN - CAPTION) / height)
        self.scale = SHARP * scale
        self.size = (
            SHARP * round(scale * width + 2 * MARGIN),
            SHARP * round(scale * height + 2 * MARGIN + CAPTION),
        )

    def at(self, x: float, y: float) -> tuple[float, float]:
        """A point's pixels."""
        return (x - self.west) * self.scale + SHARP * MARGIN, (y - self.north) * self.scale + SHARP * MARGIN

    def box(self, west: float, north: float, east: float, south: float) -> list[float]:
        """A box's pixels."""
        return [*self.at(west, north), *self.at(east, south)]

    def px(self, metres: float) -> int:
        """A length in whole pixels, at least one."""
        return max(1, round(metres * self.scale))

    def label(self, draw: ImageDraw.ImageDraw, text: str, at: tuple[float, float], style: Style) -> None:
        """Write text around a point."""
        draw.text(self.at(*at), text, style.colour, self.font(style), anchor="mm")

    def extent(self, text: str, style: Style) -> tuple[float, float]:
        """Half a text's width and height, metres, with some air; infinite if it were too small to read."""
        if self.px(style.size) < 8 * SHARP:
            return np.inf, np.inf
        return 0.5 * self.font(style).getlength(text) / self.scale + 0.08, 0.6 * style.size + 0.04

    def font(self, style: Style) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
        """Pillow's own typeface."""
        return ImageFont.load_default(self.px(style.size))


def _free_spot(room: Box, pieces: Iterable[Box], half: tuple[float, float]) -> tuple[float, float] | None:
    """Where in a room a label with these halves stands on free floor, nearest to the middle."""
    west, north, east, south = room
    x, y = np.meshgrid(np.linspace(west, east, 41), np.linspace(north, south, 41))
    free = (np.minimum(x - west, east - x) > half[0]) & (np.minimum(y - north, south - y) > half[1])
    for left, top, right, bottom in pieces:
        apart_x = (x + half[0] < left) | (x - half[0] > right)
        free &= apart_x | (y + half[1] < top) | (y - half[1] > bottom)
    if not free.any():
        return None
    # Rather above or below the middle than beside it.
    away = np.where(free, 4 * (x - (west + east) / 2) ** 2 + (y - (north + south) / 2) ** 2, np.inf)
    best = np.unravel_index(away.argmin(), away.shape)
    return float(x[best]), float(y[best])
