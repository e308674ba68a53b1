"""The options of a tuning run, and the interface of its tuner.

The command line is made from the options. A run advances its tuner in rounds, and can stop between them.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from swarm_gym.controllers.size_limits import SizeLimits

if TYPE_CHECKING:  # a command does not import the simulation before it runs
    from swarm_gym.controllers.controller import Controller


@dataclass(frozen=True)
class TuneConfig:
    """Options of a tuning run; all are stored with its result."""

    what: str = "open-loop"
    """Kind of controller to tune: open-loop, constant, schedule or a size rule, e.g. linear-reduction."""
    preset: str = "three-cases"
    """Training preset that gives the defaults of steps, scenarios, optimizer and size limits."""
    name: str = ""
    """Name of the run, whose folder is <runs>/<name>; by default tune/<what>-<action>/<seed>."""
    runs: Path = Path("runs")
    """Folder of all runs; it is created if it is missing."""
    resume: bool = False
    """Resume the stopped run of that name after its last round."""
    output: Path | None = None
    """File to write the result to, in addition to <what>.json in the run's folder, e.g. mine.json."""
    threads: int = 1
    """Number of threads for the swarms. Results do not depend on it."""
    seed: int = 0
    """Seed of all random numbers of the run."""
    total_steps: int = 1_000_000
    """Largest number of environment steps, summed over all swarms."""
    optimizer: str = "firefly"
    """Optimizer that the controller controls, e.g. firefly or fish-swarm."""
    scenarios: tuple[str, ...] = ("case1", "case2", "case3")
    """Scenarios of the episodes, each equally often, e.g. case1 case2 or random-fields:train:0-511."""
    encoding: str = "waypoints"
    """Meaning of decision vectors: waypoints, bezier on grid maps, or shifted and spherical over terrain."""
    distance_weight: float = 0.0
    """Weight of the cost of nearness to blocked cells along a path, on grid maps."""
    ground_weight: float = 0.0
    """Weight of the costs of ground along a path, on grid maps that have such costs."""
    curvature_weight: float = 0.0
    """Weight of the squared curvature of a path, in map units squared, on grid maps."""
    cost: str = "documented"
    """Cost of flights over terrain: documented, or metabox for the published one."""
    source: str = "uniform"
    """Source of new members: uniform, smooth or guided. The action sourced decides their shares."""
    iterations: int = 100
    """Length of an episode in iterations of the optimizer."""
    max_evaluations: int = 0
    """Evaluation budget of an episode; 0 is no budget."""
    min_population_size: int = 2
    """Smallest population size that the controller can choose."""
    max_population_size: int = 200
    """Largest population size that the controller can choose."""
    reward: str = "final"
    """Measure to minimise: final, the logarithm of the final gap; optimality, the final gap in per cent of
    the optimum; offline-error, that gap averaged over all iterations since the first event on the map;
    detour, how far robots that drive go above the shortest way, in per cent; anytime, the mean of log10 of
    the gap over the budget; anytime-and-end, that mean and log10 of the final gap."""
    price: float = 0.5
    """Price of 100,000 evaluations in units of the reward."""
    episodes: int = 24
    """Number of episodes of every candidate."""
    action: str = "natural"
    """Decisions of open loops and constants: natural, size and phi; extended, the optimizer's too; sourced,
    these and where new members come from, and the first population."""
    initial_population_size: int = 60
    """Population size of open loops and constants at the start of an episode, PS(0); with action sourced,
    the search only starts there."""
    initial_smooth_share: float = 0.8
    """Share of smooth members of the first population at which the search starts; for action sourced only."""
    initial_amplitude: float = 0.2
    """Amplitude of smooth members of the first population at which the search starts; for action sourced."""
    start: str = "none"
    """Open loop at whose decisions, and first population if it states a source, the search starts, e.g.
    open-loop:three-cases-extended@0.1; its own tuning is part of the effort. none is a rough guess."""
    held: tuple[str, ...] = ()
    """Decisions of open loops that are held at a value instead of searched, e.g. immigrants=0
    first_smooth_share=1; for ablations."""
    knots: tuple[int, ...] = (0, 3, 8, 15, 40, 99)
    """Iterations at which the decisions of an open loop are tuned; it interpolates between them."""
    candidates: int = 16
    """Number of candidates per generation of CMA-ES."""
    sigma: float = 0.15
    """Initial step size of CMA-ES, relative to the range of every decision."""

    @property
    def folder(self) -> Path:
        """Folder of the run."""
        return self.runs / (self.name or f"tune/{self.what}-{self.action}/{self.seed}")

    @property
    def limits(self) -> SizeLimits:
        """Population sizes that the controller can choose."""
        return SizeLimits(self.min_population_size, self.max_population_size)

    @property
    def first_limits(self) -> SizeLimits:
        """Sizes of a first population: those that the evaluation budget holds, too."""
        smallest, largest = self.min_population_size, self.max_population_size
        return SizeLimits(smallest, max(smallest, min(largest, self.max_evaluations or largest)))


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
    def result(self) -> "Controller":
        """Return the tuned controller after the rounds so far."""

    @abstractmethod
    def write(self, path: Path, manifest: Mapping[str, object]) -> None:
        """Write the file of `result` with a manifest."""
