"""Draw the planned paths that the pages on planning show: `python -m experiments.plans --help`.

One picture has paths through several corridors of case 2. One has a drivable curve in generated rooms, and
the shortest path of a robot that turns on the spot. One has a flight over a generated terrain. They are
examples: the tables of the pages say how good plans are.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import tyro

from experiments.plots.map_plot import draw_map, draw_shortest_path, label_axes, proportions
from experiments.plots.style import SPARE_STYLES, legend_below, new_figure, render, settings
from experiments.runs.run import Floats
from swarm_gym.command import command
from swarm_gym.errors import MissingExtraError
from swarm_gym.files import write_atomically
from swarm_gym.planning import plan
from swarm_gym.planning.flights import plan_flight
from swarm_gym.planning.flights.picture import as_png
from swarm_gym.scenarios import StaticScenario

WIDTH = 5.6  # of a figure, in inches
# Width of the picture of a flight in pixels, and its number of colours: the relief makes large files.
PIXELS, COLOURS = 560, 255
CORRIDORS, ROOMS, TERRAIN = "case2", "rooms:0", "terrain:test:1"
RADIUS, TURNING_RADIUS = 0.3, 2.0  # of the robot in the rooms


@dataclass(frozen=True)
class PlansConfig:
    """Options of the command."""

    output: Path = Path("docs/results/plans")
    """Folder that the pictures are written to, by default the one that the documents show."""


def alternatives(count: int = 3) -> bytes:
    """Return a picture of paths through several corridors, as SVG."""
    found = plan(CORRIDORS, alternatives=count)
    lines = [
        (f"path {number}: length {one.length:,.0f}", one.path)
        for number, one in enumerate(found.alternatives, start=1)
    ]
    return _drawn(found.map, lines)


def curve() -> bytes:
    """Return a picture of a curve, and of the shortest path of a robot that turns on the spot, as SVG."""
    tight = plan(ROOMS, robot_radius=RADIUS)
    found = plan(ROOMS, robot_radius=RADIUS, turning_radius=TURNING_RADIUS, goal_heading=0.0)
    lines = [(f"turning radius {TURNING_RADIUS:g}: length {found.length:,.1f}", found.path)]
    return _drawn(found.map, lines, (f"turns on the spot: length {tight.length:,.1f}", tight.path))


def flight() -> bytes:
    """Return a picture of a flight over terrain, as PNG.

    Raises:
        MissingExtraError: if Pillow is missing.
    """
    content = as_png(plan_flight(TERRAIN))
    from PIL import Image  # `as_png` has named the extra if it is missing

    picture = Image.open(BytesIO(content))
    small = picture.resize((PIXELS, round(PIXELS * picture.height / picture.width)), Image.Resampling.LANCZOS)
    reduced = BytesIO()
    small.quantize(COLOURS, Image.Quantize.MAXCOVERAGE).save(reduced, "PNG", optimize=True)
    return reduced.getvalue()


def _drawn(
    scenario: StaticScenario, lines: Sequence[tuple[str, Floats]], below: tuple[str, Floats] | None = None
) -> bytes:
    """Return a map with labelled paths, and with another one as a broad line below them, as SVG."""
    with settings():
        figure = new_figure(WIDTH, WIDTH * proportions(scenario) + 0.8)
        axes = figure.subplots()
        draw_map(axes, scenario)
        label_axes(axes, scenario)
        if below is not None:
            draw_shortest_path(axes, below[1], below[0])
        for (label, path), style in zip(lines, SPARE_STYLES, strict=False):
            axes.plot(*path.T, color=style.colour, linestyle=style.line, label=label, zorder=4)
        legend_below(figure)
        return render(figure, "svg")


PICTURES = {"alternatives.svg": alternatives, "curve.svg": curve, "flight.png": flight}


def main() -> None:
    """Write the pictures."""
    config = tyro.cli(PlansConfig, description=__doc__)
    with command(MissingExtraError):
        for name, draw in PICTURES.items():
            print(f"picture: {write_atomically(config.output / name, draw())}")


if __name__ == "__main__":
    main()
