"""Figures as SVG elements of a report: colours from its style sheet, unique identifiers, fewer digits."""

import html
import re

from matplotlib.figure import Figure

from experiments.plots import map_plot
from experiments.plots import style as plots_style
from experiments.plots.style import render

# Settings of Matplotlib in addition to `plots.style.settings`: text stays text, to be searched and read out.
SETTINGS = {"svg.fonttype": "none", "figure.facecolor": "none", "savefig.facecolor": "none"}

# Variables of `report.css` by the colours of figures.
VARIABLES = {
    "#ffffff": "paper",
    "#000000": "ink",
    plots_style.BLACK: "ink",
    "#4c4c4c": "faint-ink",
    plots_style.GREY: "grey",
    "#bfbfbf": "grey",
    plots_style.SETTINGS["grid.color"]: "grid",
    map_plot.OBSTACLE: "obstacle",
    map_plot.OUTLINE: "outline",
    "#f0e442": "shortest",
    plots_style.BLUE: "blue",
    plots_style.SKY: "sky",
    plots_style.GREEN: "green",
    plots_style.ORANGE: "orange",
    plots_style.RED: "red",
    plots_style.PINK: "pink",
}
_VARIABLES = {colour.lower(): f"var(--{name})" for colour, name in VARIABLES.items()}

# Coordinates are points, of which there are 72 in an inch.
_LONG_NUMBER = re.compile(r"(\d+\.\d\d)\d+")
_DRAWN = re.compile(r'(?<=\s)(d|x|y|points)="([^"]*)"')


def themed_svg(figure: Figure, prefix: str, title: str) -> str:
    """Return the SVG element of a figure, without a background.

    Args:
        figure: figure that was drawn inside `plots.style.settings` and `SETTINGS`.
        prefix: prefix of its identifiers, which no other figure of the report has.
        title: description of the figure, for screen readers.
    """
    text = render(figure, "svg").decode()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    text = re.sub(r'<style type="text/css">.*?</style>', "", text, flags=re.DOTALL)
    text = re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)
    text = re.sub(r"#[0-9a-fA-F]{6}\b", lambda m: _VARIABLES.get(m[0].lower(), m[0]), text)
    text = re.sub(r'\bid="', f'id="{prefix}-', text)
    text = re.sub(r'(href=")#', rf"\1#{prefix}-", text)
    text = text.replace("url(#", f"url(#{prefix}-")
    text = _DRAWN.sub(_shortened, text)
    text = re.sub(r"font-family: [^;\"]*", "font-family: 'DejaVu Sans', sans-serif", text)
    text = re.sub(r">\s+<", "><", text)
    width, height = figure.get_size_inches()
    attributes = f'role="img" aria-labelledby="{prefix}-title" style="--natural: {72 * width:.0f}px"'
    opening = f'<svg viewBox="0 0 {72 * width:g} {72 * height:g}" {attributes}'
    return re.sub(
        r"<svg[^>]*>",
        lambda _: f'{opening}><title id="{prefix}-title">{html.escape(title, quote=False)}</title>',
        text,
        count=1,
    )


def plain_title(figure: Figure) -> str:
    """Remove the title from a figure and return it without marks of mathematics, as a caption."""
    title = figure.get_suptitle()
    figure.suptitle("")
    title = re.sub(r"\\mathrm\{(\w+)\}", r"\1", title)
    return title.replace("$", "")


def _shortened(attribute: re.Match[str]) -> str:
    """Return an attribute with its coordinates to two places."""
    coordinates = " ".join(attribute[2].split())
    return attribute[1] + '="' + _LONG_NUMBER.sub(r"\1", coordinates) + '"'
