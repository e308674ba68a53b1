"""The swarms that a policy is trained on."""

from typing import Any

import gymnasium
from gymnasium.vector import AutoresetMode, VectorEnv

from agents import make_controller
from agents.residual import Base
from agents.train_config import TrainConfig
from swarm_gym.action import make_action
from swarm_gym.observation import make_observation
from swarm_gym.optimizers import get_optimizer
from swarm_gym.registration import environment_id


def make_swarms(
    config: TrainConfig, num_swarms: int, autoreset_mode: AutoresetMode
) -> tuple[VectorEnv, Base | None]:
    """The vector environment of a configuration, and the controller that the policy corrects, if any.

    With a base, observations are the base's and then the policy's.
    """
    controller = None if config.base == "none" else make_controller(config.base, config.limits)
    observation = config.observation
    if controller is not None:
        observation = f"{controller.observation}+{observation}"
    env = gymnasium.make_vec(
        environment_id(config.optimizer),
        num_envs=num_swarms,
        scenario=list(config.scenarios),
        observation=observation,
        action=config.action,
        initial_population_size=config.initial_population_size,
        autoreset_mode=autoreset_mode,
        num_threads=config.threads,
        **config.env_options(),
    )
    if controller is None:
        return env, None
    inner: Any = env.unwrapped
    return env, Base(controller, make_action(inner.settings, get_optimizer(config.optimizer)))


def feature_names(config: TrainConfig, base: Base | None) -> list[str]:
    """Names of what the policy sees."""
    if base is not None:
        return base.features(config.observation)
    return [feature.name for feature in make_observation(config.observation).features]
