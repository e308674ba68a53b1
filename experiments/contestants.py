"""What a suite compares: a controller, of the suite's optimizer or of one that its name begins with.

`spsfa-tip` is a controller; `multivariate+fixed:65` is the controller `fixed:65` of the optimizer
`multivariate`.
"""

from typing import NamedTuple

from swarm_gym.optimizers import OPTIMIZERS


class Contestant(NamedTuple):
    """Names of an optimizer and of a controller for it."""

    optimizer: str
    controller: str


def contestant(name: str, optimizer: str) -> Contestant:
    """Take a name apart; `optimizer` is the one of names that begin with none."""
    first, plus, rest = name.partition("+")
    return Contestant(first, rest) if plus and first in OPTIMIZERS else Contestant(optimizer, name)
