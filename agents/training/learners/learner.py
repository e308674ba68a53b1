"""What a training run asks of a learning algorithm."""

from abc import ABC, abstractmethod
from typing import Any

from agents.training.config import TrainConfig
from swarm_gym.controllers.learned.policy_file import Weights


class Learner(ABC):
    """A policy in the making. Everything random in a chunk follows from the chunk's seed.

    Attributes:
        config: what is learned, and how.
        num_steps: environment steps so far, over all swarms.
        features: names of what the policy sees.
        num_decisions: numbers in an action.
        network: the kind of the actor, a name in `swarm_gym.controllers.learned.load.NETWORKS`.
    """

    config: TrainConfig
    num_steps: int
    features: list[str]
    num_decisions: int
    network: str = "feedforward"

    @abstractmethod
    def begin(self) -> None:
        """What comes before the first chunk, such as imitation."""

    @abstractmethod
    def learn(self, seed: int) -> dict[str, float]:
        """One chunk; returns what is worth plotting, by name."""

    @abstractmethod
    def weights(self) -> Weights:
        """The actor: `<layer>.weight` (outputs, inputs) and `<layer>.bias`, tanh between layers.

        Other networks than feedforward ones have more, see the controller of that network.
        """

    @abstractmethod
    def state(self) -> dict[str, Any]:
        """All that the next chunk depends on; tensors, numbers, strings and containers of these only."""

    @abstractmethod
    def load(self, state: dict[str, Any]) -> None:
        """Go on from a state."""
