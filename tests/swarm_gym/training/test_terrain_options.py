"""Trainings and tunings over terrain: cost, source and budget reach the environments."""

import dataclasses

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from helpers.terrains import rolling_terrain
from swarm_gym.comparing import compare
from swarm_gym.comparing.entrants import entrant, environment_of
from swarm_gym.controllers import SizeLimits, make_controller, make_controller_for
from swarm_gym.controllers.controller import beside_ways
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SettingError
from swarm_gym.rollout import swarms_for
from swarm_gym.scenarios import registry
from swarm_gym.sources import Source
from swarm_gym.training.config import TrainConfig, changed_options, stored_config
from swarm_gym.training.learners.environments import make_swarms
from swarm_gym.tuning import command_line
from swarm_gym.tuning.config import TuneConfig
from swarm_gym.tuning.knots import KnotSpace
from swarm_gym.tuning.side_by_side import SideBySide
from swarm_gym.vector_env import SwarmVectorEnv
from swarm_gym.wrappers import PairedReward

TERRAIN = {"cost": "metabox", "source": "guided", "max_evaluations": 150, "iterations": 30}
FIRST = "fixed:8,smooth_share=1,amplitude=0.1"


@pytest.fixture(autouse=True)
def little_terrain(monkeypatch):
    monkeypatch.setitem(registry.SCENARIOS, "little", lambda: rolling_terrain(2))


def test_only_options_that_differ_reach_environments():
    assert changed_options(TrainConfig()) == changed_options(TuneConfig()) == {}
    config = TrainConfig(cost="metabox", source="guided", encoding="spherical")
    assert changed_options(config) == {"encoding": "spherical", "cost": "metabox", "source": "guided"}
    assert config.env_options()["source"] == "guided"
    stored = {name: value for name, value in config.options().items() if name != "runs"}
    assert stored_config({"config": stored}).env_options() == config.env_options()


def test_members_of_a_training_lie_beside_planned_flights_also_with_a_base_that_has_a_source():
    config = TrainConfig(scenarios=("little",), base=FIRST, initial_population_size=8, **TERRAIN)
    env, base = make_swarms(config, 2, AutoresetMode.DISABLED)
    settings = env.unwrapped.settings
    assert base is not None
    assert (settings.source, settings.amplitude, settings.cost) == ("guided", 0.1, "metabox")
    assert env.unwrapped.simulation.problems[0].ways is not None


def test_a_controller_keeps_the_ways_of_a_guided_environment():
    options = {"scenario": "little", "cost": "metabox", "iterations": 5}
    swarms = swarms_for(make_controller(FIRST), 2, "firefly", source="guided", **options)
    assert (swarms.settings.source, swarms.settings.new_members) == ("guided", Source(1.0, 0.1))
    plain = swarms_for(make_controller(FIRST), 2, "firefly", source="uniform", **options)
    assert plain.settings.source == "smooth"
    needed = make_controller("fixed:8,smooth_share=0.5").env_options()
    assert beside_ways("uniform", needed) == needed
    with pytest.raises(SettingError, match=r"'guided'.*mixed members.*first smooth share is 1"):
        beside_ways("guided", needed)


def test_a_given_budget_holds_also_for_a_policy_that_was_trained_with_another_one():
    policy = make_controller("learned:terrain-sourced/0")
    own = policy.env_options()["max_evaluations"]
    assert policy.options_with({"max_evaluations": 2 * own})["max_evaluations"] == 2 * own
    assert policy.options_with({"max_evaluations": None})["max_evaluations"] == own
    assert policy.options_with({"observation": "own"})["observation"] == policy.observation


def test_comparisons_and_references_keep_planned_ways():
    options = {"cost": "metabox", "source": "guided", "iterations": 5}
    env = environment_of(entrant(FIRST, "firefly"), make_controller(FIRST), "little", options)
    assert env.unwrapped.settings.source == "guided"
    reward = {"reward": "final", "price": 0.0, "initial_population_size": 8, "amplitude": 0.1}
    swarms = SwarmVectorEnv(
        2, "firefly", scenario="little", autoreset_mode=AutoresetMode.SAME_STEP, **options, **reward
    )
    paired = PairedReward(swarms, FIRST)
    paired.reset(seed=5)
    twin = paired._reference.env.unwrapped.simulation
    np.testing.assert_array_equal(twin.swarms.best_fitness, swarms.simulation.swarms.best_fitness)


def test_sizes_of_a_schedule_fit_the_optimizer():
    options = {"cost": "metabox", "source": "guided", "iterations": 20}
    found = compare(["spsfa-tip"], ["little"], range(2), "differential-evolution", **options)
    assert np.isfinite(found.fitness).all()
    assert make_controller_for("differential-evolution", "spsfa-tip").limits == SizeLimits(4, 200)
    assert make_controller_for("firefly", "spsfa-tip").limits == SizeLimits(2, 200)


def test_a_reference_with_other_members_is_refused():
    swarms = SwarmVectorEnv(
        2, "firefly", scenario="little", cost="metabox", source="guided", amplitude=0.1, reward="progress",
        initial_population_size=8, autoreset_mode=AutoresetMode.SAME_STEP,
    )  # fmt: skip
    PairedReward(swarms, "fixed:8")
    with pytest.raises(SettingError, match=r"begins with 8 members from guided.*0\.2.*guided Source.*0\.1"):
        PairedReward(swarms, "fixed:8,smooth_share=1,amplitude=0.2")
    with pytest.raises(SettingError, match="'guided': the controller begins with mixed members"):
        PairedReward(swarms, "fixed:8,smooth_share=0.5,amplitude=0.1")


def test_tunings_around_planned_ways_hold_the_share_of_smooth_members():
    options = {"what": "constant", "action": "sourced", "knots": (0,), "scenarios": ("little",), **TERRAIN}
    space = KnotSpace(TuneConfig(**options))
    knots = space.decode(np.full(len(space.start), 0.5))
    assert knots.first_source == Source(1.0, knots.first_source.amplitude)
    assert len(KnotSpace(TuneConfig(**{**options, "source": "uniform"})).start) == len(space.start) + 1
    with pytest.raises(SettingError, match=r"held first smooth share=0.5: .*expected 1, or another source"):
        KnotSpace(TuneConfig(held=("first_smooth_share=0.5",), **options))


def test_the_amplitude_of_a_base_holds_around_planned_ways():
    options = {"scenario": "little", "cost": "metabox", "iterations": 5, "base": FIRST}
    settings = SwarmEnv("firefly", source="guided", **options).settings
    assert (settings.source, settings.new_members) == ("guided", Source(1.0, 0.1))
    given = SwarmEnv("firefly", source="guided", amplitude=0.3, **options).settings
    assert given.new_members == Source(1.0, 0.3)


def test_a_reward_that_needs_the_optimum_of_a_terrain_is_refused():
    with pytest.raises(SettingError, match=r"'optimality' needs optima.*terrain.*cannot be.*'progress'"):
        SwarmEnv("firefly", scenario="little", reward="optimality")


def test_a_tuning_has_the_encoding_of_its_preset(monkeypatch):
    preset = dataclasses.replace(TrainConfig(), encoding="shifted", cost="metabox", source="guided")
    monkeypatch.setattr(command_line, "load_preset", lambda _: preset)
    config = command_line.defaults_of(["--what", "open-loop"])
    assert changed_options(config) == {"encoding": "shifted", "cost": "metabox", "source": "guided"}


def test_a_tuning_has_a_budget_and_its_own_length():
    config = TuneConfig(scenarios=("little",), episodes=3, price=0.0, initial_population_size=10, **TERRAIN)
    controllers = [make_controller("fixed:10"), make_controller("fixed:20")]
    places = SideBySide(config, 2, "paper", "natural")
    assert places._env.unwrapped.settings.encoding == "waypoints"
    assert places.steps == 2 * 3 * 30
    outcomes = places.run(controllers, 5)
    assert (outcomes.evaluations == 150).all()
    guided = swarms_for(controllers[0], 1, "firefly", scenario="little", **TERRAIN)
    assert places._env.unwrapped.settings.source == guided.settings.source == "guided"
    shifted = SideBySide(dataclasses.replace(config, encoding="shifted"), 2, "paper", "natural")
    assert shifted._env.unwrapped.settings.encoding == "shifted"
    longer = dataclasses.replace(config, knots=(0, 29))
    assert len(KnotSpace(longer).start) == 4
    with pytest.raises(SettingError, match="knots"):
        KnotSpace(dataclasses.replace(config, knots=(0, 30)))
