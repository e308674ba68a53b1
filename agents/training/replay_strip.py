"""An episode as a strip of pictures, which are drawn while it runs."""

import logging

import numpy as np
from gymnasium.error import DependencyNotInstalled
from numpy.typing import NDArray
from PIL import Image

from swarm_gym.rendering import Renderer, Scene
from swarm_gym.rendering.pen import require_pygame
from swarm_gym.simulation import Simulation

NUM_FRAMES = 5
# Pictures are drawn at the size that they are designed for, where nothing overlaps, and shrunk to half of it.
SHRINKING = 2


class ReplayStrip:
    """The first of the episodes that run side by side, from its beginning to its end.

    Raises:
        DependencyNotInstalled: if pygame is missing.
    """

    def __init__(self) -> None:
        require_pygame()
        self._renderer = Renderer()
        self._scenes: list[Scene] = []

    def look(self, simulation: Simulation) -> None:
        """Keep what there is to see, if it is time to: at the beginning, the end, and evenly in between.

        An episode that ends early stays as it is until the others have ended.
        """
        iteration, iterations = simulation.iteration[0], simulation.settings.iterations
        if iteration == 0:
            self._scenes = []
        due = np.unique(np.linspace(0, iterations, NUM_FRAMES).astype(np.int64))
        num_due = np.searchsorted(due, iteration, side="right") if simulation.running.any() else len(due)
        if len(self._scenes) < num_due:
            self._scenes += [Scene.of(simulation)] * (num_due - len(self._scenes))

    def draw(self) -> NDArray[np.uint8]:
        """The pictures of the last episode side by side, shape (height, width, 3)."""
        frames = np.hstack([self._renderer.frame(scene) for scene in self._scenes])
        return np.asarray(Image.fromarray(frames).reduce(SHRINKING))


def make_replay_strip() -> ReplayStrip | None:
    """A strip; without pygame, which is an extra, none, and that is said."""
    try:
        return ReplayStrip()
    except DependencyNotInstalled as error:
        logging.getLogger("agents").warning("no replays in TensorBoard: %s", error)
        return None
