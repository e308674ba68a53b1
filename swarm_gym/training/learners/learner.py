"""The interface of learning algorithms, which a training run uses."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping

from swarm_gym.controllers.learned.policy_file import Weights
from swarm_gym.training.config import TrainConfig


class Learner(ABC):
    """A policy in training. All random numbers of a chunk follow from the chunk's seed.

    Attributes:
        config: configuration of the training.
        num_steps: environment steps so far, summed over all swarms.
        features: names of the policy's observation features.
        num_decisions: number of decisions in an action.
        network: kind of the actor, a name in `swarm_gym.controllers.learned.networks.NETWORKS`.
        after_rollout: function that `learn` calls where the chunk can be stopped: `state` is then the state
            in the middle of the chunk, and `learn` goes on from it after `load`. Learners whose chunks cannot
            be stopped never call it.
    """

    config: TrainConfig
    num_steps: int
    features: list[str]
    num_decisions: int
    network: str = "feedforward"

    def __init__(self) -> None:
        self.after_rollout: Callable[[], None] = _go_on

    @abstractmethod
    def begin(self) -> None:
        """Prepare the first chunk, for example by imitation."""

    @abstractmethod
    def learn(self, seed: int) -> dict[str, float]:
        """Train for one chunk, or for the rest of one; return scalars to plot, by name."""

    @abstractmethod
    def weights(self) -> Weights:
        """Return the actor: `<layer>.weight` (outputs, inputs) and `<layer>.bias`, tanh between layers.

        Networks that are not feedforward have further tensors, see `learned.networks`.
        """

    @property
    def in_chunk(self) -> bool:
        """True if `learn` goes on within a chunk, after a rollout that it was stopped at."""
        return False

    def shape(self) -> dict[str, int]:
        """Return further entries of the manifest that the shapes of tensors follow from."""
        return {}

    @abstractmethod
    def state(self) -> dict[str, object]:
        """Return the state for the next chunk: tensors, numbers, strings and containers of these."""

    @abstractmethod
    def load(self, state: Mapping[str, object]) -> None:
        """Continue from a state."""


def _go_on() -> None:
    """Do nothing after a rollout."""
