"""Figures of a suite, from stored runs, as SVG and PNG: what is drawn, and under which name."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

from matplotlib.figure import Figure
from tqdm import tqdm

from experiments.drawings import (
    CASE_DRAWINGS,
    COLLISION_CONTROLLERS,
    Case,
    draw_collision,
    draw_snapshots,
)
from experiments.figure_style import FORMATS, render, settings, styles
from experiments.parameter_drawings import plan_parameter_figures
from experiments.results import Results, RunKey, Snapshot
from experiments.suites import Suite
from swarm_gym.files import write_atomically
from swarm_gym.problem import Problem
from swarm_gym.reference import known_optimum
from swarm_gym.scenarios import make_scenario

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


def plan(suite: Suite, results: Results) -> dict[str, Callable[[], Figure]]:
    """What can be drawn from the runs of a suite: functions without arguments, by name of the figure."""
    if suite.name == "parameters":
        return plan_parameter_figures(suite, results)
    cases, snapshots = load_cases(suite, results), load_snapshots(suite, results)
    drawings: dict[str, Callable[[], Figure]] = {}
    if snapshots:
        drawings["population-snapshots"] = partial(draw_snapshots, snapshots)
    colliding = [case for case in cases if not case.runs.keys().isdisjoint(COLLISION_CONTROLLERS)]
    if colliding:
        drawings["population-collision"] = partial(draw_collision, colliding)
    for case in cases:
        for kind, draw in CASE_DRAWINGS.items():
            drawings[f"{kind}-{case.scenario.name}"] = partial(draw, case)
    return drawings


def load_cases(suite: Suite, results: Results) -> list[Case]:
    """The scenarios of a suite that have runs, with these."""
    cases = []
    for name in suite.scenarios:
        runs = {
            controller: found
            for controller in suite.controllers
            if (found := results.runs(controller, name, suite.num_seeds))
        }
        if runs:
            scenario = make_scenario(name)
            optimum = known_optimum(Problem(scenario))
            cases.append(Case(scenario, optimum, runs, styles(suite.controllers)))
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
    return f"figure-{NUMBERS[name]:02}-{name}" if name in NUMBERS else f"figure-{name}"
