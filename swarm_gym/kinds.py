"""Kinds of scenarios: which problems the settings make of them, and which options have an effect there."""

from typing import NamedTuple, Protocol

from swarm_gym.checks import require_integer, require_number
from swarm_gym.ioh_problem import IohProblem
from swarm_gym.problem import (
    AnalyticProblem,
    FunctionProblem,
    GridProblem,
    Problem,
    TerrainProblem,
    WalkProblem,
    problem_of_function,
)
from swarm_gym.problem.grid.problem import MAX_POINTS, WISH_WEIGHTS
from swarm_gym.scenarios import (
    BbobScenario,
    FunctionScenario,
    GridScenario,
    IohScenario,
    OneMaxScenario,
    Scenario,
    StaticScenario,
    TerrainScenario,
    rasterised,
)


class ProblemOptions(Protocol):
    """The settings that problems depend on; `swarm_gym.settings.Settings` describes them."""

    @property
    def encoding(self) -> str:
        """Name of the encoding."""

    @property
    def num_waypoints(self) -> int:
        """Number of waypoints of a path."""

    @property
    def num_control_points(self) -> int:
        """Number of control points of a Bezier curve."""

    @property
    def length_weight(self) -> float:
        """Weight of the length in the fitness."""

    @property
    def penalty(self) -> float:
        """Fitness of a blocked part of a path."""

    @property
    def distance_weight(self) -> float:
        """Weight of the cost of nearness to blocked cells."""

    @property
    def ground_weight(self) -> float:
        """Weight of the costs of ground."""

    @property
    def curvature_weight(self) -> float:
        """Weight of the squared curvature, in map units squared."""

    @property
    def cell_size(self) -> float:
        """Side of the cells that analytic maps are converted to."""

    @property
    def cost(self) -> str:
        """Name of the cost of flights over terrain."""


def problem_of(scenario: StaticScenario, settings: ProblemOptions) -> Problem:
    """Return the problem that the settings make of a scenario, whose kind has their encoding."""
    if isinstance(scenario, FunctionScenario):
        return problem_of_any_function(scenario)
    if isinstance(scenario, GridScenario):
        return _grid_problem(scenario, settings)
    if isinstance(scenario, TerrainScenario):
        return TerrainProblem(scenario, settings.encoding, settings.num_waypoints, settings.cost)
    return _analytic_problem(scenario, settings)


def problem_of_any_function(scenario: FunctionScenario) -> FunctionProblem:
    """Return the problem of a test function, which Python code may evaluate."""
    return IohProblem(scenario) if isinstance(scenario, IohScenario) else problem_of_function(scenario)


def _analytic_problem(scenario: Scenario, settings: ProblemOptions) -> Problem:
    if settings.encoding == "walk":
        require_number("cell_size", settings.cell_size, 1e-3, 1e6)
        return WalkProblem(rasterised(scenario, settings.cell_size), settings.penalty)
    return AnalyticProblem(scenario, settings.num_waypoints, settings.length_weight)


def _grid_problem(scenario: GridScenario, settings: ProblemOptions) -> Problem:
    if settings.encoding == "walk":
        return WalkProblem(scenario, settings.penalty)
    option = {"waypoints": "num_waypoints", "bezier": "num_control_points"}[settings.encoding]
    num_points = getattr(settings, option)
    require_integer(option, num_points, 1, MAX_POINTS)
    weights = {name: getattr(settings, name) for name in WISH_WEIGHTS}
    return GridProblem(scenario, settings.encoding, num_points, settings.penalty, **weights)


class Kind(NamedTuple):
    """A kind of scenario: the class, and what the settings do with it.

    Attributes:
        name: name of such scenarios, in messages.
        options: options that have an effect on such scenarios, by encoding.
        sourced: encodings whose decision vectors are whole paths, which can come from every source.
        calls_python: whether Python code evaluates decision vectors, which no compiled optimizer can call.
        defaults: options whose defaults differ on such scenarios.
    """

    name: str
    options: dict[str, tuple[str, ...]]
    sourced: tuple[str, ...] = ()
    calls_python: bool = False
    defaults: tuple[tuple[str, object], ...] = ()


_OF_PATHS_OVER_CELLS = ("penalty", *WISH_WEIGHTS, "clearance", "final_repair")
KINDS: dict[type, Kind] = {
    Scenario: Kind(
        "analytic maps",
        {
            "waypoints": ("encoding", "num_waypoints", "length_weight", "clearance", "final_repair"),
            "walk": ("encoding", "penalty", "cell_size", "clearance", "final_repair"),
        },
        sourced=("waypoints",),
    ),
    GridScenario: Kind(
        "grid maps",
        {
            "waypoints": ("encoding", "num_waypoints", *_OF_PATHS_OVER_CELLS),
            "bezier": ("encoding", "num_control_points", *_OF_PATHS_OVER_CELLS),
            "walk": ("encoding", "penalty", "clearance", "final_repair"),
        },
        sourced=("waypoints", "bezier"),
    ),
    TerrainScenario: Kind(
        "flights over terrain",
        {
            "waypoints": ("encoding", "num_waypoints", "cost"),
            "shifted": ("encoding", "num_waypoints", "cost"),
            "spherical": ("encoding", "num_waypoints", "cost"),
        },
        sourced=("waypoints", "shifted", "spherical"),
        defaults=(("num_waypoints", 10),),
    ),
    # Before the test functions, which they are subclasses of: their problem tables are others.
    BbobScenario: Kind("BBOB functions", {"waypoints": ()}),
    IohScenario: Kind("functions of ioh", {"waypoints": ()}, calls_python=True),
    OneMaxScenario: Kind("bit strings", {"ones": ("encoding",)}),
    FunctionScenario: Kind("test functions", {"waypoints": ()}),
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
