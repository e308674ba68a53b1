"""Figures of the study of every optimizer under control: fronts by optimizer, decisions of policies."""

from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from experiments.plots.decisions import load_courses
from experiments.plots.stored import FigureMaker, Stored
from experiments.plots.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PINK,
    RED,
    SKY,
    legend_below,
    new_figure,
)
from experiments.runs.outcomes import Outcomes
from experiments.runs.suite import ControllerFamily, Suite
from experiments.studies.optimizers.tables import seeds_of
from swarm_gym.controllers.names import ControllerName

COLOURS = (BLUE, ORANGE, GREEN, PINK, SKY, RED, GREY, BLACK)
# Marker and words of each kind of controller.
KINDS = {
    "fixed": ("o", "fixed size"),
    "spsfa-tip": ("v", "rules as printed"),
    "tuned": ("D", "rules tuned"),
    "open-loop": ("s", "blind schedule"),
    "learned": ("*", "PPO"),
}
COSTS = {"evaluations": "evaluations, mean", "seconds": "seconds of a run, mean"}
ROWS = {"population_size": "population size", "repair_degree": "repair degree φ"}


def draw_fronts(suite: Suite, outcomes: Outcomes) -> Figure:
    """Draw mean gap against mean evaluations, and below against mean seconds.

    There is a column for each set of scenarios, and a line through the fixed sizes of each optimizer.
    """
    figure = new_figure(3.7 * len(outcomes.sets) + 0.8, 7.6)
    panels = figure.subplots(len(COSTS), len(outcomes.sets), sharey="row", squeeze=False)
    for row, (cost, words) in zip(panels, COSTS.items(), strict=True):
        for axes, scenario_set in zip(row, outcomes.sets, strict=True):
            for family, colour in zip(suite.families, COLOURS, strict=False):
                _draw_family(axes, outcomes, family, scenario_set, colour, cost)
            axes.set(title=scenario_set, xlabel=words, xscale="log", yscale="log")
            axes.xaxis.set_minor_formatter(NullFormatter())  # they overlap
        row[0].set_ylabel("gap in per cent of the optimum, mean")
    for marker, words in KINDS.values():
        panels[0, 0].plot([], [], marker, color=BLACK, label=words)
    figure.suptitle("Quality against cost, by optimizer and controller")
    legend_below(figure)
    return figure


def _draw_family(
    axes: Axes, outcomes: Outcomes, family: ControllerFamily, scenario_set: str, colour: str, cost: str
) -> None:
    """Draw the points of one optimizer, and a line through its fixed sizes."""
    sizes = []
    present = [group for group in family.groups if group in outcomes.groups]
    for group in present:
        sample, kind = outcomes.sample(group, scenario_set), ControllerName.parse(group).family
        point = float(getattr(sample, cost).mean()), 100.0 * float(sample.gap.mean())
        if kind == "fixed":
            sizes.append(point)
        marker, _ = KINDS[kind]
        axes.plot(*point, marker, color=colour, markersize=10 if marker == "*" else 5, zorder=3)
    if sizes:
        axes.plot(*np.transpose(sorted(sizes)), color=colour, linewidth=1.0, label=family.name)


def draw_policies(stored: Stored) -> Figure:
    """Draw size and phi by iteration, a column for each optimizer: median and quartiles of all runs."""
    suite = stored.suite
    families = [family for family in suite.families if seeds_of(family, stored.outcomes, "learned")]
    figure = new_figure(2.1 * len(families) + 0.8, 4.6)
    panels = figure.subplots(len(ROWS), len(families), sharex=True, sharey="row", squeeze=False)
    for column, family in zip(panels.T, families, strict=True):
        column[0].set_title(family.name)
        for kind, colour in (("open-loop", ORANGE), ("learned", BLUE)):
            group = seeds_of(family, stored.outcomes, kind)
            if group is None:
                continue
            courses = load_courses(suite, stored.results, group, suite.scenarios)
            for axes, name in zip(column, ROWS, strict=True):
                low, median, high = np.quantile(courses[name][:, 1:], [0.25, 0.5, 0.75], axis=0)
                iterations = np.arange(1, len(median) + 1)
                axes.plot(iterations, median, color=colour, label=KINDS[kind][1])
                axes.fill_between(iterations, low, high, color=colour, alpha=0.15, linewidth=0.0)
        column[-1].set_xlabel("iteration")
    for row, words in zip(panels, ROWS.values(), strict=True):
        row[0].set_ylabel(words)
        row[0].set_ylim(bottom=0.0)
    figure.suptitle("Decisions on size and φ: median and quartiles of all runs")
    legend_below(figure)
    return figure


FIGURES: dict[str, FigureMaker] = {
    "fronts": lambda stored: {"fronts": partial(draw_fronts, stored.suite, stored.outcomes)},
    "policies": lambda stored: {"policies": partial(draw_policies, stored)},
}
