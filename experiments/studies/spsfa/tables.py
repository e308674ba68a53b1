"""The tables of the SPSFA paper, its numbers beside ours.

Its tables 3, 6, 10 (final fitness) and 4, 7, 11 (running time); a reproduction check of every cell; and what
is of use for any few scenarios: a summary, and a paired comparison with the baseline.
"""

import numpy as np

from experiments.runs.labels import label
from experiments.runs.outcomes import Outcomes
from experiments.runs.suite import Suite
from experiments.statistics import Comparison, Summary, compare, holm, summarise
from experiments.studies.spsfa.published import FITNESS, FITNESS_TABLES, SECONDS, TIME_TABLES
from experiments.tables.table import Table, percent
from swarm_gym.problem.analytic.cost import FEASIBILITY_TOLERANCE
from swarm_gym.reference import known_optimum
from swarm_gym.settings import make_problem

MINIMUM_TOLERANCE = 0.01  # of the paper's minimum
MEAN_TOLERANCE = 0.02  # of the paper's mean, beyond our interval


def summary_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Quality and cost of every controller on every scenario."""
    return [_summary_table(suite, outcomes)]


def case_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Final fitness and running time, two tables per scenario."""
    return [
        make(suite, outcomes, scenario)
        for scenario in suite.scenarios
        for make in (_fitness_table, _time_table)
    ]


def comparison_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Every controller against the baseline."""
    return [_comparison_table(suite, outcomes)]


def reproduction_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """The paper's cells beside ours; none where the suite has none of these."""
    printed = any((scenario, c) in FITNESS for scenario in suite.scenarios for c in suite.controllers)
    return [_reproduction_table(suite, outcomes)] if printed else []


def _summary_table(suite: Suite, outcomes: Outcomes) -> Table:
    """Quality and cost of every controller on every scenario, in one cell each."""
    rows = []
    for controller in suite.controllers:
        cells = []
        for scenario in suite.scenarios:
            runs = outcomes.of(controller, scenario)
            ours = summarise(runs.fitness)
            low, high = ours.interval
            cost = runs.evaluations.mean() / 1000
            cells.append(f"{ours.mean:.1f} ({low:.1f} to {high:.1f}) at {cost:.0f}k")
        rows.append((label(controller), *cells))
    optima = [known_optimum(make_problem(scenario)) for scenario in suite.scenarios]
    rows.append(("true optimum", *("–" if np.isnan(optimum) else f"{optimum:.1f}" for optimum in optima)))
    return Table(
        "summary",
        f"Mean final fitness (95 % interval) at mean evaluations, {suite.num_seeds} seeds never trained on",
        ("controller", *suite.scenarios),
        rows,
    )


def _fitness_table(suite: Suite, outcomes: Outcomes, scenario: str) -> Table:
    optimum = known_optimum(make_problem(scenario))
    unit = optimum or np.nan  # nothing is relative to 0
    rows = []
    for controller in suite.controllers:
        runs = outcomes.of(controller, scenario)
        ours = summarise(runs.fitness)
        feasible = np.mean(runs.collision <= FEASIBILITY_TOLERANCE)
        rows.append(
            (
                label(controller),
                *_four(ours),
                f"{ours.interval[0]:.1f} to {ours.interval[1]:.1f}",
                f"{ours.median:.1f}",
                f"{100 * feasible:.0f} %",
                f"{np.median(runs.collision):.2g}",
                percent((ours.mean - optimum) / unit),
                *_printed(FITNESS.get((scenario, controller))),
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
    )  # fmt: skip


def _time_table(suite: Suite, outcomes: Outcomes, scenario: str) -> Table:
    unit = outcomes.of("fixed:60", scenario) if "fixed:60" in outcomes.controllers else None
    printed_unit = SECONDS.get((scenario, "fixed:60"))
    rows = []
    for controller in suite.controllers:
        runs = outcomes.of(controller, scenario)
        ours = summarise(runs.seconds)
        evaluations = runs.evaluations.mean()
        printed = SECONDS.get((scenario, controller))
        ratio = f"{evaluations / unit.evaluations.mean():.2f}" if unit else "–"
        printed_ratio = f"{printed.mean / printed_unit.mean:.2f}" if printed and printed_unit else "–"
        rows.append(
            (
                label(controller),
                *(f"{value:.4f}" for value in _values(ours)),
                f"{evaluations:,.0f}",
                ratio,
                printed_ratio,
                *_printed(printed),
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
    )  # fmt: skip


def _comparison_table(suite: Suite, outcomes: Outcomes) -> Table:
    """Every controller against the baseline on the same seeds; p-values corrected over the table."""
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
            f"{comparison.difference:+.1f}",
            f"{comparison.interval[0]:+.1f} to {comparison.interval[1]:+.1f}",
            f"{comparison.superiority:.2f}",
            f"{p_value:.2g}",
            f"{cost:.2f}",
        )
        for (scenario, controller, comparison, cost), p_value in zip(compared, adjusted, strict=True)
    ]
    return Table(
        "comparison",
        f"Paired with {label(suite.baseline)} on the same {suite.num_seeds} seeds: mean difference of the "
        "final fitness (negative is better), probability of being better (A12), Wilcoxon signed-rank "
        "p-value after Holm's correction, ratio of the mean evaluations",
        (
            "scenario", "controller", "difference", "95 % interval", "A12", "p", "evaluations ratio",
        ),
        rows,
    )  # fmt: skip


def _reproduction_table(suite: Suite, outcomes: Outcomes) -> Table:
    """Minimum within 1 % of the paper's; its mean inside, or within 2 % of, our interval."""
    rows = []
    for (scenario, controller), printed in FITNESS.items():
        if scenario not in outcomes.scenarios or controller not in outcomes.controllers:
            continue
        ours = summarise(outcomes.of(controller, scenario).fitness)
        off_minimum = ours.minimum / printed.minimum - 1.0
        low, high = ours.interval
        off_mean = max(low - printed.mean, printed.mean - high, 0.0) / printed.mean
        rows.append(
            (
                scenario,
                label(controller),
                f"{printed.minimum:.1f}",
                f"{ours.minimum:.1f}",
                percent(off_minimum),
                _verdict(abs(off_minimum) <= MINIMUM_TOLERANCE),
                f"{printed.mean:.1f}",
                f"{low:.1f} to {high:.1f}",
                percent(off_mean),
                _verdict(off_mean <= MEAN_TOLERANCE),
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


def _values(summary: Summary) -> tuple[float, float, float, float]:
    return summary.maximum, summary.minimum, summary.mean, summary.deviation


def _four(summary: Summary) -> tuple[str, ...]:
    return tuple(f"{value:.4f}" for value in _values(summary))


def _printed(row: tuple[float, ...] | None) -> tuple[str, ...]:
    return tuple(f"{value:.4f}" for value in row) if row else ("–",) * 4


def _verdict(within: bool) -> str:
    return "yes" if within else "**no**"


def _name(kind: str, scenario: str, numbers: dict[str, int]) -> str:
    number = numbers.get(scenario)
    return f"table-{number:02}-{kind}-{scenario}" if number else f"{kind}-{scenario}"


def _title(scenario: str, numbers: dict[str, int]) -> str:
    return f"Table {numbers[scenario]}. " if scenario in numbers else ""
