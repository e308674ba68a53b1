"""Tables of the study of OneMax; expectations are exact, and what is simulated says so.

`TABLES` are made of stored runs on bit strings. `RUNTIMES` need no runs: `python -m experiments.onemax` makes
them.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial

import numpy as np
from tqdm import tqdm

from experiments.studies.onemax import published, schedules
from experiments.studies.onemax.one_fifth import readings
from experiments.studies.onemax.q_policies import expected_of_trained
from experiments.studies.onemax.runtimes import (
    LARGE,
    MANY,
    SIZES,
    Floats,
    best_constant,
    expected,
    expected_of_seeds,
    one_step,
    optimum,
    simulated,
)
from experiments.tables import Table
from experiments.tables.cell import MISSING, Cell, Entry
from experiments.tables.gaps import evaluation_tables
from swarm_gym.checks import look_up
from swarm_gym.controllers import make_controller

LAMBDA, FOUR = "onemax-lambda", "onemax-four"
# Recipes of lambda by their names in a table. The first two choose a value, the others add normal noise.
RECIPES = {
    "choice, corrects theory": LAMBDA,
    "choice, from scratch": "onemax-choice",
    "normal noise, corrects theory": "onemax-normal-theory",
    "normal noise, corrects theory, in groups": "onemax-grouped",
    "normal noise, from scratch": "onemax-normal",
}
# Lengths at which the schedule over iterations is tuned.
SCHEDULED = (100, 500)

Row = tuple[Entry, ...]


def tables(names: Sequence[str] = ()) -> list[Table]:
    """Return tables by their names, by default all; simulations and tuning take some minutes."""
    makers = [look_up("table", name, RUNTIMES) for name in names or RUNTIMES]
    return [make() for make in tqdm(makers, desc="tables", unit="table")]


def one_parameter() -> Table:
    """Return the table of controllers of lambda, by length."""
    constants = {size: best_constant(size)[1] for size in SIZES}
    blind = {size: simulated(schedules.tune(size), size).mean for size in SCHEDULED}
    rows: list[Row] = [
        ("optimum, any lambda up to 64", *(_number(optimum("onemax", size)) for size in SIZES)),
        ("optimum, lambda in 1, 2, 4, ..., 64", *(_of(_portfolio(size), size) for size in SIZES)),
        *_of_recipe("PPO", LAMBDA),
        *_of_seeds("double DQN, published settings", expected_of_trained),
        *_of_seeds("double DQN, at the end of trainings", partial(expected_of_trained, at_the_end=True)),
        ("CMA-ES over the share of zeros", *(_of(expected("share:lambda", size), size) for size in SIZES)),
        ("DDQN, published", *(_of(published.DDQN_LAMBDA[size][0], size) for size in SIZES)),
        ("theory", *(_of(expected("theory", size), size) for size in SIZES)),
        ("one-fifth rule", *(_of(expected("one-fifth", size), size) for size in SIZES)),
        ("best schedule over iterations, simulated", *(_of(blind.get(size), size) for size in SIZES)),
        ("best constant lambda", *(_of(constants[size], size) for size in SIZES)),
    ]
    caption = (
        "Control of lambda: expected evaluations, and how far they are above the optimum over 1, 2, 4, ..., "
        "64. Of PPO and double DQN, the mean over training seeds, whose number is given, and the worst of "
        "them"
    )
    return Table("one-parameter", caption, ("controller", *_heads(SIZES)), rows)


def recipes() -> Table:
    """Return the table of recipes of PPO for lambda, which differ in noise, base and groups."""
    rows = [row for label, recipe in RECIPES.items() for row in _of_recipe(label, recipe)]
    caption = (
        "PPO of lambda, in recipes that differ in the distribution of decisions, in what they begin with and "
        "in groups: expected evaluations, and how far they are above the optimum over 1, 2, 4, ..., 64; mean "
        "over training seeds, whose number is given, and the worst of them"
    )
    return Table("recipes", caption, ("recipe", *_heads(SIZES)), rows)


def four_parameters() -> Table:
    """Return the table of controllers of four parameters, by length."""
    rows: list[Row] = [
        ("optimum, wide choices", *(_number(optimum("onemax-four", size)) for size in SIZES)),
        ("optimum, published choices", *(_of(optimum("onemax-four-published", s), s, _four) for s in SIZES)),
        *_of_recipe("PPO", FOUR, _four),
        (
            "CMA-ES over the share of zeros",
            *(_of(expected("share:four", size), size, _four) for size in SIZES),
        ),
        ("DDQN, published", *(_of(published.DDQN_FOUR[size][0], size, _four) for size in SIZES)),
        ("symbolic rule", *(_of(expected("symbolic", size), size, _four) for size in SIZES)),
        ("static, by irace, published", *(_of(published.IRACE[size][0], size, _four) for size in SIZES)),
    ]
    caption = (
        "Control of all four parameters: expected evaluations, and how far they are above the optimum over "
        "wide choices, where it is known"
    )
    return Table("four-parameters", caption, ("controller", *_heads(SIZES)), rows)


def generalisation() -> Table:
    """Return the table of lengths that no training had."""
    rows: list[Row] = []
    for size in (1000, 2000, *LARGE):
        one, four = expected_of_seeds(LAMBDA, size), expected_of_seeds(FOUR, size)
        theory, symbolic, best = expected("theory", size), expected("symbolic", size), _portfolio(size)
        tuned = expected("share:lambda", size)
        rows.append(
            (
                f"{size:,}",
                _number(theory),
                _share_of_seeds(one / theory - 1.0),
                _share_of_seeds(one / best - 1.0),
                _share(tuned / theory - 1.0),
                _share(tuned / best - 1.0),
                _number(symbolic),
                _share_of_seeds(four / symbolic - 1.0),
                _share(expected("share:four", size) / symbolic - 1.0),
            )
        )
    caption = (
        "Lengths that no training had: expected evaluations of rules, and how far PPO and CMA-ES, trained or "
        "tuned at n = 100 to 500, are above them; of PPO, the mean over ten training seeds and the worst"
    )
    heads = (
        "n",
        "theory",
        "PPO above theory",
        "PPO above the optimum",
        "CMA-ES above theory",
        "CMA-ES above the optimum",
        "symbolic",
        "PPO of four above symbolic",
        "CMA-ES of four above symbolic",
    )
    return Table("generalisation", caption, heads, rows)


def simulations() -> Table:
    """Return the table of simulated runs beside exact expectations and published means."""
    of: Mapping[str, Mapping[int, published.Mean]] = {
        "theory": published.THEORY, "one-fifth": published.ONE_FIFTH, "symbolic": {}
    }  # fmt: skip
    rows: list[Row] = []
    for name, means in of.items():
        for size in SIZES:
            found, exact = simulated(make_controller(name), size, MANY), expected(name, size)
            there: tuple[Entry, ...] = (MISSING, MISSING, MISSING)
            if means:
                mean, error = means[size][0], means[size][1] / math.sqrt(published.NUM_RUNS)
                there = (
                    Cell.of("{value:,.1f} ± {error:.1f}", value=mean, error=error),
                    _errors(found.mean - mean, math.hypot(found.error, error)),
                    _errors(mean - exact, error),
                )
            rows.append(
                (
                    name,
                    f"{size:,}",
                    _number(exact),
                    Cell.of("{value:,.1f} ± {error:.1f}", value=found.mean, error=found.error),
                    _errors(found.mean - exact, found.error),
                    *there,
                )
            )
    caption = (
        f"Exact expectations, and {len(MANY):,} simulated and {published.NUM_RUNS:,} published runs with "
        "their standard errors; differences in standard errors"
    )
    heads = (
        "rule",
        "n",
        "exact",
        "simulated",
        "minus exact",
        "published",
        "simulated minus published",
        "published minus exact",
    )
    return Table("simulations", caption, heads, rows)


def counting() -> Table:
    """Return the table of both ways to count evaluations."""
    sizes = (100, 200)
    rows: list[Row] = []
    for label, free, counted in (
        ("optimum of lambda", lambda s: optimum("onemax", s), lambda s: optimum("onemax", s, "all")),
        ("theory", lambda s: expected("theory", s), lambda s: expected("theory", s, False)),
        ("PPO of lambda", lambda s: _mean(LAMBDA, s, True), lambda s: _mean(LAMBDA, s, False)),
        ("optimum of four", lambda s: optimum("onemax-four", s), lambda s: optimum("onemax-four", s, "all")),
        ("symbolic", lambda s: expected("symbolic", s), lambda s: expected("symbolic", s, False)),
        ("PPO of four", lambda s: _mean(FOUR, s, True), lambda s: _mean(FOUR, s, False)),
    ):
        rows.append((label, *(entry for s in sizes for entry in (_number(free(s)), _number(counted(s))))))
    caption = (
        "Expected evaluations where children that equal the parent or the best mutant are free, as "
        "published, and where each child counts"
    )
    heads = (f"n = {size}, {way}" for size in sizes for way in ("copies free", "all count"))
    return Table("counting", caption, ("controller", *heads), rows)


def valley() -> Table:
    """Return the table of what one value of lambda costs in one state."""
    size, numbers = 200, (1, 2, 3, 4, 5, 6, 8, 12, 16)
    rows: list[Row] = []
    for zeros in (5, 8, 10, 12, 15, 30):
        costs = one_step(size, zeros, numbers)
        rows.append((str(zeros), *(Cell.of("{value:.1f}", value=cost - costs.min()) for cost in costs)))
    caption = (
        "Evaluations lost, at n = 200, by one value of lambda at this number of zeros, with optimal control "
        "after it: the best value and lambda = 1 are parted by worse ones"
    )
    return Table("valley", caption, ("zeros", *(f"lambda = {number}" for number in numbers)), rows)


def _heads(sizes: tuple[int, ...]) -> tuple[str, ...]:
    return tuple(f"n = {size:,}" for size in sizes)


def _portfolio(size: int) -> float:
    return optimum("onemax-portfolio", size)


def _four(size: int) -> float:
    return optimum("onemax-four", size)


def _mean(recipe: str, size: int, copies_free: bool) -> float:
    return float(expected_of_seeds(recipe, size, copies_free).mean())


def _number(value: float) -> Entry:
    return MISSING if math.isnan(value) else Cell.of("{value:,.1f}", value=value)


def _of(value: float | None, size: int, best: Callable[[int], float] = _portfolio) -> Entry:
    """Return a runtime, and how far it is above the optimum if that is known."""
    if value is None or math.isnan(value):
        return MISSING
    above = value / best(size) - 1.0
    if math.isnan(above):
        return _number(value)
    return Cell.of("{value:,.1f} ({above:%+.1f} %)", value=value, above=above)


def _of_recipe(label: str, recipe: str, best: Callable[[int], float] = _portfolio) -> list[Row]:
    """Return the rows of the mean over training seeds and of the worst of them."""
    return _of_seeds(label, partial(expected_of_seeds, recipe), best)


def _of_seeds(
    label: str, expected_by_size: Callable[[int], Floats], best: Callable[[int], float] = _portfolio
) -> list[Row]:
    """Return the rows of the mean over training seeds and of the worst of them, given those of a length."""
    by_size = [(expected_by_size(size), size) for size in SIZES]
    seeds = f"{label}, {max(len(found) for found, _ in by_size)} seeds"
    return [
        (name, *(_of(float(reduce(found)), size, best) if len(found) else MISSING for found, size in by_size))
        for name, reduce in ((seeds, np.mean), (f"{label}, worst seed", np.max))
    ]


def _share_of_seeds(shares: Floats) -> Entry:
    if np.isnan(shares).any():
        return MISSING
    return Cell.of("{value:%+.1f} % ({worst:%+.1f} %)", value=shares.mean(), worst=shares.max())


def _share(value: float) -> Entry:
    return MISSING if math.isnan(value) else Cell.of("{value:%+.1f} %", value=value)


def _errors(difference: float, error: float) -> Entry:
    return Cell.of("{value:+.1f}", value=difference / error)


RUNTIMES: dict[str, Callable[[], Table]] = {
    "one-parameter": one_parameter,
    "recipes": recipes,
    "four-parameters": four_parameters,
    "generalisation": generalisation,
    "simulations": simulations,
    "readings": readings,
    "counting": counting,
    "valley": valley,
}
TABLES = {"evaluations": evaluation_tables}
