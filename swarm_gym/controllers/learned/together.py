"""Several policies that decide together: their action is the mean of the actions of each.

The name is `together:<recipe>`, with the policies of all training seeds of that recipe, at `@<price>` if they
observe one; or `together:<policy>,<policy>,...`, with packaged policies or files. Trainings of one recipe
differ by chance, which their mean evens out in part.

Source: averaged members of an ensemble, L. Breiman, "Bagging predictors", Machine Learning 24 (1996).
"""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from swarm_gym.controllers.controller import Controller
from swarm_gym.controllers.learned.policy_file import POLICIES, PolicyFileError, policies_of
from swarm_gym.controllers.names import ControllerName
from swarm_gym.controllers.size_limits import SizeLimits
from swarm_gym.errors import shown

Load = Callable[[str, SizeLimits | None], Controller]


class Together(Controller):
    """The mean of the actions of several controllers, which need the same environment.

    Args:
        parts: at least two controllers with the same layouts and options.

    Raises:
        ValueError: for fewer than two, or for controllers of different environments.
    """

    def __init__(self, parts: Sequence[Controller]):
        if len(parts) < 2:
            raise ValueError(f"expected at least two policies that decide together, got {len(parts)}")
        self._parts = tuple(parts)
        first = parts[0]
        for other in parts[1:]:
            wanted, found = dict(first.env_options()), dict(other.env_options())
            for name in {**wanted, **found}:
                if wanted.get(name) != found.get(name):
                    raise ValueError(
                        "policies that decide together need the same environment; "
                        f"{name} is {shown(wanted.get(name))} of one and {shown(found.get(name))} of another"
                    )
        self.observation, self.action = first.observation, first.action
        self.initial_population_size, self.first_source = first.initial_population_size, first.first_source
        self.max_evaluations, self.price = first.max_evaluations, first.price
        self.corrects, self.made_for, self.needed_limits = first.corrects, first.made_for, first.needed_limits

    def stretched(self, factor: float) -> "Together":
        """Return the policies together, each stretched, see `Controller.stretched`.

        Args:
            factor: number of iterations of an episode, relative to the one of their training.
        """
        return Together([part.stretched(factor) for part in self._parts])

    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """Begin episodes."""
        for part in self._parts:
            part.reset(num_swarms, seed)

    def act(self, observations: NDArray) -> NDArray:
        """Return the means of the actions, (num_swarms, number of decisions)."""
        return np.mean([part.act(observations) for part in self._parts], axis=0)

    def identity(self) -> object:
        """Return the identities of the policies."""
        return "together", [part.identity() for part in self._parts]


def load_together(argument: str, limits: SizeLimits | None, load: Load) -> Together:
    """Return the controller of what follows `together:` in a name.

    Args:
        argument: a recipe, or policies with commas between them.
        limits: population sizes that the environment allows; None takes those of the training.
        load: function that loads a policy.

    Raises:
        PolicyFileError: if a policy is missing or damaged, or a recipe has no packaged policies.
        ValueError: if these cannot decide together.
    """
    names = argument.split(",") if "," in argument else _of_recipe(argument)
    try:
        return Together([load(name, limits) for name in names])
    except PolicyFileError:
        raise
    except ValueError as error:
        raise ValueError(f"together:{argument}: {error}") from error


def _of_recipe(argument: str) -> list[str]:
    """Return the names of the packaged policies of a recipe, with the price that the argument has."""
    name = ControllerName.of("learned", argument)
    if name.seed is not None:
        raise ValueError(
            f"together:{argument}: expected a recipe, whose policies decide together, or several policies "
            f"with commas between them, got the policy {shown(argument)}"
        )
    found = policies_of(str(name.recipe))
    if not found:
        raise PolicyFileError(POLICIES.missing("recipe of policies", argument))
    return [f"{policy}{name.price_suffix}" for policy in found]
