"""The tables of the SPSFA paper, its numbers beside ours.

Its tables 3, 6, 10 (final fitness) and 4, 7, 11 (running time); a reproduction check of every cell; and
tables for any few scenarios: a summary, and a paired comparison with the baseline.
"""

import numpy as np

from experiments.runs.labels import label
from experiments.runs.outcomes import Outcomes
from experiments.runs.suite import Suite
from experiments.statistics import Comparison, Summary, compare, holm, summarise
from experiments.studies.spsfa.parameter_tables import parameter_tables
from experiments.studies.spsfa.published import (
    FITNESS,
    FITNESS_TABLES,
    SECONDS,
    TIME_TABLES,
    PublishedSample,
)
from experiments.tables.cell import (
    MISSING,
    SIGNS,
    Cell,
    Entry,
    interval_cell,
    number,
    share,
    signed_p,
    superiority_cell,
    verdict,
)
from experiments.tables.table import Table
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE
from swarm_gym.reference import known_optimum
from swarm_gym.worlds import make_problem

MINIMUM_TOLERANCE = 0.01  # of the published minimum
MEAN_TOLERANCE = 0.02  # of the published mean, beyond our interval


def summary_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a table of quality and cost of every controller on every scenario."""
    return [_summary_table(suite, outcomes)]


def case_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return two tables per scenario: final fitness and running time."""
    return [
        make(suite, outcomes, scenario)
        for scenario in suite.scenarios
        for make in (_fitness_table, _time_table)
    ]


def comparison_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a table of every controller against the baseline."""
    return [_comparison_table(suite, outcomes)]


def reproduction_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a table of the published numbers beside ours, if the suite has any of their runs."""
    published = any((scenario, c) in FITNESS for scenario in suite.scenarios for c in suite.controllers)
    return [_reproduction_table(suite, outcomes)] if published else []


def _summary_table(suite: Suite, outcomes: Outcomes) -> Table:
    """Return a table with quality and cost in one cell for each controller and scenario."""
    rows: list[tuple[Entry, ...]] = []
    for controller in suite.controllers:
        cells: list[Entry] = []
        for scenario in suite.scenarios:
            runs = outcomes.of(controller, scenario)
            ours = summarise(runs.fitness)
            cells.append(
                Cell.of(
                    "{value:.1f} ({low:.1f} to {high:.1f}) at {evaluations:k.0f}k",
                    value=ours.mean,
                    low=ours.interval[0],
                    high=ours.interval[1],
                    evaluations=runs.evaluations.mean(),
                )
            )
        rows.append((label(controller), *cells))
    optima = [known_optimum(make_problem(scenario)) for scenario in suite.scenarios]
    rows.append(("true optimum", *map(number, optima)))
    return Table(
        "summary",
        f"Mean final fitness (95 % interval) at mean evaluations, {suite.num_seeds} seeds never trained on",
        ("controller", *suite.scenarios),
        rows,
    )


def _fitness_table(suite: Suite, outcomes: Outcomes, scenario: str) -> Table:
    optimum = known_optimum(make_problem(scenario))
    unit = optimum or np.nan  # there is no gap relative to an optimum of 0
    rows: list[tuple[Entry, ...]] = []
    for controller in suite.controllers:
        runs = outcomes.of(controller, scenario)
        ours = summarise(runs.fitness)
        feasible = np.mean(runs.collision <= FEASIBILITY_TOLERANCE)
        rows.append(
            (
                label(controller),
                *_four(ours),
                interval_cell(ours.interval),
                number(ours.median),
                share(feasible, ".0f"),
                number(np.median(runs.collision), ".2g"),
                share((ours.mean - optimum) / unit),
                *_published(FITNESS.get((scenario, controller))),
            )
        )
    known = "" if np.isnan(optimum) else f"; the true optimum is {optimum:.2f}"
    return Table(
        _name("optimal-solutions", scenario, FITNESS_TABLES),
        f"{_title(scenario, FITNESS_TABLES)}Final fitness on {scenario}, {suite.num_seeds} runs{known}",
        (
            "controller", "max", "min", "mean", "std", "95 % interval of the mean", "median",
            "feasible", "median collision", "mean gap", "paper max", "paper min", "paper mean", "paper std",
        ),
        rows,
        scenario,
    )  # fmt: skip


def _time_table(suite: Suite, outcomes: Outcomes, scenario: str) -> Table:
    unit = outcomes.of("fixed:60", scenario) if "fixed:60" in outcomes.controllers else None
    published_unit = SECONDS.get((scenario, "fixed:60"))
    rows: list[tuple[Entry, ...]] = []
    for controller in suite.controllers:
        runs = outcomes.of(controller, scenario)
        ours = summarise(runs.seconds)
        evaluations = runs.evaluations.mean()
        published = SECONDS.get((scenario, controller))
        ratio = evaluations / unit.evaluations.mean() if unit else None
        published_ratio = published.mean / published_unit.mean if published and published_unit else None
        rows.append(
            (
                label(controller),
                *_four(ours),
                number(evaluations, ",.0f"),
                number(ratio, ".2f"),
                number(published_ratio, ".2f"),
                *_published(published),
            )
        )
    return Table(
        _name("running-times", scenario, TIME_TABLES),
        f"{_title(scenario, TIME_TABLES)}Running time in seconds and evaluations on {scenario}, "
        f"{suite.num_seeds} runs",
        (
            "controller", "max", "min", "mean", "std", "mean evaluations", "evaluations / FA-60",
            "paper time / FA-60", "paper max", "paper min", "paper mean", "paper std",
        ),
        rows,
        scenario,
    )  # fmt: skip


def _comparison_table(suite: Suite, outcomes: Outcomes) -> Table:
    """Compare every controller with the baseline on the same seeds; correct p-values over the table."""
    compared: list[tuple[str, str, Comparison, float]] = []
    for scenario in suite.scenarios:
        if suite.baseline not in outcomes.controllers:
            continue
        baseline = outcomes.of(suite.baseline, scenario)
        for controller in suite.controllers:
            if controller != suite.baseline:
                runs = outcomes.of(controller, scenario)
                cost = runs.evaluations.mean() / baseline.evaluations.mean()
                compared.append((scenario, controller, compare(runs.fitness, baseline.fitness), cost))
    adjusted = holm([comparison.p_value for _, _, comparison, _ in compared])
    rows = [
        (
            scenario,
            label(controller),
            number(comparison.difference, "+.1f"),
            interval_cell(comparison.interval, "+.1f"),
            superiority_cell(comparison.superiority, comparison.difference),
            signed_p(p_value, comparison.direction),
            number(cost, ".2f"),
        )
        for (scenario, controller, comparison, cost), p_value in zip(compared, adjusted, strict=True)
    ]
    return Table(
        "comparison",
        f"Paired with {label(suite.baseline)} on the same {suite.num_seeds} seeds: mean difference of the "
        "final fitness (negative is better), probability of being better (A12), Wilcoxon signed-rank "
        f"p-value after Holm's correction, ratio of the mean evaluations. {SIGNS}",
        (
            "scenario", "controller", "difference", "95 % interval", "A12", "p", "evaluations ratio",
        ),
        rows,
    )  # fmt: skip


def _reproduction_table(suite: Suite, outcomes: Outcomes) -> Table:
    """Check that our minimum is within 1 % of the published one, and its mean within 2 % of our interval."""
    rows: list[tuple[Entry, ...]] = []
    for (scenario, controller), published in FITNESS.items():
        if scenario not in outcomes.scenarios or controller not in outcomes.controllers:
            continue
        ours = summarise(outcomes.of(controller, scenario).fitness)
        off_minimum = ours.minimum / published.minimum - 1.0
        low, high = ours.interval
        off_mean = max(low - published.mean, published.mean - high, 0.0) / published.mean
        rows.append(
            (
                scenario,
                label(controller),
                number(published.minimum),
                number(ours.minimum),
                share(off_minimum),
                verdict(abs(off_minimum) <= MINIMUM_TOLERANCE),
                number(published.mean),
                interval_cell(ours.interval),
                share(off_mean),
                verdict(off_mean <= MEAN_TOLERANCE),
            )
        )
    return Table(
        "reproduction",
        f"The paper's minima and means beside ours ({suite.num_seeds} seeds): minimum within "
        f"{100 * MINIMUM_TOLERANCE:.0f} %, mean inside or within {100 * MEAN_TOLERANCE:.0f} % of our 95 % "
        "interval",
        (
            "scenario", "controller", "paper min", "our min", "min off by", "min within", "paper mean",
            "our 95 % interval", "mean outside by", "mean within",
        ),
        rows,
    )  # fmt: skip


def _four(sample: Summary | PublishedSample) -> tuple[Entry, ...]:
    values = (sample.maximum, sample.minimum, sample.mean, sample.deviation)
    return tuple(number(value, ".4f") for value in values)


def _published(sample: PublishedSample | None) -> tuple[Entry, ...]:
    return _four(sample) if sample else (MISSING,) * 4


def _name(kind: str, scenario: str, numbers: dict[str, int]) -> str:
    number = numbers.get(scenario)
    return f"table-{number:02}-{kind}-{scenario}" if number else f"{kind}-{scenario}"


def _title(scenario: str, numbers: dict[str, int]) -> str:
    return f"Table {numbers[scenario]}. " if scenario in numbers else ""


TABLES = {
    "summary": summary_tables,
    "cases": case_tables,
    "comparison": comparison_tables,
    "reproduction": reproduction_tables,
    "parameters": parameter_tables,
}
