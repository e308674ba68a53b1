"""The tables of the SPSFA paper, its numbers beside ours.

Its tables 3, 6, 10 (final fitness) and 4, 7, 11 (running time); a reproduction check of every cell; and
tables for any few scenarios: a summary, and a paired comparison with the baseline.
"""

import numpy as np

from experiments.runs.labels import label
from experiments.runs.outcomes import Outcomes, RunNumbers
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
from experiments.tables.table import Row, Table
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE

MINIMUM_TOLERANCE = 0.01  # of the published minimum
MEAN_TOLERANCE = 0.02  # of the published mean, beyond our interval


def summary_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a table with quality and cost in one cell for each controller and scenario."""
    rows: list[Row] = [
        {
            "controller": label(controller),
            **{scenario: _summary(outcomes.of(controller, scenario)) for scenario in suite.scenarios},
        }
        for controller in suite.controllers
    ]
    optima = {
        name: number(optimum) for name, optimum in zip(outcomes.scenarios, outcomes.optima, strict=True)
    }
    caption = f"Mean final fitness (95 % interval) at mean evaluations, {suite.num_seeds} test seeds"
    return [Table.of("summary", caption, [*rows, {"controller": "true optimum", **optima}])]


def _summary(runs: RunNumbers) -> Entry:
    ours = summarise(runs.fitness)
    return Cell.of(
        "{value:.1f} ({low:.1f} to {high:.1f}) at {evaluations:k.0f}k",
        value=ours.mean,
        low=ours.interval[0],
        high=ours.interval[1],
        evaluations=runs.evaluations.mean(),
    )


def case_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return two tables per scenario: final fitness and running time."""
    return [
        make(suite, outcomes, scenario)
        for scenario in suite.scenarios
        for make in (_fitness_table, _time_table)
    ]


def _fitness_table(suite: Suite, outcomes: Outcomes, scenario: str) -> Table:
    optimum = outcomes.optima[outcomes.scenarios.index(scenario)]
    unit = optimum or np.nan  # there is no gap relative to an optimum of 0
    rows: list[Row] = []
    for controller in suite.controllers:
        runs = outcomes.of(controller, scenario)
        ours = summarise(runs.fitness)
        rows.append(
            {
                "controller": label(controller),
                **_four(ours),
                "95 % interval of the mean": interval_cell(ours.interval),
                "median": number(ours.median),
                "feasible": share(np.mean(runs.collision <= FEASIBILITY_TOLERANCE), ".0f"),
                "median collision": number(np.median(runs.collision), ".2g"),
                "mean gap": share((ours.mean - optimum) / unit),
                **_four(FITNESS.get((scenario, controller)), "paper "),
            }
        )
    known = "" if np.isnan(optimum) else f"; the true optimum is {optimum:.2f}"
    title = f"Final fitness on {scenario}, {suite.num_seeds} runs{known}"
    return _table_of_paper("optimal-solutions", title, rows, scenario, FITNESS_TABLES)


def _time_table(suite: Suite, outcomes: Outcomes, scenario: str) -> Table:
    unit = outcomes.of("fixed:60", scenario) if "fixed:60" in outcomes.controllers else None
    published_unit = SECONDS.get((scenario, "fixed:60"))
    rows: list[Row] = []
    for controller in suite.controllers:
        runs = outcomes.of(controller, scenario)
        evaluations = runs.evaluations.mean()
        published = SECONDS.get((scenario, controller))
        ratio = evaluations / unit.evaluations.mean() if unit else None
        published_ratio = published.mean / published_unit.mean if published and published_unit else None
        rows.append(
            {
                "controller": label(controller),
                **_four(summarise(runs.seconds)),
                "mean evaluations": number(evaluations, ",.0f"),
                "evaluations / FA-60": number(ratio, ".2f"),
                "paper time / FA-60": number(published_ratio, ".2f"),
                **_four(published, "paper "),
            }
        )
    title = f"Running time in seconds and evaluations on {scenario}, {suite.num_seeds} runs"
    return _table_of_paper("running-times", title, rows, scenario, TIME_TABLES)


def comparison_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a table of every other controller against the baseline; p-values are corrected over it."""
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
        {
            "scenario": scenario,
            "controller": label(controller),
            "difference": number(comparison.difference, "+.1f"),
            "95 % interval": interval_cell(comparison.interval, "+.1f"),
            "A12": superiority_cell(comparison.superiority, comparison.difference),
            "p": signed_p(p_value, comparison.direction),
            "evaluations ratio": number(cost, ".2f"),
        }
        for (scenario, controller, comparison, cost), p_value in zip(compared, adjusted, strict=True)
    ]
    caption = (
        f"Paired with {label(suite.baseline)} on the same {suite.num_seeds} seeds: mean difference of the "
        "final fitness (negative is better), probability of being better (A12), Wilcoxon signed-rank "
        f"p-value after Holm's correction, ratio of the mean evaluations. {SIGNS}"
    )
    return Table.if_any("comparison", caption, rows)


def reproduction_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a table of the published numbers beside ours, if the suite has any of their runs.

    It checks that our minimum is within 1 % of the published one, and its mean within 2 % of our interval.
    """
    rows: list[Row] = []
    for (scenario, controller), published in FITNESS.items():
        if scenario not in outcomes.scenarios or controller not in outcomes.controllers:
            continue
        ours = summarise(outcomes.of(controller, scenario).fitness)
        off_minimum = ours.minimum / published.minimum - 1.0
        low, high = ours.interval
        off_mean = max(low - published.mean, published.mean - high, 0.0) / published.mean
        rows.append(
            {
                "scenario": scenario,
                "controller": label(controller),
                "paper min": number(published.minimum),
                "our min": number(ours.minimum),
                "min off by": share(off_minimum),
                "min within": verdict(abs(off_minimum) <= MINIMUM_TOLERANCE),
                "paper mean": number(published.mean),
                "our 95 % interval": interval_cell(ours.interval),
                "mean outside by": share(off_mean),
                "mean within": verdict(off_mean <= MEAN_TOLERANCE),
            }
        )
    caption = (
        f"The paper's minima and means beside ours ({suite.num_seeds} seeds): minimum within "
        f"{100 * MINIMUM_TOLERANCE:.0f} %, mean inside or within {100 * MEAN_TOLERANCE:.0f} % of our 95 % "
        "interval"
    )
    return Table.if_any("reproduction", caption, rows)


def _four(sample: Summary | PublishedSample | None, of: str = "") -> Row:
    """Return the four numbers of the paper's tables, whose heads begin with `of`; none of no sample."""
    heads = [f"{of}{name}" for name in ("max", "min", "mean", "std")]
    if sample is None:
        return dict.fromkeys(heads, MISSING)
    values = (sample.maximum, sample.minimum, sample.mean, sample.deviation)
    return {head: number(value, ".4f") for head, value in zip(heads, values, strict=True)}


def _table_of_paper(kind: str, title: str, rows: list[Row], scenario: str, numbers: dict[str, int]) -> Table:
    """Return a table of a scenario, with its number in the paper if it has one."""
    number = numbers.get(scenario)
    name = f"table-{number:02}-{kind}-{scenario}" if number else f"{kind}-{scenario}"
    return Table.of(name, f"Table {number}. {title}" if number else title, rows, scenario)


TABLES = {
    "summary": summary_tables,
    "cases": case_tables,
    "comparison": comparison_tables,
    "reproduction": reproduction_tables,
    "parameters": parameter_tables,
}
