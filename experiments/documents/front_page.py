"""The blocks of docs/results.md: claims and headlines of all studies, read from the blocks of their pages.

The pages are made from results first; this page repeats what they say, so that it cannot say anything else.
"""

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from experiments.documents.marked_blocks import block_names, content_of
from experiments.tables.cell import verdict
from experiments.tables.document import Block, ResultsFolder
from experiments.tables.table import Row, Table

DOCS = Path("docs")
HOLDS, FAILS = verdict(True), verdict(False)
MOST_COMMITS = 2  # that a cell names


@dataclass(frozen=True)
class Study:
    """A study or a paper, its pages, and what it asks.

    Attributes:
        title: text of the link to the first page.
        pages: names of its pages without a suffix; the claims may stand on another page than the first.
        question: the question that it answers.
    """

    title: str
    pages: tuple[str, ...]
    question: str


STUDIES = (
    Study("study", ("study", "study-tables"), "Do learned sizes and phi improve on the paper's rules?"),
    Study("new members", ("newcomers", "newcomers-tables"), "What do other sources of members change?"),
    Study("changing maps", ("dynamic", "dynamic-tables"), "Does seeing help where the map changes?"),
    Study("other optimizers", ("optimizers", "optimizers-tables"), "Does control help other swarms?"),
    Study("BBOB", ("bbob",), "Which size suits particle swarms of three libraries?"),
)
PAPERS = (
    Study("IAFSA", ("iafsa-paper",), "improved artificial fish swarms"),
    Study("MOA", ("moa-paper",), "multivariate optimization and its rivals"),
    Study("glowworms and ants", ("brand-yu-paper",), "glowworms and ants on grids"),
)
# Blocks of pages whose lists of findings the page shows, and how many of each kind.
FINDINGS = {"findings-study": "study", "findings-newcomers": "newcomers", "findings-dynamic": "dynamic"}
MOST_FINDINGS = 3


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


def commits_of(text: str) -> list[str]:
    """Return the commits that the runs of a page were made with, in the order of the page."""
    made = [content_of(text, name) for name in block_names(text) if name.endswith("made-with")]
    named = [re.findall(r"commits? ((?:[0-9a-f]{10}(?:-dirty)?(?:, )?)+)", one) for one in made]
    return list(
        dict.fromkeys(commit for one in named for part in one for commit in part.split(", ") if commit)
    )


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


def _studies(results: ResultsFolder) -> str:  # noqa: ARG001
    """Return the table of the project's own studies."""
    caption = (
        "Studies: claims that hold, of all that are tested, where a sentence counts for each set of "
        "scenarios; the commits that made the runs"
    )
    return Table.of("studies", caption, [_row(study, "question") for study in STUDIES]).markdown()


def _papers(results: ResultsFolder) -> str:  # noqa: ARG001
    """Return the table of the papers whose sentences are tested."""
    caption = (
        "Sentences of papers that hold here, of all that are tested, a sentence for each set of scenarios"
    )
    return Table.of("papers", caption, [_row(paper, "about") for paper in PAPERS]).markdown()


def _row(study: Study, second: str) -> Row:
    text = _text(study.pages)
    held, all_claims = claims_of(text)
    commits = commits_of(text)
    more = f" and {len(commits) - MOST_COMMITS} more" if len(commits) > MOST_COMMITS else ""
    return {
        "page": f"[{study.title}]({study.pages[0]}.md)",
        second: study.question,
        "claims that hold": f"{held} of {all_claims}",
        "runs made with": ", ".join(commits[:MOST_COMMITS]) + more,
    }


def _findings(page: str, results: ResultsFolder) -> str:  # noqa: ARG001
    """Return the first findings of a page, those that hold and then those that do not."""
    text = _text((page,))
    return "\n".join([*findings_of(text, holding=True), *findings_of(text, holding=False)])


def _repeated(page: str, name: str, rows: Callable[[list[str]], bool], results: ResultsFolder) -> str:  # noqa: ARG001
    """Return rows of a table of a page, with its caption.

    Raises:
        ValueError: if no row is chosen.
    """
    content = content_of(_text((page,)), name)
    caption = content[: content.index("| ")]
    heads, *all_rows = _cells(content)
    chosen = [cells for cells in all_rows if rows(cells)]
    if not chosen:
        raise ValueError(f"docs/{page}.md: no row of the block {name!r} is chosen")
    lines = [heads, ["---"] * len(heads), *chosen]
    return caption + "\n".join("| " + " | ".join(cells) + " |" for cells in lines)


def _first_of(names: Iterable[str]) -> Callable[[list[str]], bool]:
    chosen = set(names)
    return lambda cells: cells[0] in chosen


ONE_MAX = (
    "optimum, any lambda up to 64",
    "optimum, lambda in 1, 2, 4, ..., 64",
    "PPO, 10 seeds",
    "DDQN, published",
    "theory",
    "one-fifth rule",
)
OVER_TERRAIN = (
    "L-SHADE, waypoints, guided", "fireflies, waypoints, guided", "CMA-ES, waypoints, guided",
    "planned flight, no swarm", "L-SHADE, waypoints, smooth", "pymoo DE, waypoints",
    "niapy L-SHADE, waypoints", "PSO, spherical, uniform", "cmaes CMA-ES, spherical",
)  # fmt: skip
FRONT_BLOCKS: Mapping[str, Block] = {
    "terrain": partial(_repeated, "terrain", "test-terrains", _first_of(OVER_TERRAIN)),
    "studies": _studies,
    **{name: partial(_findings, page) for name, page in FINDINGS.items()},
    "papers": _papers,
    "one-parameter": partial(_repeated, "known-optimum", "one-parameter", _first_of(ONE_MAX)),
    "beside-metabox": partial(
        _repeated, "strong-optimizers", "beside-metabox", _first_of(("stars of 16", "average rank"))
    ),
    "learners": partial(
        _repeated, "learners", "reached-200000", lambda cells: not cells[0].startswith("FA-")
    ),
    "planners": partial(_repeated, "planners", "planners", lambda cells: not cells[0].startswith("swarm, S")),
}
