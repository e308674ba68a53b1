"""Draw every optimizer on every kind of map: `python -m experiments.gallery` writes docs/gallery.md.

Rows are the registered optimizers. Columns are one map of each family that needs no files. So additions to
either registry appear by themselves.
"""

import argparse
import re
from contextlib import closing
from dataclasses import dataclass, field
from io import BytesIO
from itertools import islice
from pathlib import Path
from typing import Any

import gymnasium
from tqdm import tqdm

from agents import Controller, make_controller
from experiments.plots.video_files import Picture, nearest, palette_of
from swarm_gym.command import command
from swarm_gym.comparing.entrants import iterate
from swarm_gym.errors import SwarmGymError
from swarm_gym.files import write_atomically
from swarm_gym.optimizers import OPTIMIZERS
from swarm_gym.registration import environment_id
from swarm_gym.rendering.pen import CHART_COLUMN, FOOTER, HEADER, MARGIN, SMALLEST_SCALE
from swarm_gym.scenarios import FAMILIES, DynamicScenario, make_scenario

DOCUMENT = Path("docs/gallery.md")
PICTURES = Path("docs/results/gallery")
# Size of a picture in pixels, without the margins around the map.
WIDTH, HEIGHT = 280, 210

CONTROLLER, SEED = "fixed:60", 0
ITERATIONS, ITERATIONS_AFTER_EVENT = 30, 10
# The other maps are the first sample of each family.
PLAIN_MAP = "case2"
# Options of an environment, the first that is possible: curves first, since they follow winding corridors.
OPTIONS: tuple[dict[str, Any], ...] = ({"encoding": "bezier"}, {})

TEXT = """\
# Gallery

This page shows every optimizer on one map of every family, as `env.render()` draws it. After it
you can read such a picture of your own runs. A picture shows the swarm after {iterations}
iterations; on a map with an event, {after_event} iterations after the event. All runs have the
controller `{controller}`, seed {seed} and default parameters.

The best path so far is black. Feasible members are blue. Colliding members are orange, dashed or
rings. Points on maps are the positions that walks have reached. Points on functions are members
in the plane of the first two components. Paths on grid maps are Bezier curves if the optimizer
supports them.

Each picture is of one run, with parameters that nobody chose for its map. So the pictures show
how swarms move, and do not rank the optimizers. `make docs-gallery` writes this page from the
registries of optimizers and scenarios. These families are missing, since their maps are files or
their functions belong to another library: {with_files};
[scenarios-grids.md](scenarios-grids.md) says where to get them.

{table}

Combinations without a picture, and the message of the library:

{refusals}
"""


@dataclass(frozen=True)
class Panel:
    """An optimizer on a map.

    Attributes:
        optimizer: name of the optimizer.
        scenario: name of the scenario.
        options: further options of the environment.
        refusal: message of the library if there is no such environment; empty otherwise.
    """

    optimizer: str
    scenario: str
    options: dict[str, Any] = field(default_factory=dict)
    refusal: str = ""

    @property
    def file(self) -> str:
        """File name of the picture."""
        return f"{self.optimizer}-{re.sub('[^a-z0-9]+', '-', self.scenario)}.png"

    @property
    def iterations(self) -> int:
        """Number of iterations before the picture; after an event of the map, some more."""
        scenario = make_scenario(self.scenario)
        events = scenario.events if isinstance(scenario, DynamicScenario) else ()
        return max((event.iteration + ITERATIONS_AFTER_EVENT for event in events), default=ITERATIONS)


def scenarios() -> list[str]:
    """Return names of maps: a plain one, and the first sample of each family that needs no files."""
    return [PLAIN_MAP, *(family.samples[0] for family in FAMILIES.values() if family.samples)]


def plan() -> list[list[Panel]]:
    """Return a row for every optimizer, with a panel for every map."""
    return [[_panel(optimizer, scenario) for scenario in scenarios()] for optimizer in OPTIMIZERS]


def _panel(optimizer: str, scenario: str) -> Panel:
    """Return the panel with the first options that the library does not refuse."""
    refusal = ""
    for options in OPTIONS:
        try:
            _environment(Panel(optimizer, scenario, options)).close()
        except SwarmGymError as error:
            refusal = str(error)
        else:
            return Panel(optimizer, scenario, options)
    return Panel(optimizer, scenario, refusal=refusal)


def _environment(panel: Panel) -> Any:
    controller = make_controller(CONTROLLER)
    return map_environment(
        panel.optimizer, controller, (WIDTH, HEIGHT), scenario=panel.scenario, **panel.options
    )


def map_environment(optimizer: str, controller: Controller, size: tuple[int, int], **options: Any) -> Any:
    """Return an environment whose pictures, cut by `map_of`, show the map in this size, (width, height)."""
    around = (MARGIN + CHART_COLUMN, HEADER + FOOTER)
    width, height = (inner + round(outer * SMALLEST_SCALE) for inner, outer in zip(size, around, strict=True))
    return gymnasium.make(
        environment_id(optimizer),
        render_mode="rgb_array",
        render_width=width,
        render_height=height,
        **controller.env_options(),
        **options,
    )


def map_of(picture: Picture, size: tuple[int, int]) -> Picture:
    """Return the map of a picture, (height, width, 3), without the margins around it."""
    (width, height), top, left = size, round(HEADER * SMALLEST_SCALE), round(MARGIN * SMALLEST_SCALE)
    return picture[top : top + height, left : left + width]


def picture(panel: Panel) -> Picture:
    """Return the map with the swarm after the panel's iterations, (HEIGHT, WIDTH, 3)."""
    with closing(_environment(panel)) as env:
        for _ in islice(iterate(env, make_controller(CONTROLLER), SEED), panel.iterations + 1):
            pass
        return map_of(env.render(), (WIDTH, HEIGHT))


def write_picture(drawn: Picture, path: Path) -> None:
    """Write a picture as a PNG of few colours."""
    from PIL import Image

    palette = palette_of(drawn)
    image = Image.fromarray(nearest(palette, drawn))
    image.putpalette(palette.tobytes())
    content = BytesIO()
    image.save(content, "PNG", optimize=True)
    write_atomically(path, content.getvalue())


def document(rows: list[list[Panel]]) -> str:
    """Return docs/gallery.md for a plan: a table of pictures, and the reasons for those that are missing."""
    names = [panel.scenario for panel in rows[0]]
    lines = ["| optimizer |" + "".join(f" `{name}` |" for name in names), "|---" * (len(names) + 1) + "|"]
    refusals: list[str] = []
    for row in rows:
        cells = []
        for panel in row:
            if panel.refusal and panel.refusal not in refusals:
                refusals.append(panel.refusal)
            alt = f"{panel.optimizer} on {panel.scenario}"
            place = (PICTURES / panel.file).relative_to(DOCUMENT.parent).as_posix()
            note = refusals.index(panel.refusal) + 1 if panel.refusal else 0
            cells.append(f"– ({note})" if note else f"![{alt}]({place})")
        lines.append(f"| `{row[0].optimizer}` | " + " | ".join(cells) + " |")
    return TEXT.format(
        iterations=ITERATIONS,
        after_event=ITERATIONS_AFTER_EVENT,
        controller=CONTROLLER,
        seed=SEED,
        with_files=", ".join(f"`{name}`" for name, family in FAMILIES.items() if not family.samples),
        table="\n".join(lines),
        refusals="\n".join(f"{number}. {refusal}" for number, refusal in enumerate(refusals, 1))
        or "Nothing.",
    )


def write_gallery() -> str:
    """Write the document and its pictures, delete all other pictures, and return a line to print."""
    rows = plan()
    panels = [panel for row in rows for panel in row if not panel.refusal]
    with tqdm(panels, unit="picture", desc="gallery") as bar:
        for panel in bar:
            bar.set_postfix_str(panel.file)
            write_picture(picture(panel), PICTURES / panel.file)
    for file in set(PICTURES.glob("*.png")) - {PICTURES / panel.file for panel in panels}:
        file.unlink()
    write_atomically(DOCUMENT, document(rows))
    total = sum((PICTURES / panel.file).stat().st_size for panel in panels)
    return f"written: {DOCUMENT}, {len(panels)} pictures, {total / 1e6:.2f} MB"


def main() -> None:
    """Write the document and its pictures, and delete pictures that are no longer in it."""
    argparse.ArgumentParser(prog="python -m experiments.gallery", description=__doc__).parse_args()
    with command(kept="pictures that were drawn are kept"):
        print(write_gallery())


if __name__ == "__main__":
    main()
