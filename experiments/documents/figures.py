"""Figures of a suite, from stored runs, as SVG and PNG files."""

from pathlib import Path

from tqdm import tqdm

from experiments.catalogue import figures
from experiments.plots.stored import Drawings, Stored
from experiments.plots.style import settings, write_figure
from experiments.runs.database import Results
from experiments.runs.suite import Suite
from experiments.studies.spsfa.published import FIGURE_NUMBERS
from swarm_gym.checks import look_up


def write_figures(suite: Suite, results: Results, folder: Path) -> list[Path]:
    """Write all figures of a suite into a folder, which is made if missing, and return the files.

    Controllers without runs are left out, and so is a figure that would be empty. The same runs give the
    same bytes.
    """
    drawings = plan(suite, results)
    written = []
    with settings():
        for name, draw in tqdm(drawings.items(), desc="figures", unit="figure"):
            written += write_figure(draw(), folder, _stem(name))
    return written


def plan(suite: Suite, results: Results) -> Drawings:
    """Return functions without arguments that draw the figures of a suite, by name of the figure.

    Raises:
        UnknownNameError: if the suite names figures that no study has.
    """
    makers = [look_up("figure", name, figures()) for name in suite.figures]
    stored = Stored(suite, results)
    return {name: draw for make in makers for name, draw in make(stored).items()}


def _stem(name: str) -> str:
    """Return the file name of a figure, without a suffix; figures of the SPSFA paper have its numbers."""
    name = name.replace(":", "-")  # some file systems forbid colons
    return f"figure-{FIGURE_NUMBERS[name]:02}-{name}" if name in FIGURE_NUMBERS else f"figure-{name}"
