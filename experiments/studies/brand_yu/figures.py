"""Figures of the paper of Brand and Yu: fireflies on their map, trajectories, and growing grids."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from experiments.plots import map_plot
from experiments.plots.courses import CaseRuns
from experiments.plots.stored import FigureMaker
from experiments.plots.style import BLUE, GREY, RED, draw_banded_line, legend_below, new_figure, styles
from experiments.runs.run import Run, RunKey, Snapshot, arrives, trajectory_of, turning_of
from swarm_gym.controllers.names import ControllerName
from swarm_gym.problem.geometry.polylines import length_of
from swarm_gym.reference import shortest_path

PANEL_COLUMNS = 3


def draw_trajectories(case: CaseRuns, snapshots: Mapping[RunKey, list[Snapshot]]) -> Figure:
    """Draw fireflies, the robot's trajectory and the shortest path: one run with each number of fireflies."""
    rows = -(-len(case.runs) // PANEL_COLUMNS)
    figure = new_figure(3.2 * PANEL_COLUMNS, 3.5 * rows + 0.5)
    optimum, points = shortest_path(case.scenario)
    for k, (controller, runs) in enumerate(case.runs.items()):
        axes, run = figure.add_subplot(rows, PANEL_COLUMNS, k + 1), runs[0]
        map_plot.draw_map(axes, case.scenario)
        map_plot.draw_shortest_path(axes, points, f"shortest path, {optimum:.1f}")
        for snapshot in snapshots.get((run.controller, run.scenario, run.seed), []):
            _draw_fireflies(axes, snapshot)
        trajectory = trajectory_of(run)
        axes.plot(*trajectory.T, color=BLUE, linewidth=1.3, label="way of the robot", zorder=4)
        count = ControllerName.parse(controller).parameters
        length, turning = length_of(trajectory), turning_of(trajectory)
        axes.set(title=f"{count} fireflies: length {length:.1f}, turns {turning:.0f}°")
        axes.set(xticks=[], yticks=[])
    figure.suptitle(f"Fireflies on {case.scenario.name}, one run each")
    legend_below(figure)
    return figure


def draw_grids(cases: Sequence[CaseRuns]) -> Figure:
    """Draw length of the trajectory and processor time against the side of the grid: mean and range."""
    figure = new_figure(8.4, 3.8)
    sides = np.array([case.scenario.map.width for case in cases])  # type: ignore[union-attr]
    among = styles(cases[0].runs)
    measures: dict[str, Callable[[Run], float]] = {
        "length": lambda run: length_of(trajectory_of(run)),
        "processor time of a run, s": lambda run: run.seconds,
    }
    for axes, (name, value) in zip(figure.subplots(1, 2), measures.items(), strict=True):
        for controller in among:
            values = [np.array([value(run) for run in _arrived(case, controller)]) for case in cases]
            middle, low, high = (np.array([of(v) for v in values]) for of in (np.mean, np.min, np.max))
            draw_banded_line(axes, sides, middle, (low, high), controller, among)
        axes.set(xscale="log", yscale="log", xlabel="side of the grid, cells", ylabel=name)
        axes.set_xticks(sides, [str(side) for side in sides])
        axes.minorticks_off()
    optima = [shortest_path(case.scenario)[0] for case in cases]
    figure.axes[0].plot(sides, optima, color=GREY, linewidth=1.0, linestyle=":", label="shortest path")
    figure.suptitle("Length and time by the size of the grid: mean and range of the runs that arrived")
    legend_below(figure)
    return figure


def _draw_fireflies(axes: Axes, snapshot: Snapshot) -> None:
    begin = snapshot.iteration == 0
    axes.plot(
        *snapshot.paths[:, 0].T,
        "." if begin else "o",
        color=GREY if begin else RED,
        markersize=3.5,
        markerfacecolor="none" if not begin else GREY,
        linestyle="none",
        label="at first" if begin else f"after iteration {snapshot.iteration}",
        zorder=3,
    )


def _arrived(case: CaseRuns, controller: str) -> list[Run]:
    return [run for run in case.runs[controller] if arrives(run, case.scenario.target)]  # type: ignore[union-attr]


FIGURES: dict[str, FigureMaker] = {
    "brand-yu-ways": lambda stored: {
        f"ways-{case.scenario.name}": partial(draw_trajectories, case, stored.snapshots)
        for case in stored.cases
    },
    "brand-yu-grids": lambda stored: {"grids": partial(draw_grids, stored.cases)},
}
