"""The interface of tuners, which a tuning run uses: rounds of equal size that can be stopped in between."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from pathlib import Path

from swarm_gym.controllers.controller import Controller


class Tuner(ABC):
    """A method that improves a controller, round by round.

    Attributes:
        family: family of the tuned controller, as in its name `<family>:<file>`.
        rounds: number of completed rounds.
        steps_per_round: number of environment steps of every round.
    """

    family: str
    rounds: int = 0
    steps_per_round: int

    @abstractmethod
    def open(self, folder: Path) -> None:
        """Load the state of earlier rounds from the folder, if there are any.

        Raises:
            RunFolderError: if the state cannot be read.
        """

    @abstractmethod
    def advance(self) -> dict[str, float]:
        """Run one more round and store it in the folder; return numbers to show."""

    @abstractmethod
    def seeds(self) -> list[int]:
        """Return the seed of the first episode of every round; other episodes have the following seeds."""

    @abstractmethod
    def result(self) -> Controller:
        """Return the tuned controller after the rounds so far."""

    @abstractmethod
    def write(self, path: Path, manifest: Mapping[str, object]) -> None:
        """Write the file of `result` with a manifest."""
