"""Figures of the MOA paper: best paths on the maps of its tasks, and convergence on each of them."""

from functools import partial

from experiments.plots.courses import draw_best_path_maps, draw_convergence
from experiments.plots.stored import Drawings, FigureMaker, Stored


def map_figures(stored: Stored) -> Drawings:
    """Return the figure of all maps with best paths, and one of convergence for each scenario."""
    return {
        "best-path-maps": partial(draw_best_path_maps, stored.cases),
        **{f"convergence-{case.scenario.name}": partial(draw_convergence, case) for case in stored.cases},
    }


FIGURES: dict[str, FigureMaker] = {"maps": map_figures}
