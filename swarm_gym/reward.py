"""Rewards: what a controller is paid for one iteration.

| name | reward of one iteration |
|---|---|
| `progress` | log(gap before / gap after) - cost |
| `final` | log(initial gap / final gap) at the end, minus the cost of every step |
| `final-gap` | -log(final gap) at the end, minus the cost of every step |
| `optimality` | -100 * optimality gap at the end, minus the cost of every step |
| `anytime` | -log10(gap, at least 1e-8) times the share of the budget that the iteration spent |
| `anytime-and-end` | `anytime`, and -log10(gap, at least 1e-8) once more at the end of the episode |
| `offline-error` | -100 * optimality gap, averaged since the first event, minus the cost of every step |
| `detour` | -100 * detour of a robot at the end, minus the cost of every step |
| `runtime` | -evaluations of the iteration / length of the bit string |

The gap is the best fitness so far minus a lower bound that is always known. On analytic maps the bound is mu
times the straight line from start to target. On grid maps and for walks it is the straight line, and for test
functions it is 0. The cost is price * evaluations / reference_evaluations. The optimality gap is (best
fitness - optimum) / optimum, see `swarm_gym.reference`. The detour is (driven length - shortest way) /
shortest way. The shortest way leads from start to target on the map after all events.

Over an episode, the sum of `anytime` is minus the mean of log10(gap) over the evaluations of the budget. The
first population counts with its own gap. If an episode stops early, the rest of the budget counts with the
last gap.

A reward of own code has to be an array of B finite numbers. Its shape is checked in every step, and so is
that it is finite, on a GPU in the first step only: later the answer would wait for the GPU.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from swarm_gym.arrays import Namespace, as_numpy, at_least, floats
from swarm_gym.compiler.elementary import log
from swarm_gym.errors import shown
from swarm_gym.features import LOG_TEN
from swarm_gym.own_code import OwnCodeError, find
from swarm_gym.simulation import Simulation

Floats = NDArray[np.float64]

LARGEST_DETOUR = 1.0  # that the reward `detour` counts
LEAST_GAP = 1e-8  # that the reward `anytime` tells from a smaller one


class Transition(NamedTuple):
    """One iteration of B swarms; every array has shape (B,).

    Attributes:
        initial_gap: gap of the first population, as if the map had always been the present one.
        gap_before: gap before the iteration.
        gap_after: gap after the iteration, before any event on the map.
        cost: price of the evaluations of the iteration.
        ended: whether the episode ended with the iteration.
        offline_weight: share of the iteration in averages over all iterations since the first event on the
            map, or since the beginning where there is none; 0 before the event.
        optimality_gap: function that returns the optimality gaps (B,); rewards that do not need them never
            call it.
        evaluations: evaluations of the iteration.
        lengths: function that returns the lengths (B,) of bit strings; only the reward `runtime` calls it.
        detour: function that returns the detours (B,) of robots that drive, infinite for those that are not
            at the target; rewards that do not need them never call it.
        budget_shares: function that returns two arrays (B,), the shares of the evaluation budget that the
            reward of this iteration counts with the gap of the first population and with the gap after it;
            only the rewards `anytime` and `anytime-and-end` call it.
        xp: namespace of the arrays, whose functions rewards use: the module `numpy` or one of tensors, see
            `swarm_gym.arrays`.
    """

    initial_gap: Floats
    gap_before: Floats
    gap_after: Floats
    cost: Floats
    ended: NDArray[np.bool_]
    offline_weight: Floats
    optimality_gap: Callable[[], Floats]
    detour: Callable[[], Floats]
    evaluations: NDArray[np.int64]
    lengths: Callable[[], Floats]
    budget_shares: Callable[[], tuple[Floats, Floats]]
    xp: Namespace = np


Reward = Callable[[Transition], Floats]


def progress(transition: Transition) -> Floats:
    """Return log(gap before / gap after) - cost: progress on a logarithmic scale minus the price paid."""
    xp = transition.xp
    return log(transition.gap_before / transition.gap_after, xp) - transition.cost


def final(transition: Transition) -> Floats:
    """Return log(initial gap / final gap) at the end and 0 before it, minus the cost of every step.

    Over an episode the sum equals the sum of `progress`.
    """
    xp = transition.xp
    gain = log(transition.initial_gap / transition.gap_after, xp)
    return xp.where(transition.ended, gain, 0.0) - transition.cost


def optimality(transition: Transition) -> Floats:
    """Return minus the optimality gap in percent at the end and 0 before it, minus the cost of every step.

    This is the measure that studies report. Unlike a logarithm, it weighs a rare failure by its size. For a
    test function it is a hundred times the best value.
    """
    percent = -100.0 * transition.optimality_gap()
    return transition.xp.where(transition.ended, percent, 0.0) - transition.cost


def offline_error(transition: Transition) -> Floats:
    """Return minus the optimality gap in percent on the map in force, averaged since the first event.

    Over an episode the sum is minus the offline error, minus the cost of every step. The gap is measured at
    the best path so far on the map after the events of the iteration. Where there is no event, the average is
    over all iterations.

    Source: J. Branke, "Memory enhanced evolutionary algorithms for changing optimization problems", CEC 1999,
    which averages over evaluations.
    """
    return -100.0 * transition.optimality_gap() * transition.offline_weight - transition.cost


def anytime(transition: Transition) -> Floats:
    """Return -log10(gap, at least 1e-8) times the share of the budget that the iteration spent.

    Over an episode the sum is minus the mean of log10(gap) over the budget, see above. Evaluations have no
    other price.
    """
    first, later = transition.budget_shares()
    xp = transition.xp
    gaps = (at_least(xp, gap, LEAST_GAP) for gap in (transition.initial_gap, transition.gap_after))
    before, now = (log(gap, xp) / LOG_TEN for gap in gaps)
    return -(first * before + later * now)


def anytime_and_end(transition: Transition) -> Floats:
    """Return the reward `anytime`, and -log10(gap, at least 1e-8) once more at the end of the episode.

    Over an episode the sum is minus the mean of log10(gap) over the budget, minus log10 of the final gap.
    Evaluations have no other price.
    """
    xp = transition.xp
    end = log(at_least(xp, transition.gap_after, LEAST_GAP), xp) / LOG_TEN
    return anytime(transition) - xp.where(transition.ended, end, 0.0)


def detour(transition: Transition) -> Floats:
    """Return minus the detour of a robot in percent at the end and 0 before it, minus the cost of every step.

    A robot that does not arrive counts as one that drives twice the shortest way. So does one that drives
    farther than that.
    """
    xp = transition.xp
    percent = -100.0 * xp.minimum(transition.detour(), LARGEST_DETOUR)
    return xp.where(transition.ended, percent, 0.0) - transition.cost


def runtime(transition: Transition) -> Floats:
    """Return minus the evaluations of the iteration, relative to the length of the bit string.

    Over an episode that finds the optimum, the sum is minus the runtime, whose optimum is known on OneMax. It
    is between 5 and 7 lengths for good controllers.
    """
    return -transition.evaluations / transition.lengths()


def final_gap(transition: Transition) -> Floats:
    """Return -log(final gap) at the end and 0 before it, minus the cost of every step.

    Gaps are in map units, so rewards of several episodes on one scenario are comparable.
    """
    xp = transition.xp
    return xp.where(transition.ended, -log(transition.gap_after, xp), 0.0) - transition.cost


def offline_weight(simulation: Simulation) -> Floats:
    """Return (B,) share of the last iteration in averages since the first event, see `Transition`.

    An episode that ends early, for lack of a budget, stays as it is: its last iteration has the weight of
    those that are left out.
    """
    xp, length = simulation.xp, simulation.settings.iterations
    first = at_least(xp, simulation.worlds.first_event[simulation.swarms.problem], 1)
    left = length - xp.maximum(simulation.iteration, first) + 1
    share = xp.where(simulation.running, simulation.iteration >= first, left)
    return floats(xp, share) / (length - first + 1)


def budget_shares(
    simulation: Simulation, spent: NDArray[np.int64], ended: NDArray[np.bool_]
) -> tuple[Floats, Floats]:
    """Return (B,) two shares of the evaluation budget, see `Transition`.

    Args:
        simulation: swarms after the iteration, with a budget.
        spent: (B,) evaluations of the iteration.
        ended: (B,) whether the episode ended with it.
    """
    xp, budget = simulation.xp, simulation.settings.max_evaluations
    assert budget is not None
    evaluations = simulation.swarms.evaluations
    first = xp.where(simulation.iteration == 1, evaluations - spent, 0)
    later = spent + xp.where(ended, at_least(xp, budget - evaluations, 0), 0)
    return floats(xp, first) / budget, floats(xp, later) / budget


REWARDS: dict[str, Reward] = {
    "progress": progress,
    "final": final,
    "final-gap": final_gap,
    "optimality": optimality,
    "anytime": anytime,
    "anytime-and-end": anytime_and_end,
    "offline-error": offline_error,
    "detour": detour,
    "runtime": runtime,
}
# Rewards that need a scenario whose optimum is known.
NEED_AN_OPTIMUM = ("optimality", "offline-error")
# Rewards that need robots that drive in all scenarios.
NEED_ROBOTS = ("detour",)
# Rewards that need the weights of iterations, as those of own code may; for the others, these are 0.
NEED_WEIGHTS = ("offline-error",)
# Rewards that read neither gaps nor costs, which are not computed for them.
COUNT_EVALUATIONS = ("runtime",)
# Rewards that need bit strings.
NEED_BITS = ("runtime",)
# Rewards that need a budget of evaluations.
NEED_A_BUDGET = ("anytime", "anytime-and-end")


def make_reward(name: str) -> Reward:
    """Return the reward function of a name, which may be one of own code.

    Raises:
        UnknownNameError: if there is no reward of that name.
        OwnCodeError: if own code cannot be imported, or is no function.
    """
    return find("reward", name, REWARDS, callable, "a function of a Transition")


class RewardCheck:
    """A check of the rewards of own code, step by step, whose errors name the reward.

    Args:
        name: name of the reward.
    """

    def __init__(self, name: str):
        self._name = name
        self._begun = False

    def check_shape(self, reward: object, num_swarms: int) -> None:
        """Raise an error if a reward is no array of numbers with one for each swarm.

        Raises:
            OwnCodeError: with the shape and what was expected.
        """
        shape = getattr(reward, "shape", None)
        if shape is None or tuple(shape) != (num_swarms,):
            found = shown(reward) if shape is None else f"an array of shape {tuple(shape)}"
            raise OwnCodeError(
                f"reward {self._name!r} must return an array of shape ({num_swarms},), one number for each "
                f"swarm, got {found}"
            )
        if isinstance(reward, np.ndarray) and reward.dtype.kind not in "biuf":
            raise OwnCodeError(f"reward {self._name!r} must return numbers, got the type {reward.dtype}")

    def check_numbers(self, paid: Floats, iterations: NDArray[np.int64], xp: Namespace) -> None:
        """Raise an error if a swarm is paid what is no finite number.

        Args:
            paid: (B,) rewards, 0 for swarms that took no step.
            iterations: (B,) iterations that the swarms have made.
            xp: namespace of the rewards.

        Raises:
            OwnCodeError: naming the first such swarm, its iteration and the value.
        """
        if self._begun and xp is not np:
            return
        self._begun = True
        # The sum is quicker to check than every number, and not finite if one of them is not.
        if math.isfinite(paid.sum()):
            return
        swarms = np.flatnonzero(~np.isfinite(as_numpy(paid)))
        if swarms.size:
            swarm = int(swarms[0])
            raise OwnCodeError(
                f"reward {self._name!r} of swarm {swarm} in iteration {int(iterations[swarm])} is "
                f"{float(paid[swarm])}, expected a finite number"
            )
