"""Learning algorithms, one per module.

To add one, write a subclass of `learner.Learner` and enter it in `LEARNERS`.
"""

from collections.abc import Callable

from swarm_gym.checks import look_up
from swarm_gym.training.config import TrainConfig
from swarm_gym.training.learners.algorithm_options import require_options
from swarm_gym.training.learners.device_ppo import DevicePPOLearner
from swarm_gym.training.learners.dqn import DQNLearner
from swarm_gym.training.learners.evolution import EvolutionLearner
from swarm_gym.training.learners.learner import Learner
from swarm_gym.training.learners.ppo import PPOLearner
from swarm_gym.training.learners.recurrent import RecurrentPPOLearner

__all__ = ["LEARNERS", "Learner", "make_learner"]

LEARNERS: dict[str, Callable[[TrainConfig], Learner]] = {
    "ppo": PPOLearner,
    "device-ppo": DevicePPOLearner,
    "recurrent-ppo": RecurrentPPOLearner,
    "dqn": DQNLearner,
    "evolution": EvolutionLearner,
}


def make_learner(config: TrainConfig) -> Learner:
    """Return the learner that a configuration names, ready for its first chunk.

    Raises:
        UnknownNameError: if there is no such algorithm.
        ValueError: for options that the algorithm cannot use.
    """
    learner = look_up("algorithm", config.algorithm, LEARNERS)
    require_options(config)
    if config.base != "none" and config.warm_start != "none":
        raise ValueError(
            f"base {config.base!r} and warm_start {config.warm_start!r} exclude each other: a policy that "
            "corrects a controller begins as that one; set warm_start to 'none'"
        )
    return learner(config)
