"""The view of test functions, with members as dots in the plane of the first two components."""

import numpy as np
from numpy.typing import NDArray

from swarm_gym.kinds import problem_of_any_function
from swarm_gym.rendering.pen import BEST, FEASIBLE, MAP, MARGIN, MEDIUM, PAPER, TARGET, Colour, Pen
from swarm_gym.rendering.scene import Scene
from swarm_gym.rendering.view import View
from swarm_gym.scenarios import FunctionScenario

Floats = NDArray[np.float64]

# Number of values along the longer side; the picture interpolates between them.
RESOLUTION = 256
# Values below this fraction of the largest one can hardly be told apart.
LEAST_SHARE = 0.02
# Height of the picture of a function of one component, as a fraction of its width.
STRIP = 0.2
# Colour of the largest value; dots and marks stand out from it.
WORST: Colour = (164, 170, 180)


class FunctionView(View):
    """The values of a function in the plane of its first two components, the others at the optimum.

    A function of one component is shown as a strip. Darker colours are larger values, on a logarithmic scale.
    """

    scenario: FunctionScenario

    def __init__(self, scenario: FunctionScenario, pen: Pen):
        low, high = scenario.domain
        share = 1.0 if scenario.dimension > 1 else STRIP
        super().__init__(scenario, pen, (low, share * low, high, share * high))

    def draw_swarm(self, pen: Pen, scene: Scene) -> None:
        """Draw the optimum, then the members, and the best on top."""
        pen.surface.set_clip(self.border)
        self._draw_optimum(pen, self._place(np.array(self.scenario.optimum)))
        for member in scene.paths:
            self._draw_member(pen, self._place(member[:, 1]))
        if np.isfinite(scene.best_fitness):
            self._draw_best(pen, self._place(scene.best_path[:, 1]))
        pen.surface.set_clip(None)

    def draw_legend(self, pen: Pen, scene: Scene) -> None:
        """Draw a mark of each kind below the picture, and the number of members."""
        at = np.array([pen.px(MARGIN) + pen.px(6), self.border.bottom + pen.px(38)])
        for draw, text in (
            (self._draw_best, "best so far"),
            (self._draw_member, f"{len(scene.paths)} members"),
            (self._draw_optimum, "optimum"),
        ):
            draw(pen, at)
            at[0] = pen.text(text, (at[0] + pen.px(12), at[1]), "midleft", MEDIUM).right + pen.px(30)

    def _draw_ground(self, pen: Pen) -> None:
        low, high = self.scenario.domain
        x = np.linspace(low, high, RESOLUTION)
        y = x[::-1] if self.scenario.dimension > 1 else x[:1]
        values = problem_of_any_function(self.scenario).values_in_plane(x, y)
        shares = np.log1p(values / (LEAST_SHARE * values.max())) / np.log1p(1.0 / LEAST_SHARE)
        shades = np.array(MAP) + shares.T[..., None] * np.subtract(WORST, MAP)
        picture = pen.pygame.surfarray.make_surface(shades.round().astype(np.uint8))
        pen.surface.blit(pen.pygame.transform.smoothscale(picture, self.border.size), self.border)

    def _height_limits(self) -> tuple[str, str]:
        return super()._height_limits() if self.scenario.dimension > 1 else ("", "")

    def _place(self, vector: Floats) -> Floats:
        """Return the position of a decision vector in the picture; a missing second component counts as 0."""
        return self.pixels(np.append(vector[:2], 0.0)[:2])

    def _draw_optimum(self, pen: Pen, at: Floats) -> None:
        self._draw_mark(pen, at, TARGET, corners=4)

    def _draw_member(self, pen: Pen, at: Floats) -> None:
        _draw_dot(pen, at, FEASIBLE, 2.5)

    def _draw_best(self, pen: Pen, at: Floats) -> None:
        _draw_dot(pen, at, BEST, 4.0)  # small, so that the optimum can be seen below it


def _draw_dot(pen: Pen, at: Floats, colour: Colour, radius: float) -> None:
    pen.draw.circle(pen.surface, PAPER, at, pen.px(radius + 1.0))
    pen.draw.circle(pen.surface, colour, at, pen.px(radius))
