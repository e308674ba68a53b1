"""Tables of policies of size and phi that drive other optimizers than the one they were trained on."""

from experiments.runs.outcomes import Outcomes
from experiments.runs.suite import Suite
from experiments.studies.optimizers.suites import BASE_OF_SIZES, DRIVEN, RULES
from experiments.tables.cell import MISSING, Entry, number, share
from experiments.tables.differences import difference_of, mean_objective
from experiments.tables.table import Row, Table
from swarm_gym.controllers.names import ControllerName

ALL, NAMED = "learned:optimizers-all/*@1", "learned:optimizers-all-named/*@1"


def transfer_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a table of policies trained on one optimizer: a row for each optimizer that they drive."""
    caption = (
        "Objective at price 1 of policies that decide size and phi, in per cent of the objective of 60 "
        "members, which these policies correct. A column for each optimizer that they were trained on, a row "
        "for each that they drive; means over all training seeds, scenarios and seeds"
    )
    rows: list[Row] = []
    for optimizer in driven(suite):
        base = f"{optimizer}+{BASE_OF_SIZES}"
        groups = {name: f"{optimizer}+learned:optimizers-{name}-sizes/*@1" for name in DRIVEN}
        if base in outcomes.groups and outcomes.groups.keys() & set(groups.values()):
            shares = {name: _share_of(outcomes, group, base) for name, group in groups.items()}
            rows.append({"optimizer": optimizer, **shares})
    return Table.if_any("transfer", caption, rows)


def one_for_all_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a table of one policy for all optimizers, beside policies for one: a row for each optimizer."""
    caption = (
        "Objective at price 1 of policies that decide size and phi: of 60 members, of the rules as printed, "
        "of policies trained on the optimizer alone, and of one policy trained on eight optimizers; then of "
        "such a policy that is told the name of the optimizer. Differences with 95 % intervals over training "
        "seeds, scenarios and seeds; negative is a smaller objective"
    )
    whole = list(outcomes.sets)[-1]  # their union, if there are several
    rows: list[Row] = []
    for optimizer in driven(suite):
        base, rules, own, shared, named = (
            f"{optimizer}+{name}"
            for name in (BASE_OF_SIZES, RULES, f"learned:optimizers-{optimizer}-sizes/*@1", ALL, NAMED)
        )
        if shared in outcomes.groups:
            rows.append(
                {
                    "optimizer": optimizer,
                    "60 members": _objective(outcomes, base, whole),
                    "rules": _objective(outcomes, rules, whole),
                    "own policy": _objective(outcomes, own, whole),
                    "one for eight": _objective(outcomes, shared, whole),
                    "minus 60 members": difference_of(outcomes, shared, base, whole),
                    "minus own policy": difference_of(outcomes, shared, own, whole),
                    "told the name": _objective(outcomes, named, whole),
                    "minus not told": difference_of(outcomes, named, shared, whole),
                }
            )
    return Table.if_any("one-for-all", caption, rows)


def driven(suite: Suite) -> tuple[str, ...]:
    """Return the optimizers that the suite's entrants drive, in order."""
    named = (ControllerName.parse(entrant).optimizer for entrant in suite.controllers)
    return tuple(dict.fromkeys(name or suite.optimizer for name in named))


def _objective(outcomes: Outcomes, group: str, scenario_set: str) -> Entry:
    if group not in outcomes.groups:
        return MISSING
    return number(mean_objective(outcomes.sample(group, scenario_set)), ".2f")


def _share_of(outcomes: Outcomes, group: str, base: str) -> Entry:
    """Return the objective of a group as a share of that of the base, over all scenarios."""
    if group not in outcomes.groups:
        return MISSING
    whole = list(outcomes.sets)[-1]
    mine, theirs = (mean_objective(outcomes.sample(name, whole)) for name in (group, base))
    return share(mine / theirs, ".0f")
