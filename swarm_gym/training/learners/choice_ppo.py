"""Proximal policy optimization of a policy that chooses from a grid of decisions.

A categorical distribution can weigh choices far apart against each other. A normal distribution moves by
small steps, and stays where the next values are worse, as on OneMax (docs/known-optimum.md).
"""

from typing import Any

from gymnasium.vector import VectorEnv

from swarm_gym.controllers.learned.policy_file import Weights
from swarm_gym.controllers.learned.residual import Base
from swarm_gym.sb3 import ChoiceVecEnv, make_choices
from swarm_gym.training.algorithms import ChoicePPO
from swarm_gym.training.config import TrainConfig
from swarm_gym.training.learners.dqn import require_choices
from swarm_gym.training.learners.ppo import PPOLearner


class ChoicePPOLearner(PPOLearner):
    """PPO of stable-baselines3 with a categorical policy; with a base, the choices are corrections of it."""

    network = "choices"
    options: ChoicePPO

    def __init__(self, config: TrainConfig, options: ChoicePPO):
        numbers = {"size_choices": options.size_choices, "degree_choices": options.degree_choices}
        further = enumerate(options.further_choices, 1)
        numbers |= {f"further_choices {place}, {text!r},": _numbers(text) for place, text in further}
        require_choices(numbers)
        self.choices = make_choices(*numbers.values())
        super().__init__(config, options)
        if self.num_decisions != self.choices.shape[1]:
            raise ValueError(
                f"action {config.action!r} has {self.num_decisions} decisions, but there are choices for "
                f"{self.choices.shape[1]}: set further_choices for those beyond size and repair degree"
            )

    def begin(self) -> None:
        """Do nothing: at first all choices are equally likely."""

    def weights(self) -> Weights:
        """Return the layers that weigh the choices, and the choices."""
        return {**super().weights(), "choices": self.choices}

    def shape(self) -> dict[str, int]:
        """Return the number of choices."""
        return {"num_choices": len(self.choices)}

    def _make_env(self, env: VectorEnv, base: Base | None) -> Any:
        return ChoiceVecEnv(super()._make_env(env, base), self.choices)


def _numbers(text: str) -> tuple[float, ...]:
    """Return the numbers of a text, which are separated by spaces.

    Raises:
        ValueError: if it has anything else.
    """
    try:
        return tuple(map(float, text.split()))
    except ValueError as error:
        raise ValueError(f"further_choices: expected numbers such as '-1 0 1', got {text!r}") from error
