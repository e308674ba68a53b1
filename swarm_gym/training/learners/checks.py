"""Checks of the options of algorithms, before anything is made."""

import math
from itertools import pairwise

from swarm_gym.action import require_same_decisions
from swarm_gym.checks import require_integer, require_number
from swarm_gym.controllers.learned.manifest import MAX_LAYERS, MAX_WIDTH
from swarm_gym.controllers.learned.policy_file import MAX_FILE
from swarm_gym.errors import UnknownNameError
from swarm_gym.observation import make_observation
from swarm_gym.optimizers import get_optimizer
from swarm_gym.runs.seeds import ANALYSIS, VALIDATION
from swarm_gym.scenarios import expand_name
from swarm_gym.training.algorithms import (
    ClippedOptions,
    Evolution,
    GradientOptions,
    GroupedOptions,
    RecurrentPPO,
)
from swarm_gym.training.config import PAIRED, TrainConfig

DEVICES = ("cpu", "cuda")

LARGEST_AVERAGING = 0.9999
BYTES = 4  # of a weight


def require_options(config: TrainConfig) -> None:
    """Raise an error for options that are out of their ranges, or that exclude each other.

    Raises:
        UnknownNameError: for a device that does not exist.
        ValueError: naming the option and its value.
    """
    options = config.algorithm
    _require_shared(config)
    if options.device not in DEVICES:
        raise UnknownNameError("device", options.device, DEVICES)
    if config.base != "none" and options.warm_start != "none":
        raise ValueError(
            f"base {config.base!r} and warm_start {options.warm_start!r} exclude each other: a policy that "
            "corrects a controller begins as that one; set warm_start to 'none'"
        )
    require_integer("group_size", options.group_size, 1, config.num_swarms)
    require_integer("noise_steps", options.noise_steps, 0, config.iterations)
    require_number("averaging", options.averaging, 0.0, LARGEST_AVERAGING)
    require_integer("decay_steps", options.decay_steps, 0)
    if 0 < options.decay_steps < config.total_steps:
        raise ValueError(
            "decay_steps must be 0 or at least total_steps, got "
            f"{options.decay_steps} and {config.total_steps}"
        )
    require_integer("rollout_steps", options.rollout_steps, 0)
    if options.rollout_steps and (has_groups(config) or options.noise_steps != 1 or config.corrected_from):
        raise ValueError(
            f"rollout_steps {options.rollout_steps}: groups, noise that is held, and a base that begins "
            "alone need whole episodes; set rollout_steps to 0"
        )
    for first in options.branches:
        require_integer("branches", first, config.corrected_from, config.iterations - 1)
    if config.num_swarms % options.group_size:
        raise ValueError(
            f"num_swarms must be a multiple of group_size, got {config.num_swarms} and {options.group_size}"
        )
    _require_joinable(config)
    if options.branch_at_events and options.group_size == 1:
        raise ValueError("branch_at_events needs groups of several swarms, got group_size 1")
    if isinstance(options, GroupedOptions) and not options.critic and options.gae_lambda != 1.0:
        raise ValueError(f"without a critic, gae_lambda must be 1, got {options.gae_lambda}")
    if has_groups(config) or options.noise_steps != 1:
        _require_common_length(config)


def _require_shared(config: TrainConfig) -> None:
    """Raise an error for options of all algorithms that are out of their ranges."""
    require_integer("seed", config.seed, 0, 2**31 - 1)
    require_integer("threads", config.threads, 1)
    require_integer("total_steps", config.total_steps, 0, 10**12)
    for name in ("iterations", "num_swarms", "rollouts_per_chunk"):
        require_integer(name, getattr(config, name), 1)
    require_integer("validation_seeds", config.validation_seeds, 1, ANALYSIS.start - VALIDATION.start)
    for name in config.validation_scenarios:
        expand_name(name)  # raises an error for one that does not exist
    _require_network(config)
    if isinstance(config.algorithm, RecurrentPPO):
        _require_iterations(config)
    if isinstance(config.algorithm, GradientOptions):
        # The library normalises the advantages of a minibatch, which one step does not have.
        least = 2 if isinstance(config.algorithm, ClippedOptions) else 1
        require_number("learning_rate", config.algorithm.learning_rate, 0.0, 1e9)
        require_integer("batch_size", config.algorithm.batch_size, least)
        require_number("discount", config.algorithm.discount, 0.0, 1.0)
    if isinstance(config.algorithm, ClippedOptions):
        _require_clipped(config, config.algorithm)
    if isinstance(config.algorithm, Evolution):
        require_integer("candidates", config.algorithm.candidates, 2)
        require_number("sigma", config.algorithm.sigma, 1e-9, 1e9)


def _require_network(config: TrainConfig) -> None:
    """Raise an error for a network that no policy file can hold."""
    layers, memory = config.hidden_layers, config.algorithm.lstm_size
    require_integer("number of hidden_layers", len(layers), 0, MAX_LAYERS)
    for size in layers:
        require_integer("hidden_layers", size, 1, MAX_WIDTH)
    if memory is not None:
        require_integer("lstm_size", memory, 1, MAX_WIDTH)
    numbers = sum(into * out for into, out in pairwise(layers)) + 4 * (memory or 0) ** 2
    if BYTES * numbers > MAX_FILE:
        raise ValueError(
            f"hidden_layers {list(layers)} and lstm_size {memory}: a policy has at least {BYTES * numbers} "
            f"bytes, expected at most {MAX_FILE}"
        )


def _require_clipped(config: TrainConfig, options: ClippedOptions) -> None:
    """Raise an error for options of proximal policy optimization that are out of their ranges."""
    require_integer("epochs", options.epochs, 1)
    require_number("gae_lambda", options.gae_lambda, 0.0, 1.0)
    require_number("log_std", options.log_std, -20.0, 5.0)
    require_number("entropy_weight", options.entropy_weight, -1e9, 1e9)
    for name in ("clip_range", "target_kl"):
        require_number(name, getattr(options, name), 1e-9, math.inf)
    steps = options.rollout_steps if options.rollout_steps > 0 else config.iterations
    if config.num_swarms * steps < 2:
        raise ValueError(
            f"num_swarms {config.num_swarms} and iterations {config.iterations}: a rollout has one step, "
            "expected at least 2"
        )


def _require_iterations(config: TrainConfig) -> None:
    """Raise an error if policies with a memory would not see where an episode begins."""
    if any(feature.needs_bits for feature in make_observation(config.observation).features):
        raise ValueError(
            f"observation {config.observation!r} has no iteration, by which {config.algorithm.name} begins "
            "its memory; choose another algorithm"
        )


def _require_joinable(config: TrainConfig) -> None:
    """Raise an error if the optimizers of a training cannot be trained on together."""
    options = config.algorithm
    if not options.also_on:
        return
    for option in ("branches", "branch_at_events"):
        if getattr(options, option):
            raise ValueError(f"also_on and {option} exclude each other, got {getattr(options, option)!r}")
    evolution = isinstance(options, Evolution)  # earns whole episodes, and so needs no groups
    if not evolution and (options.group_size == 1 or options.warm_start != "none" or options.critic):
        raise ValueError(
            "also_on needs groups without a critic and without imitation, got group_size "
            f"{options.group_size}, critic {options.critic}, warm_start {options.warm_start!r}"
        )
    if config.num_swarms % (len(config.optimizers) * options.group_size):
        raise ValueError(
            f"num_swarms must be a multiple of group_size {options.group_size} times "
            f"{len(config.optimizers)} optimizers, got {config.num_swarms}"
        )
    for name in options.also_on:
        require_same_decisions(config.optimizer, config.action, get_optimizer(name))


def has_groups(config: TrainConfig) -> bool:
    """Return whether swarms begin in groups, or after iterations that are not part of the training."""
    return config.algorithm.group_size > 1 or bool(config.algorithm.branches)


def _require_common_length(config: TrainConfig) -> None:
    """Raise an error if swarms of a group, or steps that share noise, cannot be compared."""
    options = config.algorithm
    if config.max_evaluations and (options.group_size == 1 or options.noise_steps != 0 or options.branches):
        raise ValueError(
            f"max_evaluations {config.max_evaluations}: episodes of a group end at different iterations, and "
            "only whole returns can be compared; set noise_steps to 0 and no branches, or group_size and "
            f"noise_steps to 1, got group_size {options.group_size}, noise_steps {options.noise_steps} and "
            f"branches {list(options.branches)}"
        )
    if config.reward == PAIRED and has_groups(config):
        raise ValueError(
            f"reward {PAIRED!r} and group_size {config.algorithm.group_size} exclude each other: the mean of "
            "a group stands for the reference; choose optimality or final"
        )
