"""Put results into documents: `python -m experiments.publish DOCUMENT ...`.

Fills the marked blocks of each document, such as `study` for docs/study.md, from the results that other
commands wrote, and copies the figures that it shows to docs/results. If anything is missing, nothing is
written. No number between the marks is typed by hand.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Annotated

import tyro

from agents.backends import BackendError
from experiments import catalogue
from experiments.documents.blocks import fill
from experiments.evaluate import EvaluateConfig, evaluate
from experiments.runs.database import ResultsError
from experiments.runs.groups import EVERY_SET
from experiments.speed.page import CAPTIONS, headline, read_folder, table
from experiments.tables.document import Block, Document, ResultsFolder
from experiments.tables.reshape import split
from swarm_gym.checks import look_up
from swarm_gym.command import command
from swarm_gym.errors import MissingExtraError

SUITE, STUDY, BENCHMARK = "docs/paper", "study/headline", "benchmark"  # folders of the document `results`


def _speed(results: ResultsFolder) -> str:
    """Return the few measurements that tell most, as a table."""
    machine, groups = read_folder(results.path / BENCHMARK)
    missing = set(CAPTIONS) - set(groups)
    if missing:
        raise ValueError(f"{results.path / BENCHMARK}: {', '.join(sorted(missing))} was not measured")
    return headline(machine, groups).markdown()


def _measurements(group: str, results: ResultsFolder) -> str:
    _, groups = read_folder(results.path / BENCHMARK)
    return table(group, groups[group]).markdown()


def _headline(results: ResultsFolder) -> str:
    """Return the headline table of the study; page and figures of the paper's suite are shown beside."""
    for file in (results.path / SUITE).glob("*.svg"):
        results.show(f"{SUITE}/{file.name}")
    results.show(f"{SUITE}/README.md")
    results.show(f"{BENCHMARK}/growth.svg")
    return results.table(f"{STUDY}/headline").markdown()


def _claims(results: ResultsFolder) -> str:
    """Return the study's sentences about all cases together."""
    claims = results.table(f"{STUDY}/claims")
    return replace(split(claims)[EVERY_SET], caption=claims.caption).markdown()


PERFORMANCE_BLOCKS: Mapping[str, Block] = {
    "headline": _speed,
    **{name: partial(_measurements, name) for name in CAPTIONS},
}
# Documents by the name that stands for them on the command line; `make docs-NAME` makes their results too.
DOCUMENTS: dict[str, tuple[Document, ...]] = {
    "results": (
        Document(
            Path("README.md"), "", "", blocks={"results": _headline, "claims": _claims, "speed": _speed}
        ),
        Document(Path("docs/performance.md"), "", "", blocks=PERFORMANCE_BLOCKS),
    ),
    **{name: (document,) for name, document in catalogue.DOCUMENTS.items()},
    "planners": (Document(Path("docs/planners.md"), "planners", "planners"),),
    "scaling": (Document(Path("docs/scaling.md"), "scaling", "scaling"),),
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
    By default the results must be there. The documents results, study and scaling have no such suite."""


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


def evaluate_suite(name: str, results: Path) -> None:
    """Run the suite of a document, as far as its runs are missing, and write its tables and figures.

    Args:
        name: key of `DOCUMENTS`.
        results: folder that holds all results.

    Raises:
        ValueError: if the document has no suite.
        ResultsError: if the database of the suite cannot be used.
    """
    for document in look_up("document", name, DOCUMENTS):
        if not document.suite:
            raise ValueError(f"--evaluate: {name} is not made from one suite; run `make docs-{name}`")
        evaluate(EvaluateConfig(document.suite, output=(results / document.results).parent))


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
