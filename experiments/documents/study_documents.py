"""Documents of studies that show short tables and figures of them, with whole tables in appendices.

A page shows at most ten rows of a table, which are chosen here by their names. Its appendix shows all rows.
"""

from collections.abc import Callable, Collection, Mapping
from functools import partial
from pathlib import Path

from matplotlib.figure import Figure

from experiments.documents.interval_figure import draw_intervals
from experiments.plots.style import render, settings
from experiments.studies.bbob.suites import BASELINE, OPTIMIZERS
from experiments.studies.strong.figure import draw_cases_at_budgets
from experiments.studies.strong.suites import LADDER
from experiments.studies.terrain import table_of_control
from experiments.studies.terrain.tables_of_costs import (
    COSTS_AFTER_20_000,
    COSTS_AFTER_100_000,
    IN_SHORT,
    LONGER,
)
from experiments.tables.block_contents import shortened, texts
from experiments.tables.document import Block, Document, ResultsFolder
from experiments.tables.reshape import pick
from experiments.tables.table import Table

# Sizes of particle swarms that the findings on BBOB are about, with the swarms of all libraries.
SIZES = ("20 members", BASELINE, "falling from 100 to 10")
# What plain learners reach: those from scratch, one that decides sources, and rivals.
LEARNERS = (
    "open loop three-cases-sourced", "PPO (`ppo-sourced`)", "open loop three-cases", "SAC (`sac`)",
    "TQC (`tqc`)", "PPO (`ppo`)", "TD3 (`td3`)", "DQN (`dqn`)", "PPO (`ppo-defaults`)", "SPSFA-TIP",
)  # fmt: skip
LEARNERS_COLUMNS = (
    "learner or controller", "learns", "objective", "case1", "case2", "case3", "minus SPSFA-TIP",
    "minus open loop three-cases",
)  # fmt: skip
# Controllers of lambda on OneMax, without the worst of the training seeds.
ONE_MAX = (
    "optimum, any lambda up to 64", "optimum, lambda in 1, 2, 4, ..., 64", "PPO, 10 seeds",
    "double DQN, published settings, 10 seeds", "CMA-ES over the share of zeros", "DDQN, published",
    "theory", "one-fifth rule", "best schedule over iterations, simulated", "best constant lambda",
)  # fmt: skip
# Constants of CMA-ES around the best one, restarts, policies; L-SHADE with rules, tuned and learned.
STRONG = (
    "CMA-ES, lambda 20", "CMA-ES, BIPOP", "CMA-ES, constant tuned", "CMA-ES, early restarts",
    "CMA-ES, learned, evolution, longer", "CMA-ES, learned from early restarts, together", "L-SHADE, linear",
    "L-SHADE, constant tuned", "L-SHADE, learned, evolution",
)  # fmt: skip
# CMA-ES on BBOB: sizes, restarts, what was tuned, and policies with one that is blinded.
ON_BBOB = (
    "CMA-ES, default lambda", "CMA-ES, lambda 20", "CMA-ES, IPOP", "CMA-ES, constant tuned",
    "CMA-ES, schedule tuned", "CMA-ES, early restarts", "CMA-ES, learned, evolution, longer",
    "CMA-ES, learned, evolution, longer, together", "CMA-ES, learned, evolution, longer, blinded",
)  # fmt: skip
STRONG_COLUMNS = (
    "row", "training seeds", "functions level or ahead", "average rank", "log10 gap at the end",
    "minus the tuned constant", "minus itself blinded", "log10 gap, anytime",
)  # fmt: skip
ON_BBOB_COLUMNS = (
    "row", "at the end", "minus the tuned constant", "anytime", "anytime, minus the tuned constant",
    "anytime, minus itself blinded", "at the end, 3 dimensions", "at the end, 40 dimensions",
)  # fmt: skip
# The rows of README.md, and for each kind of optimizer others with other first members or sizes.
CASES = (
    *LADDER, "L-SHADE, 120 members, uniform first members", "CMA-ES, lambda 80, smooth first members",
    "L-SHADE, from 120 to 4", "fireflies, 60 members, smooth first members",
)  # fmt: skip
AT_BUDGETS = "strong/cases-at-budgets"  # folder of the paper's cases at equal evaluations
CASES_TABLE = f"{AT_BUDGETS}/cases-at-budgets"
LONGER_GUIDED, LONGEST_GUIDED = "terrain/longer-guided", "terrain/longest-guided"
TERRAINS, CONTROL = "terrain/all/metabox-in-short", "terrain/all/metabox-control"


def _show(results: ResultsFolder, name: str, draw: Callable[[Table], Figure], table: Table) -> None:
    """Show a figure of a table, under a name."""
    with settings():
        results.shown[f"{name}.svg"] = render(draw(table), "svg")


def draw_sizes(table: Table) -> Figure:
    """Draw what all sizes and rules reach, on all functions of BBOB and on some of them."""
    columns = {"all": "all functions", "weak structure": "weak structure"}
    return draw_intervals(table, ("optimizer", "size"), columns, "mean decimal logarithm of the precision")


def draw_objectives(table: Table) -> Figure:
    """Draw the objectives of all learners and controllers."""
    axis = "objective: mean gap in % plus evaluations / 100,000"
    return draw_intervals(table, table.columns[:1], {"objective": "objective"}, axis, "log")


def draw_gaps(table: Table) -> Figure:
    """Draw the mean gaps of all rows on the functions of MetaBox."""
    columns = {"log10 gap at the end": "at the end", "log10 gap, anytime": "over all evaluations"}
    return draw_intervals(table, table.columns[:1], columns, "mean log10 of the gap")


def draw_control(table: Table) -> Figure:
    """Draw the objectives of controllers over terrain, minus the objective of the rival."""
    columns = {"objective minus that of the rival": "objective"}
    return draw_intervals(table, table.columns[:1], columns, "objective minus the rival's", "linear", 0.0)


def _sizes(results: ResultsFolder) -> str:
    """Return the means by group of functions, of some sizes, and show the figure of all sizes."""
    table = results.table("bbob-groups")
    _show(results, "sizes", draw_sizes, table)
    keys = [(optimizer, size) for optimizer in OPTIMIZERS for size in SIZES]
    return pick(table, ("optimizer", "size"), keys).markdown()


def _learners(results: ResultsFolder) -> str:
    """Return the table of what learners reach, and show all figures of the page and of its appendix."""
    for steps in ("200000", "1000000"):
        results.show(f"curves-{steps}.svg")
    _show(results, "objectives", draw_objectives, results.table("reached-200000"))
    left_out = ", and to the controller that a residual policy corrects"
    return shortened("reached-200000", LEARNERS, results, LEARNERS_COLUMNS, left_out)


def _one_parameter(results: ResultsFolder) -> str:
    """Return the table of the control of lambda, and show the figure of decisions."""
    results.show("decisions.svg")
    return shortened("one-parameter", ONE_MAX, results, left_out=", and the worst of them")


def _strong(results: ResultsFolder) -> str:
    """Return the table of the functions of MetaBox, and show figures of all rows and of decisions."""
    name = "strong-optimizers/in-short"
    results.show("strong-optimizers/decisions.svg")
    _show(results, "gaps", draw_gaps, results.table(name))
    return shortened(name, STRONG, results, STRONG_COLUMNS)


def _control(name: str, rows: Collection[str], results: ResultsFolder) -> str:
    """Return some rows of a table of control over terrain, and show the figure of all its rows."""
    _show(results, "control", draw_control, results.table(name))
    return shortened(name, rows, results)


def _cases_at_budgets(results: ResultsFolder) -> str:
    """Return the table of the cases at equal evaluations, and show its figure."""
    _show(results, "cases-at-budgets", draw_cases_at_budgets, results.table(CASES_TABLE))
    return shortened(CASES_TABLE, CASES, results)


BBOB_BLOCKS: Mapping[str, Block] = {"bbob-groups": _sizes, **texts(("made-with",))}
BBOB_TABLES: Mapping[str, Block] = texts(("bbob-groups", "bbob-rules", "claims"))
LEARNERS_BLOCKS: Mapping[str, Block] = {"reached-200000": _learners}
LEARNERS_TABLES: Mapping[str, Block] = texts(("reached-200000", "recipes", "reached-1000000"))
ONE_MAX_BLOCKS: Mapping[str, Block] = {
    "one-parameter": _one_parameter,
    **texts(("four-parameters", "generalisation")),
}
ONE_MAX_TABLES: Mapping[str, Block] = texts(
    ("one-parameter", "recipes", "valley", "counting", "simulations", "speed")
)
READINGS_BLOCKS: Mapping[str, Block] = texts(("readings",))  # of the one-fifth rule
STRONG_BLOCKS: Mapping[str, Block] = {
    "in-short": _strong,
    "on-bbob": partial(shortened, "strong-optimizers/on-bbob", ON_BBOB, columns=ON_BBOB_COLUMNS),
    "cases-at-budgets": _cases_at_budgets,
}
STRONG_TABLES: Mapping[str, Block] = {
    **texts(
        ("in-short", "repeated", "beside-metabox", "on-bbob", "beside-libraries", "beside-pycma"),
        "strong-optimizers/",
    ),
    **texts(("cases-at-budgets",), f"{AT_BUDGETS}/"),
}
TERRAIN_BLOCKS: Mapping[str, Block] = {
    "test-terrains": partial(shortened, TERRAINS, IN_SHORT),
    "control-over-terrain": partial(_control, CONTROL, table_of_control.IN_SHORT),
    "longer-over-terrain": partial(shortened, "terrain/longer/metabox-in-short", LONGER),
    "longest-over-terrain": partial(ResultsFolder.text, name="terrain/longest/metabox-in-short.md"),
}
TERRAIN_TABLES: Mapping[str, Block] = {
    "all-rows-over-terrain": partial(ResultsFolder.text, name=f"{TERRAINS}.md"),
    "all-controllers-over-terrain": partial(ResultsFolder.text, name=f"{CONTROL}.md"),
    "longer-rows": partial(ResultsFolder.text, name="terrain/longer/metabox-in-short.md"),
    **texts(("documented-in-short", "documented-by-terrain"), "terrain/eight/"),
    **texts(("beside-metabox",), "terrain/speed/"),
}
# Rows with planned flights after more evaluations than those of the trainings.
TERRAIN_BUDGETS: Mapping[str, Block] = {
    "longer-control": partial(
        _control, f"{LONGER_GUIDED}/metabox-control", table_of_control.CONTROL_AFTER_20_000
    ),
    "longer-guided": partial(shortened, f"{LONGER_GUIDED}/metabox-in-short", COSTS_AFTER_20_000),
    "fresh-control": partial(ResultsFolder.text, name="terrain/fresh/metabox-control.md"),
    "longest-control": partial(ResultsFolder.text, name=f"{LONGEST_GUIDED}/metabox-control.md"),
    "longest-guided": partial(shortened, f"{LONGEST_GUIDED}/metabox-in-short", COSTS_AFTER_100_000),
}
TERRAIN_BUDGETS_TABLES: Mapping[str, Block] = {
    "all-longer-control": partial(ResultsFolder.text, name=f"{LONGER_GUIDED}/metabox-control.md"),
    "all-longer-guided": partial(ResultsFolder.text, name=f"{LONGER_GUIDED}/metabox-in-short.md"),
    "all-longest-guided": partial(ResultsFolder.text, name=f"{LONGEST_GUIDED}/metabox-in-short.md"),
}
TERRAIN_COSTS: Mapping[str, Block] = {
    f"{name}-by-terrain": partial(ResultsFolder.text, name=f"{folder}/metabox-by-terrain.md")
    for name, folder in (
        ("test-terrains", "terrain/all"),
        ("longer", "terrain/longer"),
        ("longer-guided", LONGER_GUIDED),
        ("longest", "terrain/longest"),
        ("longest-guided", LONGEST_GUIDED),
    )
}
STUDY_DOCUMENTS: dict[str, tuple[Document, ...]] = {
    "bbob": (
        Document(Path("docs/bbob.md"), "docs/bbob", "bbob", "bbob", BBOB_BLOCKS),
        Document(Path("docs/bbob-tables.md"), "docs/bbob", "", "bbob", BBOB_TABLES),
    ),
    "learners": (
        Document(Path("docs/learners.md"), "learners", "learners", blocks=LEARNERS_BLOCKS),
        Document(Path("docs/learners-tables.md"), "learners", "", blocks=LEARNERS_TABLES),
    ),
    "known-optimum": (
        Document(Path("docs/known-optimum.md"), "known-optimum", "known-optimum", blocks=ONE_MAX_BLOCKS),
        Document(Path("docs/known-optimum-tables.md"), "known-optimum", "", blocks=ONE_MAX_TABLES),
        Document(Path("docs/readings-optimizers.md"), "known-optimum", "", blocks=READINGS_BLOCKS),
    ),
    "strong-optimizers": (
        Document(Path("docs/strong-optimizers.md"), "", "strong-optimizers", blocks=STRONG_BLOCKS),
        Document(Path("docs/strong-optimizers-tables.md"), "", "", blocks=STRONG_TABLES),
    ),
    "terrain": (
        Document(Path("docs/terrain.md"), "", "terrain", blocks=TERRAIN_BLOCKS),
        Document(Path("docs/terrain-tables.md"), "", "", blocks=TERRAIN_TABLES),
        Document(Path("docs/terrain-cost-tables.md"), "", "", blocks=TERRAIN_COSTS),
    ),
    "terrain-budgets": (
        Document(Path("docs/terrain-budgets.md"), "", "terrain-budgets", blocks=TERRAIN_BUDGETS),
        Document(Path("docs/terrain-budgets-tables.md"), "", "", blocks=TERRAIN_BUDGETS_TABLES),
    ),
}
