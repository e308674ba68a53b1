"""Kinds of controllers that can be tuned, by name."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from swarm_gym.checks import look_up
from swarm_gym.errors import SettingError
from swarm_gym.tuning.config import TuneConfig, Tuner
from swarm_gym.tuning.evolution import OpenLoopTuner, ReactingLoopTuner
from swarm_gym.tuning.parameter_spaces import (
    DIVERSITY_LADDER,
    EARLY_RESTARTS,
    EVALUATION_REDUCTION,
    LINEAR_REDUCTION,
    NON_LINEAR_REDUCTION,
    PERIODIC,
    REACTION,
    RESTART,
    SCHEDULE,
    STATUS_MONITOR,
    ParameterSpace,
)
from swarm_gym.tuning.study import ParameterTuner

# Options that only some kinds have.
SPECIAL = (
    "action",
    "initial_population_size",
    "initial_smooth_share",
    "initial_amplitude",
    "start",
    "held",
    "knots",
    "candidates",
    "sigma",
)


@dataclass(frozen=True)
class ControllerKind:
    """A kind of controller that can be tuned.

    Attributes:
        make: function that makes the tuner of a configuration.
        options: names of the `SPECIAL` options that the kind has.
        defaults: options with other defaults than in `TuneConfig`.
    """

    make: Callable[[TuneConfig], Tuner]
    options: tuple[str, ...] = ()
    defaults: dict[str, object] = field(default_factory=dict)


def _parameters(space: ParameterSpace, **defaults: object) -> ControllerKind:
    return ControllerKind(partial(ParameterTuner, space=space), (), {"episodes": 48, **defaults})


TUNERS: dict[str, ControllerKind] = {
    "open-loop": ControllerKind(OpenLoopTuner, SPECIAL),
    "reacting-loop": ControllerKind(ReactingLoopTuner, SPECIAL),
    "constant": ControllerKind(OpenLoopTuner, tuple(set(SPECIAL) - {"knots"}), {"knots": (0,)}),
    "schedule": _parameters(SCHEDULE),
    "linear-reduction": _parameters(LINEAR_REDUCTION),
    "lpsr": _parameters(EVALUATION_REDUCTION),
    "nlpsr": _parameters(NON_LINEAR_REDUCTION),
    "diversity-ladder": _parameters(DIVERSITY_LADDER),
    "early-restarts": _parameters(EARLY_RESTARTS, optimizer="cma-es"),
    "restart": _parameters(RESTART),
    "periodic": _parameters(PERIODIC),
    "reaction": _parameters(REACTION),
    "status-monitor": _parameters(STATUS_MONITOR),
}


def kind_defaults(what: str) -> TuneConfig:
    """Return the options of a kind with their defaults.

    Raises:
        UnknownNameError: if there is no such kind.
    """
    defaults: dict[str, Any] = {"what": what, **look_up("kind to tune", what, TUNERS).defaults}
    return TuneConfig(**defaults)


def make_tuner(config: TuneConfig) -> Tuner:
    """Return the tuner of a configuration.

    Raises:
        UnknownNameError: for a kind, scenario or optimizer that does not exist.
        SettingError: for an option that the kind does not have, or an invalid value.
    """
    kind = look_up("kind to tune", config.what, TUNERS)
    defaults = kind_defaults(config.what)
    for name in SPECIAL:
        given, default = getattr(config, name), getattr(defaults, name)
        if name not in kind.options and given != default:
            raise SettingError(f"{name}: not an option of what {config.what!r}, got {given!r}")
    return kind.make(config)
