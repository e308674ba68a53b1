"""Suites: which controllers run on which scenarios, as data.

To add one, enter it in `SUITES`.
"""

from dataclasses import dataclass

from experiments import parameter_study
from swarm_gym.checks import look_up


@dataclass(frozen=True)
class Suite:
    """Every controller runs every (scenario, seed) pair, so that all comparisons are paired.

    Attributes:
        name: what results are filed under.
        controllers: names for `agents.make_controller`.
        scenarios: names for `swarm_gym.scenarios.make_scenario`.
        num_seeds: seeds 0 .. num_seeds - 1, none of which training or validation ever uses.
        baseline: the controller that the others are compared with.
        snapshots: (controller, scenario, seed, iterations) of runs whose populations are kept.
        optimizer: name of the optimizer.
        max_population_size: largest size that environments and controllers allow.
    """

    name: str
    controllers: tuple[str, ...]
    scenarios: tuple[str, ...]
    num_seeds: int
    baseline: str
    snapshots: tuple[tuple[str, str, int, tuple[int, ...]], ...] = ()
    optimizer: str = "firefly"
    max_population_size: int = 200


PAPER = Suite(
    name="paper",
    controllers=(
        "fixed:60",
        "fixed:80",
        "fixed:100",
        "spsfa",
        "spsfa-tip",
        "random",
        "ppo:three-cases",
    ),
    scenarios=("case1", "case2", "case3"),
    num_seeds=20,
    baseline="spsfa-tip",
    snapshots=(("spsfa-tip", "case1", 0, (0, 3, 10, 30, 60, 100)),),
)

PARAMETERS = Suite(
    name="parameters",
    controllers=parameter_study.CONTROLLERS,
    scenarios=(parameter_study.SCENARIO,),
    num_seeds=20,
    baseline="spsfa-tip",
    max_population_size=parameter_study.MAX_POPULATION_SIZE,
)

SUITES = {suite.name: suite for suite in (PAPER, PARAMETERS)}


def get_suite(name: str) -> Suite:
    """The suite of that name.

    Raises:
        UnknownNameError: if there is none.
    """
    return look_up("suite", name, SUITES)
