"""Layouts for networks: what 0 and the bounds ask for, and that encoding undoes decoding."""

import numpy as np
import pytest

from swarm_gym.action import ACTIONS, make_action
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SettingError
from swarm_gym.optimizers import get_optimizer
from swarm_gym.scales import Centred, FourthPower, Kinked
from swarm_gym.settings import Settings

CENTRED = [name for name in ACTIONS if name.endswith("centred")]


def decided(action, numbers, **options):
    """Return size, phi and parameters that one action asks for, by the labels of the layout."""
    env = SwarmEnv(action=action, initial_population_size=8, iterations=2, **options)
    env.reset(seed=0)
    simulation = env.simulation
    layout = make_action(env.settings, get_optimizer("firefly"))
    chosen = np.ones(1, dtype=np.bool_)
    made = layout.decode(np.array([numbers], dtype=np.float32), chosen, simulation)
    fields = get_optimizer("firefly").parameter_class._fields
    parameters = dict(zip(fields, made.parameters[0], strict=True))
    return int(made.sizes[0]), float(made.repair_degrees[0]), parameters


@pytest.mark.parametrize(
    ("number", "size", "phi"), [(-1.0, 18, 0.0), (0.0, 60, 1 / 16), (0.5, 110, 81 / 256), (1.0, 200, 1.0)]
)
def test_a_centred_action_asks_for_powers_of_the_largest_size_and_few_repairs(number, size, phi):
    found = decided("centred", [number, number])
    assert found[0] == size == round(200 * 0.3 ** (1 - number))
    assert found[1] == pytest.approx(phi, abs=1e-12)


def test_zero_keeps_the_defaults_of_parameters():
    size, phi, parameters = decided("extended-centred", [0.0] * 4)
    assert (size, phi) == (60, 1 / 16)
    defaults = get_optimizer("firefly").defaults
    for name in get_optimizer("firefly").decided_parameters():
        assert parameters[name] == pytest.approx(getattr(defaults, name), rel=1e-12)


def test_zero_of_a_sourced_action_asks_for_few_members_most_of_them_smooth_and_some_immigrants():
    env = SwarmEnv(action="sourced-centred", iterations=2)
    env.reset(seed=0)
    layout = make_action(env.settings, get_optimizer("firefly"))
    zero = np.zeros((1, len(layout.labels)), dtype=np.float32)
    made = layout.decode(zero, np.ones(1, dtype=np.bool_), env.simulation)
    assert (made.sizes.tolist(), made.repair_degrees.tolist()) == ([20], [1 / 16])
    np.testing.assert_allclose(made.sources, [[0.9, 0.4, 0.3]], rtol=1e-12)


def test_small_ranges_of_sizes_are_kept():
    options = {"min_population_size": 5, "max_population_size": 12}
    assert [decided("centred", [a, 0.0], **options)[0] for a in (-1.0, 0.0, 1.0)] == [5, 5, 12]


@pytest.mark.parametrize("action", CENTRED)
def test_encoding_undoes_decoding(action):
    layout = make_action(Settings(action=action), get_optimizer("firefly"))
    numbers = np.random.default_rng(0).uniform(-1.0, 1.0, (200, len(layout.labels)))
    simulation = SwarmEnv(action=action, iterations=1).simulation
    for scale, column in zip(layout.scales, numbers.T, strict=True):
        values = scale.decode(column, simulation)
        np.testing.assert_allclose(scale.encode(values, None), column, rtol=0, atol=1e-9)
        assert (np.diff(scale.decode(np.sort(column), simulation)) > 0.0).all()


def test_values_beyond_the_ends_are_encoded_beyond_them():
    assert Centred(2.0, 60.0, 200.0).encode(np.array([1.0, 400.0]), None).tolist()[1] > 1.0
    assert FourthPower().encode(np.array([0.0, 1.0]), None).tolist() == [-1.0, 1.0]


@pytest.mark.parametrize("ends", [(0.0, 0.0, 1.0), (0.0, 1.0, 1.0), (0.0, 2.0, 1.0)])
def test_a_kink_at_or_beyond_an_end_is_refused(ends):
    with pytest.raises(SettingError, match="smallest < centre < largest"):
        Kinked(*ends)


@pytest.mark.parametrize("ends", [(0.0, 1.0, 2.0), (2.0, 1.0, 3.0), (1.0, 4.0, 3.0)])
def test_a_centre_outside_of_the_ends_is_refused(ends):
    with pytest.raises(SettingError, match="0 < smallest <= centre <= largest"):
        Centred(*ends)
