"""Texts about verified cases: a table of what is claimed and what was found, and a line with the verdict."""

from collections.abc import Sequence

from experiments.scoring.cases import SubmittedCase
from experiments.scoring.claims import DIGITS
from experiments.scoring.comparison import Comparison, overall

HEADS = (
    "environment", "scenarios", "claimed gap", "found gap", "claimed evaluations", "found evaluations",
    "claimed feasible", "found feasible", "verdict",
)  # fmt: skip
NOTHING = "-"  # where nothing is claimed


def report(case: SubmittedCase, comparisons: Sequence[Comparison]) -> str:
    """Return a table of what is claimed and what was found, and the verdict."""
    rows = [HEADS, *map(_cells, comparisons)]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ["  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True)) for row in rows]
    submission = case.submission
    head = f"{submission.name}: digest {submission.digest[:DIGITS]}, suite {case.scored.name}"
    source = f"claim of {case.source}" if case.source else "no claim"
    return "\n".join(
        [f"{head}, {source}", *(f"  {line.rstrip()}" for line in lines), conclusion(case, comparisons)]
    )


def conclusion(case: SubmittedCase, comparisons: Sequence[Comparison]) -> str:
    """Return the verdict on a case in a line, with the first number that differs if there is one."""
    verdict = overall(comparisons)
    said = "measured only, nothing is claimed" if verdict is None else verdict.value
    differing = [one.difference for one in comparisons if one.difference]
    first = f": {differing[0]}" if differing else ""
    return f"{case.submission.name}: {said}, {case.num_runs} runs of {case.scored.name}{first}"


def _cells(one: Comparison) -> tuple[str, ...]:
    claimed, found = one.claimed, one.found
    return (
        found.environment,
        found.scenario_set,
        NOTHING if claimed is None else _gap(claimed.gap),
        _gap(found.gap),
        NOTHING if claimed is None else _evaluations(claimed.evaluations),
        _evaluations(found.evaluations),
        NOTHING if claimed is None else _share(claimed.feasible),
        _share(found.feasible),
        NOTHING if one.verdict is None else one.verdict.value,
    )


def _gap(value: float) -> str:
    return f"{100 * value:.6f} %"


def _evaluations(value: float) -> str:
    return f"{value:,.1f}"


def _share(value: float) -> str:
    return f"{100 * value:.1f} %"
