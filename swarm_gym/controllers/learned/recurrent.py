"""A learned controller with a memory: an LSTM before the layers of the actor, in NumPy.

Source: S. Hochreiter, J. Schmidhuber, "Long short-term memory", Neural Computation 9 (1997), with the forget
gate of F. Gers et al., Neural Computation 12 (2000); gates in the order of `torch.nn.LSTM`. The paper's four
numbers lack the population size: a memory can make up for what an observation does not show.
"""

import numpy as np
from numpy.typing import NDArray

from swarm_gym.controllers.learned.feedforward import FeedforwardController, affine
from swarm_gym.controllers.learned.manifest import LSTM
from swarm_gym.controllers.learned.policy_file import Weights
from swarm_gym.observation import ITERATION


class RecurrentController(FeedforwardController):
    """Deterministic actions of an actor that remembers; its memory is empty at the start of an episode.

    The file has a layer `lstm`, with weight (4 h, features + h) and bias (4 h,), where h is the manifest's
    `lstm_size`, and the layers after it.
    """

    network = LSTM

    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """Forget what was seen."""
        super().reset(num_swarms, seed)
        self._hidden = np.zeros((num_swarms, self._size), dtype=np.float32)
        self._cell = np.zeros((num_swarms, self._size), dtype=np.float32)

    def _read_weights(self, weights: Weights) -> None:
        super()._read_weights(weights)
        self._size = self.manifest["lstm_size"]
        self._lstm = weights["lstm.weight"], weights["lstm.bias"]

    def _features(self, seen: NDArray) -> NDArray:
        """The state h (B, size) after what is seen now."""
        goes_on = (seen[:, ITERATION] != 0).astype(np.float32)[:, None]
        hidden, cell = goes_on * self._hidden, goes_on * self._cell
        gates = affine(np.concatenate([seen, hidden], axis=1), *self._lstm)
        keep_new, keep_old, new, show = np.split(gates, 4, axis=1)  # i, f, g, o
        self._cell = _sigmoid(keep_old) * cell + _sigmoid(keep_new) * np.tanh(new)
        self._hidden = _sigmoid(show) * np.tanh(self._cell)
        return self._hidden


def _sigmoid(values: NDArray) -> NDArray:
    return np.float32(0.5) + np.float32(0.5) * np.tanh(np.float32(0.5) * values)
