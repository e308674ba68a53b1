"""Tools for drawing: colours, lengths, and a pen for a pygame surface."""

from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np
from gymnasium.error import DependencyNotInstalled
from numpy.typing import NDArray

from swarm_gym.scenarios import Point

if TYPE_CHECKING:
    import pygame

Floats = NDArray[np.float64]
Colour = tuple[int, int, int]

# The hues are those of Okabe and Ito, which colour-blind readers can tell apart.
FEASIBLE: Colour = (0, 114, 178)
COLLIDING: Colour = (230, 120, 0)
START: Colour = (0, 158, 115)
TARGET: Colour = (204, 80, 150)
BEST: Colour = (17, 17, 17)
INK: Colour = (40, 44, 52)
FAINT_INK: Colour = (110, 116, 126)
OBSTACLE: Colour = (192, 197, 206)
SHADE: Colour = (226, 229, 234)
MAP: Colour = (249, 249, 246)
PAPER: Colour = (255, 255, 255)

# Pygame does not smooth thick lines, so everything is drawn larger by this factor and then scaled down.
OVERSAMPLING = 2

# Lengths in this package refer to a picture of this size, in pixels, and scale with the picture.
DESIGN, SMALLEST_SCALE = (960, 520), 0.8
# Limits of a picture, in pixels: smaller ones have no room for the map, larger ones exceed all screens.
WIDTHS, HEIGHTS = (320, 4096), (240, 4096)
MARGIN, HEADER, FOOTER, CHART_COLUMN = 44, 54, 62, 276
DOT = 2.5  # radius of a dot
SMALL, MEDIUM, LARGE = 17, 20, 26  # heights of letters


class Pen:
    """A pen for an oversampled surface."""

    def __init__(self, surface: "pygame.Surface"):
        self.surface = surface
        self.width, self.height = surface.get_size()
        fits = self.width / DESIGN[0], self.height / DESIGN[1]
        self.scale = max(min(fits), SMALLEST_SCALE * OVERSAMPLING)
        self.pygame = require_pygame()
        self.draw = self.pygame.draw
        self._fonts: dict[int, pygame.font.Font] = {}
        self._texts: dict[tuple[str, int], pygame.Surface] = {}
        self._texts_before: dict[tuple[str, int], pygame.Surface] = {}

    def begin(self, background: "pygame.Surface") -> None:
        """Begin a picture with a background of the same size; texts of the last picture are kept."""
        self.surface.blit(background, (0, 0))
        # Fonts are made for each picture, because `pygame.quit` ends them; rendered texts stay valid.
        self._fonts = {}
        self._texts_before, self._texts = self._texts, {}

    def px(self, length: float) -> int:
        """Convert a length of the design to pixels of the surface, at least one."""
        return max(1, round(length * self.scale))

    def lines(self, colour: Colour, lines: Floats, width: float) -> None:
        """Draw lines (m, k, 2), with round joints where they are thick."""
        thickness = self.px(width)
        for line in lines:
            self.draw.lines(self.surface, colour, False, line, thickness)
            for point in line[1:-1] if thickness > 3 else ():
                self.draw.circle(self.surface, colour, point, thickness / 2)

    def dashes(self, colour: Colour, lines: Floats, width: float) -> None:
        """Draw lines (m, k, 2) dashed, with one to three dashes per segment."""
        steps = np.diff(lines, axis=1).reshape(-1, 2)
        counts = np.clip(np.hypot(*steps.T) // self.px(14), 1, 3).astype(np.int64)
        segment = np.repeat(np.arange(len(steps)), counts)
        number = np.arange(len(segment)) - (np.cumsum(counts) - counts)[segment]
        dash = (steps / counts[:, None])[segment]
        # The dashes of each line begin at another place, so that neighbouring lines have no common gaps.
        shift = 0.4 * (0.618 * (segment // (lines.shape[1] - 1)) % 1.0)
        begins = lines[:, :-1].reshape(-1, 2)[segment] + (number + shift)[:, None] * dash
        self._strokes(colour, begins, 0.6 * dash, self.px(width))

    def dots(self, colour: Colour, lines: Floats, width: float) -> None:
        """Draw a dot at the first point of each of the lines (m, k, 2)."""
        for point in lines[:, 0]:
            self.draw.circle(self.surface, colour, point, self.px(DOT + width / 2))

    def rings(self, colour: Colour, lines: Floats, width: float) -> None:
        """Draw a ring at the first point of each of the lines (m, k, 2)."""
        for point in lines[:, 0]:
            self.draw.circle(self.surface, colour, point, self.px(DOT + width / 2), self.px(width))

    def _strokes(self, colour: Colour, begins: Floats, steps: Floats, thickness: int) -> None:
        """Draw straight lines from points (m, 2) by steps (m, 2), all at once, since there are thousands."""
        lengths = np.ceil(np.abs(steps).max(axis=1)).astype(
            np.int64
        )  # pixels along the axis that is closer to the line
        counts, per_pixel = lengths + 1, steps / np.maximum(lengths, 1)[:, None]
        firsts = np.cumsum(counts) - counts
        pixel = np.arange(counts.sum())
        columns, rows = (
            (np.repeat(first, counts) + pixel * np.repeat(slope, counts)).astype(np.int32)
            for first, slope in zip((begins - firsts[:, None] * per_pixel + 0.5).T, per_pixel.T, strict=True)
        )
        before, after = (thickness - 1) // 2, thickness // 2
        room = self.surface.get_clip()
        inside = (columns >= room.left + before) & (columns < room.right - after)
        inside &= (rows >= room.top + before) & (rows < room.bottom - after)
        is_steep = np.abs(steps[:, 1]) > np.abs(steps[:, 0])
        aside = np.repeat(np.where(is_steep, 1, self.width), counts)[inside]
        index = (rows * np.int32(self.width) + columns)[inside]
        pixels = self.pygame.surfarray.pixels2d(self.surface).T.reshape(-1)
        assert not pixels.flags.owndata  # a view of the surface's pixels, not a copy
        for k in range(-before, after + 1):
            pixels[index + k * aside] = self.surface.map_rgb(colour)

    def text(self, text: str, at: Point, anchor: str, size: int = SMALL) -> "pygame.Rect":
        """Write text, small text faintly, at a point that pygame's rectangles call `anchor`."""
        key = (text, size)
        image = self._texts[key] = self._texts.get(key) or self._texts_before.get(key) or self._written(*key)
        return self.surface.blit(image, image.get_rect(**{anchor: at}))

    def _written(self, text: str, size: int) -> "pygame.Surface":
        if size not in self._fonts:
            self.pygame.font.init()
            self._fonts[size] = self.pygame.font.Font(None, self.px(size))
        return self._fonts[size].render(text, True, FAINT_INK if size == SMALL else INK)


def require_pygame() -> ModuleType:
    """Return pygame, which is imported only for the first picture.

    Raises:
        DependencyNotInstalled: if it is missing.
    """
    try:
        import pygame
    except ImportError as error:
        raise DependencyNotInstalled('pygame: run `pip install "swarm_gym[render]"`') from error
    return pygame
