"""An open loop that begins again whenever the best fitness rises.

The best fitness so far rises by an event on the map only. So the loop answers every event that makes the best
path worse, and no other. What it decides then is what it decides at the beginning of an episode, immigrants
included: a restart from the present population. `reacting-loop:<name>` takes the file of `open-loop:<name>`.
"""

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.elementary import expm1, log1p
from swarm_gym.controllers.controller import Floats, SizeLimits, Wrapper
from swarm_gym.controllers.open_loop import OpenLoop, load_open_loop
from swarm_gym.controllers.rule import SHARE_DONE, column
from swarm_gym.observation import ITERATION

SINCE_RISE = "log(1 + iterations since the best fitness last rose), relative to that of the last"


class ReactingLoop(Wrapper):
    """An open loop whose iterations count from the last rise of the best fitness.

    It has no memory of its own.

    Args:
        loop: the open loop.

    Attributes:
        loop: the open loop.
    """

    def __init__(self, loop: OpenLoop):
        super().__init__(loop)
        self.observation = "paper+jumps"

    @property
    def loop(self) -> OpenLoop:
        """The open loop."""
        assert isinstance(self._controller, OpenLoop)
        return self._controller

    def identity(self) -> object:
        """Return the identity of the open loop."""
        return "reacting loop", self.loop.identity()

    def act(self, observations: NDArray) -> Floats:
        """Return (B, k) decisions for the next iteration."""
        as_seen = observations[:, : ITERATION + 1].astype(np.float64)
        as_seen[:, ITERATION] = self._since_rise(observations.astype(np.float64))
        return self.loop.act(as_seen)

    def _since_rise(self, observations: Floats) -> Floats:
        """Return (B,) iterations since the last rise, or since the beginning."""
        iteration, share = observations[:, ITERATION], observations[:, column(self.observation, SHARE_DONE)]
        length = np.divide(iteration, share, out=np.ones_like(share), where=share > 0.0)
        return np.rint(expm1(observations[:, column(self.observation, SINCE_RISE)] * log1p(length)))


def load_reacting_loop(name: str, limits: SizeLimits = SizeLimits()) -> ReactingLoop:  # noqa: B008
    """Return the reacting loop of a packaged open loop by its name, or of the file at a path.

    Raises:
        OpenLoopFileError: if there is no such file, or its content is invalid.
    """
    return ReactingLoop(load_open_loop(name, limits))
