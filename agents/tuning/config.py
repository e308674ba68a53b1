"""The options of a tuning run: one documented dataclass, which is also the command line."""

from dataclasses import dataclass
from pathlib import Path

from swarm_gym.controllers import SizeLimits


@dataclass(frozen=True)
class TuneConfig:
    """Options of a tuning run; all are stored with its result."""

    what: str = "open-loop"
    """What is tuned, a name in `agents.tuning.tuners.TUNERS`."""
    preset: str = "three-cases"
    """The training preset that steps, scenarios, optimizer and size limits come from, where not given."""
    name: str = ""
    """The run's folder is <runs>/<name>; tune/<what>-<action>/<seed> by default."""
    runs: Path = Path("runs")
    """Where runs are kept."""
    resume: bool = False
    """Go on with a run of that name that was stopped."""
    output: Path | None = None
    """File to write the result to, besides <what>.json in the run's folder."""
    threads: int = 1
    """Threads that the swarms are spread over. Results do not depend on it."""
    seed: int = 0
    """Seed of everything random in the run."""
    total_steps: int = 800_000
    """Environment steps, over all swarms; never exceeded."""
    optimizer: str = "firefly"
    """The optimizer that is controlled."""
    scenarios: tuple[str, ...] = ("case1", "case2", "case3")
    """Scenarios of the episodes, each as often as any other."""
    min_population_size: int = 2
    """Smallest size that can be asked for."""
    max_population_size: int = 200
    """Largest size that can be asked for."""
    reward: str = "final"
    """'final': logarithm of the final gap to the lower bound; 'optimality': per cent above the optimum."""
    price: float = 0.5
    """What 100,000 evaluations cost, in units of the reward."""
    episodes: int = 24
    """Episodes of every candidate."""
    action: str = "natural"
    """Of open loops and constants: 'natural' decides size and phi, 'extended' the optimizer's too."""
    initial_population_size: int = 60
    """Of open loops and constants: PS(0)."""
    knots: tuple[int, ...] = (0, 3, 8, 15, 40, 99)
    """Of open loops: the iterations whose decisions are tuned."""
    candidates: int = 16
    """Of CMA-ES: candidates per generation."""
    sigma: float = 0.15
    """Of CMA-ES: initial step size, in the range of every decision scaled to [0, 1]."""

    @property
    def folder(self) -> Path:
        """Where this run is kept."""
        return self.runs / (self.name or f"tune/{self.what}-{self.action}/{self.seed}")

    @property
    def limits(self) -> SizeLimits:
        """Population sizes that can be asked for."""
        return SizeLimits(self.min_population_size, self.max_population_size)
