"""Pictures of a running swarm with pygame, as arrays or in a window."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from swarm_gym.rendering.charts import draw_charts, draw_headline
from swarm_gym.rendering.function_view import FunctionView
from swarm_gym.rendering.map_view import MapView
from swarm_gym.rendering.pen import DESIGN, OVERSAMPLING, Pen, require_pygame
from swarm_gym.rendering.scene import Scene
from swarm_gym.rendering.view import View
from swarm_gym.rendering.window import Window
from swarm_gym.scenarios import FunctionScenario, StaticScenario

if TYPE_CHECKING:
    import pygame


class Renderer:
    """Draws scenes, as arrays or into a window, where it shows at most `fps` pictures per second.

    Raises:
        DependencyNotInstalled: by the first picture, if pygame is missing.
    """

    def __init__(self, width: int = DESIGN[0], height: int = DESIGN[1], fps: float = 20):
        self.size = (width, height)
        self._window = Window(self.size, fps)
        self._view: View | None = None
        self._pen: Pen | None = None

    def frame(self, scene: Scene) -> NDArray[np.uint8]:
        """Draw a picture, shape (height, width, 3); needs no display."""
        pixels = require_pygame().image.tobytes(self._draw(scene), "RGB")
        return np.frombuffer(bytearray(pixels), dtype=np.uint8).reshape(*self.size[::-1], 3)

    def show(self, scene: Scene) -> None:
        """Put a picture into the window, and wait as its user says; does nothing once they have closed it."""
        if not self._window.is_dismissed:
            self._window.show(self._draw(scene))

    def respond(self) -> None:
        """Let the window, if there is one, react to what its user has done."""
        self._window.respond()

    def close(self) -> None:
        """Close the window, if this renderer has shown anything."""
        self._window.close()

    def _draw(self, scene: Scene) -> "pygame.Surface":
        pygame = require_pygame()
        if self._view is None or self._pen is None or self._view.scenario != scene.scenario:
            canvas = pygame.Surface(OVERSAMPLING * np.array(self.size))
            self._view = _view_of(scene.scenario, Pen(canvas))
            self._pen = Pen(canvas.copy())
        pen = self._pen
        pen.begin(self._view.background)
        self._view.draw_swarm(pen, scene)
        draw_headline(pen, scene)
        self._view.draw_legend(pen, scene)
        draw_charts(pen, scene)
        return pygame.transform.smoothscale(pen.surface, self.size)


def _view_of(scenario: StaticScenario, pen: Pen) -> View:
    if isinstance(scenario, FunctionScenario):
        return FunctionView(scenario, pen)
    return MapView(scenario, pen)
