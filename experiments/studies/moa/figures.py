"""Figures of the MOA paper: best paths on the maps of its tasks, and convergence on each of them."""

from functools import partial

from experiments.plots.courses import draw_best_path_maps, draw_convergence
from experiments.plots.stored import FigureMaker

FIGURES: dict[str, FigureMaker] = {
    "maps": lambda stored: {
        "best-path-maps": partial(draw_best_path_maps, stored.cases),
        **{f"convergence-{case.scenario.name}": partial(draw_convergence, case) for case in stored.cases},
    }
}
