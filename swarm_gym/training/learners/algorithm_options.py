"""Checks of the options that not all algorithms have, before anything is made."""

from swarm_gym.action import require_same_decisions
from swarm_gym.checks import require_integer, require_number
from swarm_gym.errors import UnknownNameError
from swarm_gym.optimizers import get_optimizer
from swarm_gym.training.config import TrainConfig
from swarm_gym.training.paired_reward import PAIRED

DEVICES = ("cpu", "cuda")

_IN_GROUPS = ("ppo", "device-ppo")
# The algorithms that have an option, which the others refuse. Other options, such as `candidates`, have no
# effect where an algorithm lacks them, so that presets may inherit them.
ALGORITHMS_OF = {
    "also_on": ("ppo",),
    "averaging": _IN_GROUPS,
    "branch_at_events": ("ppo",),
    "branches": _IN_GROUPS,
    "critic": _IN_GROUPS,
    "decay_steps": (*_IN_GROUPS, "dqn"),
    "degree_choices": ("dqn",),
    "device": ("device-ppo",),
    "exploration_steps": ("dqn",),
    "gradient_steps": ("dqn",),
    "group_size": _IN_GROUPS,
    "noise_steps": _IN_GROUPS,
    "replay_size": ("dqn",),
    "return_steps": ("dqn",),
    "size_choices": ("dqn",),
    "target_steps": ("dqn",),
}
IMITATING = ("ppo", "recurrent-ppo")  # the algorithms that can imitate a controller first
LARGEST_AVERAGING = 0.9999


def require_options(config: TrainConfig) -> None:
    """Raise an error for options that the algorithm does not have, or that exclude each other.

    Raises:
        UnknownNameError: for a device that does not exist.
        ValueError: naming the option and its value.
    """
    if config.device not in DEVICES:
        raise UnknownNameError("device", config.device, DEVICES)
    for name, algorithms in ALGORITHMS_OF.items():
        value = getattr(config, name)
        if config.algorithm not in algorithms and value != getattr(TrainConfig, name):
            allowed = " or ".join(map(repr, algorithms))
            raise ValueError(f"{name} {value!r} is for algorithm {allowed} only, got {config.algorithm!r}")
    if config.warm_start != "none" and config.algorithm not in IMITATING:
        raise ValueError(
            f"{config.algorithm} imitates no controller: warm_start must be 'none', got {config.warm_start!r}"
        )
    require_integer("group_size", config.group_size, 1, config.num_swarms)
    require_integer("noise_steps", config.noise_steps, 0, config.iterations)
    require_number("averaging", config.averaging, 0.0, LARGEST_AVERAGING)
    require_integer("decay_steps", config.decay_steps, 0)
    if 0 < config.decay_steps < config.total_steps:
        raise ValueError(
            "decay_steps must be 0 or at least total_steps, got "
            f"{config.decay_steps} and {config.total_steps}"
        )
    for first in config.branches:
        require_integer("branches", first, config.corrected_from, config.iterations - 1)
    if config.num_swarms % config.group_size:
        raise ValueError(
            f"num_swarms must be a multiple of group_size, got {config.num_swarms} and {config.group_size}"
        )
    _require_joinable(config)
    if config.branch_at_events and config.group_size == 1:
        raise ValueError("branch_at_events needs groups of several swarms, got group_size 1")
    if not config.critic and config.gae_lambda != 1.0:
        raise ValueError(f"without a critic, gae_lambda must be 1, got {config.gae_lambda}")
    if has_groups(config) or config.noise_steps != 1:
        _require_equal_lengths(config)


def _require_joinable(config: TrainConfig) -> None:
    """Raise an error if the optimizers of a training cannot be trained on together."""
    if not config.also_on:
        return
    for option in ("branches", "branch_at_events"):
        if getattr(config, option):
            raise ValueError(f"also_on and {option} exclude each other, got {getattr(config, option)!r}")
    if config.group_size == 1 or config.warm_start != "none" or config.critic:
        raise ValueError(
            "also_on needs groups without a critic and without imitation, got group_size "
            f"{config.group_size}, critic {config.critic}, warm_start {config.warm_start!r}"
        )
    if config.num_swarms % (len(config.optimizers) * config.group_size):
        raise ValueError(
            f"num_swarms must be a multiple of group_size {config.group_size} times "
            f"{len(config.optimizers)} optimizers, got {config.num_swarms}"
        )
    for name in config.also_on:
        require_same_decisions(config.optimizer, config.action, get_optimizer(name))


def has_groups(config: TrainConfig) -> bool:
    """Return whether swarms begin in groups, or after iterations that are not part of the training."""
    return config.group_size > 1 or bool(config.branches)


def _require_equal_lengths(config: TrainConfig) -> None:
    if config.max_evaluations:
        raise ValueError(
            f"max_evaluations {config.max_evaluations}: groups, and noise that is held, need episodes of one "
            "length; set group_size and noise_steps to 1, without branches"
        )
    if config.reward == PAIRED and has_groups(config):
        raise ValueError(
            f"reward {PAIRED!r} and group_size {config.group_size} exclude each other: the mean of a group "
            "stands for the reference; choose optimality or final"
        )
