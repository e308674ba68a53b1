"""Our planner, with fixed sizes, SPSFA's rules, and a learned controller."""

from collections.abc import Sequence
from typing import NamedTuple

from experiments.planners.found import Found
from experiments.planners.rivals import Planner
from experiments.planners.tasks import Task
from swarm_gym.errors import NoPathError
from swarm_gym.planning import plan


class Swarm(NamedTuple):
    """A way to plan with a swarm.

    Attributes:
        optimizer: name of the optimizer.
        controller: name of the controller.
        goes_on: whether it begins around the previous path of a task of replanning, not around that of A*.
    """

    optimizer: str
    controller: str
    goes_on: bool = False


# By the name in the tables.
SWARMS = {
    "swarm, fixed size": Swarm("multivariate", "fixed:65"),
    "swarm, SPSFA-TIP's rules": Swarm("firefly", "spsfa-tip"),
    "swarm, learned": Swarm("firefly", "learned:three-cases/0"),
    "swarm, fixed size, from the previous path": Swarm("multivariate", "fixed:65", goes_on=True),
}


def of_swarm(name: str) -> Planner:
    """Return our planner with the optimizer and the controller of a name in `SWARMS`."""
    swarm = SWARMS[name]

    def run(task: Task, checkpoints: Sequence[float], seed: int) -> list[Found]:
        try:
            found = plan(
                task.scenario,
                planner="swarm",
                optimizer=swarm.optimizer,
                controller=swarm.controller,
                max_seconds=checkpoints[-1],
                seed=seed,
                previous=task.previous if swarm.goes_on else None,
            )
        except NoPathError:
            return []
        return [
            Found(step.seconds, step.path, step.found_by.startswith("swarm")) for step in found.improvements
        ]

    return run
