"""Tables that rank the scores of suites, for docs/scores.md and its appendix."""

from collections.abc import Sequence

from experiments.runs.labels import label
from experiments.scoring.files import SCORES, ScoreFileError, read_scores, scores_file
from experiments.scoring.score import ScoreRow, mean
from experiments.scoring.suites import PRICE, SCORED, get_scored
from experiments.tables.cell import number, share
from experiments.tables.document import ResultsFolder
from experiments.tables.table import Row, Table

DIGITS = 8  # of a digest
SUITES_BLOCK = "suites"
LEADERS_BLOCK = "leaders"


def ranking(suite: str, scores: Sequence[ScoreRow]) -> Table:
    """Return the table of a suite's controllers, the smallest objective first.

    Args:
        suite: name of a scored suite.
        scores: all of its rows.
    """
    by_entrant = _by_entrant(scores)
    ranked = sorted(by_entrant.items(), key=lambda item: (objective(item[1]), item[0]))
    return Table.of(
        suite,
        f"Suite {suite}: controllers by objective, the mean gap in per cent plus {PRICE:g} for 100,000 "
        "evaluations; gaps are those at the end of the runs, means are over all runs",
        [
            {
                "place": number(place, "d"),
                "controller": label(name),
                "runs": number(sum(len(row.fitness_of_runs) for row in found), "d"),
                "mean gap": share(_mean(found, "gap"), ".2f"),
                "evaluations": number(_mean(found, "evaluations"), ",.0f"),
                "objective": number(objective(found), ".3f"),
                "feasible": share(_mean(found, "feasible")),
                "digest": found[0].digest[:DIGITS],
            }
            for place, (name, found) in enumerate(ranked, 1)
        ],
    )


def suites_table() -> Table:
    """Return the table of scored suites: environments, scenarios and seeds."""
    rows: list[Row] = []
    for name, scored in SCORED.items():
        experiment = scored.experiment
        seeds = sorted({seed for chosen in scored.sets.values() for _, seed in chosen.runs})
        options = [f"{key}={value}" for key, value in sorted(experiment.options.items())]
        rows.append(
            {
                "suite": name,
                "optimizers": ", ".join(scored.optimizers),
                "options": " ".join(options) or "none",
                "sets of scenarios": ", ".join(scored.sets),
                "scenarios": number(len(experiment.scenarios), "d"),
                "seeds": f"{seeds[0]:,}" if len(seeds) == 1 else f"{seeds[0]:,} to {seeds[-1]:,}",
                "seeds each": number(experiment.num_seeds, "d"),
                "policies": number(len(scored.policies), "d"),
                "others": number(len(scored.references), "d"),
            }
        )
    caption = (
        "Suites: optimizers and options of the environments, scenarios, seeds in all and for each scenario, "
        "packaged policies, and controllers beside them"
    )
    return Table.of(SUITES_BLOCK, caption, rows)


def leaders_table() -> Table:
    """Return the first policy of each suite, and the first controller that is not learned.

    Raises:
        ScoreFileError: if a file of scores cannot be used, or lacks a controller that ships.
    """
    return Table.of(
        LEADERS_BLOCK,
        "The first policy of each suite, and the first controller that is not learned: objective, the mean "
        f"gap in per cent plus {PRICE:g} for 100,000 evaluations; number of runs of each controller. These "
        "are few runs, without intervals",
        [_leaders(name) for name in SCORED],
    )


def _leaders(suite: str) -> Row:
    references = set(get_scored(suite).references)
    by_entrant = _by_entrant(_stored(suite))
    ranked = sorted(by_entrant, key=lambda name: (objective(by_entrant[name]), name))
    first = next(name for name in ranked if name not in references)
    other = next(name for name in ranked if name in references)
    return {
        "suite": suite,
        "runs": number(sum(len(row.fitness_of_runs) for row in by_entrant[first]), "d"),
        "first policy": label(first),
        "mean gap": share(_mean(by_entrant[first], "gap"), ".2f"),
        "evaluations": number(_mean(by_entrant[first], "evaluations"), ",.0f"),
        "objective": number(objective(by_entrant[first]), ".3f"),
        "first that is not learned": label(other),
        "its objective": number(objective(by_entrant[other]), ".3f"),
    }


def leaders_block(results: ResultsFolder) -> str:  # noqa: ARG001
    """Return the leaders of all suites as Markdown."""
    return leaders_table().markdown()


def ranking_block(suite: str, results: ResultsFolder) -> str:  # noqa: ARG001
    """Return the ranking of a suite's stored scores as Markdown.

    Raises:
        ScoreFileError: if the file of scores cannot be used, or lacks a controller that ships.
    """
    return ranking(suite, _stored(suite)).markdown()


def _stored(suite: str) -> list[ScoreRow]:
    """Return the stored scores of a suite, which have to be those of all controllers that ship."""
    path = scores_file(SCORES, suite)
    scores = read_scores(path)
    lacking = set(get_scored(suite).entrants) - {row.controller for row in scores}
    if lacking:
        raise ScoreFileError(
            f"{path}: lacks {len(lacking)} controllers, such as {min(lacking)}; run "
            "`python -m experiments.scores`"
        )
    return list(scores)


def suites_block(results: ResultsFolder) -> str:  # noqa: ARG001
    """Return the table of scored suites as Markdown."""
    return suites_table().markdown()


def _by_entrant(scores: Sequence[ScoreRow]) -> dict[str, list[ScoreRow]]:
    """Return the rows of each controller, by its name."""
    found: dict[str, list[ScoreRow]] = {}
    for row in scores:
        found.setdefault(row.controller, []).append(row)
    return found


def _mean(rows: Sequence[ScoreRow], name: str) -> float:
    """Return the mean of a column over all runs."""
    return mean([getattr(row, name) for row in rows for _ in row.fitness_of_runs])


def objective(rows: Sequence[ScoreRow]) -> float:
    """Return the mean gap in per cent plus the price of the mean evaluations, over all runs."""
    return 100.0 * _mean(rows, "gap") + PRICE * _mean(rows, "evaluations") / 100_000.0
