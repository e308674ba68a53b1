"""Figures of the study of new members: first populations by their source, and corridors in which runs end."""

from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.figure import Figure

from experiments.plots import map_plot
from experiments.plots.stored import FigureMaker
from experiments.plots.style import BLUE, GREEN, ORANGE, PINK, RED, new_figure
from experiments.runs.run import Snapshot
from experiments.studies.newcomers.corridors import Ends, ends_of
from swarm_gym.env import SwarmEnv
from swarm_gym.worlds import make_problem

POPULATION_CASES = ("case1", "case2")
POPULATION_SIZE = 60
POPULATION_SEED = 0
AMPLITUDE = 0.3
# Options of the environment by the title of a column.
POPULATIONS: Mapping[str, Mapping[str, Any]] = {
    "uniform": {"source": "uniform"},
    "smooth (harmonics)": {"source": "smooth", "amplitude": AMPLITUDE},
    "smooth (stomp)": {"source": "smooth", "amplitude": AMPLITUDE, "bends": "stomp"},
}
# By place of the corridor's letter: colour, line and width.
CORRIDOR_STYLES = (
    (BLUE, "-", 2.2), (RED, "--", 1.5), (GREEN, "-.", 1.5), (ORANGE, (0, (6, 1, 1, 1)), 1.5),
    (PINK, ":", 1.8),
)  # fmt: skip


def first_population(scenario: str, options: Mapping[str, Any]) -> Snapshot:
    """Return the first population of an environment with the options of a source."""
    env = SwarmEnv(scenario=scenario, initial_population_size=POPULATION_SIZE, **options)
    env.reset(seed=POPULATION_SEED)
    simulation = env.simulation
    collisions = simulation.swarms.collision[0, :POPULATION_SIZE].copy()
    return Snapshot(0, simulation.problem_of(0).points(simulation.positions(0)), collisions)


def draw_first_populations() -> Figure:
    """Draw first populations: a row for each scenario, a column for each source."""
    figure = new_figure(11.0, 2.3 * len(POPULATION_CASES) + 0.9)
    panels = figure.subplots(len(POPULATION_CASES), len(POPULATIONS), squeeze=False)
    for row, name in zip(panels, POPULATION_CASES, strict=True):
        for axes, (title, options) in zip(row, POPULATIONS.items(), strict=True):
            snapshot = first_population(name, options)
            map_plot.draw_map(axes, make_problem(name).scenario)
            map_plot.draw_population(axes, snapshot)
            axes.set_title(f"{name}, {title}")
    figure.suptitle(
        f"First populations by the source of their members; bends have the amplitude {AMPLITUDE:g}"
    )
    figure.legend(handles=map_plot.population_legend(), loc="outside lower center", ncols=2)
    return figure


def draw_corridors(ends: Sequence[Ends]) -> Figure:
    """Draw the best path of each corridor with a letter, a panel for each scenario."""
    figure = new_figure(4.4 * len(ends), 3.7)
    for axes, found in zip(figure.subplots(1, len(ends), squeeze=False)[0], ends, strict=True):
        map_plot.draw_map(axes, make_problem(found.scenario).scenario)
        total = sum(map(len, found.names.values()))
        for corridor, (colour, line, width) in zip(found.corridors, CORRIDOR_STYLES, strict=False):
            gap, ended = corridor.fitness / found.optimum - 1.0, len(corridor.runs) / total
            best = f"best gap {100 * gap:.2f} %" if corridor.runs else "the optimum"
            text = f"{corridor.name}: {best}, {100 * ended:.0f} % of the runs"
            axes.plot(*corridor.path.T, color=colour, linestyle=line, linewidth=width, label=text, zorder=4)
        axes.set_title(found.scenario)
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.12))
    figure.suptitle("Corridors in which most runs end: the best path in each")
    return figure


FIGURES: dict[str, FigureMaker] = {
    "first-populations": lambda _: {"first-populations": draw_first_populations},
    "corridors": lambda stored: {
        "corridors": lambda: draw_corridors(
            [ends_of(name, stored.outcomes) for name in stored.suite.scenarios]
        )
    },
}
