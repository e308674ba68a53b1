"""Simulations on tensors do what those on NumPy arrays do: decisions, states, observations and rewards."""

import copy
import sys

import numpy as np
import pytest
import torch

from helpers.layouts import OF_SWARMS, REWARDS_OF_SWARMS
from helpers.refusals import refused
from helpers.tensors import Follower, Questions, TensorSimulation
from swarm_gym.action import ACTIONS
from swarm_gym.arrays import Constant, applied, tensors, with_columns
from swarm_gym.batch import SwarmBatch
from swarm_gym.episode_seeds import draw_seeds
from swarm_gym.errors import ActionError, MissingExtraError, SettingError, StepOrderError
from swarm_gym.reward import NEED_ROBOTS
from swarm_gym.scenarios import Appear, Circle, DynamicScenario, Polygon, make_scenario
from swarm_gym.simulation import Simulation

NUM_SWARMS = 6
EVERYONE = np.ones(NUM_SWARMS, dtype=np.bool_)
BASE = make_scenario("case1")
CHANGING = DynamicScenario(
    "changing", BASE, [Appear(2, Circle(60, 570, 8)), Appear(4, Polygon.rectangle(560, 100, 640, 400))]
)
OPTIONS = {
    "scenario": [CHANGING, "case2"],
    "iterations": 7,
    "num_waypoints": 9,
    "initial_population_size": 6,
    "max_population_size": 12,
    "max_evaluations": 130,  # some episodes spend it, others end after all iterations
    "price": (0.1, 2.0),
    "reference_evaluations": 100,
}
# What torch computes with logarithms and powers differs from NumPy in the last bits.
CLOSE = {"rtol": 1e-12, "atol": 1e-13}
ROUNDED = {"rtol": 2e-6, "atol": 2e-7}


def pair(optimizer="firefly", **options):
    """Return a batch on tensors, and one on NumPy arrays that takes the decisions of the first."""
    options = {**OPTIONS, **options}
    ours = SwarmBatch(optimizer, options, NUM_SWARMS, 1, simulation_class=TensorSimulation)
    theirs = SwarmBatch(optimizer, options, NUM_SWARMS, 1, simulation_class=Follower)
    theirs.simulation.leader = ours.simulation
    return ours, theirs


def seeds(chosen=EVERYONE):
    """Return the seeds of episodes of the chosen swarms, (k, 8)."""
    return np.vstack([draw_seeds(np.random.default_rng(row), 1) for row in np.flatnonzero(chosen)])


def begin(ours, theirs, chosen=None):
    """Begin episodes of equal seeds in both batches."""
    chosen = EVERYONE if chosen is None else chosen
    ours.reset(torch.from_numpy(chosen), seeds(chosen), None)
    theirs.reset(chosen, seeds(chosen), None)


def actions_of(batch, rng, rows=NUM_SWARMS):
    """Return random valid actions, whose sizes are whole numbers if they are in members."""
    space = batch.action_space
    return rng.uniform(space.low, space.high, (rows, *space.shape)).astype(space.dtype)


def assert_same_state(ours, theirs):
    """All bits of the state agree, and so do the records."""
    one, other = ours.simulation, theirs.simulation
    for name, mine, theirs_ in zip(one.swarms._fields, one.swarms, other.swarms, strict=True):
        np.testing.assert_array_equal(mine.numpy(), theirs_.view(mine.numpy().dtype), err_msg=name)
    for name in ("iteration", "running", "history"):
        np.testing.assert_array_equal(getattr(one, name).numpy(), getattr(other, name), err_msg=name)
    np.testing.assert_array_equal(one.prices.of_reference.numpy(), other.prices.of_reference)
    np.testing.assert_allclose(one.gaps.initial.numpy(), other.gaps.initial, rtol=1e-15)


def episodes(ours, theirs, seed=0):
    """Run whole episodes in both; yield observations, rewards and endings of each step of both."""
    rng = np.random.default_rng(seed)
    begin(ours, theirs)
    yield ours.observe(), theirs.observe(), None, None
    while theirs.simulation.running.any():
        running, actions = theirs.simulation.running.copy(), actions_of(ours, rng)
        mine, ended = ours.step(ours.simulation.running.clone(), torch.from_numpy(actions))
        other, theirs_ended = theirs.step(running, actions)
        np.testing.assert_array_equal(ended.numpy(), theirs_ended)
        assert_same_state(ours, theirs)
        yield ours.observe(), theirs.observe(), mine, other


@pytest.mark.parametrize("layout", [*sorted(set(OF_SWARMS) - {"corridors"}), "paper+rich"])
def test_every_layout_sees_the_same_on_tensors(layout):
    ours, theirs = pair(observation=layout)
    assert ours.observation_space == theirs.observation_space
    # Before the first reset there is something to see, too.
    np.testing.assert_allclose(ours.observe().numpy(), theirs.observe(), **ROUNDED)
    exact, steps = layout == "paper", 0
    for seen, expected, _, _ in episodes(ours, theirs):
        assert isinstance(seen, torch.Tensor)
        assert seen.numpy().dtype == expected.dtype
        limits = CLOSE if expected.dtype == np.float64 else ROUNDED
        np.testing.assert_allclose(seen.numpy(), expected, **({"rtol": 0.0} if exact else limits))
        steps += 1
    assert steps > 4
    assert (theirs.simulation.swarms.problem > 0).any()  # events have happened
    assert len(set(theirs.simulation.iteration.tolist())) > 1  # budgets have ended some of the episodes


@pytest.mark.parametrize("layout", ACTIONS)
def test_every_layout_decides_the_same_on_tensors(layout):
    ours, theirs = pair(action=layout)
    before = theirs.simulation.parameters.copy(), theirs.simulation.sources.copy()
    for _, _, mine, expected in episodes(ours, theirs):
        if mine is not None:
            np.testing.assert_allclose(mine.numpy(), expected, **CLOSE)
    decided = ours.simulation.decided
    assert decided.sizes.dtype == torch.int64
    assert decided.parameters.shape == before[0].shape
    # Decisions leave the settings of the simulation as they are.
    np.testing.assert_array_equal(ours.simulation.parameters.numpy(), before[0])
    np.testing.assert_array_equal(ours.simulation.sources.numpy(), before[1])


@pytest.mark.parametrize("reward", [name for name in REWARDS_OF_SWARMS if name not in NEED_ROBOTS])
def test_every_reward_pays_the_same_on_tensors(reward):
    # The optima of the paper's cases with 31 waypoints come with the package.
    ours, theirs = pair(reward=reward, scenario=["case1", "case2"], num_waypoints=31)
    exact = reward in ("optimality", "offline-error")
    paid = 0.0
    for _, _, mine, expected in episodes(ours, theirs):
        if mine is not None:
            np.testing.assert_allclose(mine.numpy(), expected, **({"rtol": 0.0} if exact else CLOSE))
            paid += np.abs(expected).sum()
    assert paid > 0.0


@pytest.mark.parametrize("optimizer", ["particle-swarm", "ant-colony"])
def test_infos_are_numpy_arrays_with_the_same_content(optimizer):
    encoding = {"encoding": "walk", "cell_size": 20.0} if optimizer == "ant-colony" else {"num_waypoints": 9}
    options = {name: value for name, value in OPTIONS.items() if name != "num_waypoints"}
    ours, theirs = (
        SwarmBatch(
            optimizer, {**options, **encoding, "final_repair": True}, NUM_SWARMS, 1, simulation_class=kind
        )
        for kind in (TensorSimulation, Follower)
    )
    theirs.simulation.leader = ours.simulation
    for _ in episodes(ours, theirs):
        found, expected = ours.info(), theirs.info()
        assert list(found) == list(expected)
        for name, values in expected.items():
            assert isinstance(found[name], np.ndarray)
            np.testing.assert_array_equal(found[name], values, err_msg=name)
        for name, values in ours.numbers().items():
            assert isinstance(values, torch.Tensor)
            np.testing.assert_array_equal(values.numpy(), expected[name], err_msg=name)
    assert np.isfinite(expected["repaired_length"]).any()


def test_some_swarms_may_begin_again_and_others_rest():
    ours, theirs = pair(observation="jumps")
    begin(ours, theirs)
    rng, some = np.random.default_rng(1), np.arange(NUM_SWARMS) % 2 == 0
    for chosen in (some, ~some, some):
        actions = actions_of(ours, rng)
        actions[~chosen] = np.nan  # actions of resting swarms are not read
        mine, _ = ours.step(torch.from_numpy(chosen), torch.from_numpy(actions))
        other, _ = theirs.step(chosen, actions)
        assert (other[~chosen] == 0.0).all()
        np.testing.assert_allclose(mine.numpy(), other, **CLOSE)
        assert_same_state(ours, theirs)
    begin(ours, theirs, ~some)
    assert ours.simulation.iteration.tolist() == [2, 0] * 3
    assert_same_state(ours, theirs)


def test_first_populations_may_be_given():
    ours, theirs = pair()
    population = np.random.default_rng(2).uniform(-50.0, 50.0, (5, 9))
    everyone = EVERYONE
    for batch in (ours, theirs):
        batch.reset(everyone, seeds(), {"initial_population": population})
        for row in range(NUM_SWARMS):
            np.testing.assert_array_equal(batch.simulation.positions(row), population)
    assert_same_state(ours, theirs)


def test_rows_are_copied_alike():
    ours, theirs = pair()
    begin(ours, theirs)
    rows = np.array([3, 3, 0, 1, 5, 5])
    for batch, numbers in ((ours, torch.from_numpy(rows)), (theirs, rows)):
        batch.simulation.copy_rows(numbers)
    assert_same_state(ours, theirs)
    assert ours.simulation.swarms.stream[0].equal(ours.simulation.swarms.stream[1])


@pytest.mark.parametrize(
    "number", [np.nan, np.inf, -1.0, 12.5, 1e300], ids=["nan", "inf", "small", "large", "huge"]
)
def test_invalid_actions_on_tensors_get_the_same_message(number):
    ours, theirs = pair()
    begin(ours, theirs)
    actions = actions_of(ours, np.random.default_rng(0))
    actions[4, 0] = number
    everyone = EVERYONE
    expected = message(lambda: theirs.step(everyone, actions))
    assert "swarm 4" in expected
    assert message(lambda: ours.step(torch.from_numpy(everyone), torch.from_numpy(actions))) == expected
    assert message(lambda: ours.step(torch.from_numpy(everyone), actions)) == expected  # a NumPy array
    assert (
        message(lambda: ours._action.decode(actions, torch.from_numpy(everyone), ours.simulation)) == expected
    )
    assert ours.simulation.iteration.tolist() == [0] * NUM_SWARMS


def test_actions_of_another_shape_or_type_get_the_same_message():
    ours, theirs = pair()
    begin(ours, theirs)
    everyone = EVERYONE
    for actions in (np.ones((NUM_SWARMS, 3)), np.ones((2, 2)), np.ones(2)):
        expected = message(lambda actions=actions: theirs.step(everyone, actions))
        found = message(lambda a=actions: ours.step(torch.from_numpy(everyone), torch.from_numpy(a)))
        assert found == expected
    flags = np.ones((NUM_SWARMS, 2), dtype=np.bool_)
    for given in (flags, torch.from_numpy(flags), "left", torch.ones((6, 2), dtype=torch.complex64)):
        found = message(lambda given=given: ours.step(torch.from_numpy(everyone), given))
        assert "must be numbers, got" in found
    assert "got bool (" in message(lambda: ours.step(torch.from_numpy(everyone), torch.from_numpy(flags)))


def message(call):
    with pytest.raises(ActionError) as caught:
        call()
    return str(caught.value)


def test_integers_and_single_precision_are_actions_on_tensors_too():
    everyone = torch.from_numpy(EVERYONE)
    for dtype in (torch.int32, torch.float32):
        ours, _ = pair()
        ours.reset(everyone, seeds(), None)
        ours.step(everyone, torch.tensor([[7, 1]] * NUM_SWARMS, dtype=dtype))
        assert ours.simulation.swarms.size.tolist() == [7] * NUM_SWARMS


def test_a_step_out_of_order_is_refused_on_tensors():
    ours, theirs = pair(iterations=5)
    everyone = torch.from_numpy(EVERYONE)
    for actions in (np.full((NUM_SWARMS, 2), 5.0), np.ones(3)):  # even with an action of another shape
        with pytest.raises(StepOrderError, match="swarm 0: there was no reset"):
            ours.step(everyone, actions)
    for _ in episodes(ours, theirs):
        pass
    with pytest.raises(StepOrderError, match="swarm 0: the episode has ended"):
        ours.step(everyone, np.full((NUM_SWARMS, 2), 5.0))


@pytest.mark.parametrize("action", ["natural", "sourced-paced"])
@pytest.mark.parametrize("observation", ["paper+rich", "jumps+told+named"])
def test_a_step_asks_once_for_the_value_of_a_tensor(action, observation):
    ours, theirs = pair(action=action, observation=observation)
    begin(ours, theirs)
    everyone = torch.from_numpy(EVERYONE)
    ours.observe()
    for _ in range(3):  # an event follows the second iteration
        actions = torch.from_numpy(actions_of(ours, np.random.default_rng(0)))
        with Questions() as questions:
            ours.step(everyone, actions)
            ours.observe()
            ours.numbers()
        assert questions.asked == ["aten::_local_scalar_dense"], questions.asked
    with Questions() as questions:
        ours.info()
        assert bool(everyone[everyone].all())
    assert {"aten::_local_scalar_dense", "aten::index.Tensor"} <= set(questions.asked)


def test_what_tensors_cannot_do_is_refused():
    refused(
        lambda: pair(observation="paper+corridors"), "'paper+corridors'", "on tensors", error=SettingError
    )
    name = "dynamic:rooms:0-drive@4,every=5,distance=8"
    options = {"scenario": name, "encoding": "bezier"}
    refused(
        lambda: SwarmBatch("firefly", options, 2, simulation_class=TensorSimulation),
        repr(name),
        "drive",
        "on tensors",
        error=SettingError,
    )


def test_a_copy_of_a_batch_goes_its_own_way():
    for kind, everyone in ((TensorSimulation, torch.from_numpy(EVERYONE)), (Simulation, EVERYONE)):
        batch = SwarmBatch("firefly", OPTIONS, NUM_SWARMS, 1, simulation_class=kind)
        batch.reset(everyone, seeds(), None)
        twin = copy.deepcopy(batch)
        twin.step(everyone, np.tile([5.0, 0.5], (NUM_SWARMS, 1)))
        assert twin.simulation.iteration.tolist() == [1] * NUM_SWARMS
        assert batch.simulation.iteration.tolist() == [0] * NUM_SWARMS


def test_functions_of_numpy_apply_to_tensors():
    numbers = torch.tensor([0.5, 2.0], dtype=torch.float64)

    def size(evaluations):
        return np.maximum((1.0 + np.sqrt(evaluations * 8.0)) / 2.0 - 0.25, 2.0 ** np.floor(evaluations))

    found = applied(size, tensors(), numbers)
    assert isinstance(found, torch.Tensor)
    assert found.tolist() == size(numbers.numpy()).tolist()
    with pytest.raises(TypeError, match="spacing"):
        applied(np.spacing, tensors(), numbers)


def test_constants_are_placed_once_for_each_device():
    values = np.arange(3.0)
    constant = Constant(values)
    first = constant.on(tensors(), "cpu")
    assert first is constant.on(tensors(), "cpu")
    assert constant.on(np, "cpu") is values
    assert first.tolist() == [0.0, 1.0, 2.0]


def test_a_missing_library_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "array_api_compat", None)
    refused(tensors, "on tensors", "array-api-compat", "swarm_gym[gpu]", error=MissingExtraError)


def test_columns_are_replaced_in_a_copy_alone():
    array = np.array([[0.1, 1.0], [0.2, 2.0]])
    new = with_columns(np, array, {1: np.array([7.0, 8.0])})
    assert new.tolist() == [[0.1, 7.0], [0.2, 8.0]]
    assert array[:, 1].tolist() == [1.0, 2.0]
