"""The figures of a report: those of the suite, and what is of use for any: cases, profiles, fronts."""

import dataclasses
from dataclasses import dataclass

import matplotlib.style
from tqdm import tqdm

from experiments.figure_style import settings
from experiments.figures import NUMBERS, plan
from experiments.report.themed_svg import SETTINGS, plain_title, themed_svg
from experiments.results import Results
from experiments.suite import Suite
from swarm_gym.errors import ScenarioError

# Drawn for each scenario, so of the first few only.
OF_CASES = ("collision", "cases")
OF_ALL = ("profiles", "front")
MOST_CASES = 6
NOT_SHOWN = ("snapshots",)  # replays show populations


@dataclass(frozen=True)
class Drawn:
    """A figure of the page: its name among figures, a caption in plain text, and the SVG element."""

    name: str
    caption: str
    svg: str


def draw_all(suite: Suite, results: Results) -> tuple[list[Drawn], list[str]]:
    """Draw the figures of a suite of which no run is missing; returns them, and what could not be drawn."""
    own = tuple(name for name in suite.figures if name not in NOT_SHOWN)
    first = dataclasses.replace(
        suite,
        scenarios=suite.scenarios[:MOST_CASES],
        figures=tuple(name for name in OF_CASES if name not in own),
    )
    everything = dataclasses.replace(
        suite, figures=(*own, *(name for name in OF_ALL if name not in own and suite.num_seeds > 1))
    )
    drawings = {**plan(first, results), **plan(everything, results)}
    drawn: list[Drawn] = []
    left_out = []
    with settings(), matplotlib.style.context([SETTINGS]):
        for name, draw in tqdm(drawings.items(), desc="figures", unit="figure"):
            try:
                figure = draw()
            except ScenarioError as error:
                left_out.append(f"Figure {name} is left out: {error}.")
                continue
            caption = plain_title(figure)
            number = f"Figure {NUMBERS[name]} of the paper. " if name in NUMBERS else ""
            drawn.append(
                Drawn(name, f"{number}{caption}", themed_svg(figure, f"figure-{len(drawn)}", caption))
            )
    if len(suite.scenarios) > MOST_CASES:
        left_out.append(
            f"Figures of single scenarios are of the first {MOST_CASES} of {len(suite.scenarios)}."
        )
    return drawn, left_out
