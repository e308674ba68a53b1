"""The interface of controllers, which map observations of swarms to population sizes and repair degrees.

It also has the checks of controllers: the trial of own ones, and whether one fits episodes of another.
"""

import copy
from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, Self, TypedDict, cast

import numpy as np
from numpy.typing import NDArray

from swarm_gym.action import make_action
from swarm_gym.controllers.size_limits import SizeLimits
from swarm_gym.errors import SettingError, shown
from swarm_gym.features import THEORY
from swarm_gym.observation import ITERATION, make_observation
from swarm_gym.optimizers import get_optimizer
from swarm_gym.settings import Settings
from swarm_gym.sources import GUIDED, SMOOTH, Source

Floats = NDArray[np.float64]

NUM_SWARMS = 3  # of a trial
TRIAL_BITS = 100  # length of a bit string in a trial


class NeededOptions(TypedDict, total=False):
    """Options that the environment of a controller needs, as `SwarmEnv` has them."""

    observation: str
    action: str
    initial_population_size: int
    source: str
    smooth_share: float
    amplitude: float
    max_evaluations: int
    price: float
    min_population_size: int
    max_population_size: int
    made_for: str


class Controller(ABC):
    """A rule that decides for many swarms at once; decisions for a swarm do not depend on the others.

    Attributes:
        observation: name of the observation layout that `act` expects.
        action: name of the layout of the actions that `act` returns.
        initial_population_size: PS(0), an option of the environment.
        first_source: source of the first population, an option of the environment; None is the
            environment's own, which is uniform by default.
        max_evaluations: evaluation budget of an episode; None if the controller needs none.
        price: price of 100,000 evaluations; None if the controller does not observe it.
        corrects: controller whose decisions this one corrects, if any; `observation` begins with the layout
            of that controller.
        made_for: optimizer that it was tuned or trained on; None if it decides size and phi of any.
        needed_limits: population sizes that the environment has to allow, no more and no fewer; None is any.
        draws_numbers: whether decisions are drawn at random. Trainings with such a base or reference go on
            from whole chunks only.
    """

    observation: str = "paper"
    action: str = "natural"
    initial_population_size: int
    first_source: Source | None = None
    max_evaluations: int | None = None
    price: float | None = None
    corrects: "Controller | None" = None
    made_for: str | None = None
    needed_limits: SizeLimits | None = None
    draws_numbers: bool = False

    @abstractmethod
    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """Begin episodes of this many swarms; random decisions of swarm b are seeded with seed + b."""

    @abstractmethod
    def act(self, observations: NDArray) -> NDArray:
        """Return actions (num_swarms, number of decisions) in the layout `action`.

        Args:
            observations: shape (num_swarms, k), in the layout `observation`.
        """

    @abstractmethod
    def identity(self) -> object:
        """Return what this controller is: values by which two controllers that decide differently differ.

        They are parameters and the content of files, never numbers that are computed when it decides, which
        may have other last digits on another processor. Results databases and scores compare them.

        Returns:
            Lists, tuples, dictionaries by name, texts, numbers and None, which JSON can hold.
        """

    def stretched(self, factor: float) -> Self:
        """Return this controller for episodes of so many times the iterations and evaluations.

        An evaluation budget that it needs grows, and knots of open loops move.

        Args:
            factor: number of iterations of an episode, relative to the one that it was made for.
        """
        other = copy.copy(self)
        if self.max_evaluations is not None:
            other.max_evaluations = round(factor * self.max_evaluations)
        return other

    def env_options(self) -> NeededOptions:
        """Return the options that the environment of this controller needs."""
        options: NeededOptions = {
            "observation": self.observation,
            "action": self.action,
            "initial_population_size": self.initial_population_size,
        }
        if self.first_source is not None:
            options |= cast(NeededOptions, self.first_source.options())
        if self.max_evaluations is not None:
            options["max_evaluations"] = self.max_evaluations
        if self.price is not None:
            options["price"] = self.price
        if self.needed_limits is not None:
            options["min_population_size"] = self.needed_limits.smallest
            options["max_population_size"] = self.needed_limits.largest
        if self.made_for is not None:
            options["made_for"] = self.made_for
        return options

    def options_with(self, given: Mapping[str, object]) -> dict[str, object]:
        """Return options of an environment for this controller: given ones, and those that it needs.

        The needs of the controller replace what is given, with two exceptions. If the given source is guided,
        smooth members of the controller lie around planned ways. A given evaluation budget holds.

        Args:
            given: options of the environment by name.

        Raises:
            SettingError: if the controller asks for uniform members in a guided environment.
        """
        needed = beside_ways(given.get("source"), self.env_options())
        if given.get("max_evaluations") is not None:
            needed.pop("max_evaluations", None)
        return {**given, **needed}


class Wrapper(Controller):
    """A controller around another one, with the same environment; it changes observations or decisions.

    A subclass implements `identity`, and `act`, which is called once per iteration and asks `_controller`. A
    subclass that needs the iteration calls `_count` there, once.

    Args:
        controller: controller to wrap.
    """

    def __init__(self, controller: Controller):
        self._controller = controller
        self._iterations = np.array(-1)  # of all swarms, before the first decision
        self.observation = controller.observation
        self.action = controller.action
        self.initial_population_size = controller.initial_population_size
        self.first_source = controller.first_source
        self.max_evaluations = controller.max_evaluations
        self.price = controller.price
        self.corrects = controller.corrects
        self.made_for = controller.made_for
        self.needed_limits = controller.needed_limits
        self.draws_numbers = controller.draws_numbers

    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """Begin episodes."""
        self._iterations = np.full(num_swarms, -1)
        self._controller.reset(num_swarms, seed)

    def stretched(self, factor: float) -> Self:
        """Return a wrapper of the stretched controller, see `Controller.stretched`.

        Args:
            factor: number of iterations of an episode, relative to the one that it was made for.
        """
        other = super().stretched(factor)
        other._controller = self._controller.stretched(factor)
        other.corrects = other._controller.corrects
        return other

    def _count(self, observations: NDArray) -> NDArray[np.int64]:
        """Return (B,) the iterations of the swarms; iteration 0 in an observation begins an episode."""
        begins = observations[:, ITERATION] == 0
        self._iterations = np.where(begins, 0, self._iterations + 1)
        return self._iterations


def beside_ways(source: object, needed: Mapping[str, object]) -> dict[str, object]:
    """Return the options that a controller needs, in an environment with a source of new members.

    In a guided environment, smooth members lie around planned ways, also in a first population that a
    controller asks for.

    Args:
        source: source of the environment, a name in `swarm_gym.sources.SOURCES`.
        needed: options that the controller needs.

    Raises:
        SettingError: if the controller asks for uniform members in a guided environment.
    """
    if source != GUIDED or "source" not in needed:
        return dict(needed)
    if needed["source"] != SMOOTH:
        raise SettingError(
            f"source {GUIDED!r}: the controller begins with {needed['source']} members; choose another "
            "source, or a controller whose first smooth share is 1"
        )
    return {**needed, "source": GUIDED}


def require_fitting(controller: Controller, max_evaluations: int | None) -> None:
    """Raise an error if a controller cannot decide in episodes that were made for another one.

    Args:
        controller: controller that shall decide.
        max_evaluations: evaluation budget of these episodes; None is no budget.

    Raises:
        ValueError: if the controller needs another budget, or observes a price.
    """
    if controller.max_evaluations not in (None, max_evaluations):
        raise ValueError(
            f"it needs episodes with max_evaluations {controller.max_evaluations}, but these have "
            f"{max_evaluations or 'no budget'}"
        )
    if controller.price is not None:
        raise ValueError(f"it observes a price, {controller.price:g}, which these episodes need not have")


def in_iteration(seen: Floats, observation: str, iteration: int) -> Floats:
    """Set the iteration in observations of a trial, (B, k), and half of the bits; return them.

    Args:
        seen: observations, which are changed; features that the layout lacks are left out.
        observation: name of their layout.
        iteration: number of the iteration, from 0.
    """
    length, ones = (feature.name for feature in THEORY)
    for column, feature in enumerate(make_observation(observation).features):
        if feature.name == length:  # no bit string has a length of 0
            seen[:, column] = TRIAL_BITS
        elif feature.name == ones:
            seen[:, column] = TRIAL_BITS // 2
        elif column == ITERATION:
            seen[:, column] = iteration
    return seen


def require_trial(controller: object) -> None:
    """Raise an error if an object is no controller, or decides in another form than its layouts say.

    In a trial it decides for `NUM_SWARMS` swarms, in their first iteration and in the next one.

    Raises:
        ValueError: naming what was found and what was expected.
    """
    if not isinstance(controller, Controller):
        raise ValueError(f"expected a Controller of swarm_gym.controllers, got {shown(controller)}")
    size = getattr(controller, "initial_population_size", None)
    if not isinstance(size, int | np.integer) or isinstance(size, bool) or size < 1:
        raise ValueError(f"initial_population_size must be a positive integer, got {shown(size)}")
    optimizer = get_optimizer(controller.made_for or "firefly")
    least: Any = optimizer.default_options.get("min_population_size", SizeLimits().smallest)
    limits = controller.needed_limits or SizeLimits(least, max(int(size), SizeLimits().largest))
    settings = Settings(
        action=controller.action,
        initial_population_size=int(size),
        min_population_size=limits.smallest,
        max_population_size=limits.largest,
        max_evaluations=controller.max_evaluations,
    )
    space = make_action(settings, optimizer).space
    controller.reset(NUM_SWARMS, seed=0)
    for iteration in range(2):
        width = len(make_observation(controller.observation).features)
        seen = in_iteration(np.zeros((NUM_SWARMS, width)), controller.observation, iteration)
        try:
            decided = np.asarray(controller.act(seen))
        except Exception as error:  # somebody else's code may raise anything
            raise ValueError(f"act raised {error!r} for observations of shape {seen.shape}") from error
        expected = (NUM_SWARMS, *space.shape)
        if decided.shape != expected or decided.dtype.kind not in "fiu":
            raise ValueError(
                f"act must return numbers of shape {expected} for {NUM_SWARMS} swarms in the layout "
                f"{controller.action!r}, got {decided.dtype} of shape {decided.shape}"
            )
        if not np.isfinite(decided).all():
            raise ValueError(f"act must return finite numbers, got {shown(decided.tolist())}")
