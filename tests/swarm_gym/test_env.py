"""The single environment: contract, interface and errors."""

import warnings
from itertools import product

import gymnasium
import numpy as np
import pytest
import shapely
from gymnasium.utils.env_checker import check_env
from stable_baselines3.common.env_checker import check_env as check_env_for_sb3

import swarm_gym  # noqa: F401
from helpers.builders import is_walker
from helpers.layouts import OF_SWARMS
from helpers.loops import named_case
from swarm_gym.action import ACTIONS, make_action
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import ActionError, SettingError, StepOrderError, UnknownNameError
from swarm_gym.observation import OBSERVATIONS
from swarm_gym.optimizers import OPTIMIZERS
from swarm_gym.optimizers.firefly import Firefly
from swarm_gym.reference import shortest_path
from swarm_gym.registration import environment_id
from swarm_gym.scenarios import (
    Circle,
    GridMap,
    GridScenario,
    Scenario,
    make_scenario,
    sample_names,
    worlds_of,
)
from swarm_gym.settings import Settings

IDS = [environment_id(optimizer) for optimizer in OPTIMIZERS]
WALKING = [environment_id(optimizer) for optimizer in OPTIMIZERS if is_walker(optimizer)]
SMALL = {"initial_population_size": 6, "max_population_size": 12, "iterations": 5}
SCALED_ACTIONS = [name for name in ACTIONS if name not in ("natural", "extended", "sourced")]
# Two warnings of Gymnasium's checker that natural units and exact schedules cause on purpose.
ADVICE = ("symmetric and normalized", "recommend using np.float32", "precision lowered")


def small(**options):
    return SwarmEnv(**{**SMALL, **options})


def finish(env, action=(6, 0.5)):
    ended, rewards = False, []
    while not ended:
        _, reward, ended, _, info = env.step(np.array(action))
        rewards.append(reward)
    return info, rewards


def begun(*choices, seed=9):
    """Return environments with the same first population."""
    envs = [small(**options) for options in choices]
    for env in envs:
        env.reset(seed=seed)
    return envs


def can_have(name, action):
    """Return whether an environment can have an action layout; points of walks have one source only."""
    return "sourced" not in action or name not in WALKING


def combinations():
    """Return all actions and observations with one optimizer, and each of them with the others.

    Walkers refuse the layout `corridors`.
    """
    return [
        (name, action, observation)
        for name, action, observation in product(IDS, ACTIONS, OF_SWARMS)
        if ("/Firefly" in name or action == "natural" or observation == "paper") and can_have(name, action)
        if observation != "corridors" or name not in WALKING
    ]


def few_combinations():
    """Return each layout of an action and of an observation once, and every optimizer with two layouts."""
    first = environment_id("firefly")
    chosen = {
        *((first, action, "scaled") for action in ACTIONS),
        *((first, "extended", o) for o in OF_SWARMS),
    }
    chosen |= {(name, "natural", "paper") for name in IDS} | {(name, "normalised", "paper") for name in IDS}
    return [one for one in combinations() if one in chosen]


def assert_checked(check, name, action, observation, **options):
    """Check an environment; only those that are not scaled get advice, and nothing else is warned of."""
    env = gymnasium.make(name, **SMALL, action=action, observation=observation, max_evaluations=10_000)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        check(env.unwrapped, **options)
    advice = () if action in SCALED_ACTIONS and observation != "paper" else ADVICE
    assert [str(w.message) for w in caught if not any(a in str(w.message) for a in advice)] == []


@pytest.mark.parametrize("chosen", [few_combinations, pytest.param(combinations, marks=pytest.mark.slow)])
def test_gymnasium_checker_passes_with_nothing_but_advice(chosen):
    for name, action, observation in chosen():
        # Pictures show neither actions nor observations: once for each optimizer is enough.
        skipped = (action, observation) != ("natural", "paper")
        with named_case(f"{name}, {action}, {observation}"):
            assert_checked(check_env, name, action, observation, skip_render_check=skipped)


@pytest.mark.parametrize("names", [IDS[:1], pytest.param(IDS, marks=pytest.mark.slow)], ids=["first", "all"])
def test_stable_baselines3_checker_passes(names):
    for action, name in product(ACTIONS, names):
        if can_have(name, action):
            with named_case(f"{name}, {action}"):
                assert_checked(check_env_for_sb3, name, action, "extended")


# Fireflies on functions of BBOB need kernels that no other test compiles.
@pytest.mark.parametrize(
    "scenario",
    [pytest.param(name, marks=pytest.mark.slow if ":bbob-" in name else ()) for name in sample_names()],
)
def test_an_episode_has_g_max_steps_and_ends_terminated(scenario):
    length = max(5, *(world.iteration + 1 for world in worlds_of(make_scenario(scenario))))
    env = small(scenario=scenario, iterations=length)
    observation, info = env.reset(seed=1)
    assert observation[3] == 0
    assert info["evaluations"] == 6
    for step in range(1, length + 1):
        observation, _, terminated, truncated, info = env.step(np.array([6, 0.0]))
        assert observation in env.observation_space
        assert observation[3] == step
        assert terminated == (step == length)
        assert not truncated


def test_a_module_prefix_registers_without_an_import():
    env = gymnasium.make("swarm_gym:swarm_gym/Firefly-v0", **SMALL)
    assert env.spec.id == "swarm_gym/Firefly-v0"


def test_observation_is_e_mean_std_iteration_of_the_population():
    env = small(mean_weight=0.3)
    observation, _ = env.reset(seed=4)
    swarms = env.simulation.swarms
    collision = swarms.collision[0, : swarms.size[0]]
    mean, deviation = collision.mean(), collision.std(ddof=1)
    np.testing.assert_allclose(observation, [0.3 * mean + 0.7 * deviation, mean, deviation, 0], rtol=1e-12)


def test_progress_reward_is_log_gap_improvement_minus_the_price_of_evaluations():
    env = small(price=2.0, reference_evaluations=100)
    _, before = env.reset(seed=2)
    bound = 0.3 * 960.0
    _, reward, _, _, after = env.step(np.array([9, 0.2]))
    gain = np.log((before["best_fitness"] - bound) / (after["best_fitness"] - bound))
    spent = after["evaluations"] - before["evaluations"]
    assert reward == pytest.approx(gain - 2.0 * spent / 100, rel=1e-12)
    assert spent > 3  # three new members, and moves


def test_the_optimality_reward_is_the_final_gap_in_percent_minus_the_cost():
    env = small(reward="optimality", price=0.5, reference_evaluations=1000)
    _, first = env.reset(seed=3)
    last, rewards = finish(env)
    spent = np.array(last["evaluations"] - first["evaluations"])
    assert sum(rewards) == pytest.approx(-100 * last["optimality_gap"] - 0.5 * spent / 1000, rel=1e-9)
    assert max(rewards[:-1]) < 0 < -rewards[-1]


def test_the_optimality_reward_needs_a_known_optimum():
    scenario = Scenario("mine", (0, 0), (9000, 0), (), (0, -9000, 9000, 9000))
    with pytest.raises(SettingError, match=r"optimality.*mine"):
        small(scenario=["case1", scenario], reward="optimality")


@pytest.mark.parametrize("reward", ["progress", "final", "final-gap"])
def test_logarithmic_rewards_sum_to_total_gain_minus_total_cost(reward):
    """Compare the sum with the gain over the first gap or, for `final-gap`, over 1."""
    env = small(reward=reward, price=0.5, reference_evaluations=1000)
    _, first = env.reset(seed=3)
    last, rewards = finish(env)
    bound = 0.3 * 960.0
    begin = 1.0 if reward == "final-gap" else first["best_fitness"] - bound
    gain = np.log(begin / (last["best_fitness"] - bound))
    cost = 0.5 * (last["evaluations"] - first["evaluations"]) / 1000
    assert sum(rewards) == pytest.approx(gain - cost, rel=1e-9)


def test_info_describes_the_best_path():
    env = small(scenario="case2")
    env.reset(seed=5)
    info, _ = finish(env)
    path = info["best_path"]
    assert path.shape == (33, 2)
    np.testing.assert_allclose(path[[0, -1]], [[20, 300], [980, 300]])
    length = np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
    assert info["best_fitness"] == pytest.approx(0.3 * length + 0.7 * info["best_collision"])
    assert info["repair_degree"] == 0.5
    assert info["scenario"] == "case2"


def test_the_end_tells_length_and_clearance_of_the_best_feasible_path():
    wall = Circle(50.0, 20.0, 5.0)
    env = small(scenario=Scenario("mine", (0, 0), (100, 0), (wall,), (0, -50, 100, 50)))
    _, info = env.reset(seed=6)
    assert "feasible_length" not in info
    info, _ = finish(env)
    line = shapely.LineString(info["feasible_path"])
    assert info["feasible_length"] == pytest.approx(line.length)
    assert info["feasible_clearance"] == pytest.approx(line.distance(shapely.Point(50.0, 20.0)) - 5.0)
    assert info["feasible"] == (info["best_collision"] == 0.0)


def test_optimality_gap_of_a_scenario_of_ones_own_is_given_where_its_optimum_is_quickly_computed():
    own = small(scenario=Scenario("mine", (0, 0), (100, 0), (), (0, -50, 100, 50)))
    own.reset(seed=6)
    info, _ = finish(own)
    assert info["optimality_gap"] == pytest.approx(info["best_fitness"] / (0.3 * 100.0) - 1, rel=1e-6)
    for options in ({"encoding": "bezier"}, {}):
        grid = small(optimizer="particle-swarm", scenario="rooms:0", **options)
        grid.reset(seed=6)
        info, _ = finish(grid)
        shortest, _ = shortest_path(make_scenario("rooms:0"))
        assert info["optimality_gap"] == info["best_fitness"] / shortest - 1


def test_optimality_gap_is_given_at_the_end_where_the_optimum_is_known():
    env = small()
    _, info = env.reset(seed=6)
    assert "optimality_gap" not in info
    info, _ = finish(env)
    assert info["optimality_gap"] == pytest.approx(info["best_fitness"] / 299.1 - 1, abs=2e-3)
    unknown = small(scenario=Scenario("mine", (0, 0), (9000, 0), (), (0, -9000, 9000, 9000)))
    unknown.reset(seed=6)
    assert "optimality_gap" not in finish(unknown)[0]


def test_best_fitness_never_gets_worse_whatever_happens_to_the_population():
    env = small(iterations=30, noise=40.0)
    _, info = env.reset(seed=7)
    generator = np.random.default_rng(0)
    best = info["best_fitness"]
    for _ in range(30):
        action = np.array([generator.integers(2, 13), generator.random()])
        _, _, _, _, info = env.step(action)
        assert info["population_size"] == action[0]
        assert info["best_fitness"] <= best
        best = info["best_fitness"]


@pytest.mark.parametrize("budget", [6, 7, 20, 43])
def test_an_evaluation_budget_is_spent_exactly_and_ends_the_episode(budget):
    env = small(max_evaluations=budget, iterations=100)
    env.reset(seed=8)
    info, _ = finish(env, (12, 0.3))
    assert info["evaluations"] == budget


def test_what_a_layout_cannot_say_is_clipped_or_refused():
    layout = make_action(Settings(action="extended-normalised"), Firefly)
    still = layout.encode(np.array([[60.0, 0.0, 0.0, 0.1]]))  # without noise
    assert still[0, layout.labels.index("noise")] == -1.0
    with pytest.raises(ActionError, match=r"4 decisions.*'normalised'"):
        make_action(Settings(action="normalised"), Firefly).encode(np.array([[60.0, 0.0, 2.0, 0.1]]))


def test_normalised_actions_ask_for_the_same_as_natural_ones():
    natural, normalised = begun({}, {"action": "normalised"})
    layout = make_action(normalised.settings, Firefly)
    for size, repair in ((2, 0.0), (12, 1.0), (7, 0.5), (5, 0.25)):
        one = natural.step(np.array([size, repair]))
        other = normalised.step(layout.encode(np.array([[size, repair]]))[0])
        assert one[4]["population_size"] == other[4]["population_size"] == size
        assert one[4]["repair_degree"] == pytest.approx(other[4]["repair_degree"], abs=1e-7)


def test_extended_actions_decide_noise_and_attractiveness_of_the_iteration():
    extended, plain = begun({"action": "extended"}, {"noise": 7.0, "attractiveness": 0.4})
    one, other = extended.step(np.array([8, 0.3, 7.0, 0.4])), plain.step(np.array([8, 0.3]))
    np.testing.assert_array_equal(one[0], other[0])
    np.testing.assert_array_equal(extended.simulation.positions(0), plain.simulation.positions(0))
    history = extended.simulation.history[0, :2, extended.simulation.columns.index("noise")]
    np.testing.assert_array_equal(history, [2.0, 7.0])
    # A decision holds for one iteration only.
    extended.step(np.array([8, 0.3, 0.02, 1.0]))
    assert extended.simulation.history[0, 2, extended.simulation.columns.index("noise")] == 0.02


def test_scaled_extended_actions_ask_for_the_same_as_natural_ones():
    natural, scaled = begun({"action": "extended"}, {"action": "extended-normalised"})
    layout = make_action(scaled.settings, Firefly)
    for decided in ([2, 0.0, 0.02, 0.01], [12, 1.0, 100.0, 1.0], [7, 0.5, 3.0, 0.2]):
        natural.step(np.array(decided))
        scaled.step(layout.encode(np.array([decided]))[0])
        step = scaled.simulation.iteration[0]
        for part in (slice(1, 3), slice(5, 7)):
            found, expected = (env.simulation.history[0, step, part] for env in (scaled, natural))
            np.testing.assert_allclose(found, expected, rtol=1e-5, atol=1e-7)
    assert scaled.simulation.swarms.size[0] == 7


def test_two_decisions_encode_in_an_extended_layout_with_the_optimizers_own_parameters():
    (env,) = begun({"action": "extended-normalised", "noise": 5.0})
    layout = make_action(env.settings, Firefly)
    env.step(layout.encode(np.array([[9, 0.25]]))[0])
    names = ("population_size", "repair_degree", "noise", "attractiveness")
    recorded = env.simulation.history[0, 1, [env.simulation.columns.index(name) for name in names]]
    np.testing.assert_allclose(recorded, [9, 0.25, 5.0, 0.1], rtol=1e-5)


def test_a_paced_action_of_zero_asks_for_the_size_at_which_the_budget_lasts():
    env = small(action="paced", max_evaluations=306, initial_population_size=6, iterations=20,
                max_population_size=200)  # fmt: skip
    env.reset(seed=3)
    env.step(np.array([0.0, -1.0], dtype=np.float32))
    # 300 evaluations for 20 iterations are 15 each: 6 fireflies make 15 pairs.
    assert env.simulation.swarms.size[0] == 6
    env.step(np.array([1.0, -1.0], dtype=np.float32))
    left = (306 - env.simulation.history[0, 1, 4]) / 19
    assert env.simulation.history[0, 2, 1] == np.floor(6.0 * (1 + np.sqrt(1 + 8 * left)) / 2 + 0.5)


@pytest.mark.parametrize("action", ["paced", "extended-paced"])
def test_paced_actions_never_exceed_the_budget(action):
    env = small(action=action, max_evaluations=500, iterations=30, max_population_size=60)
    env.action_space.seed(0)
    env.reset(seed=2)
    ended = False
    while not ended:
        _, _, ended, _, info = env.step(env.action_space.sample())
        assert info["evaluations"] <= 500


def test_a_range_of_prices_is_drawn_from_by_the_seed_and_seen():
    env = small(price=(0.1, 10.0), observation="priced")
    prices = []
    for seed in range(200):
        observation, _ = env.reset(seed=seed)
        prices.append(env.simulation.prices.of_reference[0])
        assert observation[-1] == pytest.approx(np.log10(prices[-1] / 0.1) / 3, rel=1e-5)
    assert 0.1 <= min(prices) < 0.15
    assert 7.0 < max(prices) <= 10.0
    assert 0.6 < np.median(prices) < 1.6
    env.reset(seed=5)
    assert env.simulation.prices.of_reference[0] == prices[5]


def test_the_price_drawn_is_the_price_paid():
    pair = begun({"price": (0.1, 10.0), "reference_evaluations": 100}, {"price": 0.0}, seed=4)
    rewards = [env.step(np.array([9, 0.2]))[1] for env in pair]
    spent = pair[0].simulation.history[0, 1, 4] - pair[0].simulation.history[0, 0, 4]
    assert rewards[1] - rewards[0] == pytest.approx(pair[0].simulation.prices.of_reference[0] * spent / 100)


def test_layouts_can_be_joined():
    joined, paper, rich = (small(observation=name) for name in ("paper+rich", "paper", "rich"))
    seen = [env.reset(seed=6)[0] for env in (joined, paper, rich)]
    np.testing.assert_allclose(seen[0], np.concatenate(seen[1:]), rtol=1e-6)
    assert joined.observation_space.dtype == np.float64


def test_rich_observations_tell_diversity_and_recent_progress():
    env = small(observation="rich", iterations=9)
    env.reset(seed=7)
    gaps = [env.simulation.gaps.now()[0]]
    names = [feature.name for feature in OBSERVATIONS["rich"].features]
    for _ in range(8):
        observation, *_ = env.step(np.array([10, 0.4]))
        gaps.append(env.simulation.gaps.now()[0])
        positions = env.simulation.positions(0)
        diversity = np.sqrt(((positions - positions.mean(axis=0)) ** 2).sum(axis=1).mean())
        then = max(len(gaps) - 6, 0)
        expected = {
            "log(1 + diversity) / 8": np.log1p(diversity) / 8,
            "log(gap 5 iterations ago / gap)": np.log(gaps[then] / gaps[-1]),
            "share of the evaluation budget spent": 0.0,
        }
        for name, value in expected.items():
            assert observation[names.index(name)] == pytest.approx(value, abs=1e-5)


def test_sizes_are_rounded_to_nearest_half_up():
    (env,) = begun({})
    sizes = [env.step(np.array([s, 0.0]))[4]["population_size"] for s in (5.49, 5.5, 6.5, 11.99)]
    assert sizes == [5, 6, 7, 12]


def test_a_list_of_scenarios_is_drawn_from_by_the_seed():
    env = small(scenario=["case1", "case2", "case3"])
    drawn = [env.reset(seed=seed)[1]["scenario"] for seed in range(40)]
    assert set(drawn) == {"case1", "case2", "case3"}
    assert drawn == [env.reset(seed=seed)[1]["scenario"] for seed in range(40)]
    assert env.reset(seed=0, options={"scenario": "case3"})[1]["scenario"] == "case3"


def test_later_episodes_differ_but_follow_from_the_first_seed():
    env, again = small(), small()
    first = [env.reset(seed=11)[0], env.reset()[0], env.reset()[0]]
    second = [again.reset(seed=11)[0], again.reset()[0], again.reset()[0]]
    np.testing.assert_array_equal(first, second)
    assert not np.array_equal(first[0], first[1])
    assert not np.array_equal(first[1], first[2])


def test_reset_takes_an_initial_population():
    env = small()
    population = np.linspace(-100, 100, 4 * 31).reshape(4, 31)
    _, info = env.reset(seed=12, options={"initial_population": population})
    assert info["population_size"] == info["evaluations"] == 4
    np.testing.assert_array_equal(env.simulation.positions(0), population)
    assert env.reset(seed=12, options={"initial_population_size": 9})[1]["population_size"] == 9


def test_a_population_of_a_named_scenario_need_not_fit_the_others():
    maps = [
        GridScenario(name, GridMap(name, np.zeros(shape, bool)), (1.0, y), (x, y))
        for name, shape, x, y in (("small", (20, 30), 28.0, 10.0), ("large", (60, 60), 58.0, 30.0))
    ]
    env = SwarmEnv(scenario=maps, iterations=3)
    env.reset(seed=0, options={"scenario": "large"})
    population = env.simulation.positions(0).copy()
    env.reset(seed=0, options={"scenario": "large", "initial_population": population})
    np.testing.assert_array_equal(env.simulation.positions(0), population)
    with pytest.raises(SettingError, match="of all scenarios, unless `scenario` names one: component"):
        env.reset(seed=0, options={"initial_population": population})


def test_a_name_of_several_scenarios_chooses_none_of_them():
    maps = [
        GridScenario("x", GridMap("m", np.zeros((20, 30), bool)), (1.0, y), (28.0, y)) for y in (5.0, 9.0)
    ]
    env = SwarmEnv(scenario=maps, iterations=3)
    env.reset(seed=0)
    with pytest.raises(SettingError, match="'x': several scenarios of this environment have this name"):
        env.reset(seed=0, options={"scenario": "x"})


def test_observations_and_infos_are_not_reused():
    env = small()
    before, info = env.reset(seed=13)
    kept, path = before.copy(), info["best_path"].copy()
    env.step(np.array([12, 1.0]))
    np.testing.assert_array_equal(before, kept)
    np.testing.assert_array_equal(info["best_path"], path)


@pytest.mark.parametrize(
    ("action", "message"),
    [
        (np.array([np.nan, 0.0]), "nan"),
        (np.array([6.0, np.inf]), "inf"),
        (np.array([1.0, 0.0]), r"\[1.0, 0.0\]"),
        (np.array([13.0, 0.0]), "13"),
        (np.array([6.0, 1.01]), "1.01"),
        (np.array([6.0, -0.01]), "-0.01"),
        (np.array([6.0]), "shape"),
        (np.array([[6.0, 0.0]]), "shape"),
        (6.0, "shape"),
        ("ten", "numbers"),
        (None, "numbers"),
        (np.array([True, False]), "bool"),
        ([6.0, [0.0]], "numbers"),
        (np.array([6j, 0]), "complex"),
    ],
)
def test_bad_actions_are_refused_and_change_nothing(action, message):
    env, twin = begun({}, {})
    with pytest.raises(ActionError, match=message):
        env.step(action)
    after, untouched = env.step(np.array([6, 0.1])), twin.step(np.array([6, 0.1]))
    np.testing.assert_array_equal(after[0], untouched[0])
    assert after[1] == untouched[1]


def test_step_before_reset_and_after_the_end_is_refused():
    env = small()
    with pytest.raises(StepOrderError, match="no reset"):
        env.step(np.array([6, 0.0]))
    env.reset(seed=15)
    finish(env)
    with pytest.raises(StepOrderError, match="ended"):
        env.step(np.array([6, 0.0]))
    env.reset()
    env.step(np.array([6, 0.0]))


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"scenario": "case4"}, UnknownNameError, "case4.*case3, case2, case1"),
        ({"scenario": ["case1", "caseX"]}, UnknownNameError, "caseX"),
        ({"scenario": []}, SettingError, "empty"),
        ({"optimizer": "fireflies"}, UnknownNameError, "fireflies.*firefly"),
        ({"population": 3}, UnknownNameError, "population.*min_population_size, max_population_size"),
        ({"action": "raw"}, UnknownNameError, "raw.*natural, normalised"),
        ({"action": 3}, UnknownNameError, "3.*natural, normalised"),
        ({"action": "paced"}, SettingError, "paced.*max_evaluations"),
        ({"action": "sourced-paced"}, SettingError, "sourced-paced.*max_evaluations"),
        ({"price": (0.5,)}, SettingError, r"price.*\(0.5,\)"),
        ({"price": (0.5, 0.1)}, SettingError, "price.*low < high"),
        ({"price": (0.0, 0.1)}, SettingError, "price.*0.0"),
        ({"observation": "paper+all"}, UnknownNameError, "all.*extended"),
        ({"observation": "all"}, UnknownNameError, "all.*extended, jumps, named, paper"),
        ({"reward": "none"}, UnknownNameError, "none.*progress"),
        ({"render_mode": "ansi"}, UnknownNameError, "ansi.*human, rgb_array"),
        ({"iterations": 0}, SettingError, "iterations.*0"),
        ({"iterations": 2.5}, SettingError, "iterations.*2.5"),
        ({"num_waypoints": True}, SettingError, "num_waypoints.*True"),
        ({"initial_population_size": 13}, SettingError, "initial_population_size.*13"),
        ({"min_population_size": 20}, SettingError, "max_population_size"),
        ({"length_weight": 0.0}, SettingError, "length_weight"),
        ({"length_weight": float("nan")}, SettingError, "length_weight.*nan"),
        ({"mean_weight": 1.5}, SettingError, "mean_weight.*1.5"),
        ({"price": "cheap"}, SettingError, "price.*cheap"),
        ({"max_evaluations": 5}, SettingError, "max_evaluations.*5"),
        ({"noise": -1.0}, SettingError, "noise.*-1"),
        ({"attractiveness": float("nan")}, SettingError, "attractiveness.*nan"),
        ({"absorption": "far"}, SettingError, "absorption.*far"),
        ({"scenario": 3}, UnknownNameError, "3"),
    ],
)
def test_bad_options_are_refused_by_name_and_value(options, error, message):
    with pytest.raises(error, match=message):
        small(**options)


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"senario": "case1"}, UnknownNameError, "senario.*initial_population, init"),
        ({"scenario": "case2"}, UnknownNameError, "case2.*case1"),
        ({"initial_population_size": 1}, SettingError, "initial_population_size.*1"),
        ({"initial_population": np.zeros((4, 3))}, SettingError, r"\(4, 3\)"),
        ({"initial_population": np.full((4, 31), np.nan)}, SettingError, "finite"),
        ({"initial_population": np.full((4, 31), 301.0)}, SettingError, "inside"),
        ({"initial_population": np.zeros((13, 31))}, SettingError, "the size of initial_population.*13"),
        ({"initial_population": np.zeros((4, 31), bool)}, SettingError, "must be numbers"),
        ({"initial_population": np.full((4, 31), True, object)}, SettingError, "must be numbers"),
        ({"initial_population": np.zeros((4, 31)).astype(str)}, SettingError, "must be numbers"),
        ({"initial_population": np.zeros((4, 31), complex)}, SettingError, "must be numbers"),
        ({"initial_population": np.zeros((4, 31), "datetime64[s]")}, SettingError, "must be numbers"),
        ({"initial_population": np.ma.masked_array(np.zeros((4, 31)), True)}, SettingError, "be numbers"),
        (
            {"initial_population": np.vstack([np.zeros((2, 31)), np.full((2, 31), 301.0)])},
            SettingError,
            r"component 0 of member 2 must lie in \[-\d+, \d+\], got 301",
        ),
        (
            {"initial_population": np.zeros((4, 31)), "initial_population_size": 4},
            SettingError,
            "expected initial_population or initial_population_size, got both",
        ),
    ],
)
def test_bad_reset_options_are_refused(options, error, message):
    env = small()
    with pytest.raises(error, match=message):
        env.reset(seed=0, options=options)
