"""The parameters of optimizers: declared once, read by name, chosen and replaced by name."""

from typing import Annotated, NamedTuple

import numpy as np
import pytest

from swarm_gym.compiler.named_tuples import named_row
from swarm_gym.optimizers import OPTIMIZERS, get_optimizer
from swarm_gym.optimizers.optimizer import Optimizer
from swarm_gym.optimizers.parameter import Parameter, declared_parameters, replaced

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


def test_new_values_replace_those_of_the_same_name_alone():
    parameters = np.array([[0.1, 1.0], [0.2, 2.0], [0.3, 3.0]])
    new = replaced(Two, parameters, {"speed": np.array([7.0, 8.0, 9.0])})
    assert new.tolist() == [[0.1, 7.0], [0.2, 8.0], [0.3, 9.0]]
    assert parameters[:, 1].tolist() == [1.0, 2.0, 3.0]
