"""The rows of this study's tables: an optimizer, an encoding and a source of members; and other libraries."""

from typing import NamedTuple

from experiments.studies.terrain.peers import PEERS

# Population sizes, as published where papers have one; CMA-ES has its default for 20 components.
SIZES = {"particle-swarm": 50, "differential-evolution": 60, "cma-es": 13, "firefly": 20}
NAMES = {
    "particle-swarm": "PSO",
    "differential-evolution": "L-SHADE",
    "cma-es": "CMA-ES",
    "firefly": "fireflies",
}
# The first is that of published code, whose particle swarm is called SPSO.
VECTORS = (
    ("spherical", "uniform"),
    ("waypoints", "uniform"),
    ("waypoints", "smooth"),
    ("waypoints", "guided"),
)
PLANNED = "planned flight, no swarm"


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


AnyRow = Row | PeerRow


def rows() -> list[AnyRow]:
    """Return the rows of swarms, of constant size, and then those of other libraries."""
    swarms = [Row(optimizer, *vectors) for optimizer in SIZES for vectors in VECTORS]
    return [*swarms, *(PeerRow(peer, encoding) for encoding in ("spherical", "waypoints") for peer in PEERS)]
