"""Pictures of the study of OneMax: what controllers decide, by the number of zeros."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from experiments.plots.style import BLACK, BLUE, FORMATS, ORANGE, RED, SKY, render, settings
from experiments.studies.controllers import packaged_seeds
from swarm_gym.comparing.onemax import decisions_on
from swarm_gym.controllers import make_controller
from swarm_gym.files import write_atomically
from swarm_gym.reference.onemax.optima import packaged
from swarm_gym.reference.onemax.runtimes import LambdaDecisions

SIZE = 500


def write_pictures(folder: Path) -> list[Path]:
    """Write the pictures into a folder, and return their files."""
    with settings():
        figure = _decisions()
        return [write_atomically(folder / f"decisions.{form}", render(figure, form)) for form in FORMATS]


def _decisions() -> Figure:
    figure = Figure(figsize=(7.2, 2.9), layout="constrained")
    left, right = figure.subplots(1, 2)
    zeros = SIZE - np.arange(SIZE)
    shown = zeros <= SIZE // 2
    for number, name in enumerate(packaged_seeds("onemax-lambda")):
        label = None if number else "PPO, all seeds"
        left.plot(zeros[shown], _of(name).mutants[shown], color=SKY, alpha=0.5, lw=1, label=label)
    for number, name in enumerate(packaged_seeds("onemax-four")):
        learned, label = _of(name), None if number else "PPO, all seeds"
        right.plot(zeros[shown], learned.mutants[shown], color=SKY, alpha=0.5, lw=1, label=label)
        right.plot(zeros[shown], learned.children[shown], color=SKY, alpha=0.5, lw=1, ls="--")
    left.plot(zeros[shown], _of("theory").mutants[shown], color=RED, lw=1, label="theory")
    best = packaged(SIZE, "onemax").decisions
    left.plot(zeros[shown], best.mutants[shown], color=BLACK, lw=1.3, label="optimum")
    symbolic = _of("symbolic")
    right.plot(zeros[shown], symbolic.mutants[shown], color=ORANGE, lw=1, label="symbolic")
    right.plot(zeros[shown], symbolic.children[shown], color=ORANGE, lw=1, ls="--")
    best = packaged(SIZE, "onemax-four").decisions
    right.plot(zeros[shown], best.mutants[shown], color=BLACK, lw=1.3, label="optimum: mutants")
    right.plot(zeros[shown], best.children[shown], color=BLUE, lw=1.3, ls="--", label="optimum: children")
    _label(left, "lambda", "one parameter")
    _label(right, "mutants, and children (dashed)", "four parameters")
    return figure


def _label(axes: Axes, what: str, title: str) -> None:
    axes.set(
        xscale="log", yscale="log", xlabel=f"zeros that are left, of n = {SIZE}", ylabel=what, title=title
    )
    axes.set_yscale("log", base=2)
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.invert_xaxis()
    axes.legend(fontsize=8)


def _of(name: str) -> LambdaDecisions:
    return decisions_on(make_controller(name), SIZE)
