"""The expected runtime of a controller on OneMax, computed without simulation.

expected_runtime(make_controller("theory"), size=500)
"""

import numpy as np

from swarm_gym.action import make_action
from swarm_gym.controllers.controller import Controller
from swarm_gym.controllers.onemax_rules import OPTIMIZER, OneFifth
from swarm_gym.errors import SettingError
from swarm_gym.observation import make_observation
from swarm_gym.optimizers import get_optimizer
from swarm_gym.optimizers.one_plus_lambda_lambda import OnePlusLambdaLambdaParameters
from swarm_gym.reference.onemax.adaptive import ladder_runtimes
from swarm_gym.reference.onemax.runtimes import LambdaDecisions, expected_runtimes
from swarm_gym.rollout import swarms_for
from swarm_gym.scenarios.onemax import OneMaxScenario

# Numbers of ones for which a controller decides at once; their swarms take memory.
SIDE_BY_SIDE = 2048


def expected_runtime(
    controller: Controller, size: int, start: int | None = None, copies_free: bool = True
) -> float:
    """Return the expected evaluations until all bits are set, the first string included.

    Args:
        controller: controller whose decisions depend on the length and the number of ones alone, or the
            one-fifth rule, whose lambda is a state of its own.
        size: n, the length of the string.
        start: number of ones at the beginning; by default half of them.
        copies_free: whether children that equal the parent or the best mutant cost nothing.

    Raises:
        SettingError: if the controller observes more than length and number of ones.
    """
    begin = OneMaxScenario("start", size=size, **({} if start is None else {"start": start})).start
    if isinstance(controller, OneFifth):
        by_rung = ladder_runtimes(controller.ladder(size), begin, copies_free)
        return float(by_rung[0, begin]) + 1.0
    later = expected_runtimes(decisions_on(controller, size), begin, copies_free)
    return float(later[begin]) + 1.0


def decisions_on(controller: Controller, size: int) -> LambdaDecisions:
    """Return what a controller decides for every number of ones, in the environment that it needs.

    Raises:
        SettingError: if the controller observes more than length and number of ones, or remembers.
    """
    if isinstance(controller, OneFifth):
        raise SettingError(
            "one-fifth: expected a controller whose decisions follow from the number of ones, and this one "
            "remembers its lambda; `ladder` has its decisions, and `expected_runtime` takes it"
        )
    layout = make_observation(controller.observation)
    if not all(feature.needs_bits for feature in layout.features):
        raise SettingError(
            f"observation {controller.observation!r}: an expected runtime needs a controller that observes "
            "length and number of ones alone, in the layouts theory and theory-scaled; simulate this one"
        )
    side_by_side = min(size, SIDE_BY_SIDE)
    swarms = swarms_for(
        controller,
        side_by_side,
        OPTIMIZER,
        scenario=OneMaxScenario("all numbers of ones", size=size),
        iterations=1,
    )
    swarms.reset(seed=0)
    simulation = swarms.simulation
    action, every = (
        make_action(swarms.settings, get_optimizer(OPTIMIZER)),
        np.ones(side_by_side, dtype=np.bool_),
    )
    columns = np.empty((4, 0))
    for first in range(0, size, side_by_side):
        ones = np.minimum(first + np.arange(side_by_side), size - 1)
        simulation.swarms.best_fitness[:] = size - ones
        controller.reset(side_by_side)
        decided = action.decode(controller.act(layout.observe(simulation)), every, simulation)
        parameters = OnePlusLambdaLambdaParameters(*decided.parameters.T)
        children = np.floor(np.asarray(parameters.children) + 0.5)
        children = np.where(children == 0.0, decided.sizes, children)
        found = np.stack([decided.sizes, children, parameters.strength, parameters.bias])
        columns = np.concatenate([columns, found], axis=1)
    mutants, children, strength, bias = columns[:, :size]
    return LambdaDecisions(mutants.astype(np.int64), children.astype(np.int64), strength.copy(), bias.copy())
