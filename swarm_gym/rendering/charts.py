"""What is beside the map: the headline, and the courses of collision, size and repair."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from swarm_gym.rendering.pen import FAINT_INK, INK, LARGE, MAP, MARGIN, MEDIUM, SHADE, Pen
from swarm_gym.rendering.scene import Scene
from swarm_gym.simulation import HISTORY

if TYPE_CHECKING:
    import pygame

Floats = NDArray[np.float64]

# Of a scenario, in letters, large and smaller ones; there is no room for more.
LONGEST_LARGE_NAME, LONGEST_NAME = 20, 32


def draw_headline(pen: Pen, scene: Scene) -> None:
    """Write the name of the scenario and how far the episode is."""
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


def draw_charts(pen: Pen, scene: Scene) -> None:
    """Draw population collision, size and repair degree by iteration."""
    collision, size, repair = (scene.courses[name] for name in HISTORY[:3])
    charts = (
        ("collision E(P)", ".4g", collision, collision.max() or 1.0),
        ("population size", ".0f", size, scene.max_population_size),
        ("repair degree φ", ".2f", repair, 1.0),
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
    course = np.vstack([course[:1], course])  # a line even before the first iteration
    pen.draw.rect(pen.surface, MAP, plot)
    pen.draw.polygon(pen.surface, SHADE, [*course, (x[-1], plot.bottom), plot.bottomleft])
    pen.lines(FAINT_INK, np.array([[plot.topleft, plot.bottomleft, plot.bottomright]]), 1)
    pen.lines(INK, course[None], 1.5)
    pen.draw.circle(pen.surface, INK, course[-1], pen.px(3.5))
    pen.text("iteration", (plot.centerx, plot.bottom + pen.px(5)), "midtop")
    pen.text("0", (plot.left - pen.px(6), plot.bottom), "bottomright")
    pen.text(f"{iterations}", (plot.right, plot.bottom + pen.px(5)), "topright")
