"""Tables, figure and page of the analysis of a controller's inputs."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from experiments.analysis.episodes import EpisodeOutcome
from experiments.analysis.sensitivity import Sensitivity
from experiments.plots.style import BLUE, ORANGE, new_figure, settings, write_figure
from experiments.runs.labels import label
from experiments.runs.run import Floats
from experiments.statistics import paired
from experiments.tables.cell import MISSING, number, number_in, share, share_in
from experiments.tables.table import Row, Table, write_tables_page
from swarm_gym.controllers.distilled import LINEAR

SIGNED = "+.2f"  # format of differences, in per cent
SEEING = "nothing"  # taken away from the controller with all inputs


def sensitivity_tables(found: Sensitivity) -> list[Table]:
    """Return the tables of changed decisions and of changed outcomes, with a row for each input."""
    where = f"{found.seeing.gap.shape[1]} seeds on each of {', '.join(found.scenarios)}"
    changes = Table(
        "sensitivity-decisions",
        f"Decisions of {label(found.policy)}: mean absolute change where an input is replaced by its mean at "
        f"the same iteration, in the states that it visits, {where}",
        ("without", *(_unit(decision) for decision in found.decisions)),
        [(name, *(number(change, ".3f") for change in row)) for name, row in found.changes.items()],
    )
    without = {SEEING: found.seeing, **found.masked}
    performance = Table.of(
        "sensitivity-performance",
        f"Episodes of {label(found.policy)} without an input, which is replaced by its mean course: mean "
        "gap, mean evaluations, and mean differences from the controller as it is, on the same scenarios and "
        f"seeds [95 % bootstrap interval]; of evaluations, relative to its mean on the scenario; {where}",
        [_performance(name, outcome, found.seeing) for name, outcome in without.items()],
    )
    return [changes, performance]


def _performance(name: str, outcome: EpisodeOutcome, seeing: EpisodeOutcome) -> Row:
    """Return the row of episodes without an input; it has no differences if nothing was taken away."""
    differences = {
        "difference": share_in(*paired(outcome.gap - seeing.gap), SIGNED),
        "difference of evaluations": share_in(*paired(_relative_evaluations(seeing, outcome)), SIGNED),
        "difference of the return": number_in(*paired(outcome.returns - seeing.returns), "+.3f"),
    }
    return {
        "without": name,
        "mean gap": share(outcome.gap.mean(), ".2f"),
        "difference": MISSING,
        "mean evaluations": number(outcome.evaluations.mean(), ",.0f"),
        "difference of evaluations": MISSING,
        "difference of the return": MISSING,
        **({} if name == SEEING else differences),
    }


def draw_sensitivity(found: Sensitivity) -> Figure:
    """Draw changes of decisions as bars, and differences of gap and evaluations with their intervals.

    Each input has a row; each decision, the gap and the evaluations have a panel.
    """
    names = list(found.changes)
    places = np.arange(len(names))
    num_panels = len(found.decisions) + 2
    figure = new_figure(3.2 + 1.9 * num_panels, 1.4 + 0.27 * len(names))
    panels = figure.subplots(1, num_panels, sharey=True)
    for column, (axes, decision) in enumerate(zip(panels, found.decisions, strict=False)):
        axes.barh(places, [row[column] for row in found.changes.values()], 0.6, color=BLUE)
        axes.set_xlabel(f"change of\n{_unit(decision)}")
    gaps = [100.0 * (found.masked[name].gap - found.seeing.gap) for name in names]
    spent = [100.0 * _relative_evaluations(found.seeing, found.masked[name]) for name in names]
    _draw_differences(panels[-2], places, gaps, "gap, % of the optimum")
    _draw_differences(panels[-1], places, spent, "evaluations, %")
    panels[0].set_yticks(places, names)
    panels[0].invert_yaxis()
    for axes in panels:
        axes.grid(axis="y", visible=False)
    figure.suptitle(
        f"{label(found.policy)} without an input: change of its decisions, and differences in outcome "
        "(95 % intervals)"
    )
    return figure


def write_report(found: Sensitivity, folder: Path) -> Path:
    """Write tables and figure as files, and a page that shows them; return the path of the page."""
    with settings():
        write_figure(draw_sensitivity(found), folder, "figure-sensitivity")
    made_by = (
        f"Made by `python -m experiments.sensitivity --policy {found.policy} "
        f"--seeds {found.seeing.gap.shape[1]} --scenarios {' '.join(found.scenarios)}`.\n"
    )
    title = f"What {label(found.policy)} makes of its inputs"
    figure = "![sensitivity](figure-sensitivity.svg)\n"
    return write_tables_page(folder, title, sensitivity_tables(found), [made_by], [figure])


def _relative_evaluations(seeing: EpisodeOutcome, outcome: EpisodeOutcome) -> Floats:
    """Return differences of the evaluations, relative to the mean on the scenario with all inputs."""
    scale = seeing.evaluations.mean(axis=1, keepdims=True)
    return (outcome.evaluations - seeing.evaluations) / scale


def _draw_differences(axes: Axes, places: NDArray, differences: list[Floats], name: str) -> None:
    """Draw mean paired differences at these heights, with 95 % intervals."""
    found = [paired(one) for one in differences]
    low, high = np.transpose([ends for _, ends in found])
    axes.hlines(places, low, high, color=ORANGE, linewidth=1.5)
    axes.plot([mean for mean, _ in found], places, "o", color=ORANGE)
    axes.axvline(0.0, color="0.3", linewidth=0.8)
    axes.set_xlabel(f"difference of\n{name}")


def _unit(decision: str) -> str:
    """Return a decision with the scale on which its changes are measured."""
    return decision if decision == LINEAR else f"{decision}, log2"
