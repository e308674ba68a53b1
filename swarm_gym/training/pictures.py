"""Pictures of validation for TensorBoard: decisions against the iteration, and an episode as a strip."""

import logging
from collections.abc import Mapping
from itertools import islice

import numpy as np
from gymnasium.error import DependencyNotInstalled
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from swarm_gym.rendering import Renderer, Scene
from swarm_gym.rendering.pen import require_pygame
from swarm_gym.rollout import Episodes
from swarm_gym.simulation import Simulation

Floats = NDArray[np.float64]

# Size of the panel of a scenario in inches; panels of more scenarios would be too small to read.
PANEL, MOST_SCENARIOS, DOTS_PER_INCH = (3.2, 2.0), 4, 80
COLOUR = "#0072b2"
DECISIONS = {"sizes": "population size", "repair_degrees": "repair degree φ"}

NUM_FRAMES = 5
# Pictures are drawn at the size for which they are designed, without overlaps, and shrunk to half of it.
SHRINKING = 2


def draw_decisions(by_scenario: Mapping[str, Episodes]) -> NDArray[np.uint8]:
    """Draw median and quartiles over episodes, a column for each scenario; shape (height, width, 3)."""
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
    # Fewer ticks take less time to draw.
    for panel in (axes[0, 0], axes[-1, 0]):
        panel.locator_params(nbins=4)
    figure.suptitle(_title(len(shown), len(by_scenario)), fontsize="medium")
    # Explicit margins: an automatic layout takes half as long again.
    figure.subplots_adjust(0.65 / width, 0.5 / height, 1.0 - 0.1 / width, 1.0 - 0.45 / height, 0.08, 0.1)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3]


def _draw_course(panel: Axes, values: Floats) -> None:
    """Draw median and quartiles of values (B, T) while an episode runs; NaN marks ended episodes."""
    values = values[:, ~np.isnan(values).all(axis=0)]
    lower, median, upper = np.nanpercentile(values, (25.0, 50.0, 75.0), axis=0)
    iterations = np.arange(1, values.shape[1] + 1)
    panel.fill_between(iterations, lower, upper, color=COLOUR, alpha=0.25, linewidth=0.0)
    panel.plot(iterations, median, color=COLOUR)


def _title(num_shown: int, num_scenarios: int) -> str:
    if num_shown == num_scenarios:
        return "median and quartiles"
    return f"median and quartiles, the first {num_shown} of {num_scenarios} scenarios"


class ReplayStrip:
    """Pictures of the first of the episodes that run side by side, from its beginning to its end.

    Raises:
        DependencyNotInstalled: if pygame is missing.
    """

    def __init__(self) -> None:
        require_pygame()
        self._renderer = Renderer()
        self._scenes: list[Scene] = []

    def look(self, simulation: Simulation) -> None:
        """Record the scene if it is due: at the beginning, the end, and evenly in between.

        An episode that ends early shows its last scene until the others have ended.
        """
        iteration, iterations = simulation.iteration[0], simulation.settings.iterations
        if iteration == 0:
            self._scenes = []
        due = np.unique(np.linspace(0, iterations, NUM_FRAMES).astype(np.int64))
        num_due = np.searchsorted(due, iteration, side="right") if simulation.running.any() else len(due)
        if len(self._scenes) < num_due:
            self._scenes += [Scene.of(simulation)] * (num_due - len(self._scenes))

    def draw(self) -> NDArray[np.uint8]:
        """Draw the scenes of the last episode side by side, shape (height, width, 3)."""
        frames = np.hstack([self._renderer.frame(scene) for scene in self._scenes])
        return np.asarray(Image.fromarray(frames).reduce(SHRINKING))


def make_replay_strip() -> ReplayStrip | None:
    """Return a strip, or None with a warning if pygame, which is an extra, is missing."""
    try:
        return ReplayStrip()
    except DependencyNotInstalled as error:
        logging.getLogger("agents").warning("no replays in TensorBoard: %s", error)
        return None
