"""Fits of formulas to decisions: selection of inputs, and least squares for their weights."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

FOLDS = 4
MOST_PASSES = 30
LEAST_GAIN = 1e-3  # smallest relative gain in the error for which an input is added
EXACT = 1e-6  # an error below this is rounding


class Fit(NamedTuple):
    """A fit of one decision.

    Attributes:
        inputs: columns that the fit uses.
        coefficients: (1 + number of inputs,) the constant first.
        error: root mean squared error on episodes that were left out of the fit.
    """

    inputs: tuple[int, ...]
    coefficients: Floats
    error: float


def fit_within(inputs: Floats, wanted: Floats, low: float, high: float) -> Floats:
    """Return the least squares fit of a linear function that is clipped to bounds.

    Where the wanted value is a bound, the function may lie beyond it at no cost. This convex problem is
    solved by leaving such rows out until the same rows are left out twice.

    Args:
        inputs: (N, k) inputs.
        wanted: (N,) values within the bounds.
        low: the lower bound.
        high: the upper bound.

    Returns:
        (1 + k,) the constant, then the weights.
    """
    design = np.column_stack([np.ones(len(inputs)), inputs])
    counted = np.ones(len(wanted), dtype=np.bool_)
    coefficients = np.zeros(design.shape[1])
    for _ in range(MOST_PASSES):
        coefficients = np.linalg.lstsq(design[counted], wanted[counted], rcond=1e-9)[0]
        found = design @ coefficients
        beyond = ((wanted <= low) & (found <= low)) | ((wanted >= high) & (found >= high))
        if (beyond == ~counted).all() or beyond.all():
            break
        counted = ~beyond
    return coefficients


def select_forward(
    inputs: Floats, wanted: Floats, low: float, high: float, episodes: NDArray[np.int64], most_inputs: int
) -> list[Fit]:
    """Return fits with no input, one, two, ...; each adds the input that lowers the error most.

    Args:
        inputs: (N, m) candidates.
        wanted: (N,) decisions, scaled so that an error means the same everywhere.
        low: the lower bound of the decision.
        high: the upper bound.
        episodes: (N,) number of the episode of each row; errors are computed on episodes that were left out.
        most_inputs: largest number of inputs; fewer are used if another one gains less than `LEAST_GAIN`.
    """
    chosen: tuple[int, ...] = ()
    fits = [_fit(inputs, wanted, low, high, episodes, chosen)]
    while len(chosen) < most_inputs:
        candidates = [
            _fit(inputs, wanted, low, high, episodes, (*chosen, column))
            for column in range(inputs.shape[1])
            if column not in chosen
        ]
        best = min(candidates, key=lambda fit: fit.error, default=fits[-1])
        if best.error >= (1.0 - LEAST_GAIN) * fits[-1].error or fits[-1].error < EXACT:
            break
        fits.append(best)
        chosen = best.inputs
    return fits


def share_out(paths: Sequence[Sequence[Fit]], numbers: int) -> list[tuple[Fit, ...]]:
    """Share numbers out among decisions: return one fit per decision for each total, smallest total first.

    A number is added where it lowers the sum of squared errors most, looking ahead over several numbers.

    Args:
        paths: fits of each decision, as `select_forward` returns them.
        numbers: largest total number of constants and weights.

    Raises:
        ValueError: if there are fewer numbers than constants.
    """
    if numbers < len(paths):
        raise ValueError(f"{len(paths)} decisions need {len(paths)} numbers at least, got {numbers}")
    taken = [0] * len(paths)
    shared = [tuple(path[0] for path in paths)]
    left = numbers - len(paths)
    while left:
        rates = [
            ((path[at].error ** 2 - path[then].error ** 2) / (then - at), -then, place, then)
            for place, (path, at) in enumerate(zip(paths, taken, strict=True))
            for then in range(at + 1, min(len(path), at + left + 1))
        ]
        if not rates or max(rates)[0] <= 0.0:
            break
        *_, place, then = max(rates)
        left -= then - taken[place]
        taken[place] = then
        shared.append(tuple(path[at] for path, at in zip(paths, taken, strict=True)))
    return shared


def _fit(
    inputs: Floats,
    wanted: Floats,
    low: float,
    high: float,
    episodes: NDArray[np.int64],
    columns: tuple[int, ...],
) -> Fit:
    part = inputs[:, columns]
    squared = np.zeros(len(wanted))
    for fold in range(FOLDS):
        out = episodes % FOLDS == fold
        constant, *weights = fit_within(part[~out], wanted[~out], low, high)
        found = np.clip(constant + part[out] @ np.array(weights), low, high)
        squared[out] = (found - wanted[out]) ** 2
    return Fit(columns, fit_within(part, wanted, low, high), float(np.sqrt(squared.mean())))
