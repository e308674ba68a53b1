"""What a tuning run asks of a way to tune: rounds of equal size that can be stopped between."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from swarm_gym.controllers.controller import Controller


class Tuner(ABC):
    """Improves a controller, round by round.

    Attributes:
        family: of the controller that the file of the result makes, as in `<family>:<file>`.
        rounds: rounds done.
        steps_per_round: environment steps of every round.
    """

    family: str
    rounds: int = 0
    steps_per_round: int

    @abstractmethod
    def open(self, folder: Path) -> None:
        """Take up what earlier rounds left in the folder, if anything.

        Raises:
            RunFolderError: if it cannot be read.
        """

    @abstractmethod
    def advance(self) -> dict[str, float]:
        """One more round, stored in the folder; numbers to show."""

    @abstractmethod
    def seeds(self) -> list[int]:
        """The seed of the first episode of every round; the others count up from it."""

    @abstractmethod
    def result(self) -> Controller:
        """The controller that the rounds so far have led to."""

    @abstractmethod
    def write(self, path: Path, manifest: Mapping[str, Any]) -> None:
        """Write the file of `result`, with what is known of it."""
