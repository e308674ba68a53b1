"""The configuration of a suite: everything that its runs depend on, which a results database compares."""

import dataclasses
from typing import Any

from agents import CONTROLLERS, Controller
from experiments.runs.entrants import entrant
from experiments.runs.episode import controller_of
from experiments.runs.suite import Suite
from swarm_gym.controllers.controller import SizeLimits
from swarm_gym.controllers.distilled import DistilledRule
from swarm_gym.controllers.learned.networks import FeedforwardController
from swarm_gym.controllers.names import BLINDED, ControllerName
from swarm_gym.controllers.open_loop import OpenLoop
from swarm_gym.controllers.reacting_loop import ReactingLoop
from swarm_gym.controllers.tuned import load_tuned
from swarm_gym.optimizers import OPTIMIZERS, get_optimizer
from swarm_gym.own_code import origin_of
from swarm_gym.reference.optima import digest
from swarm_gym.settings import Settings, make_problem


def configuration(suite: Suite) -> dict[str, Any]:
    """Return the values that the runs of a suite depend on, by key; the database compares them."""
    found = environment_configuration(suite)
    for name in suite.controllers:
        controller_name = entrant(name, suite.optimizer).controller
        found[f"controller {name}"] = identity(controller_name, controller_of(controller_name))
    return found


def identity(name: str, controller: Controller) -> Any:
    """Return what a controller is, beyond its name: the content of its file, or a digest of own code.

    Files may be replaced under the same name, and code may change. Other controllers have their name only.
    """
    parts = ControllerName.parse(name)
    if parts.family not in CONTROLLERS and parts.family != BLINDED:
        return name, origin_of("controller", name)
    if parts.family == BLINDED:
        policy = f"learned:{parts.argument}"
        return BLINDED, identity(policy, controller_of(policy))
    if parts.family == "tuned":
        tuned = load_tuned(parts.argument)
        sizes = dataclasses.astuple(tuned.limits)
        return tuned.controller if tuned.limits == SizeLimits() else (tuned.controller, sizes)
    if isinstance(controller, FeedforwardController):
        return _identity_of_policy(controller)
    loop = controller.loop if isinstance(controller, ReactingLoop) else controller
    if isinstance(loop, OpenLoop):
        first = loop.first_source
        source = () if first is None else (dataclasses.astuple(first),)
        return loop.initial_population_size, loop.decisions.tolist(), *source
    return controller.lines() if isinstance(controller, DistilledRule) else name


def _identity_of_policy(controller: FeedforwardController) -> Any:
    """Return the digest of a policy's weights; with a base, also when it corrects which controller."""
    manifest = controller.manifest
    base = manifest["base"]
    if base == "none":
        return manifest["weights_sha256"]
    return manifest["weights_sha256"], manifest["corrected_from"], identity(base, controller_of(base))


def environment_configuration(suite: Suite) -> dict[str, Any]:
    """Return the part of `configuration` without controllers, whose policies may be missing here."""
    settings = dataclasses.asdict(
        Settings.from_options(
            get_optimizer(suite.optimizer), {"scenario": suite.scenarios[0], **suite.options}
        )
    )
    # These vary within a suite; they are part of the controllers and the runs.
    for name in ("scenario", "observation", "action", "initial_population_size", "max_evaluations", "price"):
        del settings[name]
    for name in ("final_repair", "made_for"):  # these change nothing that a run stores
        del settings[name]
    # These are part of the problems of the scenarios.
    for name in ("encoding", "num_control_points", "penalty"):
        del settings[name]
    found: dict[str, Any] = {"optimizer": suite.optimizer, "settings": settings}
    if suite.optimizer not in OPTIMIZERS:
        found["optimizer"] = f"{suite.optimizer}, {origin_of('optimizer', suite.optimizer)}"
    for name in suite.scenarios:
        problem = make_problem(name, **suite.options)
        found[f"scenario {name}"] = [digest(problem), getattr(problem.scenario, "initial_range", None)]
    return found
