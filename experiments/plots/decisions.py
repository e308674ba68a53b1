"""Figures of the decisions of controllers over a run, compared with the baseline."""

from collections.abc import Iterable, Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from experiments.plots.style import Style, draw_banded_line, legend_below, new_figure
from experiments.runs.database import Results
from experiments.runs.groups import group_controllers, scenario_sets
from experiments.runs.labels import label
from experiments.runs.run import Floats, Run
from experiments.runs.suite import Suite

# Decisions of an iteration, by name of the trace's column.
DECISIONS = {
    "population_size": "population size",
    "repair_degree": "repair degree φ",
    "noise": "noise α",
    "attractiveness": "attractiveness β₀",
    "smooth_share": "smooth share of new members",
    "amplitude": "amplitude of new members",
    "immigrants": "share of immigrants",
}
ALWAYS = ("population_size", "repair_degree")  # always drawn; others only if the controller varies them
CHANCE = "random"

Courses = dict[str, Floats]  # (runs, iterations + 1) by name of the decision


def deciding_groups(suite: Suite, results: Results) -> list[str]:
    """Return the keys of the groups whose decisions change during their first run.

    The baseline and the random controller are left out, and so is iteration 0, before the first decision.
    """
    scenario, seeds = next(iter(suite.seeds.items()))
    found = []
    for group, members in group_controllers(suite.controllers).items():
        runs = results.runs(members[0], scenario, 1, seeds.start)
        courses = _courses(runs).values()
        if group not in (suite.baseline, CHANCE) and any(np.ptp(course[:, 1:]) > 0.0 for course in courses):
            found.append(group)
    return found


def draw_decisions(suite: Suite, results: Results, group: str, among: Mapping[str, Style]) -> Figure:
    """Draw decisions of a group and of the baseline by iteration, over all runs of all training seeds.

    Each decision has a row, each set of scenarios a column. A parameter of the optimizer or a decision on new
    members has a row only if the group varies it.
    """
    sets = scenario_sets(suite.scenarios)
    shown = [key for key in (suite.baseline, group) if key in among]
    loaded = {
        key: {name: load_courses(suite, results, key, of) for name, of in sets.items()} for key in shown
    }
    rows = [name for name in DECISIONS if name in ALWAYS or _varies(name, loaded[group].values())]
    figure = new_figure(3.2 * len(sets) + 0.8, 2.1 * len(rows) + 1.0)
    panels = figure.subplots(len(rows), len(sets), sharex=True, sharey="row", squeeze=False)
    for row, name in zip(panels, rows, strict=True):
        for axes, scenario_set in zip(row, sets, strict=True):
            for key in shown:
                if name in loaded[key][scenario_set]:
                    _draw_course(axes, loaded[key][scenario_set][name], key, among)
        row[0].set_ylabel(DECISIONS[name])
        row[0].set_ylim(bottom=0.0)  # holds for all panels of the row, and needs all of them drawn
    for axes, scenario_set in zip(panels[0], sets, strict=True):
        axes.set_title(scenario_set)
    for axes in panels[-1]:
        axes.set_xlabel("iteration")
    figure.suptitle(f"Decisions of {label(group)}: median and quartiles of all runs")
    legend_below(figure)
    return figure


def _varies(name: str, courses_of_sets: Iterable[Courses]) -> bool:
    """Return whether this decision differs between iterations or between runs."""
    courses = [courses[name] for courses in courses_of_sets if name in courses]
    return bool(courses) and bool(np.ptp(np.concatenate(courses)) > 0.0)


def load_courses(suite: Suite, results: Results, group: str, scenarios: tuple[str, ...]) -> Courses:
    """Return the decisions of all runs of a group on some scenarios."""
    members = group_controllers(suite.controllers)[group]
    runs = [
        run
        for member in members
        for scenario in scenarios
        for run in results.runs(member, scenario, suite.num_seeds, suite.seeds[scenario].start)
    ]
    return _courses(runs)


def _courses(runs: list[Run]) -> Courses:
    """Return the decisions that all of the runs recorded."""
    names = [name for name in DECISIONS if runs and all(name in run.columns for run in runs)]
    return {name: np.array([run.course(name) for run in runs]) for name in names}


def _draw_course(axes: Axes, courses: Floats, key: str, among: Mapping[str, Style]) -> None:
    """Draw median and quartiles of courses, (runs, iterations + 1)."""
    low, median, high = np.quantile(courses, [0.25, 0.5, 0.75], axis=0)
    iterations = np.arange(len(median))
    draw_banded_line(axes, iterations, median, (low, high), key, among)
    axes.set_xlim(0, iterations[-1])
