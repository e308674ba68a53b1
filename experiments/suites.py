"""Suites: which controllers run on which scenarios, as data.

To add one, enter it in `SUITES`.
"""

from dataclasses import dataclass

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
    """

    name: str
    controllers: tuple[str, ...]
    scenarios: tuple[str, ...]
    num_seeds: int
    baseline: str
    snapshots: tuple[tuple[str, str, int, tuple[int, ...]], ...] = ()
    optimizer: str = "firefly"


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

SUITES = {suite.name: suite for suite in (PAPER,)}


def get_suite(name: str) -> Suite:
    """The suite of that name.

    Raises:
        UnknownNameError: if there is none.
    """
    return look_up("suite", name, SUITES)
