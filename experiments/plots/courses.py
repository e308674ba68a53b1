"""The kinds of figures of the SPSFA paper, drawn from stored runs.

A course is a value by iteration. Courses are drawn as their mean or median over the seeds, with the
interquartile range as a band.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import takewhile

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cbook import boxplot_stats
from matplotlib.figure import Figure
from matplotlib.ticker import StrMethodFormatter
from numpy.typing import NDArray

from experiments.plots import map_plot
from experiments.plots.style import GREY, Style, draw_banded_line, legend_below, new_figure
from experiments.runs.labels import label
from experiments.runs.run import Floats, Run, RunKey, Snapshot
from swarm_gym.errors import ScenarioError
from swarm_gym.reference import shortest_path
from swarm_gym.scenarios import StaticScenario, make_scenario, world_at

COLLISION_CONTROLLERS = ("fixed:60", "spsfa", "spsfa-tip")
MOST_POINTS = 100  # drawn for each box; more would cover each other
# Fitness axes are logarithmic in the excess over a value that is smaller than the least by this share.
FITNESS_MARGIN = 0.01
# Lower end of fitness axes if the optimum is 0.
LEAST_FITNESS = 1e-12
# Iterations up to which an axis is linear, since the first iterations matter most.
LINEAR_ITERATIONS = 10
ITERATION_TICKS = (0, 5, 10, 20, 50, 100, 200, 500, 1000)
EVALUATIONS_RESOLUTION = 200
SNAPSHOT_COLUMNS = 3


@dataclass(frozen=True)
class CaseRuns:
    """A scenario with the runs on it.

    Attributes:
        scenario: map and task.
        optimum: least possible fitness; NaN if unknown.
        runs: runs by controller, in the suite's order; at least one run each.
        styles: styles by controller.
    """

    scenario: StaticScenario
    optimum: float
    runs: Mapping[str, list[Run]]
    styles: Mapping[str, Style]

    @property
    def title(self) -> str:
        """Return the name of the scenario and the number of runs of each controller."""
        counts = sorted({len(group) for group in self.runs.values()})
        span = str(counts[0]) if len(counts) == 1 else f"{counts[0]} to {counts[-1]}"
        return f"{self.scenario.name}, {span} runs each"


def draw_snapshots(snapshots: Mapping[RunKey, list[Snapshot]]) -> Figure:
    """Draw populations of runs on their maps, one block per run, one panel per iteration."""
    rows = [math.ceil(len(kept) / SNAPSHOT_COLUMNS) for kept in snapshots.values()]
    figure = new_figure(10.0, 2.1 * sum(rows) + 0.7 * len(rows))
    blocks = figure.subfigures(len(rows), height_ratios=rows, squeeze=False)[:, 0]
    for (key, kept), block, num_rows in zip(snapshots.items(), blocks, rows, strict=True):
        controller, scenario, seed = key
        grid = block.subplots(num_rows, SNAPSHOT_COLUMNS, sharex=True, sharey=True, squeeze=False)
        for axes, snapshot in zip(grid.flat, kept, strict=False):
            map_plot.draw_map(axes, world_at(make_scenario(scenario), snapshot.iteration))
            map_plot.draw_population(axes, snapshot)
        for axes in grid.flat[len(kept) :]:
            axes.set_axis_off()
        block.suptitle(f"Populations of {label(controller)} on {scenario}, seed {seed}")
        block.legend(handles=map_plot.population_legend(), loc="outside lower center", ncols=2)
    return figure


def draw_collision(cases: list[CaseRuns]) -> Figure:
    """Draw the mean population collision E(P) of the runs by iteration, and its first value."""
    figure = new_figure(3.4 * len(cases) + 0.4, 3.4)
    for axes, case in zip(figure.subplots(1, len(cases), squeeze=False)[0], cases, strict=True):
        for controller in COLLISION_CONTROLLERS:
            if controller in case.runs:
                courses = columns(case.runs[controller], "population_collision")
                _draw_iterations(axes, case, controller, courses, np.mean)
                colour = case.styles[controller].colour
                axes.axhline(courses[:, 0].mean(), color=colour, linestyle=":", linewidth=1.0)
        axes.set_xscale("symlog", linthresh=LINEAR_ITERATIONS)
        last = axes.get_xlim()[1]
        axes.set_xticks([k for k in ITERATION_TICKS if k <= last], minor=False)
        axes.set_xticks([], minor=True)
        axes.xaxis.set_major_formatter(StrMethodFormatter("{x:.0f}"))
        axes.set(title=case.title, ylim=(0.0, None))
        axes.set_xlabel(f"iteration (logarithmic from {LINEAR_ITERATIONS} on)")
    figure.axes[0].set_ylabel("population collision $E(P)$")
    figure.suptitle(r"Mean $E(P)$ and interquartile band; dotted: the first population's, $E_\mathrm{init}$")
    legend_below(figure)
    return figure


def draw_convergence(case: CaseRuns) -> Figure:
    """Draw the median best fitness of the runs, by iteration and by evaluations spent."""
    figure = new_figure(10.0, 4.4)
    by_iteration, by_evaluations = figure.subplots(1, 2, sharey=True)
    first = math.inf
    for controller, runs in case.runs.items():
        courses, spent = columns(runs, "best_fitness"), columns(runs, "evaluations")
        _draw_iterations(by_iteration, case, controller, courses, np.median)
        last = max(run.evaluations for run in runs)  # columns end in NaN where a budget was spent before
        grid = np.geomspace(spent[:, 0].max(), last, EVALUATIONS_RESOLUTION)
        reached = best_by_evaluations(courses, spent, grid)
        _draw_course(by_evaluations, case, controller, grid, reached, np.median)
        first = min(first, float(np.median(spent[:, 1])))
    for axes in (by_iteration, by_evaluations):
        draw_optimum(axes, case)
    scale_fitness(by_iteration, case, "best fitness so far")
    by_evaluations.set(xscale="log", xlabel="fitness evaluations spent")
    by_evaluations.set_xlim(left=first / 2.0)  # nothing is known before the first iteration
    figure.suptitle(f"Convergence on {case.title}: median and interquartile band")
    legend_below(figure)
    return figure


def draw_population_size(case: CaseRuns) -> Figure:
    """Draw the mean population size by iteration, and phi of the controllers that repair."""
    repair_degrees = {
        controller: degrees
        for controller, runs in case.runs.items()
        if (degrees := columns(runs, "repair_degree")).any()
    }
    num_panels = 2 if repair_degrees else 1
    figure = new_figure(7.2, 5.6 if repair_degrees else 3.8)
    ratios = [2, 1][:num_panels]
    panels = figure.subplots(num_panels, sharex=True, squeeze=False, height_ratios=ratios)[:, 0]
    for controller, runs in case.runs.items():
        _draw_iterations(panels[0], case, controller, columns(runs, "population_size"), np.mean)
    panels[0].set(ylabel="population size", ylim=(0.0, None))
    for controller, degrees in repair_degrees.items():
        _draw_iterations(panels[1], case, controller, degrees, np.mean)
    if repair_degrees:
        panels[1].set(ylabel="repair degree φ", ylim=(0.0, None))
    panels[0].label_outer()
    figure.suptitle(f"Population size on {case.title}: mean and interquartile band")
    legend_below(figure)
    return figure


def draw_best_paths(case: CaseRuns) -> Figure:
    """Draw the path of each controller's best run, and the shortest path."""
    height = 8.4 * map_plot.proportions(case.scenario)
    figure = new_figure(9.0, min(max(height, 3.0), 9.0) + 1.5)
    axes = figure.subplots()
    map_plot.draw_map(axes, case.scenario)
    try:
        length, points = shortest_path(case.scenario)
        map_plot.draw_shortest_path(axes, points, f"exact shortest path, length {length:.1f}")
    except ScenarioError:  # obstacles separate start and target, or the scenario has no map
        pass
    for order, (controller, runs) in enumerate(case.runs.items()):
        best = min(runs, key=lambda run: run.final_fitness)
        text = f"{label(controller)}: {_number(best.final_fitness)} ({best.final_collision:.2f})"
        map_plot.draw_best_path(axes, best, case.styles[controller], text, order)
    map_plot.label_axes(axes, case.scenario)
    figure.suptitle(f"Best path on {case.title}: fitness (degree of collision)")
    legend_below(figure)
    return figure


def draw_best_path_maps(cases: list[CaseRuns]) -> Figure:
    """Draw the best path of each controller, and the shortest path where one is known, one panel per map."""
    columns_of_panels = min(len(cases), 3)
    rows = math.ceil(len(cases) / columns_of_panels)
    figure = new_figure(3.4 * columns_of_panels, 3.5 * rows + 0.6)
    panels = figure.subplots(rows, columns_of_panels, squeeze=False).flat
    for axes, case in zip(panels, cases, strict=False):
        map_plot.draw_map(axes, case.scenario)
        title = case.scenario.name
        try:
            length, points = shortest_path(case.scenario)
            map_plot.draw_shortest_path(axes, points, "exact shortest path")
            title += f", shortest {length:.1f}"
        except ScenarioError:  # obstacles separate start and target, or the scenario has no map
            pass
        for order, (controller, runs) in enumerate(case.runs.items()):
            best = min(runs, key=lambda run: run.final_fitness)
            map_plot.draw_best_path(axes, best, case.styles[controller], label(controller), order)
        axes.set(title=title, xticks=[], yticks=[])
    for axes in list(panels):
        axes.set_axis_off()
    figure.suptitle("Best path of all runs of each method")
    legend_below(figure)
    return figure


def draw_box_plots(case: CaseRuns) -> Figure:
    """Draw final fitness and evaluations of the runs, by controller."""
    figure = new_figure(10.0, 4.2)
    fitness, evaluations = figure.subplots(1, 2)
    groups = case.runs.values()
    _draw_boxes(fitness, case, [np.array([run.final_fitness for run in g]) for g in groups])
    _draw_boxes(evaluations, case, [np.array([run.evaluations for run in g]) for g in groups])
    draw_optimum(fitness, case)
    scale_fitness(fitness, case, "final fitness")
    evaluations.set(ylim=(0.0, None), ylabel="fitness evaluations")
    evaluations.yaxis.set_major_formatter(StrMethodFormatter("{x:,.0f}"))
    number = max(map(len, groups))
    shown = "every run" if number <= MOST_POINTS else f"{MOST_POINTS} of {number} runs"
    figure.suptitle(f"Final fitness and cost on {case.title}: quartiles, and {shown}")
    legend_below(figure)
    return figure


CASE_DRAWINGS: dict[str, Callable[[CaseRuns], Figure]] = {
    "convergence": draw_convergence,
    "population-size": draw_population_size,
    "best-paths": draw_best_paths,
    "box-plots": draw_box_plots,
}


def columns(runs: list[Run], name: str) -> Floats:
    """Return one column of the traces, (runs, iterations + 1), by its name in `HISTORY`."""
    return np.array([run.course(name) for run in runs])


def best_by_evaluations(fitness: Floats, evaluations: Floats, grid: Floats) -> Floats:
    """Return the best fitness that each run had reached after given numbers of evaluations.

    Args:
        fitness: (runs, iterations + 1) best fitness so far.
        evaluations: (runs, iterations + 1) evaluations so far, increasing.
        grid: (m,) numbers of evaluations, none below the first number of any run.

    Returns:
        Values of shape (runs, m); a run that has ended keeps its last value.
    """
    last = [np.searchsorted(spent, grid, side="right") - 1 for spent in evaluations]
    return np.array([best[index] for best, index in zip(fitness, last, strict=True)])


def _draw_iterations(
    axes: Axes, case: CaseRuns, controller: str, courses: Floats, centre: Callable[..., Floats]
) -> None:
    """Draw courses of a controller, (runs, iterations + 1), over all iterations."""
    iterations = np.arange(courses.shape[1])
    _draw_course(axes, case, controller, iterations, courses, centre)
    axes.set_xlim(0, iterations[-1])
    axes.set_xlabel("iteration")


def _draw_course(
    axes: Axes,
    case: CaseRuns,
    controller: str,
    x: NDArray,
    courses: Floats,
    centre: Callable[..., Floats],
) -> None:
    """Draw the centre of courses, (runs, m), at positions x, (m,), and their interquartile band."""
    low, high = np.quantile(courses, [0.25, 0.75], axis=0)
    draw_banded_line(axes, x, centre(courses, axis=0), (low, high), controller, case.styles)


def _draw_boxes(axes: Axes, case: CaseRuns, samples: list[Floats]) -> None:
    """Draw a box for each controller: quartiles, whiskers within 1.5 times their range, and first values."""
    # `Axes.boxplot` reads all settings, also that of the backend, and would so import pyplot.
    boxes = zip(case.runs, samples, boxplot_stats(samples), strict=True)
    for place, (controller, values, box) in enumerate(boxes, start=1):
        style = case.styles[controller]
        low, high = box["q1"], box["q3"]
        face, ink = (style.colour, 0.35), "0.3"
        axes.bar(place, high - low, 0.55, low, color=face, edgecolor=ink, linewidth=0.8)
        axes.vlines([place] * 2, [box["whislo"], high], [low, box["whishi"]], colors=ink, linewidth=0.8)
        axes.hlines(box["med"], place - 0.275, place + 0.275, colors="black", linewidth=1.6)
        points = values[:MOST_POINTS]
        x = place + np.linspace(-0.2, 0.2, len(points))
        axes.plot(x, points, style.marker, color=style.colour, markersize=3, alpha=0.8, zorder=3)
    names = [label(controller) for controller in case.runs]
    axes.set_xticks(range(1, len(names) + 1), names, rotation=30, rotation_mode="anchor", ha="right")
    axes.grid(axis="x", visible=False)


def draw_optimum(axes: Axes, case: CaseRuns) -> None:
    """Draw the optimum across the axes if it is known; 0 is not drawn, since axes are logarithmic."""
    if case.optimum and not math.isnan(case.optimum):
        text = f"known optimum, {_number(case.optimum)}"
        axes.axhline(case.optimum, color=GREY, linestyle=(0, (8, 4)), linewidth=1.0, label=text)


def scale_fitness(axes: Axes, case: CaseRuns, name: str) -> None:
    """Make the vertical axis logarithmic in the excess over a value a little below the least fitness.

    If the optimum is 0, the axis is logarithmic in the fitness itself. The data must have been drawn before.
    """
    low, high = axes.dataLim.intervaly
    if case.optimum == 0.0:
        low, high = max(axes.dataLim.minposy, LEAST_FITNESS), max(high, LEAST_FITNESS)
        axes.set(yscale="log", ylim=(low / 2.0, 2.0 * high), ylabel=name)
        return
    least = np.nanmin([low, case.optimum])
    margin = FITNESS_MARGIN * least
    floor = least - margin

    def stretch(values: Floats) -> Floats:
        return np.log(np.maximum(values - floor, 1e-9 * margin))

    axes.set_yscale("function", functions=(stretch, lambda logs: floor + np.exp(logs)))
    axes.set_ylim(floor + 0.7 * margin, high + 0.1 * (high - floor))
    doubled = takewhile(lambda gap: gap < high - floor, (margin * 2**k for k in range(64)))
    axes.set_yticks(sorted({_rounded(floor + gap, gap / 2.0) for gap in doubled}))
    axes.set_ylabel(f"{name} (logarithmic above {floor:.0f})")


def _number(fitness: float) -> str:
    """Return a fitness with two places, or with two digits if it is small."""
    return f"{fitness:.2f}" if abs(fitness) >= 0.1 else f"{fitness:.2g}"


def _rounded(value: float, tolerance: float) -> float:
    """Return a value rounded to multiples of 1, 2 or 5 times a power of ten, at most the tolerance apart."""
    power = 10.0 ** math.floor(math.log10(tolerance))
    step = max(factor * power for factor in (1, 2, 5) if factor * power <= tolerance)
    return round(value / step) * step
