"""A run as a video: `python -m experiments.video --help`."""

from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import gymnasium
import tyro
from gymnasium.error import DependencyNotInstalled
from tqdm import tqdm

from agents import Controller, make_controller
from experiments.plots.video_files import VIDEO_FILES, Frame
from experiments.runs.entrants import entrant
from experiments.runs.episode import iterate
from swarm_gym.checks import look_up, require_integer
from swarm_gym.command import command
from swarm_gym.errors import SettingError
from swarm_gym.registration import environment_id
from swarm_gym.rendering import HEIGHTS, WIDTHS

# A GIF counts hundredths of a second, and players show none of them alone.
FASTEST = 50


@dataclass(frozen=True)
class VideoConfig:
    """What is filmed, and how."""

    output: tuple[Path, ...] = (Path("video.mp4"),)
    """Files, MP4 or GIF by how their names end."""
    controller: str = "spsfa-tip"
    """Of fireflies, or of another optimizer: multivariate+fixed:65."""
    scenario: str = "case2"
    """Where."""
    iterations: int | None = None
    """Of the episode; by default those of the optimizer's environment."""
    seed: int = 0
    """Which episode."""
    fps: int = 12
    """Pictures, which are iterations, in a second."""
    width: int = 640
    """Pixels, an even number."""
    height: int = 400
    """Likewise."""


def write_video(config: VideoConfig) -> None:
    """Film, and write all files at once; where something fails, none is left half.

    Raises:
        SettingError: for a value that an option cannot have.
        ValueError: for a name that there is not.
        OSError: if a file cannot be written.
        MissingExtraError: if the library is missing that writes it.
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
        for frame in tqdm(film(env, controller, config.seed), total=length, unit="picture", desc="filming"):
            for file in files:
                file.add(frame)


def film(env: Any, controller: Controller, seed: int) -> Iterator[Frame]:
    """Run an episode; the picture of each iteration, from the first population on."""
    for _ in iterate(env, controller, seed):
        yield env.render()


def _check(config: VideoConfig) -> None:
    if len(set(config.output)) < max(1, len(config.output)):
        raise SettingError("output must name one file or several, each once")
    for name, limits in (("width", WIDTHS), ("height", HEIGHTS)):
        value = getattr(config, name)
        require_integer(name, value, *limits)
        if value % 2:
            raise SettingError(f"{name} must be even, got {value}")
    require_integer("fps", config.fps, 1, FASTEST)
    require_integer("seed", config.seed, 0)


def _made(config: VideoConfig) -> tuple[Any, Controller]:
    """The environment and the controller."""
    runs = entrant(config.controller, "firefly")
    controller = make_controller(runs.controller)
    options: dict[str, Any] = {**runs.options, **controller.env_options()}
    if config.iterations is not None:
        options["iterations"] = config.iterations
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
    """Write what the command line asks for."""
    config = tyro.cli(VideoConfig, description=__doc__)
    with command(ImportError, DependencyNotInstalled):
        write_video(config)
    print("written:", ", ".join(str(path) for path in config.output))


if __name__ == "__main__":
    main()
