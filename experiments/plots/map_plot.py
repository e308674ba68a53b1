"""Maps in figures: obstacles, start and target, populations, best paths; or vectors of test functions."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.colors import ListedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Circle as CirclePatch
from matplotlib.patches import Patch
from matplotlib.patches import Polygon as PolygonPatch
from matplotlib.ticker import MaxNLocator

from experiments.plots.style import BLUE, RED, Style
from experiments.runs.run import Floats, Run, Snapshot
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE
from swarm_gym.scenarios import (
    Circle,
    FunctionScenario,
    GridMap,
    Obstacle,
    Scenario,
    StaticScenario,
    TerrainScenario,
    hill_shade,
)

OBSTACLE, OUTLINE = "#d9dce0", "#7d838b"
INK = "#222222"
# Where both overlap, feasible members look like a halo around colliding ones.
FEASIBLE: dict[str, Any] = {"color": BLUE, "linestyle": "-", "linewidth": 1.6, "alpha": 0.6}
COLLIDING: dict[str, Any] = {"color": RED, "linestyle": (0, (6, 3)), "linewidth": 0.5, "alpha": 0.6}
# Number of waypoints per marker; paths of different controllers begin at different waypoints.
MARKER_EVERY = 7


def draw_map(axes: Axes, scenario: StaticScenario) -> None:
    """Draw the workspace with its obstacles, start (S) and target (T), in map coordinates.

    Vectors of a test function are paths in parallel coordinates; of a test function, draw the optimum.
    """
    axes.grid(False)
    axes.spines[:].set_visible(True)
    if isinstance(scenario, FunctionScenario):
        _draw_components(axes, scenario)
        return
    x_min, y_min, x_max, y_max = scenario.view
    if isinstance(scenario, Scenario):
        draw_obstacles(axes, scenario.obstacles)
    elif isinstance(scenario, TerrainScenario):
        extent = (x_min, x_max, y_min, y_max)
        axes.imshow(hill_shade(scenario), cmap="gray", vmin=-2.0, vmax=1.1, origin="lower", extent=extent)
        draw_obstacles(axes, [Circle(x, y, radius) for x, y, _, radius in scenario.threats.tolist()])
    else:
        _draw_cells(axes, scenario.map)
    heights = (y_min, y_max) if scenario.y_up else (y_max, y_min)
    axes.set(xlim=(x_min, x_max), ylim=heights, aspect="equal")
    for letter, marker, point in (("S", "o", scenario.start[:2]), ("T", "*", scenario.target)):
        size = 6 if marker == "o" else 10
        axes.plot(
            *point, marker, color=INK, markersize=size, markeredgecolor="white",
            markeredgewidth=0.7, clip_on=False, zorder=6,
        )  # fmt: skip
        axes.annotate(
            letter, point, (0, 7), textcoords="offset points", ha="center", va="bottom",
            fontsize=8.5, fontweight="bold", color=INK, zorder=6,
            bbox={"boxstyle": "round,pad=0.1", "facecolor": "white", "edgecolor": "none", "alpha": 0.8},
        )  # fmt: skip


def proportions(scenario: StaticScenario) -> float:
    """Return the height of what `draw_map` draws, relative to its width."""
    if isinstance(scenario, FunctionScenario):
        return 0.5
    x_min, y_min, x_max, y_max = scenario.view
    return (y_max - y_min) / (x_max - x_min)


def label_axes(axes: Axes, scenario: StaticScenario) -> None:
    """Label the axes of `draw_map`."""
    names = ("component", "value") if isinstance(scenario, FunctionScenario) else ("x", "y")
    axes.set(xlabel=names[0], ylabel=names[1])


def draw_population(axes: Axes, snapshot: Snapshot) -> None:
    """Draw feasible members as solid lines, colliding ones dashed above them; the title has their numbers."""
    feasible = snapshot.collisions <= FEASIBILITY_TOLERANCE
    for members, style, zorder in ((feasible, FEASIBLE, 2), (~feasible, COLLIDING, 3)):
        paths = list(snapshot.paths[members])
        axes.add_collection(LineCollection(paths, zorder=zorder, **style))
    axes.set_title(f"iteration {snapshot.iteration}: {len(feasible)} members, {feasible.sum()} feasible")


def population_legend() -> list[Line2D]:
    """Return legend handles for the lines of `draw_population`."""
    return [
        Line2D([], [], label="feasible", **FEASIBLE),
        Line2D([], [], label="colliding", **COLLIDING),
    ]


def draw_best_path(axes: Axes, run: Run, style: Style, label: str, order: int) -> None:
    """Draw the best path of a run; `order` is the position of the controller among those of the figure."""
    every = MARKER_EVERY * max(1, (len(run.best_path) - 2) // 31)
    marked: Any = (every * (2 + order % MARKER_EVERY) // MARKER_EVERY, every)
    if len(run.best_path) <= 2 * MARKER_EVERY:
        marked = 1
    axes.plot(*run.best_path.T, label=label, markevery=marked, linewidth=1.3, zorder=4, **style.options())


def draw_shortest_path(axes: Axes, points: Floats, label: str) -> None:
    """Draw a path, (k, 2), as a broad pale line below the others."""
    axes.plot(*points.T, color="#f0e442", linewidth=5, label=label, zorder=2)


def draw_obstacles(axes: Axes, obstacles: Sequence[Obstacle], colour: str = OBSTACLE) -> None:
    """Draw circles and polygons, filled with a colour."""
    patches = [_patch(obstacle) for obstacle in obstacles]
    # Outlines are above the paths, so that many paths do not hide the obstacles.
    for face, edge, zorder in ((colour, "none", 1), ("none", OUTLINE, 3.5)):
        shapes = PatchCollection(patches, facecolor=face, edgecolor=edge, linewidth=0.6, zorder=zorder)
        axes.add_collection(shapes)


def _draw_components(axes: Axes, scenario: FunctionScenario) -> None:
    """Draw the optimum of a test function in parallel coordinates."""
    numbers = np.arange(1, scenario.dimension + 1)
    style: dict[str, Any] = {"color": INK, "linewidth": 0.7, "markersize": 8, "zorder": 3.5}
    axes.plot(numbers, scenario.optimum, "*-", label="optimum", **style)
    axes.set(xlim=(0.5, scenario.dimension + 0.5), ylim=scenario.domain)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))


def _draw_cells(axes: Axes, grid: GridMap) -> None:
    """Draw the blocked cells of a grid map."""
    x_min, y_min, x_max, y_max = grid.extent
    extent = (x_min, x_max, y_min, y_max) if grid.y_up else (x_min, x_max, y_max, y_min)
    colours = ListedColormap(["white", OBSTACLE])
    axes.imshow(grid.blocked, extent=extent, cmap=colours, vmin=0, vmax=1, interpolation="none", zorder=1)


def _patch(obstacle: Obstacle) -> Patch:
    if isinstance(obstacle, Circle):
        return CirclePatch((obstacle.x, obstacle.y), obstacle.radius)
    return PolygonPatch(np.array(obstacle.vertices), closed=True)
