"""Numbers printed in the MOA paper, for comparison with ours.

Source: Li et al., "A path planner based on multivariate optimization algorithm", Acta Electronica Sinica
44(9), 2016, tables 1 and 2: 30 runs of 450 iterations of 65 members on map den400d.
"""

from typing import NamedTuple


class PublishedTask(NamedTuple):
    """Numbers of one method on one task of the MOA paper; None where it prints none."""

    length: float | None = None  # mean length of the feasible runs
    feasible: float | None = None  # share of feasible runs
    differs: bool | None = None  # from the shortest mean length, t-test at 5 %; None for the shortest itself
    success: float | None = None  # share of runs shorter than the threshold
    evaluations: float | None = None  # mean until success, or all if a run has none; None if no run has


METHODS = ("elite-genetic", "particle-swarm", "generational-firefly", "multivariate")
# Length by task: a run is a success if its best path is shorter.
THRESHOLDS = {"P1": 170.0, "P2": 156.0, "P3": 241.0, "P4": 215.0, "P5": 299.0, "P6": 269.0}

_ROWS = {
    "P1": (
        (167.8, 1.0, True, 0.83, 9.56e3), (164.8, 0.8, True, 0.73, 8.51e3),
        (182.0, 1.0, True, 0.0, None), (155.3, 1.0, None, 1.0, 1.68e3),
    ),
    "P2": (
        (142.9, 0.6, False, 0.6, 1.48e4), (141.3, 0.2, None, 0.2, 2.37e4),
        (170.7, 1.0, True, 0.07, 2.86e4), (141.5, 1.0, False, 1.0, 3.40e3),
    ),
    "P3": (
        (247.1, 0.7, True, 0.3, 2.15e4), (227.9, 0.83, True, 0.77, 1.09e4),
        (247.9, 1.0, True, 0.2, 2.72e4), (220.5, 1.0, None, 1.0, 2.96e3),
    ),
    "P4": (
        (202.4, 1.0, True, 0.9, 3.65e3), (199.5, 1.0, False, 0.9, 3.52e3),
        (209.0, 1.0, True, 0.97, 1.18e4), (195.7, 1.0, None, 1.0, 1.13e3),
    ),
    "P5": (
        (277.2, 0.13, True, 0.13, 2.55e4), (274.9, 0.13, True, 0.13, 2.56e4),
        (292.5, 1.0, True, 0.67, 1.94e4), (272.4, 1.0, None, 1.0, 1.87e3),
    ),
    "P6": (
        (254.0, 0.4, True, 0.4, 1.87e4), (248.8, 0.43, True, 0.43, 1.69e4),
        (261.8, 1.0, True, 0.93, 1.06e4), (245.6, 1.0, None, 1.0, 1.76e3),
    ),
}  # fmt: skip

PUBLISHED: dict[tuple[str, str], PublishedTask] = {
    (task, method): PublishedTask(*row)
    for task, rows in _ROWS.items()
    for method, row in zip(METHODS, rows, strict=True)
}
