"""Our planner, with fixed sizes, SPSFA's rules, and a learned controller."""

from collections.abc import Sequence

from experiments.planners.found import Found
from experiments.planners.rivals import Planner
from swarm_gym.errors import NoPathError
from swarm_gym.planning import plan
from swarm_gym.scenarios import GridScenario

# Optimizer and controller, by the name in the tables.
SWARMS = {
    "swarm, fixed size": ("multivariate", "fixed:65"),
    "swarm, SPSFA-TIP's rules": ("firefly", "spsfa-tip"),
    "swarm, learned": ("firefly", "learned:three-cases/0"),
}


def of_swarm(name: str) -> Planner:
    """Return our planner with the optimizer and the controller of a name in `SWARMS`."""
    optimizer, controller = SWARMS[name]

    def run(scenario: GridScenario, checkpoints: Sequence[float], seed: int) -> list[Found]:
        try:
            found = plan(
                scenario, optimizer=optimizer, controller=controller, max_seconds=checkpoints[-1], seed=seed
            )
        except NoPathError:
            return []
        return [Found(step.seconds, step.path, step.found_by != "guide") for step in found.improvements]

    return run
