"""Controllers and scenarios that several studies compare."""

import copy

from swarm_gym.controllers.controller import Controller
from swarm_gym.controllers.learned.policy_file import policies_of


def training_seeds(recipe: str, number: int, *prices: float) -> tuple[str, ...]:
    """Return the names of the policies of a recipe, such as `learned:three-cases/0@1`, at each price."""
    told = [f"@{price:g}" for price in prices] or [""]
    return tuple(f"{recipe}/{k}{price}" for price in told for k in range(number))


def packaged_seeds(recipe: str) -> tuple[str, ...]:
    """Return the names of the policies of a recipe that are there, one for each training seed."""
    return tuple(f"learned:{name}" for name in policies_of(recipe))


def with_budget(controller: Controller, evaluations: int) -> Controller:
    """Return a controller for this evaluation budget; a policy would keep the one of its training."""
    if controller.max_evaluations is None:
        return controller
    other = copy.copy(controller)
    other.max_evaluations = evaluations
    return other


CASES = ("case1", "case2", "case3")
FIXED_SIZES = ("fixed:60", "fixed:80", "fixed:100")

# Learned controllers at one of the prices that they were trained for, for comparisons other than fronts.
HEADLINE_LEARNED = training_seeds("learned:three-cases", 10, 1)
HEADLINE_EXTENDED = training_seeds("learned:three-cases-extended", 7, 2)
