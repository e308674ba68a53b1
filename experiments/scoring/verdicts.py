"""The comparison of a claimed score with the one that was found: bit for bit, or within a tolerance."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

from experiments.scoring.score import ScoreRow
from experiments.scoring.suites import ScoredSet

# The last bit of exp, tanh and the like differs between machines, and grows from iteration to iteration.
# Golden files have the same tolerance.
TOLERANCE = 1e-9
MEANS = ("gap", "evaluations", "feasible")  # columns with means over the runs


class Verdict(Enum):
    """The verdicts on a claim, from the strictest on."""

    EQUAL = "equal bit for bit"
    CLOSE = f"equal within {TOLERANCE:g}"
    DIFFERS = "differs"


@dataclass(frozen=True)
class ScoreComparison:
    """A claimed score beside the one that was found.

    Attributes:
        claimed: score that is claimed; None if nothing is.
        found: score of the runs that were made here.
        verdict: verdict on the claim; None without one.
        difference: first number that differs, in words; empty unless the verdict is `DIFFERS`.
    """

    claimed: ScoreRow | None
    found: ScoreRow
    verdict: Verdict | None
    difference: str = ""


def compare(claimed: ScoreRow, found: ScoreRow, chosen: ScoredSet) -> ScoreComparison:
    """Compare two scores of the same runs, run by run.

    Args:
        claimed: score that is claimed.
        found: score that was found.
        chosen: set of scenarios that both are about.
    """
    pairs = list(
        zip(
            chosen.runs,
            zip(claimed.fitness_of_runs, claimed.evaluations_of_runs, strict=True),
            zip(found.fitness_of_runs, found.evaluations_of_runs, strict=True),
            strict=True,
        )
    )
    for (scenario, seed), stated, measured in pairs:
        for name, one, other in zip(("best fitness", "evaluations"), stated, measured, strict=True):
            if not _is_close(one, other):
                where = f"{found.environment} on {scenario} with seed {seed}"
                difference = f"{where}: {name} is claimed to be {one!r}, found {other!r}"
                return ScoreComparison(claimed, found, Verdict.DIFFERS, difference)
    means = [(name, getattr(claimed, name), getattr(found, name)) for name in MEANS]
    for name, one, other in means:
        if not _is_close(one, other):
            where = f"{found.environment} on {found.scenario_set}"
            difference = f"{where}: the mean {name} is claimed to be {one!r}, found {other!r}"
            return ScoreComparison(claimed, found, Verdict.DIFFERS, difference)
    same = claimed.runs_digest == found.runs_digest and all(one == other for _, one, other in means)
    return ScoreComparison(claimed, found, Verdict.EQUAL if same else Verdict.CLOSE)


def overall(comparisons: Sequence[ScoreComparison]) -> Verdict | None:
    """Return the weakest verdict on some scores, which holds for all of them; None if nothing is claimed."""
    order = list(Verdict)
    verdicts = [one.verdict for one in comparisons if one.verdict is not None]
    return max(verdicts, key=order.index, default=None)


def _is_close(one: float, other: float) -> bool:
    """Return whether two numbers are equal within the tolerance, which is absolute and relative."""
    return abs(one - other) <= TOLERANCE * (1.0 + abs(other))
