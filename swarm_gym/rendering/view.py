"""Views: the part of a picture that shows the swarm, with its border and axes."""

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from swarm_gym.rendering.pen import (
    CHART_COLUMN,
    FAINT_INK,
    FOOTER,
    HEADER,
    MARGIN,
    PAPER,
    Colour,
    Pen,
)
from swarm_gym.rendering.scene import Scene
from swarm_gym.scenarios import StaticScenario

Floats = NDArray[np.float64]
Extent = tuple[float, float, float, float]


class View(ABC):
    """The view of a scenario: its picture without a swarm, and the positions of points on it.

    Attributes:
        scenario: scenario that is shown.
        background: surface with the picture.
        border: rectangle that the view fills, in pixels.
    """

    def __init__(self, scenario: StaticScenario, pen: Pen, extent: Extent, y_up: bool = True):
        self.scenario = scenario
        self.background = pen.surface
        self._extent, self._y_up = extent, y_up
        low, high = np.reshape(extent, (2, 2))
        corner = np.array([pen.px(MARGIN), pen.px(HEADER)])
        room = [pen.width - pen.px(CHART_COLUMN), pen.height - pen.px(FOOTER)] - corner
        self._scale = (room / (high - low)).min()
        size = np.maximum(1.0, self._scale * (high - low))
        self._origin = corner + (room + size * [-1, 1]) / 2
        self.border = border = pen.pygame.Rect(self._origin - size * [0, 1], size)
        pen.surface.fill(PAPER)
        pen.surface.set_clip(border)
        self._draw_ground(pen)
        pen.surface.set_clip(None)
        pen.draw.rect(pen.surface, FAINT_INK, border.inflate(pen.px(2), pen.px(2)), pen.px(1))
        below, before = border.bottom + pen.px(5), border.left - pen.px(6)
        pen.text(f"{low[0]:g}", (border.left, below), "topleft")
        pen.text(f"{high[0]:g}", (border.right, below), "topright")
        bottom, top = self._height_limits()
        pen.text(bottom, (before, border.bottom), "bottomright")
        pen.text(top, (before, border.top), "topright")

    def pixels(self, points: Floats) -> Floats:
        """Convert coordinates (..., 2) to coordinates of the picture, whose y grows downwards."""
        x_min, y_min, _, y_max = self._extent
        if self._y_up:
            return self._origin + (points - (x_min, y_min)) * [self._scale, -self._scale]
        return self._origin + (points - (x_min, y_max)) * self._scale

    @abstractmethod
    def draw_swarm(self, pen: Pen, scene: Scene) -> None:
        """Draw the members and the best so far."""

    @abstractmethod
    def draw_legend(self, pen: Pen, scene: Scene) -> None:
        """Explain the colours and marks, below the border."""

    def _height_limits(self) -> tuple[str, str]:
        """Return the texts next to the bottom and the top of the border."""
        _, low, _, high = self._extent
        bottom, top = (low, high) if self._y_up else (high, low)
        return f"{bottom:g}", f"{top:g}"

    @abstractmethod
    def _draw_ground(self, pen: Pen) -> None:
        """Draw the background below the swarm, over the whole border."""

    def _draw_mark(self, pen: Pen, at: Floats, colour: Colour, corners: int) -> None:
        """Draw a polygon at a point (2,) of the picture."""
        angles = 2 * np.pi * np.arange(corners) / corners
        shape = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        pen.draw.polygon(pen.surface, PAPER, at + pen.px(10) * shape)
        pen.draw.polygon(pen.surface, colour, at + pen.px(7.5) * shape)
