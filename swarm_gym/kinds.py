"""Kinds of scenarios: which problems the settings make of them, and which options have an effect there."""

from collections.abc import Callable
from typing import Any, NamedTuple

from swarm_gym.checks import require_integer, require_number
from swarm_gym.ioh_problem import IohProblem
from swarm_gym.problem import AnalyticProblem, GridProblem, Problem, WalkProblem, problem_of_function
from swarm_gym.problem.grid.problem import MAX_POINTS
from swarm_gym.scenarios import (
    BbobScenario,
    FunctionScenario,
    GridScenario,
    IohScenario,
    OneMaxScenario,
    Scenario,
    StaticScenario,
    rasterised,
)


def _analytic_problem(settings: Any, scenario: Scenario) -> Problem:
    if settings.encoding == "walk":
        require_number("cell_size", settings.cell_size, 1e-3, 1e6)
        return WalkProblem(rasterised(scenario, settings.cell_size), settings.penalty)
    return AnalyticProblem(scenario, settings.num_waypoints, settings.length_weight)


def _grid_problem(settings: Any, scenario: GridScenario) -> Problem:
    if settings.encoding == "walk":
        return WalkProblem(scenario, settings.penalty)
    option = {"waypoints": "num_waypoints", "bezier": "num_control_points"}[settings.encoding]
    num_points = getattr(settings, option)
    require_integer(option, num_points, 1, MAX_POINTS)
    return GridProblem(scenario, settings.encoding, num_points, settings.penalty)


def _function_problem(settings: Any, scenario: FunctionScenario) -> Problem:  # noqa: ARG001
    return problem_of_function(scenario)


def _ioh_problem(settings: Any, scenario: IohScenario) -> Problem:  # noqa: ARG001
    return IohProblem(scenario)


class Kind(NamedTuple):
    """A kind of scenario: the class, and what the settings do with it.

    Attributes:
        name: name of such scenarios, in messages.
        problem: function of `Settings` and a scenario that makes its problem.
        options: options that have an effect on such scenarios, by encoding.
        sourced: encodings whose decision vectors are whole paths, which can come from every source.
        calls_python: whether Python code evaluates decision vectors, which no compiled optimizer can call.
    """

    name: str
    problem: Callable[[Any, Any], Problem]
    options: dict[str, tuple[str, ...]]
    sourced: tuple[str, ...] = ()
    calls_python: bool = False


KINDS: dict[type, Kind] = {
    Scenario: Kind(
        "analytic maps",
        _analytic_problem,
        {
            "waypoints": ("encoding", "num_waypoints", "length_weight", "clearance", "final_repair"),
            "walk": ("encoding", "penalty", "cell_size", "clearance", "final_repair"),
        },
        sourced=("waypoints",),
    ),
    GridScenario: Kind(
        "grid maps",
        _grid_problem,
        {
            "waypoints": ("encoding", "num_waypoints", "penalty", "clearance", "final_repair"),
            "bezier": ("encoding", "num_control_points", "penalty", "clearance", "final_repair"),
            "walk": ("encoding", "penalty", "clearance", "final_repair"),
        },
        sourced=("waypoints", "bezier"),
    ),
    # Before the test functions, which they are subclasses of: their problem tables are others.
    BbobScenario: Kind("BBOB functions", _function_problem, {"waypoints": ()}),
    IohScenario: Kind("functions of ioh", _ioh_problem, {"waypoints": ()}, calls_python=True),
    OneMaxScenario: Kind("bit strings", _function_problem, {"ones": ("encoding",)}),
    FunctionScenario: Kind("test functions", _function_problem, {"waypoints": ()}),
}
ENCODINGS = tuple(dict.fromkeys(encoding for kind in KINDS.values() for encoding in kind.options))
PROBLEM_OPTIONS = {
    option for kind in KINDS.values() for options in kind.options.values() for option in options
}


def names_of_kinds(encoding: str) -> str:
    """Return the names of the kinds of scenarios that have an encoding, for messages."""
    return " or ".join(kind.name for kind in KINDS.values() if encoding in kind.options)


def kind_of(scenario: StaticScenario) -> Kind:
    """Return the kind of a scenario."""
    return next(kind for scenarios, kind in KINDS.items() if isinstance(scenario, scenarios))
