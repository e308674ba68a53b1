"""The tables of the IAFSA paper, among them that of convergence, and the document that shows them.

The IAFSA paper states no criterion of convergence; ours is that of `experiments.runs.run`.
"""

from dataclasses import replace

import numpy as np

from experiments.runs.labels import OPTIMIZER_LABELS
from experiments.runs.outcomes import Floats, Outcomes
from experiments.runs.run import STILL_TO_COME, Run, convergence_iteration
from experiments.runs.suite import Suite
from experiments.studies.iafsa.function_tables import find_entrants, function_tables, shifted_tables
from experiments.studies.iafsa.published import AFSA, CONVERGENCE, ITERATIONS, Function
from experiments.studies.iafsa.route_tables import route_tables
from experiments.tables.cell import mean_cell, number
from experiments.tables.document import document_of_suite
from experiments.tables.table import Row, Table

LENGTH = ITERATIONS[-1]  # of the runs; the IAFSA paper does not state it


def convergence_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return iterations to convergence (table 3)."""
    names = {o: name for (o, length), name in find_entrants(suite).items() if length == LENGTH}
    rows: list[Row] = []
    for scenario in suite.scenarios:
        level = outcomes.of(names[AFSA], scenario).fitness.mean() if AFSA in names else np.nan
        rows += [
            _row(Function.of(scenario), optimizer, outcomes.runs(name, scenario), level)
            for optimizer, name in names.items()
        ]
    caption = (
        f"Table 3. Iterations to convergence over {suite.num_seeds} runs of {LENGTH} iterations: the "
        f"first after which at most {STILL_TO_COME:g} of the run's whole gain is still to come; mean [95 "
        "% interval], and mean evaluations until then; mean iterations until the run is below the final "
        "mean of AFSA, all where it never is. The paper states no criterion and no number of iterations"
    )
    return Table.if_any("iafsa-convergence", caption, rows)


def iterations_to(course: Floats, level: float) -> int:
    """Return the iterations until a course (T + 1,) is below a level; T if it never is."""
    below = np.flatnonzero(course < level)
    return int(below[0]) if below.size else len(course) - 1


def _row(function: Function, optimizer: str, runs: list[Run], level: float) -> Row:
    """Return the row of runs of one optimizer on one function; `level` is the final mean of AFSA."""
    courses = [run.course("best_fitness") for run in runs]
    iterations = np.array([convergence_iteration(course) for course in courses], dtype=np.float64)
    spent = [run.course("evaluations")[int(k)] for run, k in zip(runs, iterations, strict=True)]
    published = CONVERGENCE.get((function.key, optimizer), (None, None, None))
    return {
        "function": function.label,
        "method": OPTIMIZER_LABELS[optimizer],
        "max": number(iterations.max(), ".0f"),
        "min": number(iterations.min(), ".0f"),
        "mean": mean_cell(iterations),
        "evaluations": number(np.mean(spent), ",.0f"),
        "to AFSA's mean": number(np.mean([iterations_to(course, level) for course in courses])),
        **{
            f"paper {name}": number(value, ".0f")
            for name, value in zip(("max", "min", "mean"), published, strict=True)
        },
    }


TABLES = {
    "iafsa-functions": function_tables,
    "iafsa-convergence": convergence_tables,
    "iafsa-shifted": shifted_tables,
    "iafsa-routes": route_tables,
}
COLLECTION = "iafsa-paper"
DOCUMENTS = {
    "iafsa": (
        document_of_suite("docs/iafsa-paper.md", COLLECTION),
        *(
            replace(document_of_suite(f"docs/{page}.md", COLLECTION), figures="")
            for page in ("iafsa-claims", "iafsa-routes")
        ),
    )
}
