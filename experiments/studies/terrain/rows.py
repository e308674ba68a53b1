"""The rows of this study's tables: an optimizer of constant size, an encoding and a source of members."""

from typing import NamedTuple

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


def rows() -> list[Row]:
    """Return the rows of swarms."""
    return [Row(optimizer, *vectors) for optimizer in SIZES for vectors in VECTORS]
