"""The parameters of optimizers: declared once, read by name, chosen by name."""

import math
from functools import partial
from typing import Annotated, NamedTuple

import pytest

from helpers.loops import looped
from helpers.refusals import refused
from swarm_gym.compiler.named_tuples import named_row
from swarm_gym.errors import SettingError
from swarm_gym.optimizers import OPTIMIZERS, get_optimizer
from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.optimizers.parameter import Parameter, declared_parameters

# Not printed: five tries and the pull of the origin of fish, the inertia factor of particle swarms.
PRINTED = {
    "firefly": {"noise": 2.0, "attractiveness": 0.1, "absorption": 5e-6},
    "generational-firefly": {
        "noise": 0.2, "attractiveness": 1.0, "absorption": 1.0, "least_attractiveness": 0.0,
    },
    "particle-swarm": {
        "first_inertia": 1.4, "last_inertia": 0.5, "inertia_factor": 1.0, "cognitive": 1.49445,
        "social": 1.49445, "velocity_limit": 0.2,
    },
    "elite-genetic": {"crossover": 0.2, "mutation": 0.01},
    "multivariate": {"radius": 20.0},
    "fish-swarm": {"visual": 0.3, "step": 0.1, "crowding": 0.6, "tries": 5.0},
    "improved-fish-swarm": {
        "visual": 0.3, "step": 0.1, "smallest_visual": 0.01, "smallest_step": 0.01, "first_beta": 0.9,
        "last_beta": 0.2, "crowding": 0.6, "tries": 5.0, "origin_pull": 0.0,
    },
    "hybrid-fish-swarm": {
        "visual": 0.3, "step": 0.1, "smallest_visual": 0.01, "smallest_step": 0.01, "crowding": 0.6,
        "tries": 5.0,
    },
}  # fmt: skip
NUMBERS = [
    (optimizer, name)
    for optimizer in OPTIMIZERS
    for name, parameter in get_optimizer(optimizer).parameters.items()
    if not parameter.choices
]

RATE = Parameter(0.5, 0.0, 1.0, "r", "rate")
SPEED = Parameter(2.0, 0.0, 9.0, "v", "speed")


class Two(NamedTuple):
    rate: Annotated[float, RATE]
    speed: Annotated[float, SPEED]


class Undeclared(NamedTuple):
    rate: Annotated[float, RATE]
    speed: float


def test_declarations_are_those_of_the_fields_in_order():
    assert list(declared_parameters(Two).items()) == [("rate", RATE), ("speed", SPEED)]


def test_a_field_without_a_declaration_is_refused_by_name():
    with pytest.raises(TypeError, match=r"Undeclared.speed must be Annotated\[float, Parameter"):
        declared_parameters(Undeclared)


def test_two_optimizers_cannot_have_a_class_of_parameters_of_the_same_name():
    taken = get_optimizer("firefly")
    with pytest.raises(AssertionError, match="class of parameters of its own"):
        type("Twin", (Optimizer,), {"parameter_class": taken.parameter_class, "kernels": taken.kernels})


@pytest.mark.parametrize("optimizer", OPTIMIZERS)
def test_rows_are_read_by_the_names_that_are_chosen(optimizer):
    cls = get_optimizer(optimizer)
    chosen = {name: each.high for name, each in cls.parameters.items() if not each.choices}
    last = list(chosen)[-1]
    parameters = cls.stacked_parameters({last: chosen[last]}, 3)
    expected = {**cls.defaults._asdict(), last: chosen[last]}
    assert named_row(cls.defaults, parameters, 2)._asdict() == expected
    assert list(expected) == list(cls.parameters)


@pytest.mark.parametrize("optimizer", PRINTED)
def test_the_defaults_are_the_printed_parameters(optimizer):
    cls = get_optimizer(optimizer)
    assert list(cls.parameters) == list(PRINTED[optimizer])
    assert cls.parameter_values({})._asdict() == PRINTED[optimizer]


@looped(("optimizer", "name"), NUMBERS)
def test_a_value_that_cannot_be_is_refused_with_its_name(optimizer, name):
    cls = get_optimizer(optimizer)
    low, high = cls.parameters[name].low, cls.parameters[name].high
    for value in (low - 1e-9, low - 0.5, 1.01 * high, math.nan, math.inf, "0.5", True):
        refused(partial(cls.parameter_values, {name: value}), name, repr(value), error=SettingError)
