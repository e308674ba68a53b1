"""The public names of the project, listed literally: whoever removes or renames one finds out here.

Scripts, stored results and papers of users refer to these names. A name may be added without a change here;
a name that goes breaks somebody's work, so remove it from these lists only on purpose.
"""

import ast
import json
import re
import sqlite3
import struct
from contextlib import closing
from pathlib import Path

import gymnasium
import numpy as np
import pytest

import swarm_gym.scenarios
from agents import CONTROLLERS, make_controller
from experiments.catalogue import COLLECTIONS, SUITES, TABLES, figures
from experiments.publish import DOCUMENTS
from experiments.runs.database import Results
from helpers.adapted import adapted
from swarm_gym.action import ACTIONS
from swarm_gym.controllers.learned.policy_file import POLICIES, packaged_policies
from swarm_gym.env import SwarmEnv
from swarm_gym.errors import SwarmGymError
from swarm_gym.history import HISTORY
from swarm_gym.observation import OBSERVATIONS
from swarm_gym.reset_options import RESET_OPTIONS
from swarm_gym.reward import REWARDS
from swarm_gym.scenarios import FAMILIES, SCENARIOS, make_scenarios
from swarm_gym.training.algorithms import EVERY_OPTION
from swarm_gym.training.presets import preset_names

ROOT = Path(__file__).parents[2]

# By environment, the parameters of its optimizer, which are options of `gymnasium.make`.
ENVIRONMENTS = {
    "swarm_gym/Firefly-v0": ("absorption", "attractiveness", "noise"),
    "swarm_gym/GenerationalFirefly-v0": ("absorption", "attractiveness", "least_attractiveness", "noise"),
    "swarm_gym/ParticleSwarm-v0": (
        "cognitive", "first_inertia", "inertia_factor", "last_inertia", "social", "velocity_limit",
    ),
    "swarm_gym/EliteGenetic-v0": ("crossover", "mutation"),
    "swarm_gym/Multivariate-v0": ("radius",),
    "swarm_gym/FishSwarm-v0": ("crowding", "step", "tries", "visual"),
    "swarm_gym/ImprovedFishSwarm-v0": (
        "crowding", "first_beta", "last_beta", "origin_pull", "smallest_step", "smallest_visual",
        "step", "tries", "visual",
    ),
    "swarm_gym/HybridFishSwarm-v0": (
        "crowding", "smallest_step", "smallest_visual", "step", "tries", "visual",
    ),
    "swarm_gym/Glowworm-v0": (
        "absorption", "decay", "decision_range", "dimming", "first_luciferin", "gain", "glow",
        "levels", "range_rule", "selection", "step", "wandering",
    ),
    "swarm_gym/AntColony-v0": ("deposit", "elite_weight", "evaporation", "sight_weight", "trail_weight"),
}  # fmt: skip
OPTIMIZERS = (
    "firefly", "generational-firefly", "particle-swarm", "elite-genetic", "multivariate", "fish-swarm",
    "improved-fish-swarm", "hybrid-fish-swarm", "glowworm", "ant-colony",
)  # fmt: skip
# Optimizers that are named as own code is, with the parameters of each; they need the extra `adapters`.
ADAPTED = {
    "swarm_gym.adapters.pymoo:Genetic": ("crossover", "crossover_index", "mutation_index"),
    "swarm_gym.adapters.pymoo:ParticleSwarm": ("velocity_limit",),
    "swarm_gym.adapters.niapy:ParticleSwarm": ("cognitive", "inertia", "social", "velocity_limit"),
    "swarm_gym.adapters.niapy:Firefly": ("absorption", "attractiveness", "cooling", "noise"),
}
# Options that every environment takes.
OPTIONS = (
    "scenario", "encoding", "num_waypoints", "num_control_points", "length_weight", "penalty",
    "cell_size", "iterations", "initial_population_size", "min_population_size", "max_population_size",
    "mean_weight", "action", "observation", "reward", "price", "reference_evaluations", "max_evaluations",
    "source", "smooth_share", "amplitude", "bends", "final_repair",
)  # fmt: skip
RESET_OPTION_NAMES = (
    "scenario", "initial_population", "initial_population_size", "smooth_share", "amplitude",
)  # fmt: skip
INFO = (
    "best_collision", "best_fitness", "best_path", "driven", "evaluations", "feasible_fitness",
    "feasible_path", "feasible_share",
    "optimality_gap", "population_size", "repair_degree", "repair_evaluations", "repaired_length",
    "repaired_path", "robot", "scenario",
)  # fmt: skip
HISTORY_COLUMNS = (
    "population_collision", "population_size", "repair_degree", "best_fitness", "evaluations",
    "best_collision", "feasible_fitness",
)  # fmt: skip
OBSERVATION_LAYOUTS = (
    "paper", "scaled", "extended", "rich", "priced", "corridors", "jumps", "told", "named",
)  # fmt: skip
ACTION_LAYOUTS = (
    "natural", "normalised", "paced", "extended", "extended-normalised", "extended-paced",
    "sourced", "sourced-normalised", "sourced-paced",
)  # fmt: skip
REWARD_NAMES = (
    "progress", "final", "final-gap", "optimality", "offline-error", "detour",
)  # fmt: skip
SINGLE_SCENARIOS = (
    "case1", "case2", "case3",
)  # fmt: skip
# By family, one name of each form; `swarm_gym.scenarios.expand_name` reads no file.
SCENARIO_FAMILIES = {
    "random-fields": (
        "random-fields:train:0-3", "random-fields:validation:0-3", "random-fields:test:0-3",
        "random-fields:denser:0-3", "random-fields:larger:0-3", "random-fields:narrow:0-3",
        "random-fields:large-obstacles:0-3", "random-fields:rotated:0-3",
    ),
    "rooms": ("rooms:0-3",),
    "caves": ("caves:0",),
    "moving-ai": ("moving-ai:arena#0-9", "moving-ai:arena?start=1,2&goal=3,4"),
    "den400d": ("den400d:P1-P6",),
    "ros": ("ros:playground?start=0,0&goal=1.5,-2&inflate=0.1",),
    "function": (
        "function:rastrigin-2", "function:sum-squares-2", "function:easom-2", "function:booth-2",
        "function:bohachevsky-2", "function:rastrigin-10-shifted:0-4", "function:bbob-15-10-3",
        "function:bbob-15-10-1-15",
    ),
    "ioh": ("ioh:bbob-8-5-1", "ioh:sbox-8-5-1-3", "ioh:cec2022-1001-10-1"),
    "block": ("block:500",),
    "open": ("open:500",),
    "routes": ("routes:turtlebot3", "routes:playground-A-C"),
    "dynamic": (
        "dynamic:case1-block@70", "dynamic:case1-passer@70", "dynamic:case1-gate@70",
        "dynamic:case2-block@70", "dynamic:case2-gate@70", "dynamic:case3-block@70",
        "dynamic:case3-gate@70", "dynamic:rooms:0-block@50-drive@40,every=5,distance=8",
        "dynamic:open:500-block@70", "dynamic:case3-drive@40,every=5,distance=80",
    ),
}  # fmt: skip
SCENARIO_EXPORTS = (
    "AnyScenario", "Appear", "BbobScenario", "Circle", "Disappear", "Drive", "DynamicScenario", "Event",
    "FAMILIES", "FunctionScenario", "GridMap", "GridScenario", "IohScenario", "MapScenario", "Move",
    "Obstacle", "Point", "Polygon", "SCENARIOS", "Scenario", "StaticScenario", "World", "drive_of",
    "expand_name", "make_scenario", "make_scenarios", "rasterised", "require_analytic", "sample_names",
    "world_at", "worlds_of",
)  # fmt: skip
# By controller family, its parameters.
CONTROLLER_FAMILIES = {
    "fixed": (),
    "spsfa": ("growth", "decay", "low_deviation", "initial_population_size", "smallest", "repair_factor"),
    "spsfa-tip": ("growth", "decay", "low_deviation", "initial_population_size", "smallest", "repair_factor"),
    "linear-reduction": ("start", "smallest", "repair_degree"),
    "diversity-ladder": ("start", "smallest", "repair_degree", "rung", "band"),
    "status-monitor": ("start", "smallest", "repair_degree", "patience", "improvement", "step"),
    "random": (),
    "open-loop": (),
    "learned": (),
    "tuned": (),
    "distilled": (),
}  # fmt: skip
# Packaged controllers besides the policies.
PACKAGED_CONTROLLERS = (
    "open-loop:random-fields", "open-loop:random-fields-extended", "open-loop:three-cases",
    "open-loop:three-cases-constant", "open-loop:three-cases-extended",
    "open-loop:three-cases-extended-13-knots@0.02", "open-loop:three-cases-extended@0.1",
    "open-loop:three-cases-extended@2", "open-loop:three-cases-long/0@1",
    "open-loop:three-cases-sourced/0@1",
    "tuned:dynamic-periodic/0@1", "tuned:dynamic-reaction/0@1",
    "tuned:random-fields", "tuned:three-cases", "tuned:three-cases-restart/0",
    "tuned:three-cases-schedule/0", "distilled:three-cases",
)  # fmt: skip
# By recipe, the number of training seeds: `learned:three-cases/0` to `learned:three-cases/9`.
PACKAGED_POLICIES = {
    "ablation-all": 5,
    "ablation-group-4": 5,
    "ablation-lambda": 5,
    "ablation-branching": 5,
    "ablation-from-start": 5,
    "ablation-imitation": 5,
    "ablation-steps-1M": 5,
    "ablation-steps-3M": 5,
    "ablation-steps-10M": 5,
    "ablation-dqn": 5,
    "dynamic-told": 5,
    "dynamic-robots": 5,
    "case1": 5,
    "case2": 5,
    "case3": 5,
    "dynamic": 5,
    "three-cases-evolution": 5,
    "random-fields-extended-ppo": 5,
    "random-fields-extended": 5,
    "random-fields": 5,
    "random-fields-sourced": 5,
    "three-cases-extended-ppo": 5,
    "three-cases-extended": 7,
    "three-cases-linear": 5,
    "three-cases-ppo": 1,
    "three-cases-sourced-ppo": 5,
    "three-cases-sourced": 5,
    "three-cases": 10,
}
# Entries of the manifests of packaged policies.
MANIFEST_ENTRIES = (
    "action", "base", "config", "corrected_from", "features", "format", "hidden_layers",
    "initial_population_size", "lstm_size", "max_evaluations", "max_population_size",
    "min_population_size", "network", "num_decisions", "observation", "optimizer", "price", "provenance",
    "steps", "validation", "validation_seeds", "weights_sha256",
)  # fmt: skip
PRESETS = (
    "ablation-all", "case1", "case2", "case3", "random-fields", "random-fields-extended",
    "random-fields-sourced", "three-cases", "three-cases-evolution", "three-cases-extended",
    "three-cases-linear", "three-cases-sourced", "three-cases-sourced-ppo",
    "optimizers", "optimizers-particle-swarm", "optimizers-elite-genetic", "optimizers-multivariate",
    "optimizers-generational-firefly", "optimizers-fish-swarm", "optimizers-improved-fish-swarm",
    "optimizers-hybrid-fish-swarm", "optimizers-ant-colony", "optimizers-glowworm", "optimizers-all",
    "optimizers-all-named", "optimizers-particle-swarm-sizes", "optimizers-elite-genetic-sizes",
    "optimizers-multivariate-sizes", "optimizers-generational-firefly-sizes",
    "optimizers-fish-swarm-sizes", "optimizers-improved-fish-swarm-sizes",
    "optimizers-hybrid-fish-swarm-sizes", "optimizers-firefly-sizes", "dynamic", "dynamic-told",
    "dynamic-robots",
)  # fmt: skip
SUITE_NAMES = (
    "paper", "headline", "generalisation", "out-of-distribution", "parameters", "moa-paper",
    "iafsa-functions", "iafsa-shifted", "iafsa-routes", "brand-yu-static", "brand-yu-dynamic",
    "brand-yu-grids", "dynamic", "newcomers", "newcomers-fields", "newcomers-ablation",
    "newcomers-optimizers",
    "newcomers-harmonics", "newcomers-harmonics-fields", "newcomers-stomp", "newcomers-stomp-fields",
    "adapters", "optimizers", "optimizers-grids", "optimizers-cells", "optimizers-transfer",
    "optimizers-transfer-cells", "bbob",
)  # fmt: skip
COLLECTION_NAMES = (
    "iafsa-paper", "brand-yu", "newcomers-study", "dynamic-study", "optimizers-study",
)  # fmt: skip
TABLE_NAMES = (
    "summary", "cases", "comparison", "reproduction", "headline", "gaps", "differences", "duels", "front",
    "near-optimum", "free-paths", "parameters", "moa", "iafsa-functions", "iafsa-convergence",
    "iafsa-shifted", "iafsa-routes", "recovery", "over-time", "seeing", "robots", "brand-yu-counts",
    "brand-yu-grids", "corridors", "claims",
    "newcomers-optimizers", "optimizers", "gains", "budgets", "areas", "transfer", "one-for-all",
    "bbob-groups", "bbob-rules",
)  # fmt: skip
FIGURE_NAMES = (
    "snapshots", "collision", "cases", "maps", "functions", "routes", "brand-yu-ways", "brand-yu-grids",
    "recovery", "profiles", "front", "decisions", "parameters", "first-populations", "corridors",
    "fronts", "policies",
)  # fmt: skip
DOCUMENT_NAMES = (
    "results", "study", "study-tables", "moa", "iafsa", "brand-yu", "dynamic", "newcomers", "scaling",
    "adapters", "optimizers", "scores", "bbob",
)  # fmt: skip
DATABASE = {
    "configuration": ("key", "value"),
    "runs": (
        "controller", "scenario", "seed", "final_fitness", "final_collision", "evaluations",
        "seconds", "best_path", "trace", "provenance", "columns", "way",
    ),
    "snapshots": ("controller", "scenario", "seed", "iteration", "paths", "collisions"),
}  # fmt: skip
# Commands as `python -m` knows them, each with its options and the names of its positional arguments.
COMMANDS = {
    "agents.train": (
        "--action", "--address", "--algorithm", "--averaging", "--backend", "--base", "--batch-size",
        "--branch-at-events", "--branches", "--candidates", "--clip-range", "--corrected-from", "--critic",
        "--decay-steps", "--degree-choices", "--device", "--discount", "--encoding", "--entropy-weight",
        "--epochs", "--exploration-steps", "--gae-lambda", "--gradient-steps", "--group-size",
        "--hidden-layers", "--initial-population-size", "--iterations", "--jobs", "--learning-rate",
        "--log-std", "--lstm-size", "--max-evaluations", "--max-population-size", "--min-population-size",
        "--name", "--noise-steps", "--num-swarms", "--observation", "--optimizer", "--preset", "--presets",
        "--price", "--reference", "--replay-size", "--resume", "--return-steps", "--reward",
        "--rollouts-per-chunk", "--runs", "--scenarios", "--seed", "--seeds", "--sigma", "--size-choices",
        "--target-kl", "--target-steps", "--threads", "--total-steps", "--validation-scenarios",
        "--validation-seeds", "--warm-start",
    ),
    "agents.tune": (
        "--action", "--address", "--backend", "--candidates", "--episodes", "--initial-amplitude",
        "--initial-population-size", "--initial-smooth-share", "--jobs", "--knots", "--max-population-size",
        "--min-population-size", "--name", "--optimizer", "--output", "--preset", "--price",
        "--resume", "--reward", "--runs", "--scenarios", "--seed", "--seeds", "--sigma", "--start",
        "--threads", "--total-steps", "--what",
    ),
    "swarm_gym.training.command_line": ("--preset", "--name", "--resume", "--seed", "--total-steps"),
    "swarm_gym.tuning.command_line": ("--what", "--preset", "--name", "--resume", "--seed", "--total-steps"),
    "swarm_gym.comparing.command_line": (
        "--first-seed", "--optimizer", "--output", "--price", "--scenarios", "--seeds", "controllers",
    ),
    "agents.distil": (
        "--episodes", "--numbers", "--output", "--report-seeds", "--rounds", "--seed",
        "--validation-seeds", "policy",
    ),
    "agents.import_sb3": (
        "--action", "--initial-population-size", "--max-evaluations", "--max-population-size",
        "--min-population-size", "--observation", "--optimizer", "--trust-pickle", "output", "zip",
    ),
    "agents.export_onnx": ("output", "policy"),
    "experiments.evaluate": (
        "--address", "--backend", "--controllers", "--database", "--figures", "--jobs", "--output",
        "--seeds", "--simulate", "--suite",
    ),
    "experiments.bbob": (
        "--budget", "--controllers", "--dimensions", "--functions", "--instances", "--iterations",
        "--optimizer", "--output", "--parameters", "--seed",
    ),
    "experiments.benchmark": ("--groups", "--output", "--repeats"),
    "experiments.benchmark_gpu": ("--output", "--repeats"),
    "experiments.branching": ("--controller", "--output", "--scenarios", "--seeds", "--threads"),
    "experiments.frame": (),
    "experiments.gallery": (),
    "experiments.publish": ("--evaluate", "--results", "documents"),
    "experiments.readings": ("--case", "--controllers", "--output", "--seeds"),
    "experiments.scores": ("--address", "--backend", "--jobs", "--output", "--results", "suites"),
    "experiments.verify": ("--claim", "--output", "--scores", "--suite", "files"),
    "experiments.sensitivity": ("--output", "--policy", "--scenarios", "--seeds", "--threads"),
    "experiments.video": (
        "--controller", "--fps", "--height", "--iterations", "--output", "--scenario", "--seed",
        "--width",
    ),
    "experiments.with_ray_tune": (
        "--address", "--jobs", "--preset", "--rungs", "--runs", "--seed", "--total-steps", "--trials",
    ),
    "experiments.playground": ("--scenarios", "output"),
    "experiments.report": ("--figures", "--output", "--replays", "--suite", "database"),
    "experiments.scaling": (
        "--nodes", "--output", "--sample", "--seconds", "--training-steps", "--units",
        "--units-per-worker",
    ),
    "experiments.site.check_links": (),
    "swarm_gym.warm_up": (),
    "swarm_gym.scenarios.download": ("--force", "names"),
    "swarm_gym.reference.waypoint_optimum": (
        "--length-weight", "--num-waypoints", "--ship", "--threads", "names",
    ),
    "experiments.speed.peers": ("--output", "--repeats"),
}  # fmt: skip


def assert_all(expected, actual):
    missing = [name for name in expected if name not in actual]
    assert not missing, f"public names that are gone: {', '.join(map(str, missing))}"


def words_of_refusal(call, *arguments, **options):
    """Return the words of the error that refuses an unknown option, which has those that there are."""
    with pytest.raises((SwarmGymError, ValueError)) as refused:
        call(*arguments, **options)
    return {*re.findall(r"[\w-]+", str(refused.value)), *getattr(refused.value, "valid", ())}


def test_every_environment_optimizer_and_option_is_there():
    for (environment, parameters), optimizer in zip(ENVIRONMENTS.items(), OPTIMIZERS, strict=True):
        assert gymnasium.spec(environment).kwargs == {"optimizer": optimizer}
        valid = words_of_refusal(gymnasium.make, environment, no_such_option=1)
        assert_all((*OPTIONS, *parameters), valid)


@pytest.mark.parametrize("name", adapted())
def test_every_adapted_algorithm_and_parameter_is_there(name):
    assert_all((*OPTIONS, *ADAPTED[name]), words_of_refusal(SwarmEnv, name, no_such_option=1))


def test_every_reset_option_and_info_is_there():
    assert_all(RESET_OPTION_NAMES, RESET_OPTIONS)
    env = gymnasium.make(
        "swarm_gym/Firefly-v0",
        iterations=1,
        scenario="dynamic:case3-drive@40,every=5,distance=80",
        source="smooth",
        amplitude=0.1,
        initial_population_size=200,
        final_repair=True,
    )
    env.reset(seed=0)  # with a feasible member
    *_, info = env.step(np.array([200, 0.5]))
    assert_all(INFO, info)


@pytest.mark.parametrize(
    ("expected", "actual"),
    [
        (HISTORY_COLUMNS, HISTORY),
        (OBSERVATION_LAYOUTS, OBSERVATIONS),
        (ACTION_LAYOUTS, ACTIONS),
        (REWARD_NAMES, REWARDS),
        (SINGLE_SCENARIOS, SCENARIOS),
        (SCENARIO_FAMILIES, FAMILIES),
        (SCENARIO_EXPORTS, vars(swarm_gym.scenarios)),
        (CONTROLLER_FAMILIES, CONTROLLERS),
        (PRESETS, preset_names()),
        (SUITE_NAMES, SUITES),
        (COLLECTION_NAMES, COLLECTIONS),
        (TABLE_NAMES, TABLES),
        (FIGURE_NAMES, figures()),
        (DOCUMENT_NAMES, DOCUMENTS),
    ],
    ids=[
        "history", "observations", "actions", "rewards", "scenarios", "families", "exports", "controllers",
        "presets", "suites", "collections", "tables", "figures", "documents",
    ],
)  # fmt: skip
def test_every_registered_name_is_there(expected, actual):
    assert_all(expected, actual)


def test_every_form_of_scenario_names_is_read():
    for names in SCENARIO_FAMILIES.values():
        for name in names:
            assert swarm_gym.scenarios.expand_name(name)
    assert len(make_scenarios("rooms:0-1")) == 2


def test_every_parameter_of_controllers_is_there():
    for family, parameters in CONTROLLER_FAMILIES.items():
        if parameters:
            assert_all(parameters, words_of_refusal(make_controller, f"{family}:no_such_parameter=1"))


def test_every_packaged_controller_is_there():
    for name in PACKAGED_CONTROLLERS:
        make_controller(name)
    for recipe, number in PACKAGED_POLICIES.items():
        assert_all((f"{recipe}/{seed}" for seed in range(number)), packaged_policies())


def test_a_packaged_policy_has_every_entry_of_manifests():
    found = set()
    for recipe in PACKAGED_POLICIES:
        content = POLICIES.find(f"{recipe}/0").read_bytes()
        (length,) = struct.unpack("<Q", content[:8])
        header = json.loads(content[8 : 8 + length])
        found |= set(json.loads(header["__metadata__"]["manifest"]))
    assert_all(MANIFEST_ENTRIES, found)


def test_every_table_and_column_of_the_database_is_there(tmp_path):
    path = tmp_path / "results.db"
    Results(path).close()
    with closing(sqlite3.connect(path)) as connection:
        for table, columns in DATABASE.items():
            there = [row[1] for row in connection.execute(f"PRAGMA table_info({table})")]
            assert_all(columns, there)


@pytest.mark.parametrize("command", COMMANDS)
def test_every_option_of_commands_is_there(command):
    assert_all(COMMANDS[command], options_of(_file_of(command)))


def options_of(file):
    """Return the options of a command from its source, since importing all of them takes seconds.

    They are the fields of the dataclass that the command gives to `tyro.cli`, or the arguments that it adds
    to a parser.
    """
    tree = ast.parse(file.read_text())
    called = [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
    assert _definition(tree, "main"), f"{file} has no main()"
    found = []
    for call in called:
        if ast.unparse(call.func) == "tyro.cli":
            found += _fields(tree, ast.unparse(call.args[0]))
        elif ast.unparse(call.func).endswith(".add_argument"):
            found.append(call.args[0].value)
    return found


def _fields(tree, name):
    """Yield the options of a dataclass that a module defines or imports, those of its parts included."""
    definition = _definition(tree, name)
    if definition is None:
        (module,) = [
            node.module
            for node in ast.walk(tree)
            if isinstance(node, ast.ImportFrom) and name in [alias.name for alias in node.names]
        ]
        file = _file_of(module)
        yield from _fields(ast.parse(file.read_text()), name)
        return
    for field in definition.body:
        if isinstance(field, ast.AnnAssign):
            kind = ast.unparse(field.annotation)
            if "AvoidSubcommands[AnyAlgorithm]" in kind:
                yield "--algorithm"
                yield from (f"--{option.replace('_', '-')}" for option in EVERY_OPTION)
            elif inner := re.fullmatch(r"tyro\.conf\.OmitArgPrefixes\[(\w+)\]", kind):
                yield from _fields(tree, inner[1])
            else:
                option = field.target.id.replace("_", "-")
                yield option if "Positional" in kind else f"--{option}"


def _definition(tree, name):
    kinds = (ast.ClassDef, ast.FunctionDef)
    return next((node for node in tree.body if isinstance(node, kinds) and node.name == name), None)


def _file_of(module):
    """Return the file that `python -m` runs, or that an import reads."""
    place = ROOT / module.replace(".", "/")
    files = (place.with_suffix(".py"), place / "__main__.py", place / "__init__.py")
    return next(file for file in files if file.is_file())
