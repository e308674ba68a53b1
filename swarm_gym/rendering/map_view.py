"""The view of maps, with members as paths."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from swarm_gym.rendering.pen import (
    BEST,
    COLLIDING,
    FEASIBLE,
    MAP,
    MARGIN,
    MEDIUM,
    OBSTACLE,
    PAPER,
    SHADE,
    START,
    TARGET,
    Colour,
    Pen,
)
from swarm_gym.rendering.scene import Scene
from swarm_gym.rendering.view import View
from swarm_gym.scenarios import (
    Circle,
    MapScenario,
    Obstacle,
    Point,
    Scenario,
    TerrainScenario,
    hill_shade,
)

Floats = NDArray[np.float64]
Draw = Callable[[Colour, Floats, float], None]


class MapView(View):
    """The map of a scenario, with start and target; flights over terrain are seen from above."""

    scenario: MapScenario | TerrainScenario

    def __init__(self, scenario: MapScenario | TerrainScenario, pen: Pen):
        super().__init__(scenario, pen, scenario.view, scenario.y_up)

    def draw_swarm(self, pen: Pen, scene: Scene) -> None:
        """Draw the colliding members, above them the feasible ones, and the best path on top."""
        pen.surface.set_clip(self.border)
        paths = self.pixels(scene.paths)
        draw_feasible, draw_colliding = _drawn_by(pen, scene)
        draw_colliding(COLLIDING, paths[~scene.feasible], 1)
        draw_feasible(FEASIBLE, paths[scene.feasible], 1)
        is_away = len(scene.trajectory) > 1
        if is_away:
            pen.lines(START, self.pixels(scene.trajectory[None]), 2.8)
        if np.isfinite(scene.best_fitness):
            pen.lines(BEST, self.pixels(scene.best_path[None]), 2.8)
        pen.surface.set_clip(None)
        robot = scene.trajectory[-1] if is_away else self.scenario.start[:2]
        self._draw_end(pen, "robot" if is_away else "start", robot, START, corners=48)
        self._draw_end(pen, "target", self.scenario.target, TARGET, corners=4)

    def draw_legend(self, pen: Pen, scene: Scene) -> None:
        """Draw a line or point of each kind below the map, and the number of members of that kind."""
        draw_feasible, draw_colliding = _drawn_by(pen, scene)
        x, y = pen.px(MARGIN), self.border.bottom + pen.px(38)
        for draw, colour, width, text in (
            (pen.lines, BEST, 2.8, f"best so far{'' if scene.best_feasible else ' (collides)'}"),
            (draw_feasible, FEASIBLE, 1, f"{scene.feasible.sum()} feasible"),
            (draw_colliding, COLLIDING, 1, f"{(~scene.feasible).sum()} colliding"),
        ):
            draw(colour, np.array([[(x, y), (x + pen.px(44), y)]]), width)
            x = pen.text(text, (x + pen.px(52), y), "midleft", MEDIUM).right + pen.px(24)

    def _draw_ground(self, pen: Pen) -> None:
        pen.draw.rect(pen.surface, MAP, self.border)
        if isinstance(self.scenario, Scenario):
            for obstacle in self.scenario.obstacles:
                self._draw_obstacle(pen, obstacle)
        elif isinstance(self.scenario, TerrainScenario):
            self._draw_terrain(pen, self.scenario)
        else:
            self._draw_cells(pen, self.scenario.map.blocked[self.scenario.window])

    def _draw_obstacle(self, pen: Pen, obstacle: Obstacle) -> None:
        if isinstance(obstacle, Circle):
            centre = self.pixels(np.array([obstacle.x, obstacle.y]))
            pen.draw.circle(pen.surface, OBSTACLE, centre, obstacle.radius * self._scale)
        else:
            pen.draw.polygon(pen.surface, OBSTACLE, self.pixels(np.array(obstacle.vertices)))

    def _draw_cells(self, pen: Pen, blocked: NDArray[np.bool_]) -> None:
        """Draw a grid map, row 0 on top, over the whole border."""
        pixels = np.where(blocked.T[..., None], OBSTACLE, MAP).astype(np.uint8)
        cells = pen.pygame.surfarray.make_surface(pixels)
        pen.surface.blit(pen.pygame.transform.scale(cells, self.border.size), self.border)

    def _draw_terrain(self, pen: Pen, scenario: TerrainScenario) -> None:
        """Draw the ground as hill shade, with y upwards, and the threats on it."""
        bright = hill_shade(scenario)[::-1].T[..., None]
        pixels = np.array(SHADE) + (np.array(MAP) - SHADE) * bright
        ground = pen.pygame.surfarray.make_surface(pixels.astype(np.uint8))
        pen.surface.blit(pen.pygame.transform.smoothscale(ground, self.border.size), self.border)
        for x, y, _, radius in scenario.threats.tolist():
            pen.draw.circle(pen.surface, OBSTACLE, self.pixels(np.array([x, y])), radius * self._scale)

    def _draw_end(self, pen: Pen, name: str, point: Point | Floats, colour: Colour, corners: int) -> None:
        """Draw a mark at a point of the map, and its name in a box next to it."""
        at = self.pixels(np.array(point))
        self._draw_mark(pen, at, colour, corners)
        side = 1 if at[1] + pen.px(40) < self.border.bottom else -1
        box = pen.pygame.Rect(0, 0, pen.px(52), pen.px(19))
        box.center = (at[0], at[1] + side * pen.px(23))
        box.clamp_ip(self.border.inflate(-pen.px(6), -pen.px(6)))
        pen.draw.rect(pen.surface, PAPER, box, border_radius=pen.px(4))
        pen.draw.rect(pen.surface, colour, box, pen.px(1), border_radius=pen.px(4))
        pen.text(name, box.center, "center", MEDIUM)


def _drawn_by(pen: Pen, scene: Scene) -> tuple[Draw, Draw]:
    """Return the functions that draw feasible and colliding members: lines and dashes, or dots and rings."""
    return (pen.dots, pen.rings) if scene.are_points else (pen.lines, pen.dashes)
