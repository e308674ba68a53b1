"""Fronts of two costs, both to be small."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


def non_dominated(points: Floats) -> Flags:
    """(n,) which of the points (n, 2) no other one matches in both coordinates and beats in one."""
    ahead = (points[:, None] <= points).all(axis=2) & (points[:, None] < points).any(axis=2)
    return np.logical_not(ahead.any(axis=0))


def hypervolume(points: Floats, reference: tuple[float, float]) -> Floats:
    """Area that points dominate and that in turn dominates the reference point.

    Source: E. Zitzler, L. Thiele, "Multiobjective evolutionary algorithms: a comparative case study and the
    strength Pareto approach", IEEE Trans. Evol. Comput. 3 (1999).

    Args:
        points: (..., n, 2), one front per leading index; n may be 0.
        reference: the worst of both coordinates; a point beyond it counts for nothing.

    Returns:
        Shape (...).
    """
    inside = np.minimum(points, reference)
    order = np.argsort(inside[..., 0], axis=-1)
    x, y = (np.take_along_axis(inside[..., k], order, axis=-1) for k in (0, 1))
    # Strips from one point to the next, as high as the best so far.
    widths = np.diff(x, axis=-1, append=np.full((*x.shape[:-1], 1), reference[0]))
    heights = reference[1] - np.minimum.accumulate(y, axis=-1)
    return (widths * heights).sum(axis=-1)
