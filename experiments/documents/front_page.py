"""The blocks of docs/results.md and docs/results-runs.md, read from the blocks of the pages of studies.

The pages are made from results first; this page repeats what they say, so that it cannot say anything else.
"""

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from experiments.catalogue import COLLECTIONS, SUITES
from experiments.documents.digests import RESULTS_OF
from experiments.documents.made_with import (
    OUT_OF_DATE,
    lines_of,
    outdated,
    records_table,
    short_state,
    span,
)
from experiments.documents.marked_blocks import block_names, content_of
from experiments.studies.terrain.tables_of_costs import IN_SHORT
from experiments.tables.cell import verdict
from experiments.tables.document import Block, ResultsFolder
from experiments.tables.table import Row, Table, list_item

DOCS = Path("docs")
HOLDS, FAILS = verdict(True), verdict(False)


@dataclass(frozen=True)
class Study:
    """A study or a paper, its pages, and what it asks.

    Attributes:
        title: text of the link to the first page.
        pages: names of its pages without a suffix; the claims may stand on another page than the first.
        question: the question that it answers.
        suites: names of the suites whose runs it shows.
    """

    title: str
    pages: tuple[str, ...]
    question: str
    suites: tuple[str, ...]

    @property
    def link(self) -> str:
        """Link to the first page."""
        return f"[{self.title}]({self.pages[0]}.md)"


LEARNED_SUITES = (
    "headline", "generalisation", "out-of-distribution", "single-cases", "ablation", "parameters"
)  # fmt: skip
STUDIES = (
    Study(
        "study",
        ("study", "study-tables"),
        "Do learned sizes and phi improve on the paper's rules?",
        LEARNED_SUITES,
    ),
    Study(
        "new members",
        ("newcomers", "newcomers-tables"),
        "What do other sources of members change?",
        COLLECTIONS["newcomers-study"],
    ),
    Study(
        "changing maps",
        ("dynamic", "dynamic-tables"),
        "Does seeing help where the map changes?",
        COLLECTIONS["dynamic-study"],
    ),
    Study(
        "other optimizers",
        ("optimizers", "optimizers-tables"),
        "Does control help other swarms?",
        COLLECTIONS["optimizers-study"],
    ),
    Study("BBOB", ("bbob", "bbob-tables"), "Which size suits particle swarms of three libraries?", ("bbob",)),
)
PAPERS = (
    Study(
        "IAFSA",
        ("iafsa-paper", "iafsa-claims", "iafsa-routes"),
        "improved artificial fish swarms",
        COLLECTIONS["iafsa-paper"],
    ),
    Study("MOA", ("moa-paper",), "multivariate optimization and its rivals", ("moa-paper",)),
    Study("glowworms and ants", ("brand-yu-paper",), "glowworms and ants on grids", COLLECTIONS["brand-yu"]),
)
# Records of runs of no suite, or of one that stands on a page of its own, by the page.
OTHERS = {
    "[README](../README.md)": ("cases-at-budgets", "paper"),
    "[learners](learners.md)": ("learners",),
    "[known optimum](known-optimum.md)": ("known-optimum",),
    "[strong optimizers](strong-optimizers.md)": (
        "strong-optimizers",
        "strong-repeated",
        "strong-on-bbob",
        "beside-libraries",
        "beside-pycma",
    ),
    "[terrain](terrain.md)": ("terrain-all", "terrain-longer", "terrain-longest", "terrain-eight"),
    "[terrain, budgets](terrain-budgets.md)": (
        "terrain-longer-guided",
        "terrain-fresh",
        "terrain-longest-guided",
    ),
    "[wishes](planning-wishes.md)": ("driving",),
    "[planners](planners.md)": ("planners", "replanning", "streams", "curves"),
    "[other libraries](adapters.md)": ("adapters",),
}
# Blocks with lists of findings, and the pages and suites that these are from.
FINDINGS = {
    "findings-study": ("study", ("headline",)),
    "findings-newcomers": ("newcomers", ("newcomers",)),
    "findings-dynamic": ("dynamic", ("dynamic", "dynamic-fields")),
}
MOST_FINDINGS = 3  # of each kind


def claims_of(text: str) -> tuple[int, int]:
    """Return how many claims of a page hold, and how many there are, a claim on each set of scenarios."""
    held = all_claims = 0
    for name in block_names(text):
        if not name.endswith("claims"):
            continue
        heads, *rows = _cells(content_of(text, name))
        if heads[-1] == "holds":
            verdicts = [row[-1] == HOLDS for row in rows]
        elif "does not hold" in heads:  # a count of the rows of another block
            continue
        else:  # a column for each subject
            verdicts = [not cell.startswith(FAILS) for row in rows for cell in row[2:] if "[" in cell]
        held, all_claims = held + sum(verdicts), all_claims + len(verdicts)
    return held, all_claims


def findings_of(text: str, holding: bool) -> list[str]:
    """Return the first findings of a page that hold everywhere, or do not hold somewhere."""
    listed = re.split(r"^\* ", content_of(text, "findings"), flags=re.MULTILINE)[1:]
    chosen = [one for one in listed if ("does **not** hold" not in " ".join(one.split())) == holding]
    return [f"* {one.strip()}" for one in chosen[:MOST_FINDINGS]]


def _cells(content: str) -> list[list[str]]:
    """Return the heads and the rows of the Markdown tables of a block, without the line below the heads."""
    lines = [line[2:-2].split(" | ") for line in content.splitlines() if line.startswith("| ")]
    return [cells for cells in lines if set("".join(cells)) != {"-"}]


def _text(pages: Iterable[str]) -> str:
    return "\n".join((DOCS / f"{page}.md").read_text(encoding="utf-8") for page in pages)


def marked(finding: str, suites: Iterable[str], changed: set[str]) -> str:
    """Return a finding, with a mark if what decided its runs has changed.

    Args:
        finding: item of a list, which begins with the sentence of a claim.
        suites: names of the suites whose claims it may be.
        changed: groups of controllers that have changed, and optimizers whose results have.
    """
    said = " ".join(finding.removeprefix("* ").split())
    claims = [claim for suite in suites for claim in SUITES[suite].claims if said.startswith(claim.sentence)]
    groups = {group for claim in claims for group in (claim.group, claim.rival)}
    results = {name for name in changed if name.startswith(RESULTS_OF)}
    if because := sorted(changed & groups | results):
        return list_item(f"{said} {OUT_OF_DATE}: {', '.join(because)}.")
    return finding


def _studies(results: ResultsFolder) -> str:  # noqa: ARG001
    """Return the table of the project's own studies."""
    caption = (
        "Studies: claims that hold, of all that are tested, where a sentence counts for each set of "
        "scenarios; when the commits that made the runs were committed; what has changed since"
    )
    return Table.of("studies", caption, [_row(study, "question") for study in STUDIES]).markdown()


def _papers(results: ResultsFolder) -> str:  # noqa: ARG001
    """Return the table of the papers whose sentences are tested."""
    caption = (
        "Sentences of papers that hold here, of all that are tested, a sentence for each set of scenarios"
    )
    return Table.of("papers", caption, [_row(paper, "about") for paper in PAPERS]).markdown()


def _row(study: Study, second: str) -> Row:
    held, all_claims = claims_of(_text(study.pages))
    return {
        "page": study.link,
        second: study.question,
        "claims that hold": f"{held} of {all_claims}",
        "runs made with": span(study.suites),
        "state": short_state(study.suites),
    }


def _records(results: ResultsFolder) -> str:  # noqa: ARG001
    """Return the table of how all runs were made."""
    pages = {study.link: study.suites for study in (*STUDIES, *PAPERS)}
    return records_table({**pages, **OTHERS}).markdown()


def _findings(page: str, suites: tuple[str, ...], results: ResultsFolder) -> str:  # noqa: ARG001
    """Return the first findings of a page, those that hold and then those that do not."""
    text, changed = _text((page,)), outdated(suites)
    chosen = [*findings_of(text, holding=True), *findings_of(text, holding=False)]
    return "\n".join([*(marked(one, suites, changed) for one in chosen), "", lines_of(suites)])


def _repeated(
    page: str,
    name: str,
    rows: Callable[[list[str]], bool],
    made_with: str,
    results: ResultsFolder,  # noqa: ARG001
) -> str:
    """Return rows of a table of a page, with its caption and how its runs were made; changed rows are marked.

    Raises:
        ValueError: if no row is chosen.
    """
    content = content_of(_text((page,)), name)
    caption = content[: content.index("| ")]
    heads, *all_rows = _cells(content)
    chosen = [cells for cells in all_rows if rows(cells)]
    if not chosen:
        raise ValueError(f"docs/{page}.md: no row of the block {name!r} is chosen")
    changed = outdated((made_with,))
    for cells in chosen:
        if cells[0] in changed:
            cells[0] += f" ({OUT_OF_DATE})"
    lines = [heads, ["---"] * len(heads), *chosen]
    table = "\n".join("| " + " | ".join(cells) + " |" for cells in lines)
    return f"{caption}{table}\n\n{lines_of((made_with,))}"


def _first_of(names: Iterable[str]) -> Callable[[list[str]], bool]:
    chosen = set(names)
    return lambda cells: cells[0] in chosen


ONE_MAX = (
    "optimum, any lambda up to 64",
    "optimum, lambda in 1, 2, 4, ..., 64",
    "CMA-ES over the share of zeros",
    "PPO, 10 seeds",
    "DDQN, published",
    "theory",
    "one-fifth rule",
)
FRONT_BLOCKS: Mapping[str, Block] = {
    "terrain": partial(_repeated, "terrain", "test-terrains", _first_of(IN_SHORT), "terrain-all"),
    "studies": _studies,
    **{name: partial(_findings, *chosen) for name, chosen in FINDINGS.items()},
    "papers": _papers,
    "one-parameter": partial(
        _repeated, "known-optimum", "one-parameter", _first_of(ONE_MAX), "known-optimum"
    ),
    "beside-metabox": partial(
        _repeated,
        "strong-optimizers-tables",
        "beside-metabox",
        _first_of(("stars of 16", "average rank")),
        "strong-optimizers",
    ),
    "on-bbob": partial(
        _repeated, "strong-optimizers", "on-bbob", lambda cells: "blinded" not in cells[0], "strong-on-bbob"
    ),
    "learners": partial(
        _repeated, "learners", "reached-200000", lambda cells: not cells[0].startswith("FA-"), "learners"
    ),
    "planners": partial(
        _repeated, "planners", "planners", lambda cells: not cells[0].startswith("swarm, S"), "planners"
    ),
}
RUNS_BLOCKS: Mapping[str, Block] = {"records": _records}
