"""Figures of the optimality gap: performance profiles, and quality against cost."""

import math
from collections.abc import Callable
from itertools import cycle

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullLocator, PercentFormatter

from experiments.plots.style import GREY, draw_banded_line, legend_below, new_figure, styles
from experiments.runs.labels import label
from experiments.runs.outcomes import Floats, Outcomes
from experiments.runs.suite import Suite
from experiments.statistics import interval, means, non_dominated, performance_profile

NUM_THRESHOLDS = 161
LEAST_GAP = 1e-4  # lower end of logarithmic axes
MOST_COLUMNS = 3
LEAST_WIDTH = 6.8  # inches that the titles need
LEAST_LABELS = 3
# Multiples of powers of ten that may label a logarithmic axis: the first that give enough labels are taken.
MULTIPLES = ((1,), (1, 3), (1, 2, 5), (1, 1.5, 2, 3, 5, 7), (1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8))
# Controllers are told apart by markers, and families by lines.
FAMILY_LINES = ("-", "--", "-.", ":", (0, (6, 1, 1, 1, 1, 1)), (0, (1, 3)))


def draw_profiles(outcomes: Outcomes) -> Figure:
    """Draw the share of runs within a gap against the gap, one panel per set of scenarios."""
    figure, panels = _panels(outcomes)
    among = styles(outcomes.groups)
    for axes, scenario_set in zip(panels, outcomes.sets, strict=True):
        samples = {group: outcomes.sample(group, scenario_set) for group in outcomes.groups}
        thresholds = _thresholds(np.concatenate([sample.gap.ravel() for sample in samples.values()]))
        for group, sample in samples.items():
            profile = performance_profile(sample.gap, thresholds, sample.draws())
            draw_banded_line(
                axes, profile.thresholds, profile.shares, (profile.low, profile.high), group, among
            )
        axes.set(title=scenario_set, xlim=(thresholds[0], thresholds[-1]), ylim=(0.0, 1.02))
        axes.set_xscale("log")
        _label_logarithmic(axes.xaxis, _percent)
        axes.yaxis.set_major_formatter(PercentFormatter(1.0, symbol=" %"))
        axes.set(xlabel="optimality gap", ylabel="runs within the gap")
    figure.suptitle("Performance profiles with pointwise 95 % bands")
    legend_below(figure)
    return figure


def draw_front(suite: Suite, outcomes: Outcomes) -> Figure:
    """Draw mean gap against mean evaluations, one panel per set; lines connect families, steps the front."""
    figure, panels = _panels(outcomes)
    for axes, scenario_set in zip(panels, outcomes.sets, strict=True):
        points = _draw_points(axes, outcomes, scenario_set)
        for family, line in zip(suite.families, cycle(FAMILY_LINES), strict=False):
            members = sorted(points[group] for group in family.groups if group in points)
            if len(members) > 1:
                axes.plot(
                    *zip(*members, strict=True), color=GREY, linestyle=line, linewidth=1.0,
                    label=family.name, zorder=1,
                )  # fmt: skip
        _draw_steps(axes, np.array(list(points.values())))
        axes.set(title=scenario_set, xlabel="fitness evaluations, mean", ylabel="optimality gap, mean")
        axes.set(xscale="log", yscale="log")
        _label_logarithmic(axes.xaxis, lambda value, _: f"{value / 1000:g}k")
        _label_logarithmic(axes.yaxis, _percent)
    figure.suptitle("Quality against cost: means with 95 % intervals; both are better when smaller")
    legend_below(figure)
    return figure


def _thresholds(gaps: Floats) -> Floats:
    """Return thresholds from the least to the greatest gap, evenly spaced in the logarithm."""
    low = max(gaps.min(), LEAST_GAP)
    return np.geomspace(low, max(gaps.max(), 2.0 * low), NUM_THRESHOLDS)


def _panels(outcomes: Outcomes) -> tuple[Figure, list[Axes]]:
    """Return a figure with a panel for each set."""
    number = len(outcomes.sets)
    num_rows = math.ceil(number / MOST_COLUMNS)
    num_columns = math.ceil(number / num_rows)
    figure = new_figure(max(3.6 * num_columns + 0.8, LEAST_WIDTH), 3.3 * num_rows + 1.0)
    panels = list(figure.subplots(num_rows, num_columns, squeeze=False).flat)
    for axes in panels[number:]:
        axes.set_axis_off()
    return figure, panels[:number]


def _draw_points(axes: Axes, outcomes: Outcomes, scenario_set: str) -> dict[str, tuple[float, float]]:
    """Draw mean evaluations and gap of every group with their intervals; return the points by group."""
    points = {}
    for group, style in styles(outcomes.groups).items():
        sample = outcomes.sample(group, scenario_set)
        draws = sample.draws()
        x, y = sample.evaluations.mean(), sample.gap.mean()
        left, right = interval(means(sample.evaluations, draws))
        low, high = interval(means(sample.gap, draws))
        axes.hlines(y, left, right, colors=style.colour, linewidth=0.9)
        axes.vlines(x, low, high, colors=style.colour, linewidth=0.9)
        axes.plot(x, y, style.marker, color=style.colour, markersize=6, label=label(group), zorder=3)
        points[group] = (x, y)
    return points


def _draw_steps(axes: Axes, points: Floats) -> None:
    """Draw the border of the region that the points, (n, 2), dominate, within the range of the points."""
    front = points[non_dominated(points)]
    ahead, behind = (front[:, 0].min(), points[:, 1].max()), (points[:, 0].max(), front[:, 1].min())
    x, y = np.array([ahead, *front[np.argsort(front[:, 0])], behind]).T
    axes.step(x, y, where="post", color="0.75", linewidth=3.0, alpha=0.6, label="not dominated", zorder=0.5)


def _label_logarithmic(axis: Axis, form: Callable[[float, int], str]) -> None:
    """Label an axis at few round numbers; its limits must be set, or its data drawn, before."""
    low, high = axis.get_view_interval()
    axis.set_major_locator(FixedLocator(logarithmic_ticks(low, high)))
    axis.set_minor_locator(NullLocator())
    axis.set_major_formatter(FuncFormatter(form))


def logarithmic_ticks(low: float, high: float) -> list[float]:
    """Return at least three round numbers between two positive ones, evenly spaced in the logarithm."""
    powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    for multiples in MULTIPLES:
        ticks = [multiple * 10.0**power for power in powers for multiple in multiples]
        inside = [tick for tick in ticks if low <= tick <= high]
        if len(inside) >= LEAST_LABELS:
            return inside
    return [
        tick for tick in MaxNLocator(5, steps=[1, 2, 5, 10]).tick_values(low, high) if low <= tick <= high
    ]


def _percent(value: float, _: int) -> str:
    return f"{100 * value:g} %"
