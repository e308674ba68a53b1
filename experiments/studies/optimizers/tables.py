"""The tables of the study of every optimizer under control, and the blocks of its page and appendix."""

from dataclasses import replace
from functools import partial
from pathlib import Path

from experiments.runs.groups import EVERY_SET
from experiments.runs.labels import label
from experiments.runs.outcomes import Outcomes, Sample
from experiments.runs.suite import ControllerFamily, Suite
from experiments.studies.optimizers.suites import (
    DRIVEN,
    ON_CELLS,
    ON_THE_CASES,
    ON_THE_CELLS,
    ON_THE_GRIDS,
    RULES,
    SIZES,
    TRANSFER,
    TRANSFER_ON_CELLS,
    base,
)
from experiments.studies.optimizers.transfer_tables import one_for_all_tables, transfer_tables
from experiments.tables.block_contents import figure
from experiments.tables.cell import MISSING, Cell, Entry, number, number_in, percent
from experiments.tables.differences import PRICE, mean_objective, minus
from experiments.tables.document import Block, Document, ResultsFolder
from experiments.tables.front import family_hypervolume
from experiments.tables.reshape import pick
from experiments.tables.table import Row, Table
from swarm_gym.controllers.names import ALL_SEEDS, BLINDED, ControllerName

OF_BUDGET = ("optimizer", "controller", "gap in per cent", "evaluations taken", "seconds of a run")
BUDGETS = (2_000, 10_000, 50_000, 200_000)
NAMES = {
    **{name: f"{ControllerName.parse(name).argument} members" for name in SIZES},
    RULES: "rules as printed",
}


def optimizer_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a table for each set of scenarios: a row for each optimizer, a column for each controller."""
    caption = (
        "Mean gap in per cent of the optimum, at mean evaluations in thousands, over all tuning and training "
        "seeds, scenarios and seeds. Tuned rules and blind schedules took as many steps as PPO; where no "
        "blind schedule did, the base that PPO corrects stands there"
    )
    rows: list[Row] = []
    for scenario_set in outcomes.sets:
        for family in suite.families:
            blind = seeds_of(family, outcomes, "open-loop") or _group(family, outcomes, base(family.name))
            groups = {
                **{head: _group(family, outcomes, name) for name, head in NAMES.items()},
                "rules tuned": seeds_of(family, outcomes, "tuned"),
                "blind schedule": blind,
                "PPO": seeds_of(family, outcomes, "learned"),
            }
            cells = {head: _cell(outcomes, group, scenario_set) for head, group in groups.items()}
            rows.append({"scenarios": scenario_set, "optimizer": family.name, **cells})
    return Table.if_any("optimizers", caption, rows)


def gain_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a table of the objective of the policies of each optimizer, beside that of its rivals."""
    caption = (
        f"Objective at price {PRICE:g}: mean gap in per cent plus evaluations / 100,000. Policies by PPO, "
        "then their objective minus the objective of the best of three fixed sizes, of the rules as printed "
        "and tuned, of the base that they correct, of the blind schedules, and of the policies themselves "
        "blinded: with every input but the clock replaced by its mean course [95 % interval over tuning and "
        "training seeds, scenarios and seeds]. Negative is a smaller objective"
    )
    rows: list[Row] = []
    for scenario_set in outcomes.sets:
        for family in suite.families:
            learned = seeds_of(family, outcomes, "learned")
            sizes = [group for name in SIZES if (group := _group(family, outcomes, name))]
            if learned is None or not sizes:
                continue
            mine = outcomes.sample(learned, scenario_set)
            best = min(sizes, key=lambda group: mean_objective(outcomes.sample(group, scenario_set)))
            rivals = {
                "the rules": _group(family, outcomes, RULES),
                "rules tuned": seeds_of(family, outcomes, "tuned"),
                "the base": _group(family, outcomes, base(family.name)),
                "blind schedules": seeds_of(family, outcomes, "open-loop"),
                "itself blinded": _blinded(learned, outcomes),
            }
            differences = {
                f"minus {words}": minus(mine, outcomes.sample(rival, scenario_set)) if rival else MISSING
                for words, rival in rivals.items()
            }
            rows.append(
                {
                    "scenarios": scenario_set,
                    "optimizer": family.name,
                    "PPO": number(mean_objective(mine), ".2f"),
                    "minus the best fixed size": _with_words(
                        minus(mine, outcomes.sample(best, scenario_set)), best
                    ),
                    **differences,
                }
            )
    return Table.if_any("gains", caption, rows)


def budget_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a table of the best optimizer and controller for each budget of evaluations."""
    caption = (
        "The optimizer and controller with the smallest mean gap among those that take at most so many "
        "evaluations on average, over all training seeds, scenarios and seeds"
    )
    rows: list[Row] = []
    for scenario_set in outcomes.sets:
        ours = [group for family in suite.families for group in family.groups if group in outcomes.groups]
        samples = {group: outcomes.sample(group, scenario_set) for group in ours}
        for budget in BUDGETS:
            within = [group for group, sample in samples.items() if sample.evaluations.mean() <= budget]
            best = min(within, key=lambda group: float(samples[group].gap.mean()), default=None)
            found = _described(best, samples[best], suite) if best else dict.fromkeys(OF_BUDGET, MISSING)
            rows.append({"scenarios": scenario_set, "evaluations": f"{budget:,}", **found})
    return [Table.of("budgets", caption, rows)]


def _described(group: str, sample: Sample, suite: Suite) -> Row:
    """Return the entries `OF_BUDGET` of a group."""
    name = ControllerName.parse(group)
    controller = str(name.controller)
    cells: tuple[Entry, ...] = (
        str(name.optimizer or suite.optimizer),
        NAMES.get(controller) or label(controller),
        number(100.0 * float(sample.gap.mean()), ".2f"),
        number(sample.evaluations.mean(), ",.0f"),
        number(float(sample.seconds.mean()), ".3f"),
    )
    return dict(zip(OF_BUDGET, cells, strict=True))


def area_tables(suite: Suite, outcomes: Outcomes) -> list[Table]:
    """Return a table of the hypervolume of each optimizer's controllers, a column for each set."""
    evaluations, gap = suite.reference
    caption = (
        "Hypervolume of the front of all controllers of an optimizer, decades of evaluations times gap [95 % "
        f"interval], from the reference point of {evaluations:,.0f} evaluations and a gap of {percent(gap)}. "
        "A larger one covers more; what has a larger gap than the reference contributes nothing"
    )
    rows: list[Row] = []
    for family in suite.families:
        if not outcomes.groups.keys().isdisjoint(family.groups):
            areas = {
                name: number_in(*family_hypervolume(family, outcomes, name, suite.reference), ".3f")
                for name in outcomes.sets
            }
            rows.append({"optimizer": family.name, **areas})
    return Table.if_any("areas", caption, rows)


def _group(family: ControllerFamily, outcomes: Outcomes, controller: str) -> str | None:
    """Return the group of a controller of a family's optimizer, if it was run."""
    name = f"{family.name}+{controller}"
    return name if name in outcomes.groups else None


def _blinded(learned: str, outcomes: Outcomes) -> str | None:
    """Return the group of the same policies blinded, if it was run."""
    name = str(replace(ControllerName.parse(learned), family=BLINDED))
    return name if name in outcomes.groups else None


def seeds_of(family: ControllerFamily, outcomes: Outcomes, kind: str) -> str | None:
    """Return the group of all tuning or training seeds of that kind, if it was run."""
    for group in family.groups:
        name = ControllerName.parse(group)
        if group in outcomes.groups and name.family == kind and name.seed == ALL_SEEDS:
            return group
    return None


def _cell(outcomes: Outcomes, group: str | None, scenario_set: str) -> Entry:
    if group is None:
        return MISSING
    sample = outcomes.sample(group, scenario_set)
    numbers = {"value": 100.0 * float(sample.gap.mean()), "evaluations": float(sample.evaluations.mean())}
    return Cell("{value:.2f} at {evaluations:k.1f}k", numbers)


def _with_words(cell: Cell, entrant: str) -> Cell:
    """Return the cell followed by the words for a controller in parentheses."""
    return Cell(f"{cell.template} ({NAMES[str(ControllerName.parse(entrant).controller)]})", cell.numbers)


TABLES = {
    "optimizers": optimizer_tables,
    "gains": gain_tables,
    "budgets": budget_tables,
    "areas": area_tables,
    "transfer": transfer_tables,
    "one-for-all": one_for_all_tables,
}
FRONTS_TEXT = "gap against evaluations, by optimizer and controller"
POLICIES_TEXT = "sizes and phi of policies and blind schedules"
RESULTS, COLLECTION = "docs/optimizers-study", "optimizers-study"
FIGURES = "results/optimizers-study"  # seen from the document


def _strongest(results: ResultsFolder) -> str:
    """Return the gains of every optimizer over all its maps of the suites on cases and on cells."""
    cases, cells = (results.table(f"{suite.name}/gains") for suite in (ON_THE_CASES, ON_THE_CELLS))
    rows = [
        *pick(cases, ("scenarios", "optimizer"), [(EVERY_SET, name) for name in DRIVEN]).rows,
        *pick(cells, ("scenarios", "optimizer"), [("block", name) for name in ON_CELLS]).rows,
    ]
    return replace(cases, rows=rows).markdown()


BLOCKS: dict[str, Block] = {
    "strongest": _strongest,
    "fronts": partial(figure, FIGURES, ON_THE_CASES.name, "fronts", FRONTS_TEXT),
    "policies": partial(figure, FIGURES, ON_THE_CASES.name, "policies", POLICIES_TEXT),
}
# The appendix shows whole tables by the names of their files.
SHOWN = {
    ON_THE_CASES.name: ("optimizers", "gains", "claims", "budgets", "areas", "made-with"),
    ON_THE_GRIDS.name: ("optimizers", "claims", "budgets", "made-with"),
    TRANSFER.name: ("transfer", "one-for-all", "claims", "made-with"),
    TRANSFER_ON_CELLS.name: ("transfer", "one-for-all", "claims", "made-with"),
    ON_THE_CELLS.name: ("optimizers", "gains", "claims", "budgets", "made-with"),
}
TABLE_BLOCKS: dict[str, Block] = {
    f"{suite}/{name}": partial(ResultsFolder.text, name=f"{suite}/{name}.md")
    for suite, names in SHOWN.items()
    for name in names
}
DOCUMENTS = {
    "optimizers": (
        Document(Path("docs/optimizers.md"), RESULTS, "optimizers-study", COLLECTION, BLOCKS),
        Document(Path("docs/optimizers-tables.md"), RESULTS, "", COLLECTION, TABLE_BLOCKS),
    )
}
