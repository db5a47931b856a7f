"""The window: a person's game beside the agent that they race, drawn by pygame."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import pygame

from agent.play.game import Game, fan, replayed
from agent.play.results import PlayedGame, ResultsError
from logic import House
from logic.house.parts import BODY as SIDE
from sim.actions import FORWARD, LEFT, RIGHT
from sim.film import BODY, RAY, SHARP, TARGET, TARGET_EDGE, TARGET_RAY, View, plan
from sim.film import Scene as Picture

SIZE = 720
"""Pixels of the longer side of a plan, at most."""

HEAD, GAP, EDGE = 64, 12, 16
"""Pixels above the plans for words, between two plans, and left of words."""

MIN_WIDTH = 320
"""Width of the column of a plan, in pixels: a policy's name also fits above a narrower plan."""

LARGE, SMALL, LEAST = 40, 26, 12
"""Font sizes, in pixels: names and scores, instructions, and the smallest size for text in a narrow space."""

FRAME = 80
"""Pixels of the height of a display that a window's title and bars of the desktop may take."""

START = "arrow keys or W, A, D: drive to the yellow square. The first key starts the clock"

FRAMES = 60
"""Frames a second."""

TURN_EVERY = 0.18
"""Seconds between turns while a key of turning is held."""

BACK, WORDS, DIM, FOG = (250, 249, 245), (51, 58, 69), (120, 128, 138), (51, 58, 69, 255)
"""Colours."""

TURNS = {pygame.K_LEFT: LEFT, pygame.K_a: LEFT, pygame.K_RIGHT: RIGHT, pygame.K_d: RIGHT}
GOES = {pygame.K_UP, pygame.K_w}

Seen = Literal["plan", "seen"]
Pixel = tuple[float, float]


class Panel:
    """A house from above, and in it a body: all of it, or what its rays have reached."""

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
        """A point of the house, metres, as a pixel of the panel."""
        across, down = self._view.at(x, y)
        return across / SHARP, down / SHARP

    def see(self, scene: Picture) -> None:
        """Lift the fog where the rays go; call it for every step."""
        if self.fog is not None:
            pygame.draw.polygon(self.fog, (0, 0, 0, 0), self._fan(scene))
            pygame.draw.circle(self.fog, (0, 0, 0, 0), self.at(*scene.pose[:2]), self._length(0.7 * SIDE))

    def draw(self, surface: pygame.Surface, corner: tuple[int, int], scene: Picture) -> None:
        """Draw the panel as it is now."""
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
    """Pixels of the longer side of each plan, so that a window with so many side by side fits a display."""
    width, height = display
    return max(1, min(SIZE, (width - GAP * (panels - 1)) // panels, height - HEAD - FRAME))


class PlayedEpisode:
    """An episode that has been played, shown up to a step."""

    def __init__(self, panel: Panel, name: str, scenes: Sequence[Picture]) -> None:
        self.panel, self.name, self.step, self._scenes = panel, name, 0, scenes
        panel.see(self.scene)

    @property
    def scene(self) -> Picture:
        """The scene that is shown."""
        return self._scenes[self.step]

    def go_on(self, step: int) -> None:
        """Go on to a step, or to the last one."""
        while self.step < min(step, len(self._scenes) - 1):
            self.step += 1
            self.panel.see(self.scene)


@dataclass
class Keys:
    """Which keys are held, and what they ask for. Times in seconds of the game."""

    going: bool = False
    asked: list[int] = field(default_factory=list)
    """Actions of keys that were pressed since the last step: no press is lost, however short."""
    held: dict[int, float] = field(default_factory=dict)
    """The keys of turning that are held, and when each turns again."""

    def down(self, key: int, now: float) -> None:
        """A key was pressed."""
        if key in GOES:
            self.going = True
            self.asked.append(FORWARD)
        elif key in TURNS:
            self.asked.append(TURNS[key])
            self.held[key] = now + TURN_EVERY

    def up(self, key: int) -> None:
        """A key was let go."""
        if key in GOES:
            self.going = False
        self.held.pop(key, None)

    def action(self, now: float) -> int | None:
        """What the next step is; None where nothing is asked for."""
        for key, again in self.held.items():
            if again <= now:
                self.asked.append(TURNS[key])
                self.held[key] = now + TURN_EVERY
        if self.asked:
            return self.asked.pop(0)
        return FORWARD if self.going else None


class GameWindow:
    """Shows games one after the other, and plays them by the keyboard."""

    def __init__(self, title: str = "Vitruvius") -> None:
        """Open the display. Raises ``pygame.error`` where there is none."""
        pygame.display.init()
        pygame.font.init()
        pygame.display.set_caption(title)
        self.clock = pygame.time.Clock()
        size = self._size(1)
        self.surface = pygame.display.set_mode((size, size))
        self.tick: Callable[[], float] = lambda: self.clock.tick(FRAMES) / 1000
        """Waits for the next frame: the seconds since the last one."""

    def play(
        self, game: Game, seconds: float, view: Seen, race: tuple[str, Sequence[Picture]] | None = None
    ) -> bool:
        """Play a game by the keyboard until its steps or its seconds are over; whether it came to its end.

        The clock starts at the first key. An agent's scenes run beside it at the game's speed, ``steps`` of
        the episode in so many seconds.
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
            # A step is due every 1 / speed seconds; where no key asks for one, it is lost: time goes on.
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
        """Show a game again, at its speed; whether it was watched to its end.

        Raises ``ResultsError`` where it cannot be played in these houses, or does not come out as it says.
        """
        if played.index >= len(houses):
            raise ResultsError(f"{where}: played in house {played.index}, here are {len(houses)}")
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
        return self.show([f"{played.player}: {played.score}", "Enter: the next game   Esc: the end"])

    def show(self, lines: Sequence[str]) -> bool:
        """Show scores and, as the last line, the keys. Return True after Enter, False after Esc."""
        width, height = self.surface.get_size()
        room = width - 4 * EDGE, height // (len(lines) + 2)
        shown = [fitted(line, LARGE if line is not lines[-1] else SMALL, room, WORDS) for line in lines]
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
        """Draw panels side by side, with the name and the score of each, and words over the first."""
        self.surface.fill(BACK)
        corner = 0
        for panel, (name, scene) in zip(panels, scenes, strict=True):
            width = max(MIN_WIDTH, panel.size[0])
            panel.draw(self.surface, (corner + (width - panel.size[0]) // 2, HEAD), scene)
            score = fitted(f"{name}: {scene.found}", LARGE, (width - EDGE, 30), WORDS)
            self.surface.blit(score, (corner + EDGE, 6))
            corner += width + GAP
        said = fitted(words, SMALL, (self.surface.get_width() - 2 * EDGE, HEAD - 36), DIM)
        self.surface.blit(said, (EDGE, 36))
        pygame.display.flip()

    def _open(self, panels: Sequence[Panel]) -> None:
        """Resize the window to fit the panels side by side."""
        across = sum(max(MIN_WIDTH, panel.size[0]) for panel in panels) + GAP * (len(panels) - 1)
        self.surface = pygame.display.set_mode((across, panels[0].size[1] + HEAD))


def fitted(words: str, size: int, room: tuple[int, int], colour: tuple[int, int, int]) -> pygame.Surface:
    """Return words in the largest font size that fits ``room`` (width, height), in one or more lines."""
    for letters in range(size, LEAST - 1, -1):
        text = pygame.font.Font(None, letters).render(words, True, colour, wraplength=room[0])
        if text.get_width() <= room[0] and text.get_height() <= room[1]:
            return text
    return pygame.font.Font(None, LEAST).render(words, True, colour, wraplength=room[0])


def _is_end(event: pygame.event.Event) -> bool:
    """Whether the window is closed, or Esc is pressed."""
    return event.type == pygame.QUIT or (event.type == pygame.KEYDOWN and event.key == pygame.K_ESCAPE)
