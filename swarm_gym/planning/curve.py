"""Curves that robots with a turning circle can follow, as results: pieces, and poses sampled along them.

Pieces are arcs and straight lines, or clothoids, along which the curvature changes evenly. Points on
clothoids are integrals by the rule of Gauss and Legendre. It is exact up to rounding for pieces that turn by
less than a half circle.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from swarm_gym.checks import require_number

Floats = NDArray[np.float64]

COLUMNS = ("x", "y", "heading", "curvature", "direction")
NODES, SHARES = (0.5 * values for values in np.polynomial.legendre.leggauss(24))  # on [-1 / 2, 1 / 2]
SPACING = 0.05  # of the poses in `Curve.poses`, in turning radii


@dataclass(frozen=True, eq=False)
class Curve:
    """A curve of arcs, straight lines and clothoids.

    Its heading is continuous. Its curvature jumps from arc to arc, and is continuous along clothoids.

    Headings are degrees from the x axis of the map towards its y axis. Curvatures are positive where the
    heading grows while the robot drives forwards.

    Attributes:
        start: x and y in map units, and heading, (3,).
        pieces: curvature at its begin, and length, which is negative where the robot reverses, of each piece,
            (k, 2).
        turning_radius: least radius that was allowed, in map units.
        rates: change of curvature over length of each piece, (k,), in 1 / map unit squared; None without
            clothoids.
    """

    start: Floats
    pieces: Floats
    turning_radius: float
    rates: Floats | None = None

    @cached_property
    def poses(self) -> Floats:
        """Poses along the curve with the columns `COLUMNS`, (n, 5), see `sampled`."""
        return self.sampled(SPACING * self.turning_radius)

    @property
    def length(self) -> float:
        """Length in map units, forwards and backwards."""
        return float(np.abs(self.pieces[:, 1]).sum())

    @property
    def end(self) -> Floats:
        """Place in map units and heading in radians at the end, (3,)."""
        return self._begins[-1].copy()

    @property
    def least_radius(self) -> float:
        """Radius of the tightest arc, in map units; infinite without arcs."""
        tightest = float(np.abs(self.pieces[:, 0]).max())
        if self.rates is not None:
            tightest = max(tightest, float(np.abs(self.pieces[:, 0] + self.rates * self.pieces[:, 1]).max()))
        return 1.0 / tightest if tightest > 0.0 else math.inf

    @property
    def changes(self) -> int:
        """Number of changes between driving forwards and backwards."""
        return int((self.pieces[1:, 1] * self.pieces[:-1, 1] < 0.0).sum())

    def bending(self) -> float:
        """Return the integral of the square of curvature times turning radius, in map units."""
        squares = (self.pieces[:, 0] * self.turning_radius) ** 2
        if self.rates is not None:
            begins, changes = self.pieces[:, 0], self.rates * self.pieces[:, 1]
            squares = self.turning_radius**2 * (begins * (begins + changes) + changes**2 / 3.0)
        return float((squares * np.abs(self.pieces[:, 1])).sum())

    def sampled(self, spacing: float) -> Floats:
        """Return poses along the curve with the columns `COLUMNS`, (n, 5).

        Each piece begins with a pose. Curvature and direction belong to the piece behind a pose, and at
        the end to the last piece. The direction is 1 forwards and -1 backwards.

        Args:
            spacing: largest distance between two poses along the curve, in map units.

        Raises:
            SettingError: if the spacing is not a positive number.
        """
        require_number("spacing", spacing, 1e-9, 1e9)
        curvatures, lengths = self.pieces.T
        begins = self._begins
        counts = np.maximum(np.ceil(np.abs(lengths) / spacing), 1.0).astype(np.int64)
        piece = np.repeat(np.arange(len(counts)), counts)
        step = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
        along = lengths[piece] * step / counts[piece]
        rates = None if self.rates is None else self.rates[piece]
        poses = _advanced(begins[piece], curvatures[piece], along, rates)
        poses = np.vstack([poses, begins[-1:]])
        piece = np.append(piece, len(counts) - 1)
        curvatures = curvatures[piece]
        if self.rates is not None:
            curvatures = curvatures + self.rates[piece] * np.append(along, lengths[-1])
        signs = np.where(lengths < 0.0, -1.0, 1.0)
        headings = np.degrees(poses[:, 2])
        headings -= 360.0 * np.round(headings / 360.0)
        return np.column_stack([poses[:, :2], headings, curvatures + 0.0, signs[piece]])

    def at(self, along: Floats) -> Floats:
        """Return places in map units and headings in radians, (n, 3), at lengths from the start, (n,)."""
        curvatures, lengths = self.pieces.T
        cuts = np.append(0.0, np.cumsum(np.abs(lengths)))
        piece = np.clip(np.searchsorted(cuts, along, side="right") - 1, 0, len(lengths) - 1)
        driven = np.where(lengths[piece] < 0.0, -1.0, 1.0) * (along - cuts[piece])
        rates = None if self.rates is None else self.rates[piece]
        return _advanced(self._begins[piece], curvatures[piece], driven, rates)

    @cached_property
    def _begins(self) -> Floats:
        """Pose at the begin of each piece and at the end, with headings in radians, (k + 1, 3)."""
        curvatures, lengths = self.pieces.T
        turns = curvatures * lengths
        if self.rates is not None:
            turns = turns + 0.5 * self.rates * lengths**2
        headings = math.radians(self.start[2]) + np.append(0.0, np.cumsum(turns))
        origins = np.column_stack([np.zeros((len(lengths), 2)), headings[:-1]])
        moves = _advanced(origins, curvatures, lengths, self.rates)[:, :2]
        places = self.start[:2] + np.vstack([np.zeros((1, 2)), np.cumsum(moves, axis=0)])
        return np.column_stack([places, headings])


def _advanced(poses: Floats, curvatures: Floats, lengths: Floats, rates: Floats | None) -> Floats:
    """Return the poses behind pieces from poses, with headings in radians, (n, 3)."""
    if rates is not None:
        return _along_clothoids(poses, curvatures, lengths, rates)
    half = 0.5 * curvatures * lengths
    chords = lengths * np.sinc(half / np.pi)
    middles = poses[:, 2] + half
    return np.column_stack(
        [
            poses[:, 0] + chords * np.cos(middles),
            poses[:, 1] + chords * np.sin(middles),
            poses[:, 2] + 2.0 * half,
        ]
    )


def _along_clothoids(poses: Floats, curvatures: Floats, lengths: Floats, rates: Floats) -> Floats:
    """Return the poses behind clothoids from poses, with headings in radians, (n, 3)."""
    along = lengths[:, None] * (NODES + 0.5)
    headings = poses[:, 2:] + along * (curvatures[:, None] + 0.5 * rates[:, None] * along)
    return np.column_stack(
        [
            poses[:, 0] + lengths * (np.cos(headings) @ SHARES),
            poses[:, 1] + lengths * (np.sin(headings) @ SHARES),
            poses[:, 2] + lengths * (curvatures + 0.5 * rates * lengths),
        ]
    )
