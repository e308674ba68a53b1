"""Animations of environments: short GIF files that the build of the site draws."""

from contextlib import closing
from pathlib import Path

import gymnasium

from agents import make_controller
from experiments.plots.video import film
from experiments.plots.video_files import GifFile
from swarm_gym.registration import environment_id

SCENARIO, CONTROLLER, SEED, ITERATIONS = "case2", "fixed:60", 0, 40
WIDTH, HEIGHT, FPS = 480, 300, 8


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
        render_width=WIDTH,
        render_height=HEIGHT,
        **controller.env_options(),
    )
    with closing(env), GifFile(path, FPS) as file:
        for picture in film(env, controller, SEED):
            file.add(picture)
