"""Digests of what the package computes, to compare processors: `python fingerprints.py PART ...` prints them.

Each part is a function that yields names and arrays; the digest of an array is that of its bits.
"""

import hashlib
import json
import sys
from pathlib import Path

import numpy as np

SEED = 7
NUM_SWARMS = 3
GOLDEN_SCENARIOS = ("case1", "rooms:0")
# Environments whose observations, rewards and scaled actions are compared, beside those of the episodes.
ENVIRONMENTS = (
    {"scenario": ["case1", "case3"], "observation": "rich", "action": "extended-normalised"},
    {"scenario": "case2", "observation": "priced", "price": (0.3, 5.0), "reward": "optimality"},
    {"scenario": "dynamic:case1-block@3", "observation": "extended+jumps+told", "reward": "offline-error"},
    {"scenario": "case1", "observation": "corridors", "max_evaluations": 900, "action": "paced"},
    {"scenario": "case2", "source": "mixed", "smooth_share": 0.5, "bends": "stomp", "reward": "final"},
    {"scenario": "rooms:0", "encoding": "bezier", "source": "guided", "action": "sourced-normalised"},
    {"scenario": "case1", "clearance": 1.0, "observation": "scaled", "reward": "final-gap"},
    {"scenario": "terrain:train:0", "cost": "metabox", "source": "guided", "action": "sourced-normalised"},
)


def elementary():
    """Yield the elementary functions of many numbers."""
    from swarm_gym.compiler import elementary as functions

    values = np.random.default_rng(SEED).normal(size=4000) * 4.0
    for name in ("exp", "log", "log1p", "expm1", "tanh", "sin", "cos"):
        yield name, getattr(functions, name)(np.abs(values) if "log" in name else values)
    yield "power", functions.power(np.abs(values), values[::-1])


def generators():
    """Yield what problems are made of: modes of bends, curves, BBOB instances and grown obstacles."""
    from swarm_gym.problem.geometry.bends import modes
    from swarm_gym.problem.geometry.curves import nearest_curves
    from swarm_gym.scenarios import Circle, make_scenario
    from swarm_gym.scenarios.growing import grown
    from swarm_gym.worlds import make_problem

    for count in (5, 30, 31):
        yield f"modes {count}", modes(count)
    paths = np.random.default_rng(SEED).random((3, 9, 2)).cumsum(axis=1)
    for number in (3, 8):
        yield f"curves {number}", nearest_curves(paths, number)
    for function in range(1, 25):
        table = make_problem(f"function:bbob-{function}-5-3").table
        for name, values in table._asdict().items():
            yield f"bbob {function} {name}", np.asarray(values, dtype=np.float64)
        for name, values in make_problem(f"metabox-bbob:{function}-10-biased").table._asdict().items():
            yield f"metabox {function} {name}", np.asarray(values, dtype=np.float64)
    for number, obstacle in enumerate(grown(make_scenario("case3"), 1.5).obstacles):
        shape = (obstacle.radius,) if isinstance(obstacle, Circle) else obstacle.vertices
        yield f"grown {number}", np.array(shape)


def golden():
    """Yield the courses of the golden files, bit by bit."""
    from swarm_gym.env import SwarmEnv
    from swarm_gym.optimizers import OPTIMIZERS

    for optimizer in OPTIMIZERS:
        for scenario in GOLDEN_SCENARIOS:
            yield f"{optimizer} on {scenario}", _course(SwarmEnv, optimizer, scenario)


def firefly():
    """Yield the courses of fireflies alone, for settings in which every kernel is compiled anew."""
    from swarm_gym.env import SwarmEnv

    for scenario in ("case1", "case2"):
        yield f"firefly on {scenario}", _course(SwarmEnv, "firefly", scenario)


def _course(make, optimizer, scenario):
    env = make(optimizer, scenario=scenario, iterations=8, initial_population_size=20)
    env.reset(seed=SEED)
    for iteration in range(8):
        env.step(np.array([20.0 + 8.0 * (-1) ** iteration, 0.25 * (iteration % 3)]))
    return env.simulation.history


def environments():
    """Yield observations and rewards of environments with all layouts, under actions of any size."""
    from swarm_gym.vector_env import SwarmVectorEnv

    for options in ENVIRONMENTS:
        env = SwarmVectorEnv(
            NUM_SWARMS, iterations=6, initial_population_size=8, max_population_size=40, **options
        )
        generator = np.random.default_rng(SEED)
        seen = [env.reset(seed=SEED)[0]]
        low, high = env.single_action_space.low, env.single_action_space.high
        for _ in range(6):
            shape = (NUM_SWARMS, len(low))
            observation, reward, *_ = env.step(low + (high - low) * generator.random(shape) ** 2)
            seen += [observation, reward[:, None]]
        yield json.dumps(options), np.concatenate([part.astype(np.float64) for part in seen], axis=1)


def of_each_recipe(names):
    """Return the first name of each recipe: training seeds of one recipe are numbered after a slash."""
    return sorted({name.partition("/")[0]: name for name in reversed(names)}.values())


def _policies_on_maps():
    """Return the policies that ship, without those of bit strings, which observe no iteration."""
    from swarm_gym.controllers.learned.policy_file import load_policy, packaged_policies, resolve
    from swarm_gym.optimizers import OPTIMIZERS

    named = packaged_policies()
    return [name for name in named if load_policy(resolve(name))[1]["optimizer"] in OPTIMIZERS]


def decisions():
    """Yield identity and decisions of a controller of each family, and of one file of each recipe."""
    from swarm_gym.controllers.distilled import packaged_rules
    from swarm_gym.controllers.open_loop import packaged_open_loops
    from swarm_gym.controllers.registry import CONTROLLERS, make_controller
    from swarm_gym.controllers.tuned import packaged_tuned
    from swarm_gym.observation import make_observation

    shipped = {
        "fixed": ["60"], "distilled": packaged_rules(), "learned": of_each_recipe(_policies_on_maps()),
        "open-loop": of_each_recipe(packaged_open_loops()), "reacting-loop": packaged_open_loops()[::20],
        "tuned": of_each_recipe(packaged_tuned()), "optimal": ["onemax", "onemax-four"],
        "share": ["lambda", "four"], "together": ["three-cases"],
    }  # fmt: skip
    for family in CONTROLLERS:
        for argument in shipped.get(family, [""]):
            name = f"{family}:{argument}" if argument else family
            controller = make_controller(name)
            controller.reset(NUM_SWARMS, seed=SEED)
            generator = np.random.default_rng(SEED)
            width = len(make_observation(controller.observation).features)
            made = []
            for iteration in (0, 1, 20, 70):
                observations = generator.random((NUM_SWARMS, width))
                if controller.observation == "theory":  # length and number of ones
                    observations = np.floor(100.0 * np.maximum(observations, [1.0, 0.0]))
                else:
                    observations[:, 3] = (
                        iteration if controller.observation.startswith("paper") else iteration / 100
                    )
                made.append(np.asarray(controller.act(observations), dtype=np.float64))
            yield name, np.stack(made)
            identity = json.dumps(controller.identity(), sort_keys=True).encode()
            yield f"identity of {name}", np.frombuffer(identity, dtype=np.uint8)


def of_each_family(recipes):
    """Return the last recipe of each family, whose names begin alike: ones with an addition come before.

    Policies over terrain are left out, whose optimizer no other fast test needs compiled for terrain.
    """
    families = {name.partition("-")[0]: name for name in recipes}
    return [name for family, name in families.items() if family != "terrain"]


def episodes():
    """Yield the results of an episode of one policy of each family of recipes."""
    from swarm_gym.controllers.learned.policy_file import packaged_policies

    yield from _episodes_of(of_each_family(of_each_recipe(packaged_policies())))


def other_episodes():
    """Yield the results of an episode of one policy of each recipe that `episodes` leaves out."""
    from swarm_gym.controllers.learned.policy_file import packaged_policies

    recipes = of_each_recipe(packaged_policies())
    yield from _episodes_of([name for name in recipes if name not in of_each_family(recipes)])


def _episodes_of(policies):
    """Yield the results of an episode of each policy, on the first map of its training."""
    from swarm_gym.controllers.registry import load_learned
    from swarm_gym.rollout import run_episodes
    from swarm_gym.scenarios.registry import expand_name
    from swarm_gym.training.config import stored_config

    for name in policies:
        controller = load_learned(name)
        config = stored_config(controller.manifest)
        first = expand_name(config.scenarios[0])[0]  # a name may stand for hundreds of maps
        found = run_episodes(
            controller, first, range(SEED, SEED + 1), config.optimizer, **config.env_options()
        )
        numbers = (found.final_fitness, found.evaluations, found.returns, found.sizes, found.repair_degrees)
        yield name, np.concatenate([part.ravel() for part in numbers])


PARTS = {
    part.__name__: part
    for part in (elementary, generators, golden, firefly, environments, decisions, episodes, other_episodes)
}


def digests(parts):
    """Return the digest of every array of some parts, by the names of part and array."""
    return {
        f"{part}: {name}": hashlib.sha256(np.ascontiguousarray(array).tobytes()).hexdigest()[:16]
        for part in parts
        for name, array in PARTS[part]()
    }


if __name__ == "__main__":
    sys.path[:0] = [str(Path(__file__).parents[2])]
    print(json.dumps(digests(sys.argv[1:])))
