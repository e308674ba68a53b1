"""What policies decided in validation, as a picture: population size and phi against the iteration."""

from collections.abc import Mapping
from itertools import islice

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from agents.evaluation.rollout import Episodes

Floats = NDArray[np.float64]

# Of one scenario, in inches; more scenarios than that get too small to be read.
PANEL, MOST_SCENARIOS, DOTS_PER_INCH = (3.2, 2.0), 4, 80
COLOUR = "#0072b2"
DECISIONS = {"sizes": "population size", "repair_degrees": "repair degree φ"}


def draw_decisions(by_scenario: Mapping[str, Episodes]) -> NDArray[np.uint8]:
    """Median and quartiles over the episodes of each scenario, a column each; shape (height, width, 3)."""
    shown = dict(islice(by_scenario.items(), MOST_SCENARIOS))
    width, height = PANEL[0] * len(shown), PANEL[1] * len(DECISIONS)
    figure = Figure((width, height + 0.3), dpi=DOTS_PER_INCH)
    axes = figure.subplots(len(DECISIONS), len(shown), sharex=True, sharey="row", squeeze=False)
    for column, (scenario, episodes) in zip(axes.T, shown.items(), strict=True):
        column[0].set_title(scenario, fontsize="small")
        column[-1].set_xlabel("iteration")
        for panel, name in zip(column, DECISIONS, strict=True):
            _draw_course(panel, getattr(episodes, name))
    for row, label in zip(axes, DECISIONS.values(), strict=True):
        row[0].set_ylabel(label)
    axes[0, 0].set_ylim(bottom=0.0)
    axes[-1, 0].set_ylim(0.0, 1.0)
    # Every tick costs time.
    for panel in (axes[0, 0], axes[-1, 0]):
        panel.locator_params(nbins=4)
    figure.suptitle(_title(len(shown), len(by_scenario)), fontsize="medium")
    # Where everything is: to let Matplotlib find out takes half as long again.
    figure.subplots_adjust(0.65 / width, 0.5 / height, 1.0 - 0.1 / width, 1.0 - 0.45 / height, 0.08, 0.1)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3]


def _draw_course(panel: Axes, values: Floats) -> None:
    """Median and quartiles of values (B, T), NaN after an episode has ended, while any of them goes on."""
    values = values[:, ~np.isnan(values).all(axis=0)]
    lower, median, upper = np.nanpercentile(values, (25.0, 50.0, 75.0), axis=0)
    iterations = np.arange(1, values.shape[1] + 1)
    panel.fill_between(iterations, lower, upper, color=COLOUR, alpha=0.25, linewidth=0.0)
    panel.plot(iterations, median, color=COLOUR)


def _title(num_shown: int, num_scenarios: int) -> str:
    if num_shown == num_scenarios:
        return "median and quartiles"
    return f"median and quartiles, the first {num_shown} of {num_scenarios} scenarios"
