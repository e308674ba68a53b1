"""Pictures of an environment that show its map alone."""

from typing import Any

import gymnasium

from agents import Controller
from experiments.plots.video_files import Picture
from swarm_gym.registration import environment_id
from swarm_gym.rendering.pen import CHART_COLUMN, FOOTER, HEADER, MARGIN, SMALLEST_SCALE


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
