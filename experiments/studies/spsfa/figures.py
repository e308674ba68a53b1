"""Figures of the SPSFA paper: convergence, populations, best paths, and its parameter studies.

There are two figures for each parameter. They correspond to figures 20 to 25 of the SPSFA paper, which show
its studies of omega, eta and T_low. That paper has numbers of the running times by omega and eta only;
everything else is drawn from our runs alone.
"""

import dataclasses
from collections.abc import Callable
from functools import partial

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, StrMethodFormatter

from experiments.plots.courses import (
    CASE_DRAWINGS,
    COLLISION_CONTROLLERS,
    MOST_POINTS,
    CaseRuns,
    columns,
    draw_collision,
    draw_optimum,
    draw_snapshots,
    scale_fitness,
)
from experiments.plots.stored import Drawings, FigureMaker, Stored
from experiments.plots.style import BAND, BLACK, BLUE, GREEN, ORANGE, Style, legend_below, new_figure
from experiments.runs.run import Floats, Run
from experiments.statistics import ratio_interval
from experiments.studies.spsfa.suites import PARAMETER_STUDIES, SCENARIO, ParameterStudy

Runs = dict[float, list[Run]]  # by value of the parameter
MARKERS = "osD^v<>PX*"
# Columns of the traces that are drawn by iteration, and the statistic of the runs.
COURSES: dict[str, Callable[..., Floats]] = {
    "best_fitness": np.median,
    "population_size": np.mean,
    "repair_degree": np.mean,
    "evaluations": np.mean,
}
# The end of the colour map that is too light for a white page is left out.
LIGHTEST = 0.88


def draw_courses(study: ParameterStudy, case: CaseRuns) -> Figure:
    """Draw best fitness (median), population size, phi and evaluations (means) by iteration, by value."""
    case, runs = _of_study(study, case)
    figure = new_figure(10.0, 7.0)
    panels = figure.subplots(2, 2, sharex=True).ravel()
    for axes, (column, centre) in zip(panels, COURSES.items(), strict=True):
        for order, (value, group) in enumerate(runs.items()):
            course = centre(columns(group, column), axis=0)
            printed = value == study.printed
            # Marks begin at different places, a tenth of the axis apart, so that equal lines show.
            axes.plot(
                np.arange(len(course)), course, label=_text(study, value),
                markevery=(0.1 * order / len(runs), 0.1), linewidth=2.2 if printed else 1.3,
                zorder=3 if printed else 2, **case.styles[study.controller(value)].options(),
            )  # fmt: skip
        axes.set_xlim(0, len(course) - 1)
    best_fitness, sizes, repair, spent = panels
    draw_optimum(best_fitness, case)
    scale_fitness(best_fitness, case, "best fitness so far")
    sizes.set(ylabel="population size", ylim=(0.0, None))
    repair.set(ylabel="repair degree φ", ylim=(0.0, None), xlabel="iteration")
    spent.set(ylabel="fitness evaluations spent", ylim=(0.0, None), xlabel="iteration")
    spent.yaxis.set_major_formatter(StrMethodFormatter("{x:,.0f}"))
    figure.suptitle(
        f"SPSFA-TIP on {case.title}, by {study.symbol}: median of the best fitness, means of the others"
    )
    legend_below(figure)
    return figure


def draw_outcomes(study: ParameterStudy, case: CaseRuns) -> Figure:
    """Draw final fitness of every run, and the cost of a run relative to the published setting, by value.

    The cost has three lines: our evaluations with the 95 % interval of the ratio, our processor time, and the
    running time of the SPSFA paper where it has one.
    """
    case, runs = _of_study(study, case)
    figure = new_figure(10.0, 4.2)
    quality, cost = figure.subplots(1, 2)
    _draw_quality(quality, runs, case)
    _draw_cost(cost, study, runs)
    for axes in (quality, cost):
        axes.axvline(study.printed, color=BLACK, linestyle=":", linewidth=1.0)
        axes.set_xticks(list(runs), [f"{value:g}" for value in runs])
        axes.set_xlabel(f"{study.symbol} (dotted: the printed setting)")
    source = "" if study.seconds else "; the paper prints no numbers"
    figure.suptitle(
        f"SPSFA-TIP on {case.title}, by {study.symbol}: final fitness, and cost as ratio to {study.symbol} = "
        f"{study.printed:g}{source}"
    )
    legend_below(figure)
    return figure


PARAMETER_DRAWINGS: dict[str, Callable[[ParameterStudy, CaseRuns], Figure]] = {
    "courses": draw_courses,
    "outcomes": draw_outcomes,
}


def _draw_quality(axes: Axes, runs: Runs, case: CaseRuns) -> None:
    values = np.array(list(runs))
    samples = [_values(group, "final_fitness") for group in runs.values()]
    spread = 0.15 * np.diff(values).min()
    number = max(map(len, samples))
    text = "a run" if number <= MOST_POINTS else f"a run, {MOST_POINTS} of {number}"
    for value, sample in zip(values, samples, strict=True):
        points = sample[:MOST_POINTS]
        x = value + np.linspace(-spread, spread, len(points))
        axes.plot(x, points, "o", color=BLUE, markersize=2.5, alpha=0.5, label=text)
    medians = [np.median(sample) for sample in samples]
    axes.plot(values, medians, color=ORANGE, marker="s", label="median of the runs")
    means = [sample.mean() for sample in samples]
    axes.plot(values, means, color=GREEN, linestyle="--", marker="^", label="mean of the runs")
    draw_optimum(axes, case)
    scale_fitness(axes, case, "final fitness")


def _draw_cost(axes: Axes, study: ParameterStudy, runs: Runs) -> None:
    values, unit = list(runs), runs[study.printed]
    low, high = np.transpose(
        [
            ratio_interval(_values(group, "evaluations"), _values(unit, "evaluations"))
            for group in runs.values()
        ]
    )
    axes.fill_between(values, low, high, color=BLUE, alpha=2.0 * BAND, linewidth=0.0)
    axes.plot(values, _ratios(runs, unit, "evaluations"), color=BLUE, marker="o", label="our evaluations")
    axes.plot(values, _ratios(runs, unit, "seconds"), color=GREEN, linestyle="-.", marker="^",
              label="our processor time")  # fmt: skip
    printed = {value: study.seconds[value] for value in values if value in study.seconds}
    if printed:
        ratios = np.array(list(printed.values())) / study.seconds[study.printed]
        axes.plot(list(printed), ratios, color=BLACK, linestyle="--", marker="s", label="the paper's time")
    axes.set_yscale("log")
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.minorticks_off()
    least, most = axes.dataLim.intervaly
    axes.set_ylim(min(0.5, least / 1.2), max(2.0, most * 1.2))  # so that nearly constant values look constant
    axes.set_ylabel("ratio to the printed setting")


def _ratios(runs: Runs, unit: list[Run], name: str) -> Floats:
    return np.array([_values(group, name).mean() for group in runs.values()]) / _values(unit, name).mean()


def _values(runs: list[Run], name: str) -> Floats:
    """Return a number of every run, by the name of its attribute."""
    return np.array([getattr(run, name) for run in runs], dtype=np.float64)


def _of_study(study: ParameterStudy, case: CaseRuns) -> tuple[CaseRuns, Runs]:
    """Return the case and the runs of a study only, coloured dark to light; the published one is black."""
    compared = study.compared(case.runs)
    shades = [to_hex(shade) for shade in colormaps["viridis"](np.linspace(0.0, LIGHTEST, len(compared)))]
    looks = {}
    for (value, controller), shade, marker in zip(compared.items(), shades, MARKERS, strict=False):
        printed = value == study.printed
        looks[controller] = Style(BLACK if printed else shade, "--" if printed else "-", marker)
    runs = {controller: case.runs[controller] for controller in compared.values()}
    by_value = dict(zip(compared, runs.values(), strict=True))
    return dataclasses.replace(case, runs=runs, styles=looks), by_value


def _text(study: ParameterStudy, value: float) -> str:
    return f"{study.symbol} = {value:g}{' (printed)' if value == study.printed else ''}"


def collision_figures(stored: Stored) -> Drawings:
    """Return the figure of the population's degree of collision, if runs of its controllers are stored."""
    colliding = [case for case in stored.cases if not case.runs.keys().isdisjoint(COLLISION_CONTROLLERS)]
    return {"population-collision": partial(draw_collision, colliding)} if colliding else {}


def parameter_figures(stored: Stored) -> Drawings:
    """Return the figures of each parameter study that the suite has the controllers of."""
    return {
        f"parameter-{study.parameter.replace('_', '-')}-{kind}": partial(draw, study, case)
        for case in stored.cases
        if case.scenario.name == SCENARIO
        for study in PARAMETER_STUDIES
        if study.compared(case.runs)
        for kind, draw in PARAMETER_DRAWINGS.items()
    }


FIGURES: dict[str, FigureMaker] = {
    "snapshots": lambda stored: (
        {"population-snapshots": partial(draw_snapshots, stored.snapshots)} if stored.snapshots else {}
    ),
    "collision": collision_figures,
    "cases": lambda stored: {
        f"{kind}-{case.scenario.name}": partial(draw, case)
        for case in stored.cases
        for kind, draw in CASE_DRAWINGS.items()
    },
    "parameters": parameter_figures,
}
