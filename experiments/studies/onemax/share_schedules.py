"""Schedules over the share of zeros, tuned by CMA-ES on exact expected runtimes: no run is simulated."""

import json
from pathlib import Path

import numpy as np
from cmaes import CMA
from tqdm import trange

import swarm_gym.controllers.onemax_schedules as schedules
from experiments.studies.onemax.runtimes import Floats, optimum
from swarm_gym.controllers.onemax_schedules import FIRST, NUM_KNOTS, SPACING, ShareSchedule
from swarm_gym.files import write_atomically
from swarm_gym.reference.onemax.runtimes import LambdaDecisions, expected_runtimes

SIZES = (100, 200, 500)
FILE = Path(schedules.__file__).parent / "data" / schedules.FILE
# Binary logarithms of the least and the greatest lambda_m, lambda_c, alpha and beta, as in an action.
SPANS = np.array([(0.0, 9.0), (0.0, 8.0), (-9.0, 5.0), (-3.0, 2.0)])
# Candidates of a generation, and generations, by the number of decisions.
EFFORT = {1: (14, 200), 4: (18, 300)}
STEP = 0.6


def tune(num_decisions: int, seed: int = 0) -> ShareSchedule:
    """Return the schedule of lambda, or of all four, with the least mean logarithm of the expected runtime.

    The search begins at the lambda of theory.

    Args:
        num_decisions: 1 or 4.
        seed: seed of CMA-ES.
    """
    candidates, generations = EFFORT[num_decisions]
    half = 0.5 * (FIRST + SPACING * np.arange(NUM_KNOTS))
    start = np.stack([half, half + 1.0, 0.0 * half, 0.0 * half])[:num_decisions]
    bounds = np.repeat(SPANS[:num_decisions], NUM_KNOTS, axis=0)
    strategy = CMA(start.ravel(), STEP, bounds=bounds, seed=seed, population_size=candidates)
    best, least = start.ravel(), np.inf
    for _ in (bar := trange(generations, desc=f"schedule of {num_decisions}")):
        points = [strategy.ask() for _ in range(candidates)]
        losses = [loss(point.reshape(num_decisions, NUM_KNOTS)) for point in points]
        strategy.tell(list(zip(points, losses, strict=True)))
        if min(losses) < least:
            best, least = points[int(np.argmin(losses))], min(losses)
        bar.set_postfix(above=f"{100.0 * (np.exp(least) - 1.0):.2f} %", refresh=False)
    return ShareSchedule(np.round(best.reshape(num_decisions, NUM_KNOTS), 4).astype(np.float64))


def loss(knots: Floats) -> float:
    """Return the mean logarithm of the expected runtime above that of the optimum, over `SIZES`."""
    schedule, choices = ShareSchedule(knots), "onemax-portfolio" if len(knots) == 1 else "onemax-four"
    return float(np.mean([np.log(_runtime(schedule, n) / optimum(choices, n)) for n in SIZES]))


def _runtime(schedule: ShareSchedule, size: int) -> float:
    """Return what `expected_runtime` does, without an environment, which takes longer than short strings."""
    ones = np.arange(size, dtype=np.float64)
    sizes, _, *others = schedule.act(np.stack([np.full(size, float(size)), ones], axis=1)).T
    decisions = LambdaDecisions.of_size(sizes)
    if others:
        decisions = LambdaDecisions(
            decisions.mutants, np.floor(others[0] + 0.5).astype(np.int64), *others[1:]
        )
    return float(expected_runtimes(decisions, size // 2)[size // 2]) + 1.0


def ship() -> Path:
    """Tune both schedules and write the file that the package reads; about an hour."""
    found = {"lambda": tune(1), "four": tune(4)}
    return write_atomically(
        FILE, json.dumps({name: one.knots.tolist() for name, one in found.items()}, indent=1) + "\n"
    )
