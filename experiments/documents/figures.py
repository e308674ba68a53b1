"""Figures of a suite, from stored runs, as SVG and PNG: what is drawn, and under which name."""

import re
from collections.abc import Callable
from functools import cached_property, partial
from pathlib import Path

from matplotlib.figure import Figure
from tqdm import tqdm

from experiments.plots.courses import (
    CASE_DRAWINGS,
    COLLISION_CONTROLLERS,
    Case,
    draw_best_path_maps,
    draw_collision,
    draw_convergence,
    draw_snapshots,
)
from experiments.plots.decisions import deciding_groups, draw_decisions
from experiments.plots.gaps import draw_front, draw_profiles
from experiments.plots.style import FORMATS, render, settings, styles
from experiments.runs.database import Results
from experiments.runs.groups import group_controllers
from experiments.runs.outcomes import Outcomes
from experiments.runs.run import RunKey, Snapshot
from experiments.runs.suite import Suite
from experiments.studies.brand_yu.figures import draw_grids, draw_ways
from experiments.studies.dynamic.figures import draw_recovery
from experiments.studies.iafsa.figures import (
    AXES,
    draw_function_convergence,
    draw_route_convergence,
    draw_route_maps,
)
from experiments.studies.spsfa.parameter_figures import PARAMETER_DRAWINGS
from experiments.studies.spsfa.parameters import SCENARIO, STUDIES
from swarm_gym.checks import look_up
from swarm_gym.files import write_atomically
from swarm_gym.reference import known_optimum
from swarm_gym.settings import make_problem

# The numbers that figures have in the SPSFA paper; those of other scenarios have none.
NUMBERS = {
    "population-snapshots": 3,
    "population-collision": 4,
    "convergence-case1": 8,
    "population-size-case1": 9,
    "best-paths-case1": 10,
    "box-plots-case1": 11,
    "convergence-case2": 12,
    "population-size-case2": 13,
    "best-paths-case2": 14,
    "box-plots-case2": 15,
    "convergence-case3": 16,
    "population-size-case3": 17,
    "best-paths-case3": 18,
    "box-plots-case3": 19,
}


def write_figures(suite: Suite, results: Results, folder: Path) -> list[Path]:
    """Write all figures of a suite into a folder, which is made if missing; returns the files.

    Controllers without runs are left out, and so is a figure that would be empty. The same runs give the
    same bytes.
    """
    drawings = plan(suite, results)
    written = []
    with settings():
        for name, draw in tqdm(drawings.items(), desc="figures", unit="figure"):
            figure = draw()
            for form in FORMATS:
                path = folder / f"{_stem(name)}.{form}"
                written.append(write_atomically(path, render(figure, form)))
    return written


class Stored:
    """What a suite's figures are drawn from, each part loaded once it is needed."""

    def __init__(self, suite: Suite, results: Results):
        self.suite = suite
        self.results = results

    @cached_property
    def cases(self) -> list[Case]:
        """The scenarios with all that is stored of their runs."""
        return load_cases(self.suite, self.results)

    @cached_property
    def outcomes(self) -> Outcomes:
        """The numbers of all runs, none of which may be missing."""
        return self.results.outcomes(self.suite.controllers, self.suite.seeds)


Drawings = dict[str, Callable[[], Figure]]  # by name of the figure


def plan(suite: Suite, results: Results) -> Drawings:
    """What can be drawn from the runs of a suite: functions without arguments, by name of the figure.

    Raises:
        UnknownNameError: if the suite names figures that are not there.
    """
    makers = [look_up("figure", name, FIGURES) for name in suite.figures]
    stored = Stored(suite, results)
    return {name: draw for make in makers for name, draw in make(stored).items()}


def _snapshots(stored: Stored) -> Drawings:
    snapshots = load_snapshots(stored.suite, stored.results)
    return {"population-snapshots": partial(draw_snapshots, snapshots)} if snapshots else {}


def _collision(stored: Stored) -> Drawings:
    colliding = [case for case in stored.cases if not case.runs.keys().isdisjoint(COLLISION_CONTROLLERS)]
    return {"population-collision": partial(draw_collision, colliding)} if colliding else {}


def _cases(stored: Stored) -> Drawings:
    return {
        f"{kind}-{case.scenario.name}": partial(draw, case)
        for case in stored.cases
        for kind, draw in CASE_DRAWINGS.items()
    }


def _maps(stored: Stored) -> Drawings:
    return {
        "best-path-maps": partial(draw_best_path_maps, stored.cases),
        **{f"convergence-{case.scenario.name}": partial(draw_convergence, case) for case in stored.cases},
    }


def _functions(stored: Stored) -> Drawings:
    return {f"functions-by-{axis}": partial(draw_function_convergence, stored.cases, axis) for axis in AXES}


def _routes(stored: Stored) -> Drawings:
    return {
        "route-maps": partial(draw_route_maps, stored.cases),
        "route-convergence": partial(draw_route_convergence, stored.cases),
    }


def _ways(stored: Stored) -> Drawings:
    snapshots = load_snapshots(stored.suite, stored.results)
    return {f"ways-{case.scenario.name}": partial(draw_ways, case, snapshots) for case in stored.cases}


def _grids(stored: Stored) -> Drawings:
    return {"grids": partial(draw_grids, stored.cases)}


def _recovery(stored: Stored) -> Drawings:
    return {"recovery": partial(draw_recovery, stored.suite, stored.outcomes)}


def _profiles(stored: Stored) -> Drawings:
    return {"profiles": partial(draw_profiles, stored.outcomes)}


def _front(stored: Stored) -> Drawings:
    return {"front": partial(draw_front, stored.suite, stored.outcomes)}


def _decisions(stored: Stored) -> Drawings:
    among = styles(group_controllers(stored.suite.controllers))
    return {
        decisions_name(group): partial(draw_decisions, stored.suite, stored.results, group, among)
        for group in deciding_groups(stored.suite, stored.results)
    }


def _parameters(stored: Stored) -> Drawings:
    return {
        f"parameter-{study.parameter.replace('_', '-')}-{kind}": partial(draw, study, case)
        for case in stored.cases
        if case.scenario.name == SCENARIO
        for study in STUDIES
        if study.compared(case.runs)
        for kind, draw in PARAMETER_DRAWINGS.items()
    }


# To add a kind: a function of what is stored, a line here, and its name in the suites that have it.
FIGURES: dict[str, Callable[[Stored], Drawings]] = {
    "snapshots": _snapshots,
    "collision": _collision,
    "cases": _cases,
    "maps": _maps,
    "functions": _functions,
    "routes": _routes,
    "brand-yu-ways": _ways,
    "brand-yu-grids": _grids,
    "recovery": _recovery,
    "profiles": _profiles,
    "front": _front,
    "decisions": _decisions,
    "parameters": _parameters,
}


def load_cases(suite: Suite, results: Results) -> list[Case]:
    """The scenarios of a suite that have runs, with these."""
    cases = []
    for name in suite.scenarios:
        runs = {
            controller: found
            for controller in suite.controllers
            if (found := results.runs(controller, name, suite.num_seeds, suite.seeds[name].start))
        }
        if runs:
            problem = make_problem(name, **suite.options)
            cases.append(Case(problem.scenario, known_optimum(problem), runs, styles(suite.controllers)))
    return cases


def load_snapshots(suite: Suite, results: Results) -> dict[RunKey, list[Snapshot]]:
    """The populations that a suite asks for and has, by run."""
    found = {}
    for controller, scenario, seed, iterations in suite.snapshots:
        if controller in suite.controllers and scenario in suite.scenarios:
            stored = results.snapshots(controller, scenario, seed)
            kept = [snapshot for snapshot in stored if snapshot.iteration in iterations]
            if kept:
                found[controller, scenario, seed] = kept
    return found


def _stem(name: str) -> str:
    name = name.replace(":", "-")  # which is no part of a file name everywhere
    return f"figure-{NUMBERS[name]:02}-{name}" if name in NUMBERS else f"figure-{name}"


def decisions_name(group: str) -> str:
    """Name of the figure of a group's decisions, by the key of the group."""
    return f"decisions-{re.sub(r'[^a-z0-9]+', '-', group.lower().replace('/*', '-seeds')).strip('-')}"
