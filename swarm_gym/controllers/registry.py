"""Controllers of population size and repair degree, made by name.

CONTRIBUTING.md lists the steps to add one.
"""

import os
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any, cast

from swarm_gym.controllers import onemax_rules, onemax_schedules
from swarm_gym.controllers.controller import Controller, SizeLimits, require_trial
from swarm_gym.controllers.distilled import load_rule
from swarm_gym.controllers.early_restarts import EarlyRestarts
from swarm_gym.controllers.fixed import Fixed, Random
from swarm_gym.controllers.immigrants import Periodic, Reaction, Restart
from swarm_gym.controllers.learned.networks import NETWORKS, FeedforwardController
from swarm_gym.controllers.learned.policy_file import PolicyFileError, load_policy, resolve
from swarm_gym.controllers.learned.together import Together, load_together
from swarm_gym.controllers.movement_rule import MovementSize
from swarm_gym.controllers.names import ControllerName
from swarm_gym.controllers.open_loop import load_open_loop
from swarm_gym.controllers.reacting_loop import load_reacting_loop
from swarm_gym.controllers.schedules import SelfAdaptiveSchedule
from swarm_gym.controllers.size_rules import (
    DiversityLadder,
    EvaluationReduction,
    IncreasingSize,
    LinearReduction,
    NonLinearReduction,
    StatusMonitor,
    TwoRegimes,
)
from swarm_gym.controllers.tuned import load_tuned
from swarm_gym.errors import shown
from swarm_gym.optimizers import get_optimizer
from swarm_gym.own_code import OwnCodeError, find, is_own, own, refuse_unless_given
from swarm_gym.settings import Settings

__all__ = [
    "CONTROLLERS", "Controller", "SizeLimits", "load_learned", "make_controller", "make_controller_for",
]  # fmt: skip

LIMITS = ("min_population_size", "max_population_size")  # options of environments


def make_controller(name: str | ControllerName, limits: SizeLimits | None = None) -> Controller:
    """Return a controller by its name, e.g. `fixed:60`, `spsfa-tip` or `learned:three-cases/0`.

    Parameters follow the name of a schedule or size rule: `spsfa-tip:growth=500,decay=0.1`,
    `linear-reduction:start=120`. The argument of `learned:`, `open-loop:`, `reacting-loop:`, `tuned:` and
    `distilled:` is the name of a packaged file or the path of a file. Policies of one recipe are called
    `learned:<preset>/<training seed>`; `learned:<policy>@0.3` sets the price of 100,000 evaluations that a
    policy observes. The policies of a recipe decide as one by `together:<preset>`.
    `swarm_gym.controllers.names` describes all parts of a name.
    A controller of your own is `module:attribute`, see `swarm_gym.own_code`.

    Args:
        name: the family, and after a colon its argument.
        limits: population sizes that the environment allows; by default those that a policy was trained with
            or a controller was tuned with, and for all others those that environments have by default.

    Raises:
        UnknownNameError: for an unknown family; the message lists the valid ones.
        OwnCodeError: for own code that cannot be imported, or does not give a controller that decides.
        ValueError: for an argument that the family cannot take.
        PolicyFileError: for a policy that is missing, damaged or made for something else.
    """
    parts = ControllerName.parse(str(name))
    if parts.optimizer is not None:
        raise ValueError(
            f"controller {shown(str(name))}: the optimizer {shown(parts.optimizer)} may only be named in a "
            f"suite; the controller is {shown(str(parts.controller))}"
        )
    if parts.family not in CONTROLLERS and os.path.isfile(str(name)):
        raise ValueError(
            f"controller {shown(str(name))} is a file; write learned:{name} for a policy, or open-loop:, "
            "tuned: or distilled: before the path"
        )
    if parts.family not in CONTROLLERS and is_own("controller", str(name)):
        return _own_controller(str(name))
    make = find("controller", parts.family, CONTROLLERS, callable, "a controller")
    if limits is None and parts.family in _WITH_LIMITS:
        return _WITH_LIMITS[parts.family](parts.argument)
    return make(parts.argument, limits or SizeLimits())


def make_controller_for(
    optimizer: str, name: str, options: Mapping[str, object] = MappingProxyType({})
) -> Controller:
    """Return a controller by its name, for the population sizes that an optimizer's environments allow.

    Policies and tuned controllers keep the sizes that they were made with.

    Args:
        optimizer: name of the optimizer.
        name: name for `make_controller`.
        options: options of the environments by name.

    Raises:
        UnknownNameError: for an unknown family or optimizer.
        ValueError: as in `make_controller`.
    """
    parts = ControllerName.parse(name)
    return make_controller(name, None if parts.family in _WITH_LIMITS else limits_of(optimizer, options))


def limits_of(optimizer: str, options: Mapping[str, object]) -> SizeLimits:
    """Return the population sizes that environments of an optimizer allow.

    Args:
        optimizer: name of the optimizer, whose defaults hold for what the options do not say.
        options: options of the environment by name.
    """
    chosen = {**get_optimizer(optimizer).default_options, **options}
    sizes: list[Any] = [chosen.get(name, getattr(Settings, name)) for name in LIMITS]
    return SizeLimits(*sizes)


def load_learned(policy: str | Path, limits: SizeLimits | None = None) -> FeedforwardController:
    """Return the controller of a packaged policy or of a policy file; `<policy>@<price>` sets its price.

    It needs the population sizes that it was trained with; other `limits` are refused.

    Raises:
        PolicyFileError: if the file is missing, damaged or made for something else.
    """
    name, price = ControllerName.of("learned", str(policy)), None
    is_file = os.path.isfile(policy)  # the path of a file may end in what looks like a price
    path = resolve(str(policy) if is_file else name.without_price.argument)
    if name.price is not None and not is_file:
        try:
            price = float(name.price)
        except ValueError as error:
            raise PolicyFileError(
                f"policy {shown(str(policy))}: {shown(name.price)} is not a price; expected a number after @"
            ) from error
    weights, manifest = load_policy(path)
    make_base = partial(_in_file, f"{path}: base")
    return NETWORKS[manifest["network"]](path, weights, manifest, limits, price, make_base)


def _together(argument: str, limits: SizeLimits | None = None) -> Together:
    """Return the controller whose action is the mean of those of several policies."""
    return load_together(argument, limits, load_learned)


def _own_controller(name: str) -> Controller:
    """Return the controller of own code, after a trial."""
    found = own("controller", name, callable, "a class or function that gives a Controller")
    make = cast(Callable[[], Controller], found)  # which a trial checks
    try:
        controller = make()
    except Exception as error:  # own code may raise anything
        raise OwnCodeError(f"controller {shown(name)}: {error!r} when called without arguments") from error
    try:
        require_trial(controller)
    except ValueError as error:
        raise OwnCodeError(f"controller {shown(name)}: {error}") from error
    return controller


def _no_argument(make: Callable[[SizeLimits], Controller]) -> Callable[[str, SizeLimits], Controller]:
    def checked(argument: str, limits: SizeLimits) -> Controller:
        if argument:
            raise ValueError(f"this controller takes no argument, got {shown(argument)}")
        return make(limits)

    return checked


def _tuned(argument: str, limits: SizeLimits | None = None) -> Controller:
    """Return the controller whose parameters were tuned, a schedule or a rule, from its file."""
    found = load_tuned(argument)
    return _in_file(f"tuned {argument}", found.controller, limits or found.limits)


def _in_file(where: str, name: str, limits: SizeLimits) -> Controller:
    """Return the controller that a file names, which never imports code."""
    if ControllerName.parse(name).family not in CONTROLLERS:
        refuse_unless_given("controller", name, where)
    return make_controller(name, limits)


# Family name to a function of the text after the colon and the size limits.
CONTROLLERS: dict[str, Callable[[str, SizeLimits], Controller]] = {
    "fixed": Fixed.from_argument,
    "spsfa": partial(SelfAdaptiveSchedule.from_argument, treats_infeasible_paths=False),
    "spsfa-tip": partial(SelfAdaptiveSchedule.from_argument, treats_infeasible_paths=True),
    "linear-reduction": LinearReduction.from_argument,
    "lpsr": EvaluationReduction.from_argument,
    "nlpsr": NonLinearReduction.from_argument,
    "diversity-ladder": DiversityLadder.from_argument,
    "status-monitor": StatusMonitor.from_argument,
    "ipop": IncreasingSize.from_argument,
    "bipop": TwoRegimes.from_argument,
    "psa": MovementSize.from_argument,
    "early-restarts": EarlyRestarts.from_argument,
    "restart": Restart.from_argument,
    "periodic": Periodic.from_argument,
    "reaction": Reaction.from_argument,
    "random": _no_argument(Random),
    "open-loop": load_open_loop,
    "reacting-loop": load_reacting_loop,
    "learned": load_learned,
    "together": _together,
    "tuned": _tuned,
    "distilled": load_rule,
    **{name: rule.from_argument for name, rule in onemax_rules.RULES.items()},
    "share": onemax_schedules.ShareSchedule.from_argument,
}
# Families whose files state the size limits that are used where none are given.
_WITH_LIMITS: dict[str, Callable[[str], Controller]] = {
    "learned": load_learned,
    "together": _together,
    "tuned": _tuned,
    "distilled": load_rule,
}
