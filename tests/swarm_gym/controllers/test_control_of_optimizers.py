"""Every optimizer is driven by schedules and by policies, on both kinds of map."""

import dataclasses

import numpy as np
import pytest

from agents import make_controller
from helpers.builders import options_for
from helpers.slow import slow_but
from helpers.trainings import make_policy
from swarm_gym.action import make_action
from swarm_gym.controllers.knots import Knots
from swarm_gym.controllers.learned.residual import Base
from swarm_gym.controllers.open_loop import save_open_loop
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SettingError, UnknownNameError
from swarm_gym.optimizers import OPTIMIZERS, get_optimizer
from swarm_gym.rollout import run_episodes
from swarm_gym.settings import Settings
from swarm_gym.training.config import TrainConfig
from swarm_gym.training.run import TrainingRun
from swarm_gym.vector_env import SwarmVectorEnv

MAPS = {"analytic": {"scenario": "case3"}, "grid": {"scenario": "rooms:0", "encoding": "bezier"}}
both = pytest.mark.parametrize("kind", MAPS)


# Ants walk over maps without cells in small steps, which takes long.
with_any_optimizer_on_both = pytest.mark.parametrize(
    ("optimizer", "kind"),
    slow_but(
        [
            *((name, "analytic") for name in OPTIMIZERS if name != "ant-colony"),
            *((name, "grid") for name in ("firefly", "ant-colony", "multivariate")),
        ],
        [(name, kind) for name in OPTIMIZERS for kind in MAPS],
    ),
)


@with_any_optimizer_on_both
def test_the_schedule_decides_by_the_collision_that_it_sees(optimizer, kind):
    schedule = make_controller("spsfa-tip")
    schedule.reset(2)
    envs = SwarmVectorEnv(
        2, optimizer, iterations=6, **schedule.env_options(), **options_for(optimizer, **MAPS[kind])
    )
    observations, _ = envs.reset(seed=3)
    sizes = []
    for _ in range(6):
        actions = schedule.act(observations)
        observations, _, _, _, info = envs.step(actions)
        sizes.append(info["population_size"])
        # MOA has fewer members than it was asked for where lists are short.
        assert (info["population_size"] <= np.round(actions[:, 0])).all()
        assert (observations[:, 0] >= 0.0).all()
    assert len({tuple(size) for size in sizes}) > 1


@with_any_optimizer_on_both
def test_a_policy_drives_it_alike_in_every_run(optimizer, kind, tmp_path):
    rng, least = np.random.default_rng(0), max(get_optimizer(optimizer).smallest_population, 2)
    path = make_policy(tmp_path / "policy.safetensors", rng, optimizer=optimizer, min_population_size=least)
    options = {"iterations": 6, **options_for(optimizer, **MAPS[kind])}
    scenario = options.pop("scenario")
    runs = [
        run_episodes(make_controller(f"learned:{path}"), scenario, range(3), optimizer, **options)
        for _ in range(2)
    ]
    assert runs[0].sizes.tolist() == runs[1].sizes.tolist()
    assert runs[0].final_fitness.tolist() == runs[1].final_fitness.tolist()
    assert (runs[0].evaluations > 80).all()


@pytest.mark.parametrize(
    ("made_for", "optimizer"), [("firefly", "multivariate"), ("fish-swarm", "particle-swarm")]
)
def test_a_controller_of_other_decisions_is_refused_by_their_names(made_for, optimizer, tmp_path):
    loop = loop_for(made_for, tmp_path)
    names = [*get_optimizer(made_for).decided_parameters(), *get_optimizer(optimizer).decided_parameters()]
    with pytest.raises(SettingError, match=f"made for {made_for}") as error:
        SwarmEnv(optimizer, **make_controller(loop).env_options())
    assert all(name in str(error.value) for name in names)
    assert len(str(error.value)) < 400
    layout = make_action(Settings(action="extended-normalised"), get_optimizer(optimizer))
    with pytest.raises(SettingError, match=f"made for {made_for}"):
        Base(make_controller(loop), layout)


def test_a_controller_of_the_same_decisions_drives_another_optimizer_and_info_says_so(tmp_path):
    loop = make_controller(loop_for("fish-swarm", tmp_path))
    own = SwarmEnv("fish-swarm", **loop.env_options())
    assert "made_for" not in own.reset(seed=0)[1]
    other = SwarmEnv("improved-fish-swarm", **loop.env_options())
    assert other.reset(seed=0)[1]["made_for"] == "fish-swarm"
    assert other.step(loop.act(np.zeros((1, 4)))[0])[-1]["made_for"] == "fish-swarm"
    envs = SwarmVectorEnv(3, "improved-fish-swarm", **loop.env_options())
    assert envs.reset(seed=0)[1]["made_for"].tolist() == ["fish-swarm"] * 3


def test_size_and_phi_fit_every_optimizer(tmp_path):
    rng, least = np.random.default_rng(0), max(get_optimizer(name).smallest_population for name in OPTIMIZERS)
    path = make_policy(tmp_path / "policy.safetensors", rng, optimizer="firefly", min_population_size=least)
    policy = make_controller(f"learned:{path}")
    for optimizer in OPTIMIZERS:
        options = options_for(optimizer, **MAPS["analytic"])
        found = SwarmEnv(optimizer, **options, **policy.env_options()).reset(seed=0)[1].get("made_for")
        assert found == (None if optimizer == "firefly" else "firefly")


def test_an_unknown_optimizer_is_refused():
    with pytest.raises(UnknownNameError, match="bees"):
        SwarmEnv(made_for="bees")


def loop_for(optimizer, folder):
    """Write an open loop of the optimizer's own decisions and return its name."""
    decided = get_optimizer(optimizer).decided_parameters()
    knobs = {name: [parameter.decided[0]] for name, parameter in decided.items()}
    path = folder / f"{optimizer}.json"
    save_open_loop(path, Knots(6, [0], [6.0], [0.1], knobs, optimizer=optimizer), {})
    return f"open-loop:{path}"


@pytest.mark.slow
def test_short_trainings_by_ppo_beat_a_fixed_size_at_fewer_evaluations(tmp_path):
    """On average; one may end below it."""
    config = TrainConfig(runs=tmp_path).changed(
        algorithm="ppo",
        optimizer="particle-swarm",
        scenarios=("case1",),
        warm_start="none",
        initial_population_size=65,
        price=(1.0,),
        log_std=-1.0,
        total_steps=96_000,
        validation_seeds=32,
    )
    policies = [
        TrainingRun(dataclasses.replace(config, name=f"ppo-{seed}", seed=seed)).run() for seed in range(3)
    ]
    *learned, fixed = (
        run_episodes(make_controller(name), "case1", range(5000, 5100), "particle-swarm", price=1.0)
        for name in (*(f"learned:{policy}" for policy in policies), "fixed:65")
    )
    assert all(episodes.evaluations.mean() < fixed.evaluations.mean() for episodes in learned)
    returns = np.mean([episodes.returns for episodes in learned])
    assert returns > fixed.returns.mean() + 0.05
