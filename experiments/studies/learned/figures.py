"""Figures of the study of learned controllers: performance profiles, fronts and decisions."""

from functools import partial

from experiments.plots.decisions import deciding_groups, draw_decisions
from experiments.plots.gaps import draw_front, draw_profiles
from experiments.plots.stored import Drawings, FigureMaker, Stored
from experiments.plots.style import styles
from experiments.runs.groups import group_controllers
from experiments.tables.block_contents import decisions_name


def decision_figures(stored: Stored) -> Drawings:
    """Return a figure of the decisions of each group of controllers that decides anything."""
    among = styles(group_controllers(stored.suite.controllers))
    return {
        decisions_name(group): partial(draw_decisions, stored.suite, stored.results, group, among)
        for group in deciding_groups(stored.suite, stored.results)
    }


FIGURES: dict[str, FigureMaker] = {
    "profiles": lambda stored: {"profiles": partial(draw_profiles, stored.outcomes)},
    "front": lambda stored: {"front": partial(draw_front, stored.suite, stored.outcomes)},
    "decisions": decision_figures,
}
