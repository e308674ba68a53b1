"""The figures of a report: those of the suite, and those of its first scenarios."""

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass

import matplotlib.style
from tqdm import tqdm

from experiments.documents.figures import plan
from experiments.plots.style import settings
from experiments.report.themed_svg import SETTINGS, plain_title, themed_svg
from experiments.runs.database import Results
from experiments.runs.suite import Suite
from experiments.studies.spsfa.published import FIGURE_NUMBERS

# Figures of single scenarios are drawn for the first few scenarios only.
OF_CASES = ("collision", "cases")
MOST_CASES = 6
NOT_SHOWN = ("snapshots",)  # replays show populations instead


@dataclass(frozen=True)
class DrawnFigure:
    """A figure of a report.

    Attributes:
        name: name of the figure, see `experiments.documents.figures.plan`.
        caption: caption in plain text.
        svg: SVG element.
    """

    name: str
    caption: str
    svg: str


def draw_all(
    suite: Suite, results: Results, further: Sequence[str] = ()
) -> tuple[list[DrawnFigure], list[str]]:
    """Draw the figures of a suite of which no run is missing.

    Args:
        suite: suite whose figures, and figures of its first scenarios, are drawn.
        results: database with its runs.
        further: names of further figures in `experiments.catalogue`.

    Returns:
        The figures, and notices of figures that are left out.
    """
    own = tuple(name for name in suite.figures if name not in NOT_SHOWN)
    first = dataclasses.replace(
        suite,
        scenarios=suite.scenarios[:MOST_CASES],
        figures=tuple(name for name in OF_CASES if name not in own),
    )
    everything = dataclasses.replace(suite, figures=(*own, *further))
    drawings = {**plan(first, results), **plan(everything, results)}
    drawn: list[DrawnFigure] = []
    with settings(), matplotlib.style.context([SETTINGS]):
        for name, draw in tqdm(drawings.items(), desc="figures", unit="figure"):
            figure = draw()
            caption = plain_title(figure)
            number = f"Figure {FIGURE_NUMBERS[name]} of the SPSFA paper. " if name in FIGURE_NUMBERS else ""
            drawn.append(
                DrawnFigure(name, f"{number}{caption}", themed_svg(figure, f"figure-{len(drawn)}", caption))
            )
    few = len(suite.scenarios) <= MOST_CASES
    left = f"Figures of single scenarios are drawn for the first {MOST_CASES} of {len(suite.scenarios)}."
    return drawn, [] if few else [left]
