"""Figures of the IAFSA paper: convergence on many functions or routes at once, and paths on their maps."""

import dataclasses
import math
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator
from numpy.typing import NDArray

from experiments.plots import map_plot
from experiments.plots.courses import CaseRuns, best_by_evaluations, columns
from experiments.plots.stored import FigureMaker
from experiments.plots.style import GREY, draw_banded_line, legend_below, new_figure, styles
from experiments.runs.labels import label
from experiments.runs.run import Floats, Run
from experiments.studies.iafsa.published import Function
from experiments.studies.iafsa.routes import A_STAR, make_route
from swarm_gym.scenarios import GridMap

# Points of a course: few, so that a figure with many panels stays small, and close together at its beginning.
MOST_POINTS = 18
PATH_POINTS = 32
# Below this, values of functions are rounding errors of their formulas.
LEAST_VALUE = 1e-16
SHOWN_GAPS = (0.03, 300.0)  # per cent
PANEL_COLUMNS = 4
MOST_TICKS = 3
WALL = "#7d838b"

By = Callable[[list[Run]], tuple[NDArray, Floats]]


def by_iterations(runs: list[Run]) -> tuple[NDArray, Floats]:
    """Return iterations (m,), and the best fitness (runs, m) after these."""
    best = columns(runs, "best_fitness")
    last = best.shape[1] - 1
    at = np.unique(np.round(last * np.linspace(0.0, 1.0, MOST_POINTS) ** 2).astype(np.int64))
    return at, best[:, at]


def by_evaluations(runs: list[Run]) -> tuple[NDArray, Floats]:
    """Return numbers of evaluations (m,), and the best fitness (runs, m) after these."""
    best, spent = columns(runs, "best_fitness"), columns(runs, "evaluations")
    at = np.geomspace(spent[:, 0].max(), max(run.evaluations for run in runs), MOST_POINTS)
    return at, best_by_evaluations(best, spent, at)


# By name of the axis that courses are drawn over: the function that makes them, the label and the scale.
AXES: dict[str, tuple[By, str, str]] = {
    "iterations": (by_iterations, "iterations", "linear"),
    "evaluations": (by_evaluations, "fitness evaluations spent", "log"),
}


def draw_function_convergence(cases: Sequence[CaseRuns], axis: str) -> Figure:
    """Draw the best value so far on each function in the longest episodes, over iterations or evaluations."""
    return _draw_convergence(
        cases,
        axis,
        "Best value so far above the optimum",
        titles=[Function.of(case.scenario.name).label for case in cases],
        scale=lambda best, _: np.maximum(best, LEAST_VALUE),
    )


def draw_route_convergence(cases: Sequence[CaseRuns]) -> Figure:
    """Draw by how much the best path is longer than the shortest path, over evaluations."""
    routes = [make_route(case.scenario.name, {}) for case in cases]
    figure = _draw_convergence(
        cases,
        "evaluations",
        "Best path so far above the shortest path in %",
        titles=[route.label for route in routes],
        scale=lambda best, k: 100.0 * (best / routes[k].shortest[0] - 1.0),
    )
    for axes in figure.axes:
        # Penalties are far above the limits of the axes, so that only feasible paths show.
        axes.set_ylim(*SHOWN_GAPS)
        axes.yaxis.set_major_locator(LogLocator())
        axes.label_outer()
    return figure


def draw_route_maps(cases: Sequence[CaseRuns]) -> Figure:
    """Draw the best path of each optimizer on each route, that of A* and the shortest path at any angle."""
    figure, panels = _panels(cases, 2.7)
    for axes, case in zip(panels, cases, strict=True):
        route = make_route(case.scenario.name, {})
        map_plot.draw_map(axes, case.scenario)
        _draw_walls(axes, route.raw)
        length, points = route.shortest
        map_plot.draw_shortest_path(axes, points, "shortest path at any angle")
        axes.plot(*route.cell_paths[A_STAR].T, color=GREY, linewidth=1.0, label=A_STAR, zorder=3)
        among = styles(case.runs)
        for order, (controller, runs) in enumerate(case.runs.items()):
            best = min(runs, key=lambda run: run.final_fitness)
            map_plot.draw_best_path(axes, _thinned(best), among[controller], label(controller), order)
        axes.set(title=f"{route.label}, shortest {length:.2f} m", xticks=[], yticks=[])
    figure.suptitle("Best path of all runs; obstacles, and around them what the robot's centre keeps out of")
    legend_below(figure)
    return figure


def _draw_convergence(
    cases: Sequence[CaseRuns],
    axis: str,
    quantity: str,
    titles: Sequence[str],
    scale: Callable[[Floats, int], Floats],
) -> Figure:
    """Draw courses of the best fitness, scaled by a function of them and the number of the panel."""
    course_of, name, x_scale = AXES[axis]
    figure, panels = _panels(cases, 2.2)
    for axes in panels[1:]:
        axes.sharex(panels[0])
    for k, (axes, case) in enumerate(zip(panels, cases, strict=True)):
        shown = _longest(case)
        among = styles(shown)
        for controller, runs in shown.items():
            x, best = course_of(runs)
            low, middle, high = np.quantile(scale(best, k), [0.25, 0.5, 0.75], axis=0)
            draw_banded_line(axes, x, middle, (low, high), controller, among)
        axes.set(title=titles[k], yscale="log", xscale=x_scale)
        axes.yaxis.set_major_locator(LogLocator(numticks=MOST_TICKS))
        if x_scale == "linear":
            axes.xaxis.set_major_locator(MaxNLocator(MOST_TICKS))
        axes.minorticks_off()
    figure.suptitle(f"{quantity}, by {name}: median and interquartile band")
    legend_below(figure)
    return figure


def _longest(case: CaseRuns) -> dict[str, list[Run]]:
    """Return the runs of the controllers whose episodes are the longest ones."""
    lengths = {controller: len(runs[0].trace) for controller, runs in case.runs.items()}
    return {c: runs for c, runs in case.runs.items() if lengths[c] == max(lengths.values())}


def _panels(cases: Sequence[CaseRuns], height: float) -> tuple[Figure, list[Axes]]:
    """Return a figure with a panel for each case, and the panels."""
    across = min(len(cases), PANEL_COLUMNS)
    rows = math.ceil(len(cases) / across)
    figure = new_figure(2.9 * across, height * rows + 0.8)
    return figure, [figure.add_subplot(rows, across, k + 1) for k in range(len(cases))]


def _thinned(run: Run) -> Run:
    """Return the run with fewer points on its path."""
    at = np.linspace(0, len(run.best_path) - 1, min(PATH_POINTS, len(run.best_path))).astype(np.int64)
    return dataclasses.replace(run, best_path=run.best_path[at])


def _draw_walls(axes: Axes, raw: GridMap) -> None:
    """Draw the obstacles themselves, on the map that is inflated."""
    x_min, y_min, x_max, y_max = raw.extent
    axes.autoscale(False)
    walls = np.ma.masked_where(~raw.blocked, np.ones(raw.blocked.shape))
    axes.imshow(
        walls,
        extent=(x_min, x_max, y_min, y_max),
        cmap=ListedColormap([WALL]),
        interpolation="none",
        zorder=1.5,
    )


FIGURES: dict[str, FigureMaker] = {
    "functions": lambda stored: {
        f"functions-by-{axis}": partial(draw_function_convergence, stored.cases, axis) for axis in AXES
    },
    "routes": lambda stored: {
        "route-maps": partial(draw_route_maps, stored.cases),
        "route-convergence": partial(draw_route_convergence, stored.cases),
    },
}
