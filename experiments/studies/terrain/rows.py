"""The rows of this study's tables: an optimizer, an encoding and a source of members; and other libraries."""

from typing import NamedTuple

from experiments.studies.libraries import installed

# Population sizes, as published where papers have one. The default of CMA-ES is 12 with 20 components.
SIZES = {"particle-swarm": 50, "differential-evolution": 60, "cma-es": 13, "firefly": 20, "multivariate": 20}
NAMES = {
    "particle-swarm": "PSO",
    "differential-evolution": "L-SHADE",
    "cma-es": "CMA-ES",
    "firefly": "fireflies",
    "multivariate": "multivariate",
}
# The first is that of published code, whose particle swarm is called SPSO.
VECTORS = (
    ("spherical", "uniform"),
    ("waypoints", "uniform"),
    ("waypoints", "smooth"),
    ("waypoints", "guided"),
    ("shifted", "uniform"),
    ("shifted", "guided"),
)
# The planned flight alone, by its encoding.
PLANNED = {"waypoints": "planned flight, no swarm", "shifted": "planned flight, shifted, no swarm"}
# Optimizers of other libraries, keys of `experiments.studies.libraries.PEERS`.
PEERS = (
    "cmaes CMA-ES", "pymoo PSO", "pymoo DE", "niapy PSO", "niapy L-SHADE", "mealpy PSO", "mealpy L-SHADE"
)  # fmt: skip


class Row(NamedTuple):
    """A row of a table.

    Attributes:
        optimizer: name of the optimizer.
        encoding: name of the encoding.
        source: name of the source of members.
    """

    optimizer: str
    encoding: str
    source: str

    @property
    def controllers(self) -> tuple[str, ...]:
        """The name of the controller, which holds the population size constant."""
        return (f"fixed:{SIZES[self.optimizer]}",)

    @property
    def is_learned(self) -> bool:
        """False: no controller is a policy."""
        return False

    @property
    def group(self) -> tuple[str, str]:
        """Optimizer and encoding, within which controllers are compared."""
        return self.optimizer, self.encoding

    @property
    def controlled_name(self) -> str:
        """Name of the optimizer with its controller, and an encoding that is not the first."""
        return _with_encoding(f"{NAMES[self.optimizer]}, {SIZES[self.optimizer]} members", self.encoding)

    @property
    def name(self) -> str:
        """Name of the row in tables."""
        return f"{NAMES[self.optimizer]}, {self.encoding}, {self.source}"


class PeerRow(NamedTuple):
    """A row of another library.

    Attributes:
        peer: a key of `PEERS`.
        encoding: name of the encoding.
    """

    peer: str
    encoding: str

    @property
    def name(self) -> str:
        """Name of the row in tables."""
        return f"{self.peer}, {self.encoding}"


class PlannedRow(NamedTuple):
    """The planned flight alone, which no swarm improves.

    Attributes:
        encoding: name of the encoding.
    """

    encoding: str = "waypoints"

    @property
    def name(self) -> str:
        """Name of the row in tables."""
        return PLANNED[self.encoding]


class ControlledRow(NamedTuple):
    """A row whose population sizes, and perhaps more, a controller decides.

    Attributes:
        label: name of the kind of controller in tables.
        optimizer: name of the optimizer.
        source: name of the source of members.
        controllers: names of the controllers, one for each training seed.
        evaluations: evaluation budget of the training; None if there was no training.
        iterations: most iterations of an episode with this budget, and in proportion with others; None is as
            many as evaluations.
        encoding: name of the encoding.
    """

    label: str
    optimizer: str
    source: str
    controllers: tuple[str, ...]
    evaluations: int | None = None
    iterations: int | None = None
    encoding: str = "waypoints"

    @property
    def is_learned(self) -> bool:
        """True if the controllers are policies, one for each training seed."""
        return self.label.startswith("learned")

    def iterations_of(self, evaluations: int) -> int:
        """Return the most iterations of an episode with an evaluation budget."""
        if self.iterations is None or self.evaluations is None:
            return evaluations
        return self.iterations * evaluations // self.evaluations

    @property
    def group(self) -> tuple[str, str]:
        """Optimizer and encoding, within which controllers are compared."""
        return self.optimizer, self.encoding

    @property
    def controlled_name(self) -> str:
        """Name of the optimizer with its controller, and an encoding that is not the first."""
        return _with_encoding(f"{NAMES[self.optimizer]}, {self.label}", self.encoding)

    @property
    def name(self) -> str:
        """Name of the row in tables."""
        return f"{NAMES[self.optimizer]}, {self.label}, {self.encoding}, {self.source}"


AnyRow = Row | PeerRow | PlannedRow | ControlledRow


class Setting(NamedTuple):
    """Row, cost, budget and terrain that runs have in common.

    Attributes:
        row: name of the row.
        cost: name of the cost.
        evaluations: evaluation budget.
        terrain: name of the terrain.
    """

    row: str
    cost: str
    evaluations: int
    terrain: str


def swarm_rows() -> list[AnyRow]:
    """Return the rows of swarms of constant size."""
    return [Row(optimizer, *vectors) for optimizer in SIZES for vectors in VECTORS]


def peer_rows() -> list[AnyRow]:
    """Return the rows of other libraries that are installed."""
    return [PeerRow(peer, encoding) for encoding in ("spherical", "waypoints") for peer in installed(PEERS)]


def _with_encoding(name: str, encoding: str) -> str:
    return name if encoding == "waypoints" else f"{name}, {encoding}"
