"""How figures look: one colour, line and marker per controller, and settings of Matplotlib."""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import matplotlib.style
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from experiments.runs.labels import label

# The hues are Okabe and Ito's, which colour-blind readers can tell apart too.
BLACK, GREY = "#222222", "#8c8c8c"
BLUE, SKY, GREEN, ORANGE, RED, PINK = (
    "#0072B2", "#56B4E9", "#009E73", "#E69F00", "#D55E00", "#CC79A7",
)  # fmt: skip

BAND, BAND_EDGE = 0.1, 0.35  # opacities
# Of legends: a character is about so wide, and a handle with its gaps takes as much as so many.
CHARACTER, HANDLE_CHARACTERS = 0.075, 10  # inches, characters
FORMATS = ("svg", "png")
SETTINGS: dict[str, Any] = {
    "axes.axisbelow": True,
    "axes.grid": True,
    "axes.labelsize": 9,
    "axes.linewidth": 0.7,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlesize": 9.5,
    "figure.titlesize": 10.5,
    "font.size": 9,
    "grid.color": "#e4e4e4",
    "grid.linewidth": 0.6,
    "legend.fontsize": 8.5,
    "legend.frameon": False,
    "legend.handlelength": 3.2,
    "lines.linewidth": 1.5,
    "lines.markersize": 4,
    "savefig.dpi": 150,
    "svg.hashsalt": "swarm_gym",
    "xtick.labelsize": 8.5,
    "ytick.labelsize": 8.5,
}


@dataclass(frozen=True)
class Style:
    """How a controller is drawn; no two share a colour and a marker."""

    colour: str
    line: Any
    marker: str

    def options(self) -> dict[str, Any]:
        """Keyword arguments of `Axes.plot`."""
        return {"color": self.colour, "linestyle": self.line, "marker": self.marker}


KNOWN_STYLES = {
    "fixed:60": Style(SKY, "--", "o"),
    "fixed:80": Style(BLUE, "-.", "s"),
    "fixed:100": Style(BLACK, ":", "^"),
    "spsfa": Style(ORANGE, (0, (6, 1, 1, 1, 1, 1)), "D"),
    "spsfa-tip": Style(RED, "-", "v"),
    "random": Style(GREY, (0, (2, 2)), "x"),
}
SPARE_LINES = (
    ((0, (8, 2)), "P"), ("-", "*"), ("--", "X"), ("-.", "<"), (":", "h"),
    ((0, (4, 1, 1, 1)), ">"), ((0, (1, 1)), "d"), ((0, (5, 1)), "p"), ((0, (3, 3)), "8"),
    ((0, (9, 3, 2, 3)), "H"),
)  # fmt: skip
SPARE_COLOURS = (GREEN, PINK, BLUE, ORANGE)
# From one to the next both change: no two of the first ten differ by colour alone.
SPARE_STYLES = [
    Style(SPARE_COLOURS[(k + turn) % len(SPARE_COLOURS)], line, marker)
    for turn in range(len(SPARE_COLOURS))
    for k, (line, marker) in enumerate(SPARE_LINES)
]


def styles(controllers: Iterable[str]) -> dict[str, Style]:
    """A style for each controller: its own, or the next spare one in the order given."""
    found: dict[str, Style] = {}
    spare = 0
    for controller in controllers:
        if controller in KNOWN_STYLES:
            found[controller] = KNOWN_STYLES[controller]
        else:
            found[controller] = SPARE_STYLES[spare % len(SPARE_STYLES)]
            spare += 1
    return found


def draw_banded_line(
    axes: Axes,
    x: NDArray,
    y: NDArray,
    band: tuple[NDArray, NDArray],
    controller: str,
    among: Mapping[str, Style],
) -> None:
    """Draw the line (m,) of a controller and both ends of its band, in its style among others."""
    style = among[controller]
    # Points inside a level stretch add to the file only; Matplotlib drops those of lines, but not of areas.
    moves = (np.diff(band) != 0.0).any(axis=0)
    kept = np.concatenate([[True], moves]) | np.concatenate([moves, [True]])
    axes.fill_between(
        x[kept], *(end[kept] for end in band),
        linewidth=0.6, facecolor=(style.colour, BAND), edgecolor=(style.colour, BAND_EDGE),
    )  # fmt: skip
    # Every tenth of the axis, beginning at different places, so that equal lines show.
    order = list(among).index(controller)
    axes.plot(x, y, label=label(controller), markevery=(0.1 * order / len(among), 0.1), **style.options())


@contextmanager
def settings() -> Iterator[None]:
    """Matplotlib's defaults and our settings within the block, whatever the user's own are."""
    with matplotlib.style.context(["default", SETTINGS]):
        yield


def new_figure(width: float, height: float) -> Figure:
    """An empty figure, in inches, that no window and no global state knows of."""
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def render(figure: Figure, form: str) -> bytes:
    """The file of a figure, "svg" or "png"; within `settings`, the same figure gives the same bytes."""
    file = BytesIO()
    metadata = {"Date": None} if form == "svg" else {"Software": None}
    figure.savefig(file, format=form, metadata=metadata)
    return file.getvalue()


def legend_below(figure: Figure) -> None:
    """Put one legend for all panels below them, every label once, in as many columns as there is room for."""
    handles: dict[str, Artist] = {}
    for axes in figure.axes:
        for handle, text in zip(*axes.get_legend_handles_labels(), strict=True):
            handles.setdefault(text, handle)
    if handles:
        width = CHARACTER * (max(map(len, handles)) + HANDLE_CHARACTERS)
        columns = max(1, min(len(handles), int(figure.get_figwidth() / width)))
        figure.legend(handles.values(), handles, loc="outside lower center", ncols=columns)
