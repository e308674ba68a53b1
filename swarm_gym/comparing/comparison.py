"""Episodes of several controllers on the same scenarios and seeds."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from swarm_gym.checks import require_integer
from swarm_gym.comparing.compared_runs import ComparedRuns, least_evaluations_of, optima_of
from swarm_gym.comparing.entrants import Entrant, entrant, environment_of, iterate, with_encoding
from swarm_gym.controllers import Controller, make_controller_for
from swarm_gym.errors import SettingError, shown
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE
from swarm_gym.scenarios import expand_name

CASES = ("case1", "case2", "case3")


def say_nothing(_: str) -> None:
    """Ignore a report of progress."""


def compare(
    controllers: Sequence[str] | Mapping[str, Controller],
    scenarios: Sequence[str] = CASES,
    seeds: Sequence[int] = range(20),
    optimizer: str = "firefly",
    report: Callable[[str], None] = say_nothing,
    **options: object,
) -> ComparedRuns:
    """Run every controller on every scenario with every seed, and return the runs.

    `print` shows them as a table:

        print(compare(["spsfa-tip", "learned:three-cases/0@1"], ["case1", "rooms:0-9"]))

    Args:
        controllers: names of controllers, or controllers by any name. Differences are to the first. A name
            may begin with an optimizer, as in `multivariate+fixed:65`.
        scenarios: names of scenarios. One of several scenarios, such as `rooms:0-9`, is a set: its scenarios
            are taken as drawn from many, and intervals account for the draw.
        seeds: seeds of the environments and controllers. Training never uses seeds below 100,000.
        optimizer: optimizer of controllers whose name has none.
        report: function that is called with the name of each controller before it runs.
        options: options of all environments, e.g. `encoding="bezier"`.

    Raises:
        SettingError: for a name that is given twice, a seed that is none, or too few runs for an interval.
        UnknownNameError: for a name of a controller, optimizer or scenario that does not exist.
        ValueError: for a controller or an option that cannot be.
    """
    for kind, given in (("controllers", controllers), ("scenarios", scenarios)):
        if isinstance(given, str):
            raise SettingError(
                f"{kind}: expected a list of names, got {shown(given)}; write [{shown(given)}]"
            )
        if not isinstance(given, Sequence | Mapping):
            raise SettingError(f"{kind}: expected a list of names, got {shown(given)}")
    if isinstance(controllers, Mapping):
        for name, one in controllers.items():
            if not isinstance(one, Controller):
                raise SettingError(f"controllers: expected a controller as {shown(name)}, got {shown(one)}")
    expanded = [(name, expand_name(name)) for name in scenarios]
    sets, names = dict(expanded), [name for _, of_one in expanded for name in of_one]
    _check(list(controllers), names, seeds)
    seeds = [int(seed) for seed in seeds]  # Gymnasium refuses integers of NumPy
    if min(map(len, sets.values())) * len(seeds) < 2:
        raise SettingError(
            f"seeds: expected at least 2, since an interval needs 2 runs of a scenario, got {list(seeds)}"
        )
    if isinstance(controllers, Mapping):
        runners = [(Entrant(optimizer, name), one) for name, one in controllers.items()]
    else:
        entrants = [entrant(name, optimizer) for name in controllers]
        runners = [(runs, make_controller_for(runs.optimizer, runs.controller, options)) for runs in entrants]
    optima = optima_of(names, with_encoding([runs.optimizer for runs, _ in runners], options))
    least = least_evaluations_of(names, options)
    found = np.empty((3, len(runners), len(names), len(seeds)))
    for k, (label, (runs, controller)) in enumerate(zip(controllers, runners, strict=True)):
        report(label)
        for j, scenario in enumerate(names):
            env = environment_of(runs, controller, scenario, options)
            for i, seed in enumerate(seeds):
                *_, last = iterate(env, controller, seed)
                info: Mapping[str, Any] = last
                found[:, k, j, i] = info["best_fitness"], info["best_collision"], info["evaluations"]
            env.close()
    fitness, collision, evaluations = found
    feasible = collision <= FEASIBILITY_TOLERANCE
    return ComparedRuns(
        tuple(controllers), sets, tuple(seeds), fitness, collision, feasible, evaluations, optima, least
    )


def _check(controllers: Sequence[str], scenarios: Sequence[str], seeds: Sequence[int]) -> None:
    """Raise an error for input that gives no comparison."""
    for kind, given in (("controllers", controllers), ("scenarios", scenarios), ("seeds", seeds)):
        if not len(given):
            raise SettingError(f"{kind}: expected a list with at least one entry, got {shown(given)}")
        if len(set(given)) < len(given):
            raise SettingError(f"{kind}: each one once, got {shown(list(given))}")
    for seed in seeds:
        require_integer("seed", seed, 0, 2**31 - 1)
