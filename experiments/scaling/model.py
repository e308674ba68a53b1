"""A model of how long work takes on a cluster: what its parts were measured to take, put together.

Units are handed to whichever core is free, so that no core is idle before the last unit has begun:

    wall time <= start + max(units * (seconds + overhead) / cores + longest unit,
                             units / (units per second that the driver hands out and takes back),
                             rows / (rows per second that the database takes))

The first is the bound of R. L. Graham, "Bounds on multiprocessing timing anomalies", SIAM Journal on Applied
Mathematics 17(2):416-429, 1969, but for a factor 1 - 1 / cores of its last term. Assumed is that cores are as
fast as the one that units were measured on, that nodes become ready side by side, and that nothing is lost.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Work:
    """Units of work.

    Attributes:
        units: how many.
        seconds: that one takes on a core, on average.
        longest: seconds of the longest.
        rows: of the database that they lead to.
    """

    units: int
    seconds: float
    longest: float
    rows: int = 0


@dataclass(frozen=True)
class Overheads:
    """What a backend adds, as measured.

    Attributes:
        start: seconds before the first unit begins on a node, kernels compiled.
        per_unit: seconds of a core.
        units_per_second: that the driver can hand out and take back.
        rows_per_second: that the database takes.
    """

    start: float
    per_unit: float
    units_per_second: float
    rows_per_second: float


@dataclass(frozen=True)
class Prediction:
    """What the model says.

    Attributes:
        seconds: wall time.
        bottleneck: what it is the time of, besides the start.
    """

    seconds: float
    bottleneck: str


def predict(work: Work, overheads: Overheads, cores: int) -> Prediction:
    """Wall time of work on so many cores, and what bounds it."""
    spread = work.units * (work.seconds + overheads.per_unit) / cores
    parts = {
        "cores" if spread >= work.longest else "longest unit": spread + work.longest,
        "driver": work.units / overheads.units_per_second,
        "database": work.rows / overheads.rows_per_second,
    }
    bottleneck = max(parts, key=lambda name: parts[name])
    return Prediction(overheads.start + parts[bottleneck], bottleneck)
