"""The headline table: objective, quality and cost of every group, beside itself blinded and blind rivals."""

from dataclasses import replace

from experiments.runs.groups import EVERY_SET
from experiments.runs.labels import label
from experiments.runs.outcomes import Outcomes, Sample
from experiments.runs.suite import Suite
from experiments.statistics import mean_difference
from experiments.tables.cell import MISSING, Cell, Entry, gap_at_cost, number, number_in
from experiments.tables.differences import RIVAL_STREAM
from experiments.tables.table import Row, Table
from swarm_gym.comparing.compared_runs import aligned
from swarm_gym.controllers.names import BLINDED, ControllerName
from swarm_gym.errors import ScenarioError

CAPTION = (
    "Objective: mean gap in per cent plus price times evaluations / 100,000, over all training and tuning "
    "seeds [95 % interval over these seeds, scenarios of a set and seeds]. By set of scenarios: mean gap "
    "in per cent at mean evaluations. Minus itself blinded: the objective minus the one of the "
    "same controller with every input but the clock replaced by its mean course. Minus the best blind rival: "
    "minus the smallest objective of the controllers that see nothing and are for the same price. "
    "Negative is a smaller objective; a controller without a price counts at price 1"
)
UNTOLD = 1.0  # price at which controllers without one are compared


def headline_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a table of all groups but blinded ones, ordered by price and then by objective."""
    sets = [name for name in outcomes.sets if name != EVERY_SET]
    whole = list(outcomes.sets)[-1]
    samples = {group: outcomes.sample(group, whole) for group in outcomes.groups}
    objectives = {group: float(samples[group].objective(price_of(group)).mean()) for group in samples}
    shown = [group for group in samples if ControllerName.parse(group).family != BLINDED]
    rows: list[Row] = []
    for group in sorted(shown, key=lambda name: (price_of(name), objectives[name])):
        mine, price = samples[group], price_of(group)
        rival = best_blind(suite, price, objectives)
        rows.append(
            {
                "controller": label(group),
                "price": number(price, "g"),
                "seeds": number(mine.num_training_seeds, "d"),
                "objective": number_in(*mine.mean(mine.objective(price)), ".3f"),
                **{name: _gap_at_cost(outcomes.sample(group, name)) for name in sets},
                "minus itself blinded": _minus(mine, samples.get(blinded(group)), price, 0),
                "minus the best blind rival": MISSING
                if rival == group
                else _minus(mine, samples.get(rival), price, RIVAL_STREAM),
            }
        )
    return Table.if_any("headline", CAPTION, rows)


def objectives_as_text(suite: Suite, outcomes: Outcomes) -> str:
    """Return what the headline table says of each group by itself, as aligned text for a terminal.

    Where an optimum is unknown there is no objective, and the text says so.
    """
    try:
        tables = headline_tables(suite, outcomes)
    except ScenarioError as error:
        return f"no objective: {error}; `swarm-gym optimum` computes optima that can be known"
    kept = [k for k, head in enumerate(tables[0].columns) if not head.startswith("minus")]
    lines = [tables[0].columns, *tables[0].rows]
    said = "objective: mean gap in % plus price times evaluations / 100,000 [95 % interval]"
    return "\n".join([said, *aligned([[str(line[k]) for k in kept] for line in lines])])


def price_of(group: str) -> float:
    """Return the price of 100,000 evaluations that a group is for; `UNTOLD` if its name states none."""
    price = ControllerName.parse(group).price
    return UNTOLD if price is None else float(price)


def blinded(group: str) -> str:
    """Return the key of the group of the same policies, blinded."""
    return str(replace(ControllerName.parse(group), family=BLINDED))


def best_blind(suite: Suite, price: float, objectives: dict[str, float]) -> str:
    """Return the group with the smallest objective among those of blind families for a price, if any."""
    blind = [
        group
        for family in suite.families
        if family.blind
        for group in family.groups
        if group in objectives and price_of(group) == price
    ]
    return min(blind, key=objectives.__getitem__, default="")


def _gap_at_cost(sample: Sample) -> Cell:
    return gap_at_cost(sample.gap.mean(), sample.evaluations.mean())


def _minus(mine: Sample, theirs: Sample | None, price: float, stream: int) -> Entry:
    """Return the difference of two objectives; stream 0 pairs training seeds, too."""
    if theirs is None:
        return MISSING
    objectives = mine.objective(price), theirs.objective(price)
    return number_in(*mean_difference(*objectives, mine.draws(), theirs.draws(stream)), "+.3f")
