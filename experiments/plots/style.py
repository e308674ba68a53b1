"""The style of figures: one colour, line and marker per controller, and settings of Matplotlib."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib.style
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from experiments.runs.labels import label
from swarm_gym.files import write_atomically

# Colours of Okabe and Ito, which colour-blind readers can tell apart, too.
BLACK, GREY = "#222222", "#8c8c8c"
BLUE, SKY, GREEN, ORANGE, RED, PINK = (
    "#0072B2", "#56B4E9", "#009E73", "#E69F00", "#D55E00", "#CC79A7",
)  # fmt: skip

BAND, BAND_EDGE = 0.1, 0.35  # opacities
# Widths in legends: of a character in inches, and of a handle with its gaps in characters.
CHARACTER, HANDLE_CHARACTERS = 0.075, 10
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
    """The style of one controller; no two controllers of a figure share both colour and marker."""

    colour: str
    line: Any
    marker: str

    def options(self) -> dict[str, Any]:
        """Return the style as keyword arguments of `Axes.plot`."""
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
# Colour and line change from one style to the next, so that no two of the first ten differ by colour alone.
SPARE_STYLES = [
    Style(SPARE_COLOURS[(k + turn) % len(SPARE_COLOURS)], line, marker)
    for turn in range(len(SPARE_COLOURS))
    for k, (line, marker) in enumerate(SPARE_LINES)
]


def styles(controllers: Iterable[str]) -> dict[str, Style]:
    """Return a style for each controller: a fixed one, or the next spare one in the order given."""
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
    """Draw a line of a controller with a band around it.

    Args:
        axes: axes to draw into.
        x: (m,) horizontal coordinates.
        y: (m,) heights of the line.
        band: lower and upper end of the band, (m,) each.
        controller: name of the controller.
        among: styles of all controllers of the figure.
    """
    style = among[controller]
    # Points inside a level stretch only make files larger; Matplotlib drops them from lines, not from areas.
    moves = (np.diff(band) != 0.0).any(axis=0)
    kept = np.concatenate([[True], moves]) | np.concatenate([moves, [True]])
    axes.fill_between(
        x[kept], *(end[kept] for end in band),
        linewidth=0.6, facecolor=(style.colour, BAND), edgecolor=(style.colour, BAND_EDGE),
    )  # fmt: skip
    # Markers at every tenth of the axis begin at different places, so that equal lines can be told apart.
    order = list(among).index(controller)
    axes.plot(x, y, label=label(controller), markevery=(0.1 * order / len(among), 0.1), **style.options())


@contextmanager
def settings() -> Iterator[None]:
    """Use Matplotlib's defaults with our settings inside the block, whatever settings the user has."""
    with matplotlib.style.context(["default", SETTINGS]):
        yield


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure, of a size in inches, without a window and without global state."""
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def render(figure: Figure, form: str) -> bytes:
    """Return a figure as a file, "svg" or "png"; inside `settings`, equal figures give equal bytes."""
    file = BytesIO()
    metadata = {"Date": None} if form == "svg" else {"Software": None}
    figure.savefig(file, format=form, metadata=metadata)
    return file.getvalue()


def write_figure(figure: Figure, folder: Path, stem: str) -> list[Path]:
    """Write a figure in every format, inside `settings`; return the files, e.g. folder/stem.svg."""
    return [write_atomically(folder / f"{stem}.{form}", render(figure, form)) for form in FORMATS]


def legend_below(figure: Figure) -> None:
    """Draw one legend below all panels, every label once, in as many columns as fit."""
    handles: dict[str, Artist] = {}
    for axes in figure.axes:
        for handle, text in zip(*axes.get_legend_handles_labels(), strict=True):
            handles.setdefault(text, handle)
    if handles:
        width = CHARACTER * (max(map(len, handles)) + HANDLE_CHARACTERS)
        columns = max(1, min(len(handles), int(figure.get_figwidth() / width)))
        figure.legend(handles.values(), handles, loc="outside lower center", ncols=columns)


def error_bars(
    intervals: Sequence[tuple[float, float, float]],
) -> tuple[tuple[float, ...], tuple[list[float], list[float]]]:
    """Return the values of intervals (value, low, high), and how far these reach below and above them."""
    values, lows, highs = zip(*intervals, strict=True)
    below = [value - low for value, low in zip(values, lows, strict=True)]
    above = [high - value for value, high in zip(values, highs, strict=True)]
    return values, (below, above)
