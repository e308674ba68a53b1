"""Configurations of experiments: everything that runs depend on, which a results database compares."""

import dataclasses
import json
from collections.abc import Mapping
from typing import Any

from agents import CONTROLLERS, Controller
from experiments.runs.entries import FROM_CONTENT, IDENTITIES, KEY
from experiments.runs.episode import controller_of
from experiments.runs.experiment import Experiment
from swarm_gym.comparing.entrants import entrant, with_encoding
from swarm_gym.controllers.names import BLINDED, ControllerName
from swarm_gym.optimizers import ALL_OPTIMIZERS, get_optimizer
from swarm_gym.own_code import origin_of
from swarm_gym.problem.grid.problem import WISH_WEIGHTS
from swarm_gym.reference.optima import digest
from swarm_gym.settings import Settings
from swarm_gym.worlds import make_problem

# An option that is added later is stated where it is not the default, so that databases without it stay
# usable.
ALWAYS_STATED = (
    "num_waypoints", "length_weight", "cell_size", "clearance", "iterations", "min_population_size",
    "max_population_size", "source", "smooth_share", "amplitude", "bends", "mean_weight", "reward",
    "reference_evaluations", "knobs",
)  # fmt: skip
NEVER_STATED = (
    # These vary within an experiment; they are part of the controllers and the runs.
    "scenario", "observation", "action", "initial_population_size", "max_evaluations", "price",
    # These change nothing that a run stores.
    "final_repair", "made_for",
    # These are part of the problems of the scenarios.
    "encoding", "num_control_points", "penalty", *WISH_WEIGHTS, "cost",
)  # fmt: skip


def configuration(experiment: Experiment) -> dict[str, Any]:
    """Return the values that the runs of an experiment depend on, by key; the database compares them."""
    controllers = {f"{KEY}{name}": found for name, found in identities(experiment).items()}
    return {**environment_configuration(experiment), IDENTITIES: FROM_CONTENT, **controllers}


def identities(experiment: Experiment) -> dict[str, Any]:
    """Return what each controller of an experiment is, by its name in the experiment."""
    found = {}
    for name in experiment.controllers:
        optimizer, controller, _ = entrant(name, experiment.optimizer)
        found[name] = identity(controller, controller_of(controller))
        if optimizer != experiment.optimizer and _may_change(optimizer):
            found[name] = [found[name], origin_of("optimizer", optimizer)]
    return found


def changed_since(name: str, experiment: Experiment, identities: Mapping[str, str]) -> bool:
    """Return whether a controller of an experiment is another one in this process than is stated.

    A worker process loads files of controllers itself, perhaps after somebody has replaced them. Own code is
    not compared: its file may be edited while a process still runs what it has imported.

    Args:
        name: name of the controller in the experiment.
        experiment: experiment that gives the optimizer.
        identities: stated identities by name, as JSON.
    """
    optimizer, controller, _ = entrant(name, experiment.optimizer)
    if name not in identities or not _is_packaged(controller) or _may_change(optimizer):
        return False
    here = json.dumps(controller_of(controller).identity(), sort_keys=True)
    return identities[name] != here


def _may_change(optimizer: str) -> bool:
    """Return whether an optimizer is code of the user, which has no version."""
    return optimizer not in ALL_OPTIMIZERS and not optimizer.startswith("swarm_gym.")


def identity(name: str, controller: Controller) -> Any:
    """Return what a controller is, beyond its name; for own code, also the digest of the code."""
    if _is_packaged(name):
        return controller.identity()
    return name, origin_of("controller", name), controller.identity()


def _is_packaged(name: str) -> bool:
    """Return whether the code of a controller is this package's, even if a file of the user describes it."""
    return ControllerName.parse(name).family in (*CONTROLLERS, BLINDED)


def optimizers_of(experiment: Experiment) -> set[str]:
    """Return the names of the optimizers of an experiment."""
    return {entrant(name, experiment.optimizer).optimizer for name in experiment.controllers}


def environment_configuration(experiment: Experiment) -> dict[str, Any]:
    """Return the part of `configuration` without controllers, whose policies may be missing here."""
    settings = Settings.from_options(
        get_optimizer(experiment.optimizer), {"scenario": experiment.scenarios[0], **experiment.options}
    )
    found: dict[str, Any] = {"optimizer": experiment.optimizer, "settings": stated(settings)}
    if experiment.optimizer not in ALL_OPTIMIZERS:
        found["optimizer"] = f"{experiment.optimizer}, {origin_of('optimizer', experiment.optimizer)}"
    # Given ones win over those of controllers.
    found |= {name: experiment.options.get(name) for name in ("max_evaluations", "price")}
    options: dict[str, Any] = with_encoding(optimizers_of(experiment), experiment.options)
    options.pop("iterations", None)  # an entrant may have its own, and problems do not depend on them
    for name in experiment.scenarios:
        problem = make_problem(name, **options)
        found[f"scenario {name}"] = [digest(problem), getattr(problem.scenario, "initial_range", None)]
    return found


def stated(settings: Settings) -> dict[str, Any]:
    """Return the options of environments that a database compares, by name."""
    defaults = {option.name: option.default for option in dataclasses.fields(settings)}
    return {
        name: value
        for name, value in dataclasses.asdict(settings).items()
        if name in ALWAYS_STATED or (name not in NEVER_STATED and value != defaults[name])
    }
