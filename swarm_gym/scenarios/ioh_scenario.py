"""Functions that the package `ioh` keeps, by name: `ioh:<suite>-<function>-<dimension>-<instance>`.

Source: J. de Nobel et al., "IOHexperimenter: benchmarking platform for iterative optimization heuristics",
Evolutionary Computation 32, 2024. `ioh` evaluates these functions one vector at a time, called from Python.
`ioh` defines the numbers of functions and instances:

| suite | functions | dimensions | domain |
|---|---|---|---|
| `bbob` | 1 to 24, as `function:bbob-...` has them | 2 to 100 | [-5, 5] |
| `sbox` | 1 to 24: BBOB with the box as a constraint and optima anywhere in it | 2 to 100 | [-5, 5] |
| `cec2022` | 1001 to 1012: F1 to F12 of the competition of 2022 | 2, 10, 20 | [-100, 100] |
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple, cast

from swarm_gym.checks import look_up
from swarm_gym.errors import MissingExtraError, ScenarioError, shown
from swarm_gym.scenarios.family import NUMBER, Family, parse_numbers
from swarm_gym.scenarios.function_scenario import FunctionScenario

if TYPE_CHECKING:
    from ioh.iohcpp.problem import RealSingleObjective

NAME = "ioh"
USAGE = f"{NAME}:<suite>-<function>-<dimension>-<instance>"
EXAMPLE = f"{NAME}:bbob-8-5-1"
INSTANCES = range(1, 1001)


class IohSuite(NamedTuple):
    """A suite of functions of `ioh` that are minimised in a box and whose optimum is known.

    Attributes:
        problem_class: name of the suite in `ioh.ProblemClass`.
        functions: numbers of its functions.
        dimensions: dimensions that all of them are defined for.
        reach: bound of the domain: components lie in [-reach, reach].
        lacking: dimensions that some functions are not defined for, by number of the function.
    """

    problem_class: str
    functions: range
    dimensions: range | tuple[int, ...]
    reach: float
    lacking: Mapping[int, tuple[int, ...]] = MappingProxyType({})


SUITES = {
    "bbob": IohSuite("BBOB", range(1, 25), range(2, 101), 5.0),
    "sbox": IohSuite("SBOX", range(1, 25), range(2, 101), 5.0),
    # The hybrid functions F6, F7 and F8 divide the components into groups, and need more than two.
    "cec2022": IohSuite(
        "CEC2022", range(1001, 1013), (2, 10, 20), 100.0, {1006: (2,), 1007: (2,), 1008: (2,)}
    ),
}


@dataclass(frozen=True)
class IohScenario(FunctionScenario):
    """The task to find the minimum of a function of `ioh`, from which its least value is subtracted.

    So the least value is 0, as for every test function. Compiled optimizers cannot call `ioh`;
    optimizers of `swarm_gym.adapters` can.

    Attributes:
        name: name under which results are filed.
        function: suite and number of the function, such as `bbob-8`.
        dimension: D, the length of a decision vector.
        optimum: (D,) position of the minimum; it follows from the others.
        instance: number of the instance, 1 to 1000.

    Raises:
        ScenarioError: for a function, a dimension or an instance that does not exist.
        UnknownNameError: if there is no such suite.
        MissingExtraError: if `ioh` is not installed.
    """

    optimum: tuple[float, ...] = field(init=False)
    instance: int = 1

    def __post_init__(self) -> None:
        where = f"scenario {shown(self.name)}"
        match = re.fullmatch(rf"([a-z0-9]+)-({NUMBER})", str(self.function))
        if match is None:
            raise ScenarioError(
                f"{where}: expected suite and number of a function, such as bbob-8, got "
                f"{shown(self.function)}"
            )
        require_parts(where, match[1], int(match[2]), self.dimension, self.instance)
        object.__setattr__(self, "optimum", tuple(self.ioh_problem.optimum.x))

    @property
    def suite(self) -> str:
        """Name of the suite, a key of `SUITES`."""
        return self.function.partition("-")[0]

    @property
    def number(self) -> int:
        """Number of the function in `ioh`."""
        return int(self.function.partition("-")[2])

    @property
    def domain(self) -> tuple[float, float]:
        """The smallest and the largest value of every component."""
        reach = SUITES[self.suite].reach
        return -reach, reach

    @property
    def ioh_problem(self) -> "RealSingleObjective":
        """The object of `ioh` that optimizers call, one for each function in a process.

        All environments of this function share it, with its count of evaluations (`state.evaluations`) and
        its loggers. `reset()` of it sets the count to 0 and begins a run in the logs.
        """
        return called(self.suite, self.number, self.dimension, self.instance)


def _made(suite: str, function: int, dimension: int, instance: int) -> "RealSingleObjective":
    """Return a new object of `ioh` for a function.

    Args:
        suite: a key of `SUITES`.
        function: number of the function.
        dimension: length of a decision vector.
        instance: number of the instance.

    Raises:
        MissingExtraError: if `ioh` is not installed.
    """
    try:
        import ioh
    except ImportError as error:
        raise MissingExtraError(f"a scenario {USAGE}", "ioh", "benchmarks") from error
    problem_class = getattr(ioh.ProblemClass, SUITES[suite].problem_class)
    found = ioh.get_problem(function, instance, dimension, problem_class)
    return cast("RealSingleObjective", found)  # as all functions of these suites


called = cache(_made)  # the objects that optimizers call, whose evaluations count
uncounted = cache(_made)  # the objects for pictures and checks


def require_parts(where: str, suite: str, function: object, dimension: object, instance: object) -> None:
    """Raise an error unless a suite has a function of that number, dimension and instance.

    Args:
        where: scenario that is asked for, as the message begins.
        suite: name of the suite.
        function: number of the function.
        dimension: length of a decision vector.
        instance: number of the instance.

    Raises:
        UnknownNameError: if there is no such suite.
        ScenarioError: with the value and those that are valid.
    """
    found = look_up("suite of ioh", suite, SUITES)
    lacking = found.lacking.get(function, ()) if isinstance(function, int) else ()
    dimensions = [each for each in found.dimensions if each not in lacking]
    of = f"function {function} of {suite}" if lacking else suite
    for owner, part, value, valid in (
        (suite, "function", function, found.functions),
        (of, "dimension", dimension, dimensions),
        (suite, "instance", instance, INSTANCES),
    ):
        if not isinstance(value, int) or isinstance(value, bool) or value not in valid:
            last = valid[-1]
            is_range = last - valid[0] == len(valid) - 1
            text = f"{valid[0]} to {last}" if is_range else ", ".join(map(str, valid))
            raise ScenarioError(f"{where}: {owner} has the {part}s {text}, got {part} {shown(value)}")


def expand(name: str) -> tuple[str, ...]:
    """Return the names of the single functions that a name stands for.

    `ioh:bbob-8-5-1-3` stands for three instances.

    Raises:
        UnknownNameError: if there is no such suite.
        ScenarioError: if the name has another form, or there is no such function, dimension or instance.
    """
    suite, function, dimension, instances = _parse(name)
    return tuple(f"{NAME}:{suite}-{function}-{dimension}-{instance}" for instance in instances)


def make(name: str) -> IohScenario:
    """Return the single function of that name.

    Raises:
        MissingExtraError: if `ioh` is not installed.
    """
    suite, function, dimension, instances = _parse(name)
    return IohScenario(name, f"{suite}-{function}", dimension, instances[0])


def _parse(name: str) -> tuple[str, int, int, range]:
    """Return the suite, the function, the dimension and the instances, one or more, of a name."""
    pattern = rf"{NAME}:([a-z0-9]+)-({NUMBER})-({NUMBER})-({NUMBER}(?:-{NUMBER})?)"
    match = re.fullmatch(pattern, name)
    if match is None:
        raise ScenarioError(
            f"scenario {shown(name)}: expected {USAGE}, with a suite of {', '.join(SUITES)} and three "
            f"numbers such as {EXAMPLE}, or a range of instances such as {EXAMPLE}-5"
        )
    suite, function, dimension = match[1], int(match[2]), int(match[3])
    instances = parse_numbers(match[4], name)
    if not instances:
        raise ScenarioError(f"scenario {shown(name)}: the range of instances {match[4]} is empty")
    for instance in (instances[0], instances[-1]):
        require_parts(f"scenario {shown(name)}", suite, function, dimension, instance)
    return suite, function, dimension, instances


# No samples: they would be run with compiled optimizers.
FAMILY = Family(USAGE, (), expand, make)
