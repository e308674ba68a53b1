"""Learning algorithms, one per module.

To add one, write a subclass of `learner.Learner` and enter it in `LEARNERS`; its options are in
`swarm_gym.training.algorithms`.
"""

from importlib import import_module

from swarm_gym.training.config import TrainConfig
from swarm_gym.training.learners.checks import require_options
from swarm_gym.training.learners.learner import Learner

__all__ = ["LEARNERS", "Learner", "make_learner"]

# Module and class by name; a module is imported when it is used, since each library takes its time.
LEARNERS: dict[str, tuple[str, str]] = {
    "ppo": ("ppo", "PPOLearner"),
    "choice-ppo": ("choice_ppo", "ChoicePPOLearner"),
    "device-ppo": ("device_ppo", "DevicePPOLearner"),
    "recurrent-ppo": ("recurrent", "RecurrentPPOLearner"),
    "dqn": ("dqn", "DQNLearner"),
    "evolution": ("evolution", "EvolutionLearner"),
}


def make_learner(config: TrainConfig) -> Learner:
    """Return the learner that a configuration names, ready for its first chunk.

    Raises:
        ValueError: for options that the algorithm cannot use.
    """
    require_options(config)
    module, name = LEARNERS[config.algorithm.name]
    learner = getattr(import_module(f"{__name__}.{module}"), name)
    return learner(config, config.algorithm)
