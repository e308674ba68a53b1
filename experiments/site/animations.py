"""Animations of environments: short GIF files of the map alone, which the build of the site draws."""

from contextlib import closing
from pathlib import Path

import gymnasium

from agents import make_controller
from experiments.plots.video import film
from experiments.plots.video_files import GifFile, Picture
from swarm_gym.registration import environment_id
from swarm_gym.rendering.pen import CHART_COLUMN, FOOTER, HEADER, MARGIN, SMALLEST_SCALE

# Few members: their lines are what makes a file large.
SCENARIO, CONTROLLER, SEED, ITERATIONS = "case2", "fixed:10", 0, 40
# Size of the map in pixels, without the margins around it; pictures per second.
WIDTH, HEIGHT, FPS = 260, 156, 8


def write_animation(optimizer: str, path: Path) -> None:
    """Film a short episode of an optimizer's environment into a GIF file.

    Raises:
        OSError: if the file cannot be written.
        MissingExtraError: if a library of the extra `video` is missing.
    """
    controller = make_controller(CONTROLLER)
    env = gymnasium.make(
        environment_id(optimizer),
        scenario=SCENARIO,
        iterations=ITERATIONS,
        render_mode="rgb_array",
        render_width=WIDTH + round((MARGIN + CHART_COLUMN) * SMALLEST_SCALE),
        render_height=HEIGHT + round((HEADER + FOOTER) * SMALLEST_SCALE),
        **controller.env_options(),
    )
    with closing(env), GifFile(path, FPS) as file:
        for picture in film(env, controller, SEED):
            file.add(_map_of(picture))


def _map_of(picture: Picture) -> Picture:
    """Return the map of a picture, (HEIGHT, WIDTH, 3)."""
    top, left = round(HEADER * SMALLEST_SCALE), round(MARGIN * SMALLEST_SCALE)
    return picture[top : top + HEIGHT, left : left + WIDTH]
