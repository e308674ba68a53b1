"""Figures of maps that change: the obstacles that appear, and runs before and after that by iteration."""

from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from experiments.plots import map_plot
from experiments.plots.courses import columns
from experiments.plots.gaps import logarithmic_ticks
from experiments.plots.stored import FigureMaker
from experiments.plots.style import BLUE, GREY, RED, draw_banded_line, legend_below, new_figure, styles
from experiments.runs.outcomes import Outcomes
from experiments.runs.suite import Suite
from experiments.studies.controllers import CASES
from swarm_gym.reference import known_optimum, shortest_path
from swarm_gym.scenarios import Scenario, make_scenario, worlds_of
from swarm_gym.settings import Settings
from swarm_gym.worlds import problems_for, worlds_for

# Groups that the figure shows, as far as they were run.
SHOWN = (
    "spsfa-tip", "tuned:random-fields", "open-loop:random-fields-sourced/*@1", "restart",
    "reacting-loop:dynamic-reacting/*@1", "learned:dynamic/*",
)  # fmt: skip
EVENTS = {"gate": "closes the corridor of most runs", "block": "stands in the shortest way"}


def draw_events() -> Figure:
    """Draw each case with the obstacle that appears, a row for each kind of event, and the shortest ways."""
    figure = new_figure(11.0, 5.6)
    panels = figure.subplots(len(EVENTS), len(CASES), squeeze=False)
    for row, (event, effect) in zip(panels, EVENTS.items(), strict=True):
        for axes, case in zip(row, CASES, strict=True):
            _draw_event(axes, f"dynamic:{case}-{event}@1")
            axes.set_title(f"{case}-{event}: {effect}")
    figure.suptitle("Obstacles that appear (red), and the shortest ways before and after")
    legend_below(figure)
    return figure


def _draw_event(axes: Axes, name: str) -> None:
    (_, before), (_, after) = worlds_of(make_scenario(name))
    assert isinstance(before, Scenario)
    assert isinstance(after, Scenario)
    map_plot.draw_map(axes, before)
    new = [obstacle for obstacle in after.obstacles if obstacle not in before.obstacles]
    map_plot.draw_obstacles(axes, new, RED)
    for scenario, style, text in ((before, "--", "before"), (after, "-", "after")):
        way = shortest_path(scenario)[1]
        axes.plot(*way.T, color=BLUE, linestyle=style, linewidth=1.4, label=f"shortest way {text}", zorder=4)


def draw_recovery(suite: Suite, outcomes: Outcomes) -> Figure:
    """Draw best fitness on the map in force and the optimum of that map, by iteration.

    Each set of scenarios in which an obstacle closes a corridor has a panel. Its events are at the middle one
    of the set's times.
    """
    scenarios = [
        strata[0][len(strata[0]) // 2] for name, strata in outcomes.sets.items() if name.endswith("-gate")
    ]
    figure = new_figure(3.5 * len(scenarios) + 0.6, 4.6)
    panels = figure.subplots(1, len(scenarios), squeeze=False)[0]
    groups = {group: outcomes.groups[group] for group in SHOWN if group in outcomes.groups}
    among = styles(groups)
    for axes, scenario in zip(panels, scenarios, strict=True):
        for group, controllers in groups.items():
            runs = [run for controller in controllers for run in outcomes.runs(controller, scenario)]
            courses = columns(runs, "best_fitness")
            low, middle, high = np.quantile(courses, [0.25, 0.5, 0.75], axis=0)
            draw_banded_line(axes, np.arange(courses.shape[1]), middle, (low, high), group, among)
        _draw_optima(axes, Settings(scenario=scenario, **suite.options), courses.shape[1] - 1)
        axes.set(title=scenario, xlabel="iteration", yscale="log")
        ticks = logarithmic_ticks(*axes.get_ylim())
        axes.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
        axes.minorticks_off()
    panels[0].set_ylabel("best fitness on the map in force")
    figure.suptitle("An obstacle closes the corridor: median of the runs and interquartile band")
    legend_below(figure)
    return figure


def _draw_optima(axes: Axes, settings: Settings, last: int) -> None:
    """Draw the least fitness of each of the maps, and when they change."""
    begins = [world.iteration for world in worlds_for(settings)]
    optima = [known_optimum(problem) for problem in problems_for(settings)]
    axes.step(
        [*begins, last], [*optima, optima[-1]], where="post", color="black", linewidth=1.0, label="optimum"
    )
    for begin in begins[1:]:
        axes.axvline(begin, color=GREY, linestyle=":", linewidth=1.0, label="the obstacle appears")


FIGURES: dict[str, FigureMaker] = {
    "events": lambda _: {"events": draw_events},
    "recovery": lambda stored: {"recovery": partial(draw_recovery, stored.suite, stored.outcomes)},
}
