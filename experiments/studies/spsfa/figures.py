"""Figures of the SPSFA paper: convergence, populations, best paths, and its parameter studies."""

from functools import partial

from experiments.plots.courses import CASE_DRAWINGS, COLLISION_CONTROLLERS, draw_collision, draw_snapshots
from experiments.plots.stored import Drawings, FigureMaker, Stored
from experiments.studies.spsfa.parameter_figures import PARAMETER_DRAWINGS
from experiments.studies.spsfa.parameters import PARAMETER_STUDIES, SCENARIO


def snapshot_figures(stored: Stored) -> Drawings:
    """Return the figure of populations at some iterations, if there are stored ones."""
    return {"population-snapshots": partial(draw_snapshots, stored.snapshots)} if stored.snapshots else {}


def collision_figures(stored: Stored) -> Drawings:
    """Return the figure of the population's degree of collision, if runs of its controllers are stored."""
    colliding = [case for case in stored.cases if not case.runs.keys().isdisjoint(COLLISION_CONTROLLERS)]
    return {"population-collision": partial(draw_collision, colliding)} if colliding else {}


def case_figures(stored: Stored) -> Drawings:
    """Return the figures of each scenario."""
    return {
        f"{kind}-{case.scenario.name}": partial(draw, case)
        for case in stored.cases
        for kind, draw in CASE_DRAWINGS.items()
    }


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
    "snapshots": snapshot_figures,
    "collision": collision_figures,
    "cases": case_figures,
    "parameters": parameter_figures,
}
