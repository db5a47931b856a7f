"""Game window: a person's game next to the agent's episode, drawn by pygame."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import pygame

from vitruvius.agent.play.game import Game, fan, replayed
from vitruvius.agent.play.results import PlayedGame, ResultsError
from vitruvius.logic import House
from vitruvius.logic.house.parts import BODY as SIDE
from vitruvius.sim.actions import FORWARD, LEFT, RIGHT
from vitruvius.sim.film import BODY, RAY, SHARP, TARGET, TARGET_EDGE, TARGET_RAY, View, plan
from vitruvius.sim.film import Scene as Picture

SIZE = 720
"""Largest length of a plan's longer side, in pixels."""

HEAD, GAP, EDGE = 64, 12, 16
"""Pixels above the plans for words, between two plans, and left of words."""

MIN_WIDTH = 320
"""Least width of the column of a plan, in pixels: a policy's name also fits above a narrower plan."""

LARGE_PX, SMALL_PX, MIN_PX = 40, 26, 12
"""Font sizes, in pixels: names and scores, instructions, and the smallest size for text in a narrow space."""

FRAME = 80
"""Pixels of a display's height that a window's title and the desktop's bars may take."""

START = "arrow keys or W, A, D: drive to the yellow square. The first key starts the clock"

FRAMES = 60
"""Frames per second."""

TURN_EVERY = 0.18
"""Seconds between two turns while a turn key is held."""

BACK, WORDS, DIM, FOG = (250, 249, 245), (51, 58, 69), (120, 128, 138), (51, 58, 69, 255)
"""Colours of the window."""

TURNS = {pygame.K_LEFT: LEFT, pygame.K_a: LEFT, pygame.K_RIGHT: RIGHT, pygame.K_d: RIGHT}
GOES = {pygame.K_UP, pygame.K_w}

Seen = Literal["plan", "seen"]
Pixel = tuple[float, float]


class Panel:
    """House from above with a body in it: the whole house, or what the body's rays have reached."""

    def __init__(self, house: House, view: Seen, size: int = SIZE) -> None:
        image = plan(house, size).reduce(SHARP)
        self.plan = pygame.image.frombytes(image.tobytes(), image.size, "RGB")
        self.size = image.size
        self._view = View(house, size)
        self.fog: pygame.Surface | None = None
        if view == "seen":
            self.fog = pygame.Surface(image.size, pygame.SRCALPHA)
            self.fog.fill(FOG)

    def at(self, x: float, y: float) -> Pixel:
        """Return a point of the house, metres, as a pixel of the panel."""
        across, down = self._view.at(x, y)
        return across / SHARP, down / SHARP

    def see(self, scene: Picture) -> None:
        """Lift the fog where the rays go; call this method for every step."""
        if self.fog is not None:
            pygame.draw.polygon(self.fog, (0, 0, 0, 0), self._fan(scene))
            pygame.draw.circle(self.fog, (0, 0, 0, 0), self.at(*scene.pose[:2]), self._length(0.7 * SIDE))

    def draw(self, surface: pygame.Surface, corner: tuple[int, int], scene: Picture) -> None:
        """Draw the panel in its present state."""
        whole = self.plan.copy()
        half = scene.config.target / 2
        hidden = self.fog is not None and not scene.is_target.any()
        rays = pygame.Surface(self.size, pygame.SRCALPHA)
        points = self._fan(scene)
        pygame.draw.polygon(rays, (*RAY, 34), points)
        for end, hit in zip(points[1:], scene.is_target, strict=True):
            pygame.draw.aaline(rays, (*TARGET_RAY, 255) if hit else (*RAY, 120), points[0], end)
        whole.blit(rays, (0, 0))
        if self.fog is not None:
            whole.blit(self.fog, (0, 0))
        if not hidden:
            box = self._box(scene.target - half, scene.target + half)
            pygame.draw.rect(whole, TARGET, box, border_radius=3)
            pygame.draw.rect(whole, TARGET_EDGE, box, width=2, border_radius=3)
        self._body(whole, scene)
        surface.blit(whole, corner)

    def _body(self, surface: pygame.Surface, scene: Picture) -> None:
        heading = float(scene.pose[2])
        diagonal = round(heading / (np.pi / 4)) % 2
        low, side = scene.pose[:2] - scene.config.eye[diagonal], scene.config.body[diagonal]
        pygame.draw.rect(surface, BODY, self._box(low, low + side), border_radius=4)
        arrow = side * np.array([(0.4, 0.0), (-0.25, 0.3), (-0.25, -0.3)])
        turn = np.array([(np.cos(heading), -np.sin(heading)), (-np.sin(heading), -np.cos(heading))])
        pygame.draw.polygon(surface, "white", [self.at(*point) for point in low + side / 2 + arrow @ turn.T])

    def _fan(self, scene: Picture) -> list[Pixel]:
        return [self.at(*scene.pose[:2]), *(self.at(*end) for end in fan(scene))]

    def _box(self, low: np.ndarray, high: np.ndarray) -> pygame.Rect:
        (left, top), (right, bottom) = self.at(*low), self.at(*high)
        return pygame.Rect(round(left), round(top), max(4, round(right - left)), max(4, round(bottom - top)))

    def _length(self, metres: float) -> float:
        return metres * self._view.frame.scale


def size_of(display: tuple[int, int], panels: int) -> int:
    """Return the longer side of each plan, in pixels, so that ``panels`` plans side by side fit a display."""
    width, height = display
    return max(1, min(SIZE, (width - GAP * (panels - 1)) // panels, height - HEAD - FRAME))


class PlayedEpisode:
    """Played episode, shown up to a step."""

    def __init__(self, panel: Panel, name: str, scenes: Sequence[Picture]) -> None:
        self.panel, self.name, self.step, self._scenes = panel, name, 0, scenes
        panel.see(self.scene)

    @property
    def scene(self) -> Picture:
        """Scene that is shown."""
        return self._scenes[self.step]

    def go_on(self, step: int) -> None:
        """Advance to a step, or to the last one."""
        while self.step < min(step, len(self._scenes) - 1):
            self.step += 1
            self.panel.see(self.scene)


@dataclass
class Keys:
    """Keys that are held, and the actions that they ask for. Times are in seconds of the game."""

    going: bool = False
    asked: list[int] = field(default_factory=list)
    """Actions of keys that were pressed since the last step: no press is lost, however short."""
    held: dict[int, float] = field(default_factory=dict)
    """Turn keys that are held, and the time of each key's next turn."""

    def down(self, key: int, now: float) -> None:
        """Note that a key was pressed."""
        if key in GOES:
            self.going = True
            self.asked.append(FORWARD)
        elif key in TURNS:
            self.asked.append(TURNS[key])
            self.held[key] = now + TURN_EVERY

    def up(self, key: int) -> None:
        """Note that a key was released."""
        if key in GOES:
            self.going = False
        self.held.pop(key, None)

    def action(self, now: float) -> int | None:
        """Return the next action, or None if no key asks for one."""
        for key, again in self.held.items():
            if again <= now:
                self.asked.append(TURNS[key])
                self.held[key] = now + TURN_EVERY
        if self.asked:
            return self.asked.pop(0)
        return FORWARD if self.going else None


class GameWindow:
    """Window that shows games one after the other, and plays them by the keyboard."""

    def __init__(self, title: str = "Vitruvius") -> None:
        """Open the display. Raises ``pygame.error`` without a display."""
        pygame.display.init()
        pygame.font.init()
        pygame.display.set_caption(title)
        self.clock = pygame.time.Clock()
        size = self._size(1)
        self.surface = pygame.display.set_mode((size, size))
        self.tick: Callable[[], float] = lambda: self.clock.tick(FRAMES) / 1000
        """Function that waits for the next frame and returns the seconds since the last one."""

    def play(
        self, game: Game, seconds: float, view: Seen, race: tuple[str, Sequence[Picture]] | None = None
    ) -> bool:
        """Play a game by the keyboard until its steps or seconds are over.

        Returns False if the player left early. The clock starts at the first key. An agent's scenes run next
        to the game at the game's speed: all ``steps`` of the episode in ``seconds``.
        """
        house, size = game.scene.house, self._size(2 if race else 1)
        ghost = PlayedEpisode(Panel(house, view, size), *race) if race else None
        panels = [Panel(house, view, size), *([ghost.panel] if ghost else [])]
        self._open(panels)
        speed, keys = game.scene.config.steps / seconds, Keys()
        now, due, began = 0.0, 0.0, False
        panels[0].see(game.scene)
        while True:
            for event in pygame.event.get():
                if _is_end(event):
                    return False
                if event.type == pygame.KEYDOWN:
                    began |= event.key in GOES or event.key in TURNS
                    keys.down(event.key, now)
                elif event.type == pygame.KEYUP:
                    keys.up(event.key)
            passed = self.tick()
            if began:
                now, due = now + passed, due + passed * speed
            # A step is due every 1 / speed seconds. Without a key for it the step is lost: time goes on.
            while due >= 1:
                due -= 1
                action = keys.action(now)
                if action is not None:
                    game.act(action)
                    panels[0].see(game.scene)
            if ghost:
                ghost.go_on(int(now * speed))
            scenes = [("you", game.scene), *([(ghost.name, ghost.scene)] if ghost else [])]
            step = f"{max(seconds - now, 0):.1f} s   step {game.scene.step} of {game.scene.config.steps}"
            self._draw(panels, scenes, step if began else START)
            if game.ended or now >= seconds:
                return True

    def replay(self, played: PlayedGame, houses: Sequence[House], where: str) -> bool:
        """Replay a game at its speed; return True if it was watched to its end.

        Raises ``ResultsError`` if the game does not belong to these houses, or if the replay differs from its
        record.
        """
        if played.index >= len(houses):
            raise ResultsError(
                f"{where}: the game was played in house {played.index}, and there are {len(houses)} houses"
            )
        game, scenes = replayed(played, houses[played.index], where)
        trace = PlayedEpisode(Panel(scenes[0].house, played.view, self._size(1)), played.player, scenes)
        self._open([trace.panel])
        speed, now = game.scene.config.steps / played.seconds, 0.0
        while trace.step < len(scenes) - 1:
            if any(_is_end(event) for event in pygame.event.get()):
                return False
            now += self.tick()
            trace.go_on(int(now * speed))
            self._draw([trace.panel], [(trace.name, trace.scene)], f"step {trace.step}")
        return self.show([f"{played.player}: {played.score}", "Enter: next game   Esc: quit"])

    def show(self, lines: Sequence[str]) -> bool:
        """Show scores and, as the last line, the keys. Return True after Enter, False after Esc."""
        width, height = self.surface.get_size()
        room = width - 4 * EDGE, height // (len(lines) + 2)
        shown = [fitted(line, LARGE_PX if line is not lines[-1] else SMALL_PX, room, WORDS) for line in lines]
        tall = sum(each.get_height() + GAP for each in shown) + GAP
        card = pygame.Rect(0, 0, max(each.get_width() for each in shown) + 2 * EDGE, tall)
        card.center = width // 2, height // 2
        pygame.draw.rect(self.surface, BACK, card, border_radius=8)
        pygame.draw.rect(self.surface, DIM, card, width=2, border_radius=8)
        top = card.top + GAP
        for each in shown:
            self.surface.blit(each, each.get_rect(midtop=(card.centerx, top)))
            top += each.get_height() + GAP
        pygame.display.flip()
        while True:
            for event in pygame.event.get():
                if _is_end(event):
                    return False
                if event.type == pygame.KEYDOWN and event.key in (pygame.K_RETURN, pygame.K_SPACE):
                    return True
            self.tick()

    def close(self) -> None:
        """Close the display."""
        pygame.quit()

    @staticmethod
    def _size(panels: int) -> int:
        return size_of(pygame.display.get_desktop_sizes()[0], panels)

    def _draw(self, panels: Sequence[Panel], scenes: Sequence[tuple[str, Picture]], words: str) -> None:
        """Draw panels side by side, each with its name and score, and ``words`` over the first."""
        self.surface.fill(BACK)
        corner = 0
        for panel, (name, scene) in zip(panels, scenes, strict=True):
            width = max(MIN_WIDTH, panel.size[0])
            panel.draw(self.surface, (corner + (width - panel.size[0]) // 2, HEAD), scene)
            score = fitted(f"{name}: {scene.found}", LARGE_PX, (width - EDGE, 30), WORDS)
            self.surface.blit(score, (corner + EDGE, 6))
            corner += width + GAP
        said = fitted(words, SMALL_PX, (self.surface.get_width() - 2 * EDGE, HEAD - 36), DIM)
        self.surface.blit(said, (EDGE, 36))
        pygame.display.flip()

    def _open(self, panels: Sequence[Panel]) -> None:
        """Resize the window to fit the panels side by side."""
        across = sum(max(MIN_WIDTH, panel.size[0]) for panel in panels) + GAP * (len(panels) - 1)
        self.surface = pygame.display.set_mode((across, panels[0].size[1] + HEAD))


def fitted(words: str, size: int, room: tuple[int, int], colour: tuple[int, int, int]) -> pygame.Surface:
    """Return words in the largest font size that fits ``room`` (width, height), in one or more lines."""
    for letters in range(size, MIN_PX - 1, -1):
        text = pygame.font.Font(None, letters).render(words, True, colour, wraplength=room[0])
        if text.get_width() <= room[0] and text.get_height() <= room[1]:
            return text
    return pygame.font.Font(None, MIN_PX).render(words, True, colour, wraplength=room[0])


def _is_end(event: pygame.event.Event) -> bool:
    """Return True if the window is closed, or Esc is pressed."""
    return event.type == pygame.QUIT or (event.type == pygame.KEYDOWN and event.key == pygame.K_ESCAPE)
