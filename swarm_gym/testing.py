"""Contracts that controllers, optimizers and scenarios have to keep, checked by one call each.

They are for code of your own, in the manner of Gymnasium's `check_env`. A name is `module:attribute`, or one
of this package.
"""

import warnings
from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
from gymnasium.spaces import Box
from gymnasium.utils.env_checker import check_env
from numpy.typing import NDArray

from swarm_gym.controllers import Controller, make_controller
from swarm_gym.controllers.controller import in_iteration, require_trial
from swarm_gym.env import Info, SwarmEnv
from swarm_gym.errors import SwarmGymError
from swarm_gym.observation import make_observation
from swarm_gym.optimizers import get_optimizer
from swarm_gym.reference.shortest import shortest_path
from swarm_gym.registration import environment_id
from swarm_gym.rollout import run_episodes
from swarm_gym.scenarios import (
    DynamicScenario,
    FunctionScenario,
    TerrainScenario,
    make_scenario,
    worlds_of,
)
from swarm_gym.vector_env import SwarmVectorEnv

NUM_SWARMS, ITERATIONS, SEED, BUDGET = 5, 12, 7, 70

# A controller gets a hint if its mean best fitness is above that of a constant population by this factor.
_CONSTANT, _WORSE = "fixed:60", 1.1
# Mean phi of the first iterations that counts as early repair, and the median of sizes that counts as few.
_EARLY, _EARLY_DEGREE, _FEW = 20, 0.05, 5


class ContractError(SwarmGymError, AssertionError):
    """A contract that is not kept; the message names it, what was found and what was expected."""


class ControllerHint(UserWarning):
    """A controller that keeps its contract, but ends worse than a constant population; the text says why."""


def check_controller(name: str, scenario: str = "case3") -> None:
    """Check that a controller decides in its layouts, alike for any number of swarms, and through episodes.

    A controller that ends worse than 60 constant members on five seeds gets a `ControllerHint`, a warning
    with both results and the likely reasons.

    Raises:
        OwnCodeError: if the name cannot be imported, or is no controller that decides.
        ContractError: for a contract that it does not keep.
    """
    controller = make_controller(name)
    require_trial(controller)
    _check_widths(name)
    first, again = (_course(make_controller(name), scenario) for _ in range(2))
    _require(first == again, f"controller {name}: two episodes of the same seed differ")
    optimizer = controller.made_for or "firefly"
    envs = SwarmVectorEnv(
        NUM_SWARMS,
        optimizer,
        scenario=scenario,
        iterations=_iterations_on(scenario),
        **controller.env_options(),
    )
    controller.reset(NUM_SWARMS, SEED)
    observations, _ = envs.reset(seed=SEED)
    ended = np.zeros(NUM_SWARMS, np.bool_)
    for _ in range(_iterations_on(scenario)):
        if ended.any():
            break  # on bit strings, where an episode ends at the optimum
        # The environment refuses an action outside of its space, and names the swarm.
        observations, _, ended, _, _ = envs.step(controller.act(observations))
    _hint(name, make_controller(name), scenario, optimizer)


def check_optimizer(name: str, scenario: str = "case3") -> None:
    """Check an optimizer: Gymnasium's contract, counted evaluations, bounds, the best path, the same bits.

    Raises:
        OwnCodeError: if the name cannot be imported, or is no optimizer.
        ContractError: for a contract that it does not keep.
    """
    least = max(2, get_optimizer(name).smallest_population)
    options: dict[str, Any] = {
        "scenario": scenario,
        "iterations": ITERATIONS,
        "initial_population_size": least + 7,
        "min_population_size": least,
    }
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # recommendations about spaces
        check_env(gymnasium.make(environment_id(name), **options).unwrapped, skip_render_check=True)
    env = SwarmEnv(name, **options, max_evaluations=BUDGET)
    _, info = env.reset(seed=SEED)
    rng, before, ended = np.random.default_rng(SEED), np.inf, False
    while not ended:
        asked = int(rng.integers(least, least + 13))
        _, _, ended, _, info = env.step(_fitting(env, asked, rng.random()))
        _check_state(name, env, info, asked, before)
        before = info["best_fitness"]
    _require(
        int(info["evaluations"]) <= BUDGET,
        f"optimizer {name}: {BUDGET} evaluations allowed, {info['evaluations']} made",
    )
    _check_bits(name, options)


def check_scenario(name: str, optimizer: str = "firefly") -> None:
    """Check that a scenario is the same whenever it is made, has a free path, and can be run on.

    Raises:
        OwnCodeError: if the name cannot be imported, or gives no scenario.
        ScenarioError: if no free path leads from its start to its target.
        ContractError: for a contract that it does not keep.
    """
    scenario = make_scenario(name)
    _require(
        make_scenario(name) == scenario,
        f"scenario {name}: two calls give different scenarios, so that no run can be repeated",
    )
    if not isinstance(scenario, FunctionScenario | DynamicScenario | TerrainScenario):
        shortest_path(scenario)
    least = get_optimizer(optimizer).smallest_population
    limits: dict[str, Any] = {"min_population_size": least} if least > 2 else {}  # bit strings have one
    env = SwarmEnv(optimizer, scenario=name, iterations=_iterations_on(name), **limits)
    _, info = env.reset(seed=SEED)
    ended = False
    while not ended:
        _, _, ended, _, info = env.step(_fitting(env, 9.0, 0.5))
    _require(
        bool(np.isfinite(info["best_fitness"])),
        f"scenario {name}: the best fitness of an episode is {info['best_fitness']}",
    )


def _hint(name: str, controller: Controller, scenario: str, optimizer: str) -> None:
    """Warn if a controller ends worse than a constant population, and say what may be the reason."""
    seeds = range(SEED, SEED + NUM_SWARMS)
    own, constant = (
        run_episodes(one, scenario, seeds, optimizer) for one in (controller, make_controller(_CONSTANT))
    )
    mine, theirs = (float(episodes.final_fitness.mean()) for episodes in (own, constant))
    if mine <= _WORSE * theirs:
        return
    reasons = []
    if (degree := float(np.nanmean(own.repair_degrees[:, :_EARLY]))) > _EARLY_DEGREE:
        reasons.append(
            f"it repairs early: phi is {degree:.2f} on average in the first {_EARLY} iterations, and "
            "repaired members leave too little variety to search with; keep phi at 0 until the population "
            "has settled"
        )
    if (size := float(np.nanmedian(own.sizes))) <= _FEW:
        reasons.append(
            f"it keeps {size:g} members in most iterations, too few to search with; decide sizes between 20 "
            "and 100"
        )
    reason = f" ({'; '.join(reasons)})" if reasons else ""
    warnings.warn(
        f"controller {name}: on scenario {scenario!r} and {NUM_SWARMS} seeds this controller ends at a mean "
        f"best fitness of {mine:.0f}; 60 constant members end at {theirs:.0f}{reason}",
        ControllerHint,
        stacklevel=3,
    )


def _check_state(name: str, env: SwarmEnv, info: Info, asked: int, before: float) -> None:
    """Check the state of an optimizer after an iteration; `before` is the best fitness before it."""
    where = f"optimizer {name}, iteration {env.simulation.iteration[0]}"
    size, best = int(info["population_size"]), info["best_fitness"]
    _require(1 <= size <= asked, f"{where}: {asked} members were asked for, there are {size}")
    _require(best <= before, f"{where}: the best fitness rises from {before} to {best}")
    swarms, problem = env.simulation.swarms, env.simulation.problem_of(0)
    positions = swarms.positions[0, :size, : problem.dimension]
    lower, upper = problem.bounds
    inside = (positions >= lower - 1e-9) & (positions <= upper + 1e-9)
    _require(bool(inside.all()), f"{where}: member {int(np.argmin(inside.all(axis=1)))} is out of bounds")
    _require(
        bool(np.isfinite(swarms.fitness[0, :size]).all()), f"{where}: the fitness of a member is not finite"
    )
    if env.settings.encoding == "walk":
        return  # members are points, whose fitness is not that of a walk
    _require(
        bool(best <= swarms.fitness[0, :size].min()),
        f"{where}: the best fitness is {best}, but a member has {swarms.fitness[0, :size].min()}; evaluate "
        "with evaluate_path or evaluate_member, which remember the best path",
    )


def _check_bits(name: str, options: Mapping[str, Any]) -> None:
    """Check that a seed gives the same bits in a single environment and among other swarms."""
    env = SwarmEnv(name, **options)
    action = _fitting(env, 11.0, 0.5)
    courses: list[list[float]] = []
    for row in range(NUM_SWARMS):
        env.reset(seed=SEED + row)
        courses.append([])
        ended = False
        while not ended and len(courses[row]) < ITERATIONS:
            _, _, ended, _, info = env.step(action)
            courses[row].append(float(info["best_fitness"]))
    length = min(map(len, courses))  # on bit strings an episode ends at the optimum
    envs = SwarmVectorEnv(NUM_SWARMS, name, **options)
    envs.reset(seed=SEED)
    for _ in range(length):
        infos = envs.step(np.tile(action, (NUM_SWARMS, 1)))[-1]
    found = [course[length - 1] for course in courses]
    together = np.asarray(infos["best_fitness"]).tolist()
    _require(
        found == together,
        f"optimizer {name}: the same seeds give {found} one by one, and {together} side by side; draw random "
        "numbers from swarms.stream[b] only, and keep what a swarm remembers in swarms.memory",
    )


def _iterations_on(scenario: str) -> int:
    """Return the iterations of trial episodes: at least one more after the last event of a changing map."""
    return max(ITERATIONS, worlds_of(make_scenario(scenario))[-1].iteration + 1)


def _fitting(env: SwarmEnv, size: float, repair_degree: float) -> NDArray:
    """Return an action of this size and phi, within the bounds of the action space."""
    space = env.action_space
    assert isinstance(space, Box)
    return np.clip([size, repair_degree], space.low, space.high)


def _require(kept: bool, message: str) -> None:
    if not kept:
        raise ContractError(message)


def _check_widths(name: str) -> None:
    """Check that decisions for a swarm do not depend on the other swarms."""
    together = make_controller(name)
    together.reset(NUM_SWARMS, SEED)
    alone = [make_controller(name) for _ in range(NUM_SWARMS)]
    for row, controller in enumerate(alone):
        controller.reset(1, SEED + row)
    rng = np.random.default_rng(SEED)
    for iteration in range(4):
        seen = _observations(together, rng, iteration)
        all_rows = np.asarray(together.act(seen))
        for row, controller in enumerate(alone):
            one = np.asarray(controller.act(seen[row : row + 1]))[0]
            _require(
                bool((one == all_rows[row]).all()),
                f"controller {name}: swarm {row} alone gets {one.tolist()} in iteration {iteration}, but "
                f"{all_rows[row].tolist()} beside {NUM_SWARMS - 1} others",
            )


def _observations(controller: Controller, rng: np.random.Generator, iteration: int) -> NDArray:
    num_features = len(make_observation(controller.observation).features)
    return in_iteration(rng.random((NUM_SWARMS, num_features)), controller.observation, iteration)


def _course(controller: Controller, scenario: str) -> list[float]:
    """Return the best fitness after every iteration of an episode."""
    env = SwarmEnv(
        controller.made_for or "firefly",
        scenario=scenario,
        iterations=_iterations_on(scenario),
        **controller.env_options(),
    )
    controller.reset(1, SEED)
    observation, _ = env.reset(seed=SEED)
    found, ended = [], False
    while not ended:
        observation, _, ended, _, info = env.step(controller.act(observation[None])[0])
        found.append(float(info["best_fitness"]))
    return found
