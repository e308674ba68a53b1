"""Environments of a training: the swarms of the policy, and of the reference of a paired reward."""

import hashlib
import json
from typing import Any

import gymnasium
from gymnasium.vector import AutoresetMode, VectorEnv

from swarm_gym.action import layout_of, make_action
from swarm_gym.checks import require_integer
from swarm_gym.controllers import Controller, make_controller
from swarm_gym.controllers.controller import beside_ways
from swarm_gym.controllers.learned.residual import Base
from swarm_gym.observation import make_observation
from swarm_gym.optimizers import get_optimizer
from swarm_gym.own_code import is_own, origin_of
from swarm_gym.registration import environment_id
from swarm_gym.settings import Settings
from swarm_gym.sources import GUIDED, UNIFORM, Source
from swarm_gym.training.config import PAIRED, EnvOptions, TrainConfig
from swarm_gym.training.learners.checks import has_groups
from swarm_gym.wrappers.paired_reward import Reference


def make_swarms(
    config: TrainConfig, num_swarms: int, autoreset_mode: AutoresetMode
) -> tuple[VectorEnv, Base | None]:
    """Return the vector environment of a configuration, and the base that the policy corrects, if any.

    With a base, observations have the columns of the base and then the columns of the policy. A base that
    states the source of its first population begins the episodes of the policy, too.

    Raises:
        ValueError: for options that exclude each other.
    """
    if layout_of(config.action).size == "natural":
        raise ValueError(f"action {config.action!r}: a policy decides in a layout scaled to [-1, 1]")
    require_integer("corrected_from", config.corrected_from, 0, config.iterations - 1)
    if config.corrected_from and config.base == "none":
        raise ValueError(
            f"corrected_from {config.corrected_from}: without a base there is nothing to correct"
        )
    controller = make_base(config)
    observation = config.observation
    if controller is not None:
        observation = f"{controller.observation}+{observation}"
    env = _make_env(
        config,
        num_swarms,
        autoreset_mode,
        {
            **config.env_options(),
            "observation": observation,
            "action": config.action,
            **beside_ways(config.source, _options_of(*first_population(config, controller))),
        },
    )
    inner: Any = env.unwrapped
    if config.algorithm.noise_steps != 1 and not has_groups(config) and inner.simulation.may_end_early:
        raise ValueError(
            f"noise_steps {config.algorithm.noise_steps}: steps that share noise share an advantage, so "
            "episodes must end together, but these may end early; set noise_steps to 1"
        )
    if controller is None:
        return env, None
    layout = make_action(inner.settings, get_optimizer(config.optimizer))
    try:
        base = Base(controller, layout, config.corrected_from, inner.settings.max_evaluations)
    except ValueError as error:
        raise ValueError(f"base {config.base!r}: {error}") from error
    if config.corrected_from and base.iteration_unit not in (1, config.iterations):
        raise ValueError(
            f"corrected_from {config.corrected_from}: base {config.base!r} observes the iteration as a share "
            f"of {base.iteration_unit}, so iterations must be {base.iteration_unit}, got {config.iterations}"
        )
    return env, base


def parts_of(config: TrainConfig) -> list[TrainConfig]:
    """Return a configuration for each optimizer of a training, with its share of the swarms."""
    if not config.algorithm.also_on:
        return [config]
    share = config.num_swarms // len(config.optimizers)
    return [
        config.changed(optimizer=optimizer, also_on=(), num_swarms=share) for optimizer in config.optimizers
    ]


def make_base(config: TrainConfig) -> Controller | None:
    """Return the controller that the policy corrects, if any."""
    return None if config.base == "none" else make_controller(config.base, config.limits)


def first_population(config: TrainConfig, base: Controller | None) -> tuple[int, Source | None]:
    """Return PS(0) and the source of the first population, from a base that states its source.

    Otherwise, PS(0) is an option of the run, and the source, None, is left to the environment.
    """
    if base is None or base.first_source is None:
        return config.initial_population_size, None
    return base.initial_population_size, base.first_source


def stated_source(config: TrainConfig, source: Source | None) -> Source | None:
    """Return a source of first members that a controller states, or that of the environments of a training.

    It is None for the default of environments, and for planned ways, which depend on the map.
    """
    if source is None and config.source not in (UNIFORM, GUIDED):
        return Settings(source=config.source).new_members
    return source


def _options_of(size: int, source: Source | None) -> dict[str, Any]:
    return {"initial_population_size": size, **(source.options() if source is not None else {})}


def make_reference(config: TrainConfig, num_swarms: int) -> Reference | None:
    """Return the reference of a paired reward in its own swarms; None for other rewards.

    Raises:
        ValueError: for a reference whose episodes begin with another first population than the policy's.
    """
    if config.reward != PAIRED:
        return None
    controller, options = reference_controller(config)
    _require_equal_starts(config, controller)
    needed = controller.options_with(options)
    return Reference(controller, _make_env(config, num_swarms, AutoresetMode.SAME_STEP, needed))


def reference_controller(config: TrainConfig) -> tuple[Controller, EnvOptions]:
    """Return the reference controller, and the options of its environments besides the controller's own.

    The reference has neither a price nor the policy's budget, so that it does not depend on these.

    Raises:
        ValueError: for a controller that observes the price.
    """
    controller = make_controller(config.reference, config.limits)
    if controller.price is not None:
        raise ValueError(f"reference {config.reference!r}: it observes a price, but a reference pays none")
    return controller, {**config.env_options(), "price": 0.0, "max_evaluations": None}


def controllers_beside(config: TrainConfig) -> dict[str, Controller]:
    """Return the base and the reference of a training, those that it has, by their options."""
    names = {"base": config.base, **({"reference": config.reference} if config.reward == PAIRED else {})}
    return {role: make_controller(name, config.limits) for role, name in names.items() if name != "none"}


def digests_of_controllers(config: TrainConfig) -> dict[str, str]:
    """Return a digest of what the base and the reference of a training are, by their options."""
    found = {}
    for role, one in controllers_beside(config).items():
        name = getattr(config, role)
        code = origin_of("controller", name) if is_own("controller", name) else None
        said = json.dumps([one.identity(), code], sort_keys=True, default=lambda value: type(value).__name__)
        found[role] = hashlib.sha256(said.encode()).hexdigest()
    return found


def draws_numbers(config: TrainConfig) -> bool:
    """Return whether the base or the reference of a training draws random numbers in its episodes."""
    for one in controllers_beside(config).values():
        controller: Controller | None = one
        while controller is not None:
            if controller.draws_numbers:
                return True
            controller = controller.corrects
    return False


def _require_equal_starts(config: TrainConfig, reference: Controller) -> None:
    """Raise an error if a reference begins with another first population than the policy."""
    size, source = first_population(config, make_base(config))
    source = stated_source(config, source)
    theirs = reference.initial_population_size, stated_source(config, reference.first_source)
    if theirs != (size, source):
        with_source = f" from the source {source}, theirs from {theirs[1]}" if theirs[1] != source else ""
        raise ValueError(
            f"reference {config.reference!r} begins with {theirs[0]} members, but the policy with {size}"
            f"{with_source}: a paired reward compares equal starts; change initial_population_size, or name "
            f"a reference with the policy's, e.g. spsfa-tip:initial_population_size={size}"
        )


def _make_env(
    config: TrainConfig, num_swarms: int, autoreset_mode: AutoresetMode, options: dict[str, Any]
) -> VectorEnv:
    return gymnasium.make_vec(
        environment_id(config.optimizer),
        num_envs=num_swarms,
        scenario=list(config.scenarios),
        autoreset_mode=autoreset_mode,
        num_threads=config.threads,
        device=config.algorithm.device,
        **options,
    )


def feature_names(config: TrainConfig, base: Base | None) -> list[str]:
    """Return the names of the policy's observation features."""
    if base is not None:
        return base.features(config.observation)
    return [feature.name for feature in make_observation(config.observation).features]
