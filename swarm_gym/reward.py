"""Rewards: what a controller is paid for one iteration.

The gap is the best fitness so far above a lower bound that is always known: mu times the straight line from
start to target; on grid maps the straight line; of test functions 0.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.checks import look_up

Floats = NDArray[np.float64]


class Transition(NamedTuple):
    """One iteration of B swarms; every array has shape (B,)."""

    initial_gap: Floats  # as if the map had been what it is when the iteration is done
    gap_before: Floats
    gap_after: Floats  # before anything happens on the map
    cost: Floats  # price of the evaluations spent
    ended: NDArray[np.bool_]
    # Best fitness so far above the known optimum, relative to it; called by the reward that needs it.
    optimality_gap: Callable[[], Floats]


Reward = Callable[[Transition], Floats]


def progress(transition: Transition) -> Floats:
    """log(gap before / gap after) - cost: progress on a logarithmic scale minus the price paid."""
    return np.log(transition.gap_before / transition.gap_after) - transition.cost


def final(transition: Transition) -> Floats:
    """The same sum paid at the end: log(initial gap / final gap) then, minus the cost at every step."""
    gain = np.log(transition.initial_gap / transition.gap_after)
    return np.where(transition.ended, gain, 0.0) - transition.cost


def optimality(transition: Transition) -> Floats:
    """The optimality gap in percent, paid at the end with a minus, minus the cost at every step.

    What studies report; unlike the logarithm it counts the rare run that fails by how far it fails. Of a test
    function it is a hundred times the best value.
    """
    return np.where(transition.ended, -100.0 * transition.optimality_gap(), 0.0) - transition.cost


def final_gap(transition: Transition) -> Floats:
    """-log(final gap) at the end, gaps in map units, minus the cost at every step: comparable to others'."""
    return np.where(transition.ended, -np.log(transition.gap_after), 0.0) - transition.cost


REWARDS: dict[str, Reward] = {
    "progress": progress,
    "final": final,
    "final-gap": final_gap,
    "optimality": optimality,
}
# Rewards that only scenarios with a known optimum have.
NEED_AN_OPTIMUM = ("optimality",)


def make_reward(name: str) -> Reward:
    """The reward function of that name.

    Raises:
        UnknownNameError: if there is none.
    """
    return look_up("reward", name, REWARDS)
