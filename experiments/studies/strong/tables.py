"""Tables of the suite of the paper's cases at equal evaluations."""

from experiments.runs.outcomes import Outcomes, Sample
from experiments.runs.run import Floats, Run
from experiments.runs.suite import Suite
from experiments.studies.strong.suites import BUDGET, ROWS, SHOWN
from experiments.tables.cell import Cell, Entry, share_in
from experiments.tables.table import Row, Table


def budget_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return the mean gap of every group after so many evaluations, ordered by the last one."""
    whole = list(outcomes.sets)[-1]
    named = {controllers[0]: row for row, controllers in ROWS.items()}
    found: list[tuple[float, Row]] = []
    for group in outcomes.groups:
        sample = outcomes.sample(group, whole)
        cells: dict[str, Entry] = {
            f"{budget:,}": share_in(*sample.mean(_gap_at(sample, budget)), ".2f") for budget in SHOWN
        }
        free = Cell.of("{value:%.0f} %", value=float(sample.feasible.mean()))
        name = named.get(outcomes.groups[group][0], group)
        row: Row = {"optimizer and controller": name, **cells, "free at the end": free}
        found.append((float(_gap_at(sample, BUDGET).mean()), row))
    caption = (
        f"Mean gap in per cent of the optimum over the three cases, {suite.num_seeds} test seeds each, after "
        "so many evaluations [95 % interval over training seeds, cases and seeds]; collision counts as "
        "length. A run that ends earlier keeps its last gap. Free: share whose best path is free "
        "before repair"
    )
    rows = [row for _, row in sorted(found, key=lambda one: one[0])]
    return [Table.of("cases-at-budgets", caption, rows)]


def _gap_at(sample: Sample, budget: int) -> Floats:
    """Return the gaps after so many evaluations, shaped like `sample.fitness`."""

    def best_after(run: Run) -> float:
        within = run.course("evaluations") <= budget
        return float(run.course("best_fitness")[within].min()) if within.any() else float("inf")

    return (sample.each(best_after) - sample.optimum) / sample.optimum


TABLES = {"cases-at-budgets": budget_tables}
