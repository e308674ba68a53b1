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
from swarm_gym.scenarios import FunctionScenario, StaticScenario

if TYPE_CHECKING:
    import pygame


class Renderer:
    """Draws scenes, as arrays or into a window, where it shows at most `fps` pictures per second.

    Raises:
        DependencyNotInstalled: by the first picture, if pygame is missing.
    """

    def __init__(self, width: int = DESIGN[0], height: int = DESIGN[1], fps: int = 20):
        self.size = (width, height)
        self.fps = fps
        self._view: View | None = None
        self._clock: pygame.time.Clock | None = None
        self._dismissed = False

    def frame(self, scene: Scene) -> NDArray[np.uint8]:
        """Draw a picture, shape (height, width, 3); needs no display."""
        pixels = require_pygame().surfarray.array3d(self._draw(scene))
        return np.ascontiguousarray(pixels.swapaxes(0, 1))

    def show(self, scene: Scene) -> None:
        """Put a picture into the window; does nothing once the user has closed it."""
        if self._dismissed:
            return
        pygame = require_pygame()
        window = pygame.display.get_surface()
        # Pygame has one window per process, so that another renderer may have closed or resized it.
        if window is None or window.get_size() != self.size:
            window = pygame.display.set_mode(self.size)
            pygame.display.set_caption("swarm_gym")
        self._clock = self._clock or pygame.time.Clock()
        if any(event.type == pygame.QUIT for event in pygame.event.get()):
            self.close()
            self._dismissed = True
            return
        window.blit(self._draw(scene), (0, 0))
        pygame.display.flip()
        self._clock.tick(self.fps)

    def close(self) -> None:
        """Close the window, if this renderer has shown anything."""
        if self._clock is not None:
            require_pygame().display.quit()
            self._clock = None

    def _draw(self, scene: Scene) -> "pygame.Surface":
        pygame = require_pygame()
        if self._view is None or self._view.scenario != scene.scenario:
            canvas = pygame.Surface(OVERSAMPLING * np.array(self.size))
            self._view = _view_of(scene.scenario, Pen(canvas))
        pen = Pen(self._view.background.copy())
        self._view.draw_swarm(pen, scene)
        draw_headline(pen, scene)
        self._view.draw_legend(pen, scene)
        draw_charts(pen, scene)
        return pygame.transform.smoothscale(pen.surface, self.size)


def _view_of(scenario: StaticScenario, pen: Pen) -> View:
    if isinstance(scenario, FunctionScenario):
        return FunctionView(scenario, pen)
    return MapView(scenario, pen)
