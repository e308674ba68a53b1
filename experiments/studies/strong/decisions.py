"""Population sizes that policies of CMA-ES choose on four functions of MetaBox, and their figure."""

from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from experiments.plots.style import draw_banded_line, legend_below, new_figure, styles
from experiments.studies.strong.entrants import Entrant, controller_of
from experiments.studies.strong.measured_gaps import Floats, file_name, kept, run_row
from experiments.studies.strong.published import EVALUATIONS, RUNS
from swarm_gym.runs.seeds import TEST
from swarm_gym.scenarios.bbob.instance import FUNCTION_NAMES

# Of the constants 10, 40 and 80, the first is best on functions 12 and 22, the second on 24, the last on 18.
SHOWN = (12, 18, 22, 24)
PLACES = np.arange(250, EVALUATIONS - 250, 250)  # evaluations at which sizes are shown
WIDTH, HEIGHT = 6.4, 5.0  # in inches


class Sizes(NamedTuple):
    """Sizes that a controller chooses.

    Attributes:
        sizes: (functions, runs, places) size of the generation to which an evaluation belongs.
    """

    sizes: Floats


def choose(policies: Entrant, folder: Path) -> Floats:
    """Return the sizes that all policies of a row choose, (functions, runs of all policies, places).

    Args:
        policies: the row.
        folder: folder of files, one for each policy; what is there is not run again.
    """
    return np.concatenate([_choose_one(policies, name, folder) for name in policies.controllers], axis=1)


def _choose_one(policies: Entrant, name: str, folder: Path) -> Floats:
    made = controller_of(policies, name)
    asked: dict[str, object] = {"controller": name, "identity": repr(made.identity()), "functions": [*SHOWN]}

    def run() -> Sizes:
        return Sizes(np.stack([sizes_on(f"metabox-bbob:{function}-10-biased") for function in SHOWN]))

    def sizes_on(scenario: str) -> Floats:
        episodes = run_row(policies, made, scenario, TEST[:RUNS], EVALUATIONS)
        return np.stack([at_places(sizes) for sizes in episodes.sizes])

    return kept(folder / file_name("sizes", name), asked, Sizes, run).sizes


def at_places(sizes: Floats) -> Floats:
    """Return the sizes of the generations that the evaluations in `PLACES` belong to.

    Args:
        sizes: (T,) size of each generation; NaN after the end.
    """
    chosen = sizes[np.isfinite(sizes)]
    generations = np.searchsorted(np.cumsum(chosen), PLACES)
    return chosen[np.minimum(generations, len(chosen) - 1)]


def draw_decisions(rows: Mapping[str, Floats]) -> Figure:
    """Draw the median and the quartiles of sizes by evaluations, a panel for each function.

    Args:
        rows: sizes by the name of the row, (functions, runs, places) each.
    """
    among = styles(rows)
    figure = new_figure(WIDTH, HEIGHT)
    panels = figure.subplots(2, 2, sharex=True, sharey=True)
    for place, (function, axes) in enumerate(zip(SHOWN, panels.flat, strict=True)):
        for name, sizes in rows.items():
            low, median, high = np.quantile(sizes[place], [0.25, 0.5, 0.75], axis=0)
            draw_banded_line(axes, PLACES, median, (low, high), name, among)
        axes.set_title(f"{function} {FUNCTION_NAMES[function - 1]}")
        axes.set_yscale("log")
        axes.yaxis.set_major_formatter("{x:g}")
    for axes in panels[-1]:
        axes.set_xlabel("evaluations")
    for axes in panels[:, 0]:
        axes.set_ylabel("population size")
    legend_below(figure)
    return figure
