"""Optima of the scenarios that controllers are compared on."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swarm_gym.errors import ScenarioError
from swarm_gym.reference import known_optimum, quick_optima
from swarm_gym.scenarios import GridScenario
from swarm_gym.worlds import make_problem

Floats = NDArray[np.float64]


def optima_of(scenarios: Sequence[str], options: Mapping[str, object]) -> Floats:
    """Return the fitness of the optimum of each scenario, (scenarios,), nan where it is unknown.

    Unknown ones of grid maps are computed if that is quick.

    Args:
        scenarios: names of the scenarios.
        options: options of their environments.
    """
    given: Mapping[str, Any] = options
    problems = [make_problem(name, **given) for name in scenarios]
    found = np.array([known_optimum(problem) for problem in problems])
    on_grids = [isinstance(problem.scenario, GridScenario) for problem in problems]
    unknown = np.flatnonzero(np.isnan(found) & on_grids)
    if unknown.size:
        found[unknown] = quick_optima([problems[number] for number in unknown])
    return found


def refuse_unknown_optima(scenarios: Sequence[str], optima: Floats) -> None:
    """Raise an error if an optimum is unknown.

    Raises:
        ScenarioError: naming the first of these scenarios.
    """
    unknown = [name for name, optimum in zip(scenarios, optima, strict=True) if np.isnan(optimum)]
    if unknown:
        raise ScenarioError(
            f"gaps need the optimum, which is not known for {len(unknown)} of {len(optima)} scenarios, "
            f"the first of them {unknown[0]}"
        )
