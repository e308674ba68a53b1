"""Proximal policy optimization of an actor with an LSTM, by sb3-contrib.

Source: J. Schulman et al., arXiv 1707.06347 (2017), with an LSTM before the hidden layers of actor and critic
each. The state of the LSTM is carried through an episode; gradients go through the part of an episode that is
in a minibatch.
"""

from typing import Any, ClassVar

import sb3_contrib
import torch
from sb3_contrib.ppo_recurrent import MlpLstmPolicy

from swarm_gym.controllers.learned.policy_file import Weights
from swarm_gym.training.algorithms import RecurrentPPO
from swarm_gym.training.imitation import Demonstration
from swarm_gym.training.learners.ppo import PPOLearner


class SequencePolicy(MlpLstmPolicy):
    """The library's policy, made faster.

    The library goes step by step through every batch in which an episode begins. In minibatches, episodes
    begin only at the start of sequences. Then emptying the first states is enough, and one call of the LSTM
    computes the whole sequence.
    """

    @staticmethod
    def _process_sequence(
        features: torch.Tensor,
        lstm_states: tuple[torch.Tensor, torch.Tensor],
        episode_starts: torch.Tensor,
        lstm: torch.nn.LSTM,
    ) -> Any:  # the library's own annotation is not what it returns
        """Return outputs (sequences * length, h) and states (1, sequences, h) of flattened sequences."""
        hidden, cell = lstm_states
        begins = episode_starts.reshape(hidden.shape[1], -1)
        if not begins[:, 1:].any():
            goes_on = (1.0 - begins[:, 0])[None, :, None]
            lstm_states = (goes_on * hidden, goes_on * cell)
            episode_starts = torch.zeros_like(episode_starts)
        return MlpLstmPolicy._process_sequence(features, lstm_states, episode_starts, lstm)


class RecurrentPPOLearner(PPOLearner):
    """PPO with an LSTM of `lstm_size` before the hidden layers."""

    options: RecurrentPPO
    network = "lstm"
    algorithm: ClassVar[type] = sb3_contrib.RecurrentPPO
    policy: ClassVar[str | type] = SequencePolicy

    def weights(self) -> Weights:
        """Return the layers that compute the mean action; the two halves of torch's LSTM are one layer."""
        lstm = self.model.policy.lstm_actor
        with torch.no_grad():
            weight = torch.cat([lstm.weight_ih_l0, lstm.weight_hh_l0], dim=1)
            bias = lstm.bias_ih_l0 + lstm.bias_hh_l0
        return {**super().weights(), "lstm.weight": weight.numpy(), "lstm.bias": bias.numpy()}

    def _lessons(self, shown: Demonstration) -> Demonstration:
        return shown

    def _predict(self, seen: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        policy, (number, length) = self.model.policy, seen.shape[:2]
        # Sequences are whole episodes: the memory is empty at first, and no other episode begins inside.
        empty = torch.zeros(1, number, self.options.lstm_size)
        goes_on = torch.zeros(number * length)
        flat = seen.flatten(0, 1)
        decided, _ = policy.get_distribution(flat, (empty, empty), goes_on)
        return decided.mode(), policy.predict_values(flat, (empty, empty), goes_on).flatten()

    def _policy_options(self) -> dict[str, Any]:
        return {**super()._policy_options(), "lstm_hidden_size": self.options.lstm_size}
