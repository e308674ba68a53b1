"""Animations of environments: short GIF files of the map alone, which the build of the site draws."""

from contextlib import closing
from pathlib import Path

from agents import make_controller
from experiments.plots.video import film, map_environment, map_of
from experiments.plots.video_files import GifFile

# Few members: their lines are what makes a file large.
SCENARIO, CONTROLLER, SEED, ITERATIONS = "case2", "fixed:10", 0, 40
# Width and height of the map in pixels, without the margins around it; pictures per second.
SIZE, FPS = (260, 156), 8


def write_animation(optimizer: str, path: Path) -> None:
    """Film a short episode of an optimizer's environment into a GIF file.

    Raises:
        OSError: if the file cannot be written.
        MissingExtraError: if a library of the extra `video` is missing.
    """
    controller = make_controller(CONTROLLER)
    env = map_environment(optimizer, controller, SIZE, scenario=SCENARIO, iterations=ITERATIONS)
    with closing(env), GifFile(path, FPS) as file:
        for picture in film(env, controller, SEED):
            file.add(map_of(picture, SIZE))
