"""Proximal policy optimization of an actor with a memory, by sb3-contrib.

Source: J. Schulman et al., arXiv 1707.06347 (2017), with an LSTM before the hidden layers of actor and critic
each; its state is carried through an episode, and gradients through the part of it that is in a minibatch.
"""

from typing import Any, ClassVar

import torch
from sb3_contrib import RecurrentPPO

from agents.imitation import Demonstration
from agents.learners.ppo import PPOLearner
from agents.policy_file import Weights


class RecurrentPPOLearner(PPOLearner):
    """PPO with an LSTM of `lstm_size` before the hidden layers."""

    network = "lstm"
    algorithm: ClassVar[type] = RecurrentPPO
    policy: ClassVar[str] = "MlpLstmPolicy"

    def weights(self) -> Weights:
        """The mean of the actor; the two halves of torch's LSTM as one layer."""
        lstm = self.model.policy.lstm_actor
        with torch.no_grad():
            weight = torch.cat([lstm.weight_ih_l0, lstm.weight_hh_l0], dim=1)
            bias = lstm.bias_ih_l0 + lstm.bias_hh_l0
        return {**super().weights(), "lstm.weight": weight.numpy(), "lstm.bias": bias.numpy()}

    def _lessons(self, shown: Demonstration) -> Demonstration:
        return shown

    def _predict(self, seen: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        policy, (number, length) = self.model.policy, seen.shape[:2]
        # Sequences are whole episodes: nothing is remembered at first, and no other begins inside.
        empty = torch.zeros(1, number, self.config.lstm_size)
        goes_on = torch.zeros(number * length)
        flat = seen.flatten(0, 1)
        decided, _ = policy.get_distribution(flat, (empty, empty), goes_on)
        return decided.mode(), policy.predict_values(flat, (empty, empty), goes_on).flatten()

    def _policy_options(self) -> dict[str, Any]:
        return {**super()._policy_options(), "lstm_hidden_size": self.config.lstm_size}
