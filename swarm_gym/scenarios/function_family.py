"""Test functions by name: the scenarios `function:<function>-<dimension>`, see `function_scenario`.

In `function:<function>-<dimension>-shifted:<number>` the optimum is drawn uniformly from the middle 80 % of
the domain. These scenarios expose optimizers that drift to the origin or to the middle of the domain.

The functions of the benchmark BBOB are `function:bbob-<function>-<dimension>-<instance>`, see `bbob`.
"""

import hashlib
import re

import numpy as np

from swarm_gym.errors import ScenarioError, shown
from swarm_gym.scenarios.bbob.scenario import BbobScenario, require_parts
from swarm_gym.scenarios.family import NUMBER, Family, numbers_below, parse_numbers
from swarm_gym.scenarios.function_scenario import FUNCTIONS, FunctionScenario, require_dimension

NAME = "function"
BBOB_USAGE = f"{NAME}:bbob-<function>-<dimension>-<instance>"
USAGE = f"{NAME}:<function>-<dimension>[-shifted:<number>]"
BBOB = f"{NAME}:bbob-"

NUM_SHIFTED = 1_000_000
# Fraction of the domain, on either side, in which no optimum is drawn.
RIM = 0.1


def expand(name: str) -> tuple[str, ...]:
    """Return the names of the single functions that a name stands for.

    `...-shifted:0-49` stands for fifty functions, and `bbob-15-10-1-5` for five instances.

    Raises:
        UnknownNameError: if there is no such function.
        ScenarioError: if the name has another form, or the function is not defined for this dimension.
    """
    if name.startswith(BBOB):
        number, length, instances = _parse_bbob(name)
        return tuple(f"{BBOB}{number}-{length}-{instance}" for instance in instances)
    function, dimension, numbers = _parse(name)
    require_dimension(f"scenario {shown(name)}", function, dimension)
    if numbers is None:
        return (name,)
    chosen = numbers_below(NUM_SHIFTED, numbers, name, "0-49", "'shifted:'")
    return tuple(f"{name.removesuffix(numbers)}{number}" for number in chosen)


def make(name: str) -> FunctionScenario:
    """Return the single function of that name."""
    if name.startswith(BBOB):
        function_number, length, instances = _parse_bbob(name)
        return BbobScenario(name, f"bbob-{function_number}", length, instances[0])
    function, dimension, number = _parse(name)
    if number is None:
        return FunctionScenario(name, function, dimension)
    # Never change how the optimum is drawn: results refer to these names.
    seed = int.from_bytes(hashlib.sha256(name.encode()).digest(), "big")
    shares = np.random.Generator(np.random.PCG64(seed)).random(dimension)
    reach = FUNCTIONS[function].reach
    optimum = reach * (1.0 - 2.0 * RIM) * (2.0 * shares - 1.0)
    return FunctionScenario(name, function, dimension, tuple(optimum.tolist()))


def _parse(name: str) -> tuple[str, int, str | None]:
    """Return the function, the dimension, and the text that stands for the numbers of shifted functions."""
    match = re.fullmatch(rf"{NAME}:([a-z-]+)-([1-9][0-9]{{0,8}})(?:-shifted:(.*))?", name, re.DOTALL)
    if match is None:
        raise ScenarioError(
            f"scenario {shown(name)}: expected {USAGE}, with a function of {', '.join(FUNCTIONS)}; or "
            f"{BBOB_USAGE}"
        )
    function, dimension, numbers = match.groups()
    return function, int(dimension), numbers


def _parse_bbob(name: str) -> tuple[int, int, range]:
    """Return the function, the dimension and the instances, one or more, of a name of BBOB."""
    match = re.fullmatch(rf"{BBOB}({NUMBER})-({NUMBER})-({NUMBER}(?:-{NUMBER})?)", name)
    if match is None:
        raise ScenarioError(
            f"scenario {shown(name)}: expected {BBOB_USAGE}, three numbers such as {BBOB}15-10-3, or a range "
            f"of instances such as {BBOB}15-10-1-5"
        )
    function, dimension = int(match[1]), int(match[2])
    instances = parse_numbers(match[3], name)
    if not instances:
        raise ScenarioError(f"scenario {shown(name)}: the range of instances {match[3]} is empty")
    for instance in (instances[0], instances[-1]):
        require_parts(f"scenario {shown(name)}", function, dimension, instance)
    return function, dimension, instances


FAMILY = Family(
    f"{USAGE} or {BBOB_USAGE}",
    (
        *(f"{NAME}:{function}-2" for function in FUNCTIONS),
        f"{NAME}:rastrigin-10-shifted:0",
        f"{BBOB}15-10-3",
    ),
    expand,
    make,
)
