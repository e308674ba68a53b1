"""Tables that rank the scores of a suite, for docs/scores.md."""

from collections.abc import Sequence

from experiments.runs.labels import label
from experiments.scoring.files import SCORES, ScoreFileError, read_scores, scores_file
from experiments.scoring.score import ScoreRow, mean
from experiments.scoring.suites import PRICE, SCORED, get_scored
from experiments.tables.cell import Entry, number, share
from experiments.tables.document import ResultsFolder
from experiments.tables.table import Table

DIGITS = 8  # of a digest
SUITES_BLOCK = "suites"


def ranking(suite: str, scores: Sequence[ScoreRow]) -> Table:
    """Return the table of a suite's controllers, the smallest objective first.

    Args:
        suite: name of a scored suite.
        scores: all of its rows.
    """
    by_entrant: dict[str, list[ScoreRow]] = {}
    for row in scores:
        by_entrant.setdefault(row.controller, []).append(row)
    ranked = sorted(by_entrant.items(), key=lambda item: (_objective(item[1]), item[0]))
    rows: list[tuple[Entry, ...]] = [
        (
            number(place, "d"),
            label(name),
            number(sum(len(row.fitness_of_runs) for row in found), "d"),
            share(_mean(found, "gap"), ".2f"),
            number(_mean(found, "evaluations"), ",.0f"),
            number(_objective(found), ".3f"),
            share(_mean(found, "feasible")),
            found[0].digest[:DIGITS],
        )
        for place, (name, found) in enumerate(ranked, 1)
    ]
    return Table(
        suite,
        f"Suite {suite}: controllers by objective, the mean gap in per cent plus {PRICE:g} for 100,000 "
        "evaluations; gaps are those at the end of the runs, means are over all runs",
        (
            "place", "controller", "runs", "mean gap", "evaluations", "objective", "feasible", "digest",
        ),
        rows,
    )  # fmt: skip


def suites_table() -> Table:
    """Return the table of scored suites: environments, scenarios and seeds."""
    rows: list[tuple[Entry, ...]] = []
    for name, scored in SCORED.items():
        experiment, sets = scored.experiment, scored.sets
        seeds = sorted({seed for chosen in sets.values() for _, seed in chosen.runs})
        rows.append(
            (
                name,
                ", ".join(scored.optimizers),
                " ".join(f"{key}={value}" for key, value in sorted(experiment.options.items())) or "none",
                ", ".join(sets),
                number(len(experiment.scenarios), "d"),
                f"{seeds[0]:,}" if len(seeds) == 1 else f"{seeds[0]:,} to {seeds[-1]:,}",
                number(experiment.num_seeds, "d"),
                number(len(scored.policies), "d"),
                number(len(scored.references), "d"),
            )
        )
    return Table(
        SUITES_BLOCK,
        "Suites: optimizers and options of the environments, scenarios, seeds in all and for each scenario, "
        "packaged policies, and controllers beside them",
        (
            "suite", "optimizers", "options", "sets of scenarios", "scenarios", "seeds", "seeds each",
            "policies", "others",
        ),
        rows,
    )  # fmt: skip


def ranking_block(suite: str, results: ResultsFolder) -> str:  # noqa: ARG001
    """Return the ranking of a suite's stored scores as Markdown.

    Raises:
        ScoreFileError: if the file of scores cannot be used, or lacks a controller that ships.
    """
    path = scores_file(SCORES, suite)
    scores = read_scores(path)
    lacking = set(get_scored(suite).entrants) - {row.controller for row in scores}
    if lacking:
        raise ScoreFileError(
            f"{path}: lacks {len(lacking)} controllers, such as {min(lacking)}; run "
            "`python -m experiments.scores`"
        )
    return ranking(suite, scores).markdown()


def suites_block(results: ResultsFolder) -> str:  # noqa: ARG001
    """Return the table of scored suites as Markdown."""
    return suites_table().markdown()


def _mean(rows: Sequence[ScoreRow], name: str) -> float:
    """Return the mean of a column over all runs."""
    return mean([getattr(row, name) for row in rows for _ in row.fitness_of_runs])


def _objective(rows: Sequence[ScoreRow]) -> float:
    return 100.0 * _mean(rows, "gap") + PRICE * _mean(rows, "evaluations") / 100_000.0
