"""Tables of a suite, from stored runs, as Markdown, CSV and LaTeX.

For the paper's cases: its tables 3, 6, 10 (final fitness) and 4, 7, 11 (running time) with its numbers beside
ours; a reproduction check of every cell; and for any suite a paired comparison with the baseline.
"""

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from experiments.labels import label
from experiments.paper_numbers import FITNESS, FITNESS_TABLES, SECONDS, TIME_TABLES
from experiments.results import Results, ResultsError, Run
from experiments.statistics import Comparison, Summary, compare, holm, summarise
from experiments.suites import Suite
from swarm_gym.problem import Problem
from swarm_gym.problem.cost import FEASIBILITY_TOLERANCE
from swarm_gym.reference import known_optimum
from swarm_gym.scenarios import make_scenario

MINIMUM_TOLERANCE = 0.01  # of the paper's minimum
MEAN_TOLERANCE = 0.02  # of the paper's mean, beyond our interval


@dataclass(frozen=True)
class Table:
    """A table: file name, caption, column heads and cells, already formatted."""

    name: str
    caption: str
    columns: tuple[str, ...]
    rows: Sequence[tuple[str, ...]]

    def markdown(self) -> str:
        """GitHub's Markdown, with the caption above."""
        lines = [self.columns, tuple("---" for _ in self.columns), *self.rows]
        body = "\n".join("| " + " | ".join(line) + " |" for line in lines)
        return f"**{self.caption}**\n\n{body}\n"

    def csv(self) -> str:
        """Comma-separated values with a head line."""
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerows([self.columns, *self.rows])
        return text.getvalue()

    def latex(self) -> str:
        """A `table` environment with booktabs rules."""
        lines = [" & ".join(map(_escape, line)) + r" \\" for line in (self.columns, *self.rows)]
        return "\n".join(
            [
                r"\begin{table}",
                r"\centering",
                rf"\caption{{{_escape(self.caption)}}}",
                rf"\begin{{tabular}}{{l{'r' * (len(self.columns) - 1)}}}",
                r"\toprule",
                lines[0],
                r"\midrule",
                *lines[1:],
                r"\bottomrule",
                r"\end{tabular}",
                r"\end{table}",
                "",
            ]
        )


def make_tables(suite: Suite, results: Results) -> list[Table]:
    """All tables of a suite.

    Raises:
        ResultsError: if a run of the suite is missing.
    """
    runs = load(suite, results)
    tables = [_summary_table(suite, runs)]
    for scenario in suite.scenarios:
        tables += [_fitness_table(suite, runs, scenario), _time_table(suite, runs, scenario)]
    tables.append(_comparison_table(suite, runs))
    if any((scenario, c) in FITNESS for scenario in suite.scenarios for c in suite.controllers):
        tables.append(_reproduction_table(suite, runs))
    return tables


Runs = dict[tuple[str, str], list[Run]]  # by scenario and controller


def load(suite: Suite, results: Results) -> Runs:
    """All runs of a suite, by scenario and controller, in the order of the seeds.

    Raises:
        ResultsError: if one is missing.
    """
    runs: Runs = {}
    for scenario in suite.scenarios:
        for controller in suite.controllers:
            found = results.runs(controller, scenario, suite.num_seeds)
            if len(found) < suite.num_seeds:
                raise ResultsError(
                    f"{results.path}: {controller} on {scenario} has {len(found)} of {suite.num_seeds} runs"
                )
            runs[scenario, controller] = found
    return runs


def _summary_table(suite: Suite, runs: Runs) -> Table:
    """Quality and cost of every controller on every scenario, in one cell each."""
    rows = []
    for controller in suite.controllers:
        cells = []
        for scenario in suite.scenarios:
            group = runs[scenario, controller]
            ours = summarise(_fitness(group))
            low, high = ours.interval
            cost = _evaluations(group).mean() / 1000
            cells.append(f"{ours.mean:.1f} ({low:.1f} to {high:.1f}) at {cost:.0f}k")
        rows.append((label(controller), *cells))
    optima = [known_optimum(Problem(make_scenario(scenario))) for scenario in suite.scenarios]
    rows.append(("true optimum", *("–" if np.isnan(optimum) else f"{optimum:.1f}" for optimum in optima)))
    return Table(
        "summary",
        f"Mean final fitness (95 % interval) at mean evaluations, {suite.num_seeds} seeds never trained on",
        ("controller", *suite.scenarios),
        rows,
    )


def _fitness_table(suite: Suite, runs: Runs, scenario: str) -> Table:
    optimum = known_optimum(Problem(make_scenario(scenario)))
    rows = []
    for controller in suite.controllers:
        ours = summarise(_fitness(runs[scenario, controller]))
        feasible = np.mean(
            [run.final_collision <= FEASIBILITY_TOLERANCE for run in runs[scenario, controller]]
        )
        rows.append(
            (
                label(controller),
                *_four(ours),
                f"{ours.interval[0]:.1f} to {ours.interval[1]:.1f}",
                f"{ours.median:.1f}",
                f"{100 * feasible:.0f} %",
                f"{np.median([run.final_collision for run in runs[scenario, controller]]):.2g}",
                _percent((ours.mean - optimum) / optimum),
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


def _time_table(suite: Suite, runs: Runs, scenario: str) -> Table:
    unit = runs.get((scenario, "fixed:60"))
    printed_unit = SECONDS.get((scenario, "fixed:60"))
    rows = []
    for controller in suite.controllers:
        group = runs[scenario, controller]
        ours = summarise(np.array([run.seconds for run in group]))
        evaluations = _evaluations(group).mean()
        printed = SECONDS.get((scenario, controller))
        ratio = f"{evaluations / _evaluations(unit).mean():.2f}" if unit else "–"
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


def _comparison_table(suite: Suite, runs: Runs) -> Table:
    """Every controller against the baseline on the same seeds; p-values corrected over the table."""
    compared: list[tuple[str, str, Comparison, float]] = []
    for scenario in suite.scenarios:
        baseline = runs.get((scenario, suite.baseline))
        for controller in suite.controllers:
            if baseline is None or controller == suite.baseline:
                continue
            group = runs[scenario, controller]
            cost = _evaluations(group).mean() / _evaluations(baseline).mean()
            compared.append((scenario, controller, compare(_fitness(group), _fitness(baseline)), cost))
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


def _reproduction_table(suite: Suite, runs: Runs) -> Table:
    """Minimum within 1 % of the paper's; its mean inside, or within 2 % of, our interval."""
    rows = []
    for (scenario, controller), printed in FITNESS.items():
        if (scenario, controller) not in runs:
            continue
        ours = summarise(_fitness(runs[scenario, controller]))
        off_minimum = ours.minimum / printed.minimum - 1.0
        low, high = ours.interval
        off_mean = max(low - printed.mean, printed.mean - high, 0.0) / printed.mean
        rows.append(
            (
                scenario,
                label(controller),
                f"{printed.minimum:.1f}",
                f"{ours.minimum:.1f}",
                _percent(off_minimum),
                _verdict(abs(off_minimum) <= MINIMUM_TOLERANCE),
                f"{printed.mean:.1f}",
                f"{low:.1f} to {high:.1f}",
                _percent(off_mean),
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


def _fitness(runs: list[Run]) -> np.ndarray:
    return np.array([run.final_fitness for run in runs])


def _evaluations(runs: list[Run]) -> np.ndarray:
    return np.array([run.evaluations for run in runs], dtype=np.float64)


def _values(summary: Summary) -> tuple[float, float, float, float]:
    return summary.maximum, summary.minimum, summary.mean, summary.deviation


def _four(summary: Summary) -> tuple[str, ...]:
    return tuple(f"{value:.4f}" for value in _values(summary))


def _printed(row: tuple[float, ...] | None) -> tuple[str, ...]:
    return tuple(f"{value:.4f}" for value in row) if row else ("–",) * 4


def _percent(value: float) -> str:
    return "–" if np.isnan(value) else f"{100 * value:.1f} %"


def _verdict(within: bool) -> str:
    return "yes" if within else "**no**"


def _name(kind: str, scenario: str, numbers: dict[str, int]) -> str:
    number = numbers.get(scenario)
    return f"table-{number:02}-{kind}-{scenario}" if number else f"{kind}-{scenario}"


def _title(scenario: str, numbers: dict[str, int]) -> str:
    return f"Table {numbers[scenario]}. " if scenario in numbers else ""


def _escape(text: str) -> str:
    text = text.replace("**", "").replace("–", "--")
    for character in "&%$#_":
        text = text.replace(character, "\\" + character)
    return text
