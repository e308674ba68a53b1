"""What a suite compares: a controller, of the suite's optimizer or of one that its name begins with.

`spsfa-tip` is a controller; `multivariate+fixed:65` is the controller `fixed:65` of the optimizer
`multivariate`, and `multivariate(50)+fixed:65` the same in episodes of 50 iterations: where parameters follow
a schedule over the episode, its length makes another contestant.
"""

import re
from typing import NamedTuple

from swarm_gym.optimizers import OPTIMIZERS


class Contestant(NamedTuple):
    """Names of an optimizer and of a controller for it, and how many iterations where the suite's are not."""

    optimizer: str
    controller: str
    iterations: int | None = None

    @property
    def options(self) -> dict[str, int]:
        """Options of the environment that differ from the suite's."""
        return {} if self.iterations is None else {"iterations": self.iterations}


def contestant(name: str, optimizer: str) -> Contestant:
    """Take a name apart; `optimizer` is the one of names that begin with none."""
    match = re.fullmatch(r"([a-z-]+)(?:\(([1-9][0-9]*)\))?\+(.+)", name)
    if not match or match[1] not in OPTIMIZERS:
        return Contestant(optimizer, name)
    return Contestant(match[1], match[3], int(match[2]) if match[2] else None)
