"""Learning curves of plain learners: the objective on validation seeds by environment steps."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from experiments.plots.style import BLACK, BLUE, FORMATS, GREEN, ORANGE, PINK, RED, SKY, render, settings
from experiments.studies.learners.recipes import RECIPES
from experiments.studies.learners.trainings import stored
from swarm_gym.files import write_atomically

COLOURS = (BLUE, RED, GREEN, ORANGE, PINK, SKY, BLACK)
LEAST, MOST = 0.5, 60.0  # of the shown objectives


def write_curves(folder: Path, output: Path, steps: int, paper: float, base: float) -> list[Path]:
    """Write the curves of all recipes into a folder, and return the files.

    Args:
        folder: folder of the trainings.
        output: folder of the pictures.
        steps: environment steps of the trainings that are shown.
        paper: objective of SPSFA-TIP, a line.
        base: objective of the base of residual policies, a line.
    """
    with settings():
        figure = Figure(figsize=(7.2, 2.9), layout="constrained")
        axes = figure.subplots(1, 2, sharey=True)
        scratch = [name for name, recipe in RECIPES.items() if recipe.kind == "from scratch"]
        _draw(axes[0], folder, scratch, steps)
        others = [name for name, recipe in RECIPES.items() if not recipe.kind.startswith("from scratch")]
        _draw(axes[1], folder, others, steps)
        for one, title in zip(axes, ("from scratch", "residual, and with sources"), strict=True):
            one.axhline(paper, color=BLACK, lw=1, ls=":", label="SPSFA-TIP")
            one.axhline(base, color=BLACK, lw=1, ls="--", label="base")
            one.set(xlabel="environment steps", title=title, yscale="log", ylim=(LEAST, MOST))
            one.xaxis.set_major_formatter(lambda value, _: f"{value / 1000:g}k")
            one.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
            one.legend(fontsize=7)
        axes[0].set_ylabel("objective on validation seeds")
        return [write_atomically(output / f"curves-{steps}.{form}", render(figure, form)) for form in FORMATS]


def _draw(axes: Axes, folder: Path, names: Iterable[str], steps: int) -> None:
    """Draw the mean of each recipe over training seeds, and the range of these seeds."""
    found = {name: trainings for name in names if (trainings := stored(folder, name, steps))}
    for colour, (name, trainings) in zip(COLOURS, found.items(), strict=False):
        at = list(trainings[0].course)
        courses = np.array([list(one.course.values()) for one in trainings])
        axes.plot(at, courses.mean(axis=0), color=colour, label=name)
        axes.fill_between(at, courses.min(axis=0), courses.max(axis=0), color=colour, alpha=0.15, lw=0)
