"""Picture of the beliefs of an agent with a map, drawn next to its house."""

import numpy as np
from PIL import Image, ImageDraw

from vitruvius.agent.planner import FREE, TAKEN, Planner
from vitruvius.agent.planner.core.config import CERTAIN
from vitruvius.agent.planner.core.frame import AXES, quarters
from vitruvius.agent.planner.core.state import NONE, TARGET
from vitruvius.logic import House
from vitruvius.logic.drawing.canvas import Block, Drawing, Oval, Shape, Text, png, text_width
from vitruvius.logic.drawing.palettes import Inks
from vitruvius.sim.film import BODY, MARGIN, SHARP, View
from vitruvius.sim.film import TARGET as FOUND
from vitruvius.sim.geometry import geometry

UNKNOWN, LIKELY, EARLIER, LATELY = (226, 226, 222), (190, 214, 178), (178, 205, 232), (255, 255, 255)
"""Colours of ground: never seen; never seen, but surely free floor; seen before the last pick-up; seen
since."""
OCCUPIED, VIEWPOINT = (51, 58, 69), (140, 70, 160)

TRUE = (200, 60, 50)
"""Colour of the house's true lines, which are shown if a network predicts unseen ground."""

PALE_INTENSITY = 0.3
"""Intensity of floor without targets, relative to certain floor with targets."""

KEY = (
    (OCCUPIED, "occupied"),
    (LATELY, "seen since the last pick-up"),
    (EARLIER, "seen before"),
    (LIKELY, "unseen, likely floor"),
    (VIEWPOINT, "next viewpoint"),
    (FOUND, "target"),
)
FORESEEN = {LIKELY: "a target is likely (red: the true house)"}
"""Labels that differ if a network predicts unseen ground."""

ROW = 18
"""Height of a row of the key, in pixels."""


class MapPicture:
    """Painter of maps in the house's orientation: the film knows the episode's start, the agent does not."""

    def __init__(self, house: House, width: int) -> None:
        """Draw pictures of the house of this width, as for ``sim.film.Camera``."""
        self.view, self.solids = View(house, width), geometry(house).solids

    def begin(self, pose: np.ndarray) -> None:
        """Begin the map at the pose (3,) of the eye: x and y in metres, and its heading."""
        frame = self.view.frame
        self.corner = -np.array([frame.left, frame.top]) / frame.scale - pose[:2]  # metres from the start
        self.quarters = quarters(pose[2])

    def drawn(self, planner: Planner) -> Image.Image:
        """Return the picture of the first environment's planner."""
        scale = self.view.frame.scale * planner.cell  # pixels to a cell
        side = 1 << planner.config.map_bits  # cells; the episode began in the middle
        corner = self.corner / planner.cell + side // 2
        box = np.concatenate([corner, corner + np.array(self.view.shown) / scale])
        whole = Image.fromarray(np.ascontiguousarray(np.rot90(_ground(planner), self.quarters)))
        picture = whole.transform(
            self.view.size,
            Image.Transform.EXTENT,
            tuple(box),
            fillcolor=UNKNOWN,
        )
        draw, scale = ImageDraw.Draw(picture), SHARP * scale

        def mark(place: np.ndarray, colour: tuple[int, int, int]) -> None:
            x, y = (place @ AXES[self.quarters] + side // 2 - corner) * scale
            radius = 6 * SHARP
            draw.ellipse([x - radius, y - radius, x + radius, y + radius], colour, "white", SHARP)

        if planner.body.prior:
            for x, y, wide, high in self.solids:
                draw.rectangle(
                    self.view.box(x - wide, y - high, x + wide, y + high), outline=TRUE, width=SHARP
                )
        kind = planner.read("kind")[0]
        if kind != NONE:
            goal = np.array(divmod(int(planner.read("goal")[0]), side)[::-1])
            mark((goal + side // 2) % side - side // 2, FOUND if kind == TARGET else VIEWPOINT)
        mark(np.array(planner.pose(0)[:2]), BODY)
        return picture.reduce(SHARP)


def _ground(planner: Planner) -> np.ndarray:
    """Return the colours (S, S, 3) uint8 of the cells of the first environment's map."""
    states, since = planner.occupancy(0), int(planner.read("since")[0])
    share = _likely(planner).repeat(2, axis=0).repeat(2, axis=1)[..., None]
    ground = np.asarray(UNKNOWN) + share * (np.asarray(LIKELY) - UNKNOWN)
    ground[states == FREE] = EARLIER
    ground[(states == FREE) & (planner.last_seen(0) >= since)] = LATELY
    ground[states == TAKEN] = OCCUPIED
    return ground.astype(np.uint8)


def _likely(planner: Planner) -> np.ndarray:
    """Return the probability, 0 to 1, that a target may lie on a block if the block was never seen.

    Blocks (S / 2, S / 2) are those of the first environment. Floor that is predicted without a target counts
    ``PALE_INTENSITY``.
    """
    if not planner.body.prior:
        return planner.unseen_floor(0) / CERTAIN
    counts = planner.foreseen(0)
    return np.maximum(counts / CERTAIN, PALE_INTENSITY * (counts > 0))


def beside(house: Image.Image, map_: Image.Image, foresees: bool = False) -> Image.Image:
    """Return both pictures side by side, above a key of the map's colours, if a network ``foresees``."""
    width = house.width + map_.width
    shapes: list[Shape] = []
    x, y = float(MARGIN), ROW / 2
    for colour, words in ((each, FORESEEN.get(each, was) if foresees else was) for each, was in KEY):
        needed = 16 + text_width(words, 11) + 16
        if x > MARGIN and x + needed > width:
            x, y = float(MARGIN), y + ROW
        box, fill = (x, y - 5.5, x + 11, y + 5.5), "#{:02x}{:02x}{:02x}".format(*colour)
        shapes.append(Oval(box, fill) if colour in (VIEWPOINT, FOUND) else Block(box, fill, Inks().wall, 0.8))
        shapes.append(Text((x + 16, y), words, 11, Inks().ink, "start"))
        x += needed
    high = round(y + ROW / 2 + 4)
    key = png([((0, 0), Drawing(width, high, tuple(shapes)))], width, high).reduce(SHARP)
    whole = Image.new("RGB", (width, max(house.height, map_.height) + high), "white")
    whole.paste(house, (0, 0))
    whole.paste(map_, (house.width, 0))
    whole.paste(key, (0, whole.height - high))
    return whole
