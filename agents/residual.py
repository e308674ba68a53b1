"""Residual decisions: what a policy adds to the decisions of a controller that is there already.

Source: T. Silver et al., "Residual policy learning", arXiv 1812.06298 (2018). Both are added in an action
layout scaled to [-1, 1], so that a policy whose output is zero decides as the controller does.
"""

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

from agents.controller import Controller
from swarm_gym.action import Action
from swarm_gym.observation import make_observation


class Base:
    """A controller whose decisions a policy corrects.

    Observations have its own layout first, then the policy's. The policy sees its part, and what the
    controller proposes.

    Attributes:
        controller: decides first; its action layout is `natural` or `extended`.
        layout: of the actions that are made, scaled to [-1, 1].
    """

    def __init__(self, controller: Controller, layout: Action):
        scaled = (layout.space.low == -1.0).all() and (layout.space.high == 1.0).all()
        paced = layout.name.endswith("paced")
        more = controller.action == "extended" and not layout.name.startswith("extended")
        if controller.action not in ("natural", "extended") or not scaled or paced or more:
            raise ValueError(
                f"a controller with actions {controller.action!r} cannot be corrected in the layout "
                f"{layout.name!r}"
            )
        self.controller = controller
        self.layout = layout
        self._columns = len(make_observation(controller.observation).features)

    def features(self, observation: str) -> list[str]:
        """Names of what the policy sees."""
        return [
            *(feature.name for feature in make_observation(observation).features),
            *(f"proposed {label}" for label in self.layout.labels),
        ]

    def propose(self, observations: NDArray) -> tuple[NDArray, NDArray]:
        """The controller's actions (B, k), scaled, and what the policy sees, float32."""
        actions = self.layout.encode(self.controller.act(observations[:, : self._columns]))
        seen = np.concatenate([observations[:, self._columns :], actions], axis=1)
        return actions, seen.astype(np.float32)

    def last(self, observation: NDArray) -> NDArray:
        """What the policy sees, (k,), of one observation to which nothing is proposed: zeros."""
        proposal = np.zeros(len(self.layout.labels))
        return np.concatenate([observation[self._columns :], proposal]).astype(np.float32)

    def observation_space(self, space: Box) -> Box:
        """The space of what the policy sees, from that of the whole observation."""
        low = np.concatenate([space.low[self._columns :], self.layout.space.low])
        high = np.concatenate([space.high[self._columns :], self.layout.space.high])
        return Box(low.astype(np.float32), high.astype(np.float32), dtype=np.float32)
