"""Tables of a suite, from stored runs, as Markdown, CSV and LaTeX.

To add one: write a function of the suite and its outcomes that returns tables, enter it in `TABLES`, and name
it in the suites that shall have it.
"""

from collections.abc import Callable

from experiments.runs.database import Results
from experiments.runs.outcomes import Outcomes
from experiments.runs.suite import Suite
from experiments.studies.brand_yu.tables import count_tables, grid_tables
from experiments.studies.dynamic.tables import recovery_tables
from experiments.studies.iafsa.convergence_tables import convergence_tables
from experiments.studies.iafsa.function_tables import function_tables, shifted_tables
from experiments.studies.iafsa.route_tables import route_tables
from experiments.studies.moa.tables import moa_tables
from experiments.studies.spsfa import tables as spsfa_tables
from experiments.studies.spsfa.parameter_tables import parameter_tables
from experiments.tables.differences import difference_tables, duel_tables
from experiments.tables.front import front_tables
from experiments.tables.gaps import gap_tables, near_optimum_tables
from experiments.tables.table import Table
from swarm_gym.checks import look_up

__all__ = ["TABLES", "Table", "make_tables"]

TABLES: dict[str, Callable[[Suite, Outcomes], list[Table]]] = {
    "summary": spsfa_tables.summary_tables,
    "cases": spsfa_tables.case_tables,
    "comparison": spsfa_tables.comparison_tables,
    "reproduction": spsfa_tables.reproduction_tables,
    "gaps": gap_tables,
    "differences": difference_tables,
    "duels": duel_tables,
    "front": front_tables,
    "near-optimum": near_optimum_tables,
    "parameters": parameter_tables,
    "moa": moa_tables,
    "iafsa-functions": function_tables,
    "iafsa-convergence": convergence_tables,
    "iafsa-shifted": shifted_tables,
    "iafsa-routes": route_tables,
    "recovery": recovery_tables,
    "brand-yu-counts": count_tables,
    "brand-yu-grids": grid_tables,
}


def make_tables(suite: Suite, results: Results) -> list[Table]:
    """All tables of a suite.

    Raises:
        ResultsError: if a run of the suite is missing.
        UnknownNameError: if the suite names a table that is not there.
    """
    makers = [look_up("table", name, TABLES) for name in suite.tables]
    outcomes = results.outcomes(suite.controllers, suite.seeds)
    return [table for make in makers for table in make(suite, outcomes)]
