"""Entrants of suites: a controller, its optimizer and the length of its episodes.

`spsfa-tip` is a controller of the suite's own optimizer. `multivariate+fixed:65` is the controller `fixed:65`
of the optimizer `multivariate`. `multivariate(50)+fixed:65` runs in episodes of 50 iterations; it is another
entrant, since parameters may follow a schedule over the episode.
"""

from typing import NamedTuple

from swarm_gym.checks import look_up
from swarm_gym.controllers.names import ControllerName
from swarm_gym.optimizers import OPTIMIZERS, get_optimizer
from swarm_gym.own_code import is_own


class Entrant(NamedTuple):
    """Names of an optimizer and of a controller for it, and the number of iterations.

    Attributes:
        optimizer: name of the optimizer.
        controller: name for `make_controller`.
        iterations: length of an episode; None is the suite's own.
    """

    optimizer: str
    controller: str
    iterations: int | None = None

    @property
    def options(self) -> dict[str, int]:
        """Options of the environment that differ from the suite's."""
        return {} if self.iterations is None else {"iterations": self.iterations}


def entrant(name: str, optimizer: str) -> Entrant:
    """Return the entrant of that name; `optimizer` is used where the name has none.

    Raises:
        UnknownNameError: if the name has an optimizer that does not exist.
        OwnCodeError: if the name has an optimizer of own code that cannot be imported.
    """
    parts = ControllerName.parse(name)
    if parts.optimizer is not None:
        if not is_own("optimizer", parts.optimizer):
            look_up(f"optimizer in {name!r}:", parts.optimizer, OPTIMIZERS)
        get_optimizer(parts.optimizer)
    return Entrant(parts.optimizer or optimizer, str(parts.controller), parts.iterations)
