"""The renderer: draws a view, the headline and the charts into one picture, as an array or in a window."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from swarm_gym.rendering.function_view import FunctionView
from swarm_gym.rendering.map_view import MapView
from swarm_gym.rendering.pen import (
    DESIGN,
    FAINT_INK,
    INK,
    LARGE,
    MAP,
    MARGIN,
    MEDIUM,
    OVERSAMPLING,
    SHADE,
    Pen,
    require_pygame,
)
from swarm_gym.rendering.scene import Scene
from swarm_gym.rendering.view import View
from swarm_gym.rendering.window import Window
from swarm_gym.scenarios import FunctionScenario, StaticScenario

if TYPE_CHECKING:
    import pygame

Floats = NDArray[np.float64]

# Maximum length of a scenario's name, in large and in smaller letters; there is no room for more.
LONGEST_LARGE_NAME, LONGEST_NAME = 20, 32


class Renderer:
    """A renderer of scenes, as arrays or in a window with at most `fps` pictures per second.

    Args:
        width: width of a picture in pixels.
        height: height of a picture in pixels.
        fps: maximum number of pictures per second in the window.

    Raises:
        DependencyNotInstalled: by the first picture, if pygame is missing.
    """

    def __init__(self, width: int = DESIGN[0], height: int = DESIGN[1], fps: float = 20):
        self.size = (width, height)
        self._window = Window(self.size, fps)
        self._view: View | None = None
        self._pen: Pen | None = None

    def frame(self, scene: Scene) -> NDArray[np.uint8]:
        """Return a picture of a scene as an array, shape (height, width, 3); this needs no display."""
        pixels = require_pygame().image.tobytes(self._draw(scene), "RGB")
        return np.frombuffer(bytearray(pixels), dtype=np.uint8).reshape(*self.size[::-1], 3)

    def show(self, scene: Scene) -> None:
        """Show a picture in the window and wait until the next one is due.

        The wait depends on speed and pause, which the user sets. Once the user has closed the window, this
        does nothing.
        """
        if not self._window.is_dismissed:
            self._window.show(self._draw(scene))

    def respond(self) -> None:
        """Let the window, if there is one, react to the input of its user."""
        self._window.respond()

    def close(self) -> None:
        """Close the window if this renderer has shown anything."""
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
        _draw_headline(pen, scene)
        self._view.draw_legend(pen, scene)
        _draw_charts(pen, scene)
        return pygame.transform.smoothscale(pen.surface, self.size)


def _view_of(scenario: StaticScenario, pen: Pen) -> View:
    if isinstance(scenario, FunctionScenario):
        return FunctionView(scenario, pen)
    return MapView(scenario, pen)


def _draw_headline(pen: Pen, scene: Scene) -> None:
    """Write the name of the scenario and the progress of the episode."""
    facts = (
        f"iteration {scene.iteration} of {scene.iterations}     "
        f"best fitness {scene.best_fitness:.5g}     evaluations {scene.evaluations:,}"
    )
    name = scene.scenario.name
    size = LARGE if len(name) <= LONGEST_LARGE_NAME else MEDIUM
    if len(name) > LONGEST_NAME:
        name = f"{name[: LONGEST_NAME - 1]}…"
    box = pen.text(name, (pen.px(MARGIN), pen.px(28)), "midleft", size)
    pen.text(facts, (box.right + pen.px(24), pen.px(28)), "midleft", MEDIUM)


def _draw_charts(pen: Pen, scene: Scene) -> None:
    """Draw population collision, population size and repair degree by iteration."""
    courses = scene.courses
    collision = courses["population_collision"]
    charts = (
        ("collision E(P)", ".4g", collision, collision.max() or 1.0),
        ("population size", ".0f", courses["population_size"], scene.max_population_size),
        ("repair degree φ", ".2f", courses["repair_degree"], 1.0),
    )
    height = (pen.height - pen.px(20)) // len(charts)
    area = pen.pygame.Rect(pen.width - pen.px(224), pen.px(18), pen.px(204), height)
    for title, form, values, top in charts:
        pen.text(title, area.topleft, "topleft", MEDIUM)
        pen.text(f"{values[-1]:{form}}", area.topright, "topright", LARGE)
        plot = pen.pygame.Rect(area.x, area.y + pen.px(23), area.width, area.height - pen.px(53))
        _draw_course(pen, plot, values / top, scene.iterations)
        pen.text(f"{top:{form}}", (plot.left - pen.px(6), plot.top), "topright")
        area.top += area.height


def _draw_course(pen: Pen, plot: "pygame.Rect", shares: Floats, iterations: int) -> None:
    x = plot.left + np.arange(len(shares)) / iterations * plot.width
    course = np.stack([x, plot.bottom - shares * plot.height], axis=1)
    course = np.vstack(
        [course[:1], course]
    )  # two points at least, so that there is a line before the first iteration
    pen.draw.rect(pen.surface, MAP, plot)
    pen.draw.polygon(pen.surface, SHADE, [*course, (x[-1], plot.bottom), plot.bottomleft])
    pen.lines(FAINT_INK, np.array([[plot.topleft, plot.bottomleft, plot.bottomright]]), 1)
    pen.lines(INK, course[None], 1.5)
    pen.draw.circle(pen.surface, INK, course[-1], pen.px(3.5))
    pen.text("iteration", (plot.centerx, plot.bottom + pen.px(5)), "midtop")
    pen.text("0", (plot.left - pen.px(6), plot.bottom), "bottomright")
    pen.text(f"{iterations}", (plot.right, plot.bottom + pen.px(5)), "topright")
