"""Put results into documents: `python -m experiments.publish DOCUMENT ...`.

Fills the marked blocks of each document, such as `study` for docs/study.md, from the results that other
commands wrote. Copies the figures that a document shows to docs/results. If anything is missing, nothing is
written. No number between the marks is typed by hand.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import tyro

from agents.backends import BackendError
from experiments import catalogue
from experiments.documents.front_page import FRONT_BLOCKS, RUNS_BLOCKS
from experiments.documents.marked_blocks import fill
from experiments.documents.records import keep, records_in
from experiments.documents.study_documents import (
    AT_BUDGETS,
    CASES_TABLE,
    LONGER_GUIDED,
    LONGEST_GUIDED,
    STUDY_DOCUMENTS,
)
from experiments.evaluate import EvaluateConfig, evaluate
from experiments.planners.short_tables import CURVE_TABLES, SHORT_TABLES
from experiments.runs.database import ResultsError
from experiments.scoring.ranking import (
    LEADERS_BLOCK,
    SUITES_BLOCK,
    leaders_block,
    ranking_block,
    suites_block,
)
from experiments.scoring.suites import SCORED
from experiments.site.layouts import LAYOUT_BLOCKS
from experiments.speed.benchmark_page import CAPTIONS, OF_PEERS, headline, in_short, read_folder, table
from experiments.speed.measurement import Measurement
from experiments.studies.strong.suites import LADDER
from experiments.tables.block_contents import rows_of, shortened
from experiments.tables.document import Block, Document, ResultsFolder
from experiments.tables.reshape import select
from swarm_gym.checks import look_up
from swarm_gym.command import command
from swarm_gym.errors import MissingExtraError

# What README.md shows of the headline table: rows by the keys of their groups, with other names, and columns.
STRONGEST = {
    "learned:three-cases/*@1": "learned size and phi",
    "open-loop:three-cases-13-knots/*@1": "schedule of 13 knots, blind",
    "tuned:three-cases": "tuned schedule, blind",
    "spsfa-tip": "SPSFA-TIP",
    "fixed:100": "100 members (FA-100)",
}
SHOWN = ("controller", "seeds", "objective", "case1", "case2", "case3", "minus the best blind rival")
CAPTION = (
    "Objective: mean gap in per cent of the optimum plus evaluations / 100,000 [95 % interval], "
    f"{catalogue.SUITES['headline'].num_seeds} test seeds a case. By case: mean gap at mean evaluations. "
    "Blind: observes the iteration only; the last column is the difference to the best of these"
)
SUITE, STUDY, BENCHMARK = "docs/paper", "study/headline", "benchmark"  # folders of the document `results`


def _speed(results: ResultsFolder) -> str:
    """Return the few measurements that tell most, as a table."""
    return headline(*_complete_benchmark(results)).markdown()


def _speed_in_short(results: ResultsFolder) -> str:
    """Return five measurements, as a table."""
    return in_short(*_complete_benchmark(results)).markdown()


def _complete_benchmark(results: ResultsFolder) -> tuple[dict[str, Any], dict[str, list[Measurement]]]:
    machine, groups = read_folder(results.path / BENCHMARK)
    missing = set(CAPTIONS) - set(groups)
    if missing:
        raise ValueError(f"{results.path / BENCHMARK}: {', '.join(sorted(missing))} was not measured")
    return machine, groups


def _measurements(group: str, results: ResultsFolder) -> str:
    _, groups = read_folder(results.path / BENCHMARK)
    return table(group, groups[group]).markdown()


def _headline(results: ResultsFolder) -> str:
    """Return the strongest rows of the headline table; the page and figures of the paper are shown, too.

    Raises:
        ValueError: if the table lacks one of the rows.
    """
    for file in (results.path / SUITE).glob("*.svg"):
        results.show(f"{SUITE}/{file.name}")
    results.show(f"{SUITE}/README.md")
    results.show(f"{BENCHMARK}/growth.svg")
    chosen = rows_of(results.table(f"{STUDY}/headline"), tuple(STRONGEST))
    rows = [(name, *row[1:]) for name, row in zip(STRONGEST.values(), chosen.rows, strict=True)]
    return select(replace(chosen, caption=CAPTION, rows=rows), SHOWN).markdown()


# Each group of measurements stands on one page: moves, other libraries, and all others.
MOVES_BLOCKS: Mapping[str, Block] = {"moves": partial(_measurements, "moves")}
LIBRARIES_BLOCKS: Mapping[str, Block] = {name: partial(_measurements, name) for name in OF_PEERS}
PERFORMANCE_BLOCKS: Mapping[str, Block] = {
    "headline": _speed,
    **{
        name: partial(_measurements, name)
        for name in CAPTIONS
        if name not in (*MOVES_BLOCKS, *LIBRARIES_BLOCKS)
    },
}
README_BLOCKS: Mapping[str, Block] = {
    "ladder": partial(shortened, CASES_TABLE, LADDER),
    "results": _headline,
    "speed": _speed_in_short,
}
RANKINGS: Mapping[str, Block] = {name: partial(ranking_block, name) for name in SCORED}
SCORES_BLOCKS: Mapping[str, Block] = {SUITES_BLOCK: suites_block, LEADERS_BLOCK: leaders_block}
# Documents by the name that stands for them on the command line; `make docs-NAME` makes their results too.
DOCUMENTS: dict[str, tuple[Document, ...]] = {
    "results": (
        Document(Path("README.md"), "", "", blocks=README_BLOCKS),
        Document(Path("docs/performance.md"), "", "", blocks=PERFORMANCE_BLOCKS),
        Document(Path("docs/performance-moves.md"), "", "", blocks=MOVES_BLOCKS),
        Document(Path("docs/performance-libraries.md"), "", "", blocks=LIBRARIES_BLOCKS),
    ),
    **catalogue.DOCUMENTS,
    **STUDY_DOCUMENTS,
    "layouts": (Document(Path("docs/layouts.md"), "", "", blocks=LAYOUT_BLOCKS),),
    "planners": (
        Document(Path("docs/planners.md"), "planners", "planners", blocks=SHORT_TABLES),
        Document(Path("docs/planners-tables.md"), "planners", ""),
        Document(Path("docs/curves.md"), "planners", "", blocks=CURVE_TABLES),
    ),
    "numbers": (
        Document(Path("docs/results.md"), "", "", blocks=FRONT_BLOCKS),
        Document(Path("docs/results-runs.md"), "", "", blocks=RUNS_BLOCKS),
    ),
    "scaling": (Document(Path("docs/scaling.md"), "scaling", "scaling"),),
    "scores": (
        Document(Path("docs/scores.md"), "", "", blocks=SCORES_BLOCKS),
        Document(Path("docs/scores-tables.md"), "", "", blocks=RANKINGS),
    ),
}

# Folders of records of runs that documents without a folder of their own show.
RECORDED = {
    "results": ("docs/paper", "study/headline", AT_BUDGETS),
    "strong-optimizers": ("strong-optimizers", AT_BUDGETS),
    "terrain": ("terrain",),
    "terrain-budgets": (LONGER_GUIDED, LONGEST_GUIDED),
}


@dataclass(frozen=True)
class PublishConfig:
    """Options of the command."""

    documents: Annotated[tuple[str, ...], tyro.conf.Positional, tyro.conf.arg(metavar="DOCUMENT")]
    """Names of the documents to fill, e.g. moa for docs/moa-paper.md. A wrong name lists the valid ones."""
    results: Path = Path("results")
    """Folder that holds all results, by default results. The document moa takes results/docs/moa-paper."""
    evaluate: bool = False
    """First run the suite of each document, as `python -m experiments.evaluate` does, e.g. moa-paper for moa.
    By default the results must be there. The documents results, study, scaling and scores have no such
    suite."""


def publish(name: str, results: Path) -> None:
    """Fill the blocks of the documents of a name and copy their figures.

    Args:
        name: key of `DOCUMENTS`.
        results: folder that holds all results.

    Raises:
        UnknownNameError: if there is no such document.
        OSError: if a table or figure is missing, or the document.
        ValueError: if a block is missing or unknown, or a file is not as expected.
    """
    filled = [fill(document, results) for document in look_up("document", name, DOCUMENTS)]
    for one in filled:
        one.write()
    folders = {document.results for document in DOCUMENTS[name]} - {""} | set(RECORDED.get(name, ()))
    keep(record for folder in sorted(folders) for record in records_in(results / folder))


def evaluate_suite(name: str, results: Path) -> None:
    """Run the suite of a document, as far as its runs are missing, and write its tables and figures.

    Args:
        name: key of `DOCUMENTS`.
        results: folder that holds all results.

    Raises:
        ValueError: if the document has no suite.
        ResultsError: if the database of the suite cannot be used.
    """
    documents = look_up("document", name, DOCUMENTS)
    for suite, folder in dict.fromkeys((document.suite, document.results) for document in documents):
        if not suite:
            raise ValueError(f"--evaluate: {name} is not made from one suite; run `make docs-{name}`")
        evaluate(EvaluateConfig(suite, output=(results / folder).parent))


def main() -> None:
    """Publish the documents that the command line names."""
    config = tyro.cli(PublishConfig, description=__doc__)
    with command(ResultsError, BackendError, MissingExtraError):
        if not config.documents:
            raise ValueError(f"no document is named; name some of {', '.join(DOCUMENTS)}")
        for name in config.documents:
            look_up("document", name, DOCUMENTS)
        for name in config.documents:
            if config.evaluate:
                evaluate_suite(name, config.results)
            publish(name, config.results)


if __name__ == "__main__":
    main()
