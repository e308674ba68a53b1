"""Tables of claims: of a suite's comparative sentences with their numbers, and of how often a claim holds."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from experiments.runs.claims import GroupClaim
from experiments.runs.measures import MEASURES
from experiments.runs.outcomes import Outcomes
from experiments.runs.suite import Suite
from experiments.statistics import Interval, interval, mean_difference, mean_of_present, means
from experiments.tables.cell import MISSING, Cell, Entry, count_of, number, number_in, verdict
from experiments.tables.differences import RIVAL_STREAM
from experiments.tables.table import Row, Table

CAPTION = (
    "Sentences that compare, a row for each set of scenarios: mean of the measure; the rival's mean, with "
    "the factor that the sentence names, or the limit; their difference [95 % interval over training seeds, "
    "scenarios of a set and seeds]. A sentence holds where the whole interval is below 0"
)
ABOUT_SUBJECTS = (
    "Sentences that compare, a column for each subject: the mean of the measure minus the rival's mean "
    "[95 % interval over training seeds, scenarios of a set and seeds]. A sentence holds where the whole "
    "interval is below 0; where it does not, the cell says **no**"
)


def group_claim_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a table of the suite's claims about groups that were run; none if there are none.

    It has a column for each subject if the claims have subjects, and a row for each claim otherwise.
    """
    known = {*outcomes.groups, *suite.yardsticks, ""}
    claims = [claim for claim in suite.claims if claim.group in outcomes.groups and claim.rival in known]
    if claims and all(claim.about for claim in claims):
        return [_by_subject(claims, suite, outcomes)]
    rows = [
        _row(claim, suite, outcomes, scenario_set)
        for claim in claims
        for scenario_set in claim.sets or outcomes.sets
        if scenario_set in {*outcomes.sets, *outcomes.scenarios}
    ]
    return Table.if_any("claims", _caption(CAPTION, claims), rows)


def _caption(first: str, claims: list[GroupClaim]) -> str:
    """Return a caption that says what the measures of the claims are."""
    measures = dict.fromkeys(claim.metric for claim in claims)
    return "; ".join([first, *(MEASURES[name].said for name in measures)])


def _by_subject(claims: list[GroupClaim], suite: Suite, outcomes: Outcomes) -> Table:
    """Return a table with a row for each sentence and set of scenarios, and a column for each subject."""
    subjects = tuple(dict.fromkeys(claim.about for claim in claims))
    cells: dict[tuple[str, str], dict[str, Entry]] = {}
    for claim in claims:
        for scenario_set in claim.sets or outcomes.sets:
            if scenario_set in {*outcomes.sets, *outcomes.scenarios}:
                row = cells.setdefault((claim.sentence, scenario_set), {})
                row[claim.about] = _difference(claim, suite, outcomes, scenario_set)
    rows = [(*names, *(row.get(subject, MISSING) for subject in subjects)) for names, row in cells.items()]
    return Table("claims", _caption(ABOUT_SUBJECTS, claims), ("claim", "scenarios", *subjects), rows)


def _difference(claim: GroupClaim, suite: Suite, outcomes: Outcomes, scenario_set: str) -> Entry:
    """Return the difference that a claim is about, marked where the claim does not hold."""
    mine, theirs, ends = check_claim(claim, suite, outcomes, scenario_set)
    if math.isnan(mine - theirs):
        return MISSING
    cell = number_in(mine - theirs, ends, f"+{MEASURES[claim.metric].form}")
    return cell if ends[1] < 0.0 else Cell(f"**no** {cell.template}", cell.numbers)


def check_claim(
    claim: GroupClaim, suite: Suite, outcomes: Outcomes, scenario_set: str
) -> tuple[float, float, Interval]:
    """Return the mean of the group, that of the rival times the factor, and the difference's interval."""
    measure = MEASURES[claim.metric].of
    mine = outcomes.sample(claim.group, scenario_set)
    values = measure(mine, claim.price)
    mean = mean_of_present(values)
    if claim.rival not in outcomes.groups:
        limit = claim.factor * suite.yardsticks[claim.rival](scenario_set) if claim.rival else claim.limit
        return mean, limit, interval(means(values, mine.draws()) - limit)
    theirs = outcomes.sample(claim.rival, scenario_set)
    others = claim.factor * measure(theirs, claim.price)
    _, ends = mean_difference(values, others, mine.draws(), theirs.draws(RIVAL_STREAM))
    return mean, mean_of_present(others), ends


def _row(claim: GroupClaim, suite: Suite, outcomes: Outcomes, scenario_set: str) -> Row:
    mine, theirs, ends = check_claim(claim, suite, outcomes, scenario_set)
    form = MEASURES[claim.metric].form
    told = f" at price {claim.price:g}" if claim.metric.endswith("objective") else ""
    return {
        "claim": claim.sentence,
        "scenarios": scenario_set,
        "measure": f"{claim.metric}{told}",
        "controller": number(mine, form),
        "rival or limit": _rival(claim, theirs, form),
        "difference": MISSING if math.isnan(mine - theirs) else number_in(mine - theirs, ends, f"+{form}"),
        "holds": verdict(ends[1] < 0.0),
    }


def _rival(claim: GroupClaim, theirs: float, form: str) -> Entry:
    """Return the number that a controller has to be below, with the rival's own mean where it differs."""
    if claim.factor == 1.0 or not claim.rival or math.isnan(theirs):
        return number(theirs, form)
    numbers = {"factor": claim.factor, "mean": theirs / claim.factor, "value": theirs}
    return Cell(f"{{factor:.3g}} × {{mean:{form}}} = {{value:{form}}}", numbers)


@dataclass(frozen=True)
class Claim:
    """A claim, and whether it holds in each of the cases that it is about.

    Attributes:
        text: the claim in words.
        cases: whether it holds, by the name of the case.
    """

    text: str
    cases: Mapping[str, bool]

    @property
    def row(self) -> tuple[Entry, ...]:
        """Claim, number of cases in which it holds, and names of the other cases."""
        failing = [case for case, holds in self.cases.items() if not holds]
        holding = len(self.cases) - len(failing)
        return self.text, count_of(holding, len(self.cases)), ", ".join(failing) or MISSING


def claims_table(name: str, caption: str, claims: Sequence[Claim]) -> Table:
    """Return a table of the claims that are about at least one case, in their order."""
    columns = ("claim", "holds", "does not hold")
    return Table(name, caption, columns, [claim.row for claim in claims if claim.cases])
