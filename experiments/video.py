"""Film a run, one picture for each iteration: `python -m experiments.video --help`."""

from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import gymnasium
import tyro
from gymnasium.error import DependencyNotInstalled
from tqdm import tqdm

from agents import Controller, make_controller_for
from experiments.plots.video_files import VIDEO_FILES, Picture
from swarm_gym.checks import look_up, require_integer
from swarm_gym.command import command
from swarm_gym.comparing.entrants import entrant, iterate
from swarm_gym.errors import SettingError
from swarm_gym.registration import environment_id
from swarm_gym.rendering import HEIGHTS, WIDTHS

# A GIF counts hundredths of a second, and players do not show a picture for one hundredth only.
MOST_FPS = 50

OPTIONS = ("iterations", "max_evaluations", "encoding", "source", "cost")  # of the environment


@dataclass(frozen=True)
class VideoConfig:
    """Options of a video: the episode, the size and the files."""

    output: tuple[Path, ...] = (Path("video.mp4"),)
    """Files to write; their endings, .mp4 or .gif, say which kind."""
    controller: str = "spsfa-tip"
    """Controller to run, e.g. spsfa-tip for fireflies, or multivariate+fixed:65 for another optimizer."""
    scenario: str = "case2"
    """Scenario to run on, e.g. case1 or rooms:0."""
    iterations: int | None = None
    """Length of the episode in iterations; by default that of the optimizer's environment."""
    max_evaluations: int | None = None
    """Evaluation budget of the episode; by default that of the controller, if it has one."""
    encoding: str | None = None
    """Meaning of a member's numbers, e.g. bezier."""
    source: str | None = None
    """Origin of new members, e.g. smooth."""
    cost: str | None = None
    """Cost of flights over terrain, metabox or documented."""
    seed: int = 0
    """Seed of the episode."""
    fps: int = 12
    """Pictures per second, at most 50; each picture is one iteration."""
    width: int = 640
    """Width of the video in pixels; an even number."""
    height: int = 400
    """Height of the video in pixels; an even number."""


def write_video(config: VideoConfig) -> None:
    """Film an episode and write all files side by side; after a failure none of them is left.

    Raises:
        SettingError: if an option has a value out of its range.
        ValueError: if a name is unknown.
        OSError: if a file cannot be written.
        MissingExtraError: if the library that writes a file is missing.
    """
    kinds = [look_up("kind of video file", path.suffix.lower(), VIDEO_FILES) for path in config.output]
    _check(config)
    with ExitStack() as stack:
        files = [
            stack.enter_context(kind(path, config.fps))
            for kind, path in zip(kinds, config.output, strict=True)
        ]
        env, controller = _made(config)
        stack.callback(env.close)
        length = env.unwrapped.settings.iterations + 1
        for picture in tqdm(film(env, controller, config.seed), total=length, unit="picture", desc="filming"):
            for file in files:
                file.add(picture)


def film(env: Any, controller: Controller, seed: int) -> Iterator[Picture]:
    """Run an episode and yield the picture of every iteration, beginning with the first population."""
    for _ in iterate(env, controller, seed):
        yield env.render()


def _check(config: VideoConfig) -> None:
    """Raise SettingError if an option has a value out of its range."""
    if len(set(config.output)) < max(1, len(config.output)):
        raise SettingError("output must name one file or several, each once")
    for name, limits in (("width", WIDTHS), ("height", HEIGHTS)):
        value = getattr(config, name)
        require_integer(name, value, *limits)
        if value % 2:
            raise SettingError(f"{name} must be even, got {value}")
    require_integer("fps", config.fps, 1, MOST_FPS)
    require_integer("seed", config.seed, 0)


def _made(config: VideoConfig) -> tuple[Any, Controller]:
    """Return the environment and the controller."""
    runs = entrant(config.controller, "firefly")
    controller = make_controller_for(runs.optimizer, runs.controller)
    given = {name: value for name in OPTIONS if (value := getattr(config, name)) is not None}
    options: dict[str, Any] = controller.options_with({**runs.options, **given})
    env = gymnasium.make(
        environment_id(runs.optimizer),
        scenario=config.scenario,
        render_mode="rgb_array",
        render_width=config.width,
        render_height=config.height,
        **options,
    )
    return env, controller


def main() -> None:
    """Write the video files that the command line asks for."""
    config = tyro.cli(VideoConfig, description=__doc__)
    with command(ImportError, DependencyNotInstalled):
        write_video(config)
    print("written:", ", ".join(str(path) for path in config.output))


if __name__ == "__main__":
    main()
