"""A model of the wall time of work on a cluster, made of measured parts.

Units are handed to any free core, so that no core is idle before the last unit has begun:

    wall time <= start + max(units * (seconds + overhead) / cores + longest unit,
                             units / (units per second that the driver hands out and takes back),
                             rows / (rows per second that the database takes))

The first term is the bound of R. L. Graham, "Bounds on multiprocessing timing anomalies", SIAM Journal on
Applied Mathematics 17(2):416-429, 1969, without the factor 1 - 1 / cores of its last part. The model assumes
that cores are as fast as the measured one, that nodes start at the same time, and that no unit is lost.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Work:
    """An amount of work in units.

    Attributes:
        units: number of units.
        seconds: mean time of a unit on one core.
        longest: time of the longest unit in seconds.
        rows: number of rows that all units add to the database.
    """

    units: int
    seconds: float
    longest: float
    rows: int = 0


@dataclass(frozen=True)
class Overheads:
    """Measured overheads of a backend.

    Attributes:
        start: seconds before the first unit begins on a node, compilation of kernels included.
        per_unit: seconds that it adds to each unit on its core.
        units_per_second: greatest rate at which the driver hands out units and takes back results.
        rows_per_second: greatest rate at which the database stores rows.
    """

    start: float
    per_unit: float
    units_per_second: float
    rows_per_second: float


@dataclass(frozen=True)
class Prediction:
    """A prediction of the model.

    Attributes:
        seconds: wall time.
        bottleneck: part that determines the wall time after the start.
    """

    seconds: float
    bottleneck: str


def predict(work: Work, overheads: Overheads, cores: int) -> Prediction:
    """Return the wall time of work on a number of cores, and the part that bounds it."""
    spread = work.units * (work.seconds + overheads.per_unit) / cores
    parts = {
        "cores" if spread >= work.longest else "longest unit": spread + work.longest,
        "driver": work.units / overheads.units_per_second,
        "database": work.rows / overheads.rows_per_second,
    }
    bottleneck = max(parts, key=lambda name: parts[name])
    return Prediction(overheads.start + parts[bottleneck], bottleneck)
