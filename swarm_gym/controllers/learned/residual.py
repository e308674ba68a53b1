"""Residual decisions: what a policy adds to the decisions of a controller that is there already.

Source: T. Silver et al., "Residual policy learning", arXiv 1812.06298 (2018). Both are added in an action
layout scaled to [-1, 1], so that a policy whose output is zero decides as the controller does.
"""

from typing import NamedTuple

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

from swarm_gym.action import Action
from swarm_gym.controllers.controller import Controller, require_fitting
from swarm_gym.observation import ITERATION, make_observation
from swarm_gym.settings import Settings


class Proposal(NamedTuple):
    """What a controller would do with B swarms, for a policy to correct.

    Attributes:
        actions: (B, k) in [-1, 1].
        correctable: (B,) whether corrections count yet.
        seen: (B, n) what the policy sees, float32.
    """

    actions: NDArray
    correctable: NDArray[np.bool_]
    seen: NDArray

    def corrected(self, corrections: NDArray) -> NDArray:
        """(B, k) actions: the sum with corrections (B, k), each clipped to [-1, 1]."""
        allowed = np.where(self.correctable[:, None], np.clip(corrections, -1.0, 1.0), 0.0)
        return np.clip(self.actions + allowed, -1.0, 1.0)


def carried_out(decided: NDArray, proposal: Proposal | None) -> NDArray:
    """(B, k) actions in [-1, 1], of what a policy decides: corrections of a proposal, or all by itself."""
    return np.clip(decided, -1.0, 1.0) if proposal is None else proposal.corrected(decided)


class Base:
    """A controller whose decisions a policy corrects.

    Observations have its own layout first, then the policy's. The policy sees its part, and what the
    controller proposes.

    Args:
        controller: decides first; its action layout is `natural` or `extended`.
        layout: of the actions that are made, scaled to [-1, 1].
        corrected_from: the iteration, counted from 0, from which the policy is listened to.
        max_evaluations: budget of the episodes, which are the policy's; None is no budget.

    Raises:
        ValueError: for a controller or a layout that this cannot be done with, or a controller that needs
            other episodes.
    """

    def __init__(
        self,
        controller: Controller,
        layout: Action,
        corrected_from: int = 0,
        max_evaluations: int | None = None,
    ):
        scaled = (layout.space.low == -1.0).all() and (layout.space.high == 1.0).all()
        paced = layout.name.endswith("paced")
        more = controller.action == "extended" and not layout.name.startswith("extended")
        if controller.action not in ("natural", "extended") or not scaled or paced or more:
            raise ValueError(
                f"a controller with actions {controller.action!r} cannot be corrected in the layout "
                f"{layout.name!r}"
            )
        require_fitting(controller, max_evaluations)
        self.controller = controller
        self.layout = layout
        self.corrected_from = corrected_from
        features = make_observation(controller.observation).features
        self._columns = len(features)
        # All layouts have the iteration here, as a number or as a share of all.
        self._unit = 1.0 if features[ITERATION].name == "iteration" else Settings.iterations

    def features(self, observation: str) -> list[str]:
        """Names of what the policy sees."""
        return [
            *(feature.name for feature in make_observation(observation).features),
            *(f"proposed {label}" for label in self.layout.labels),
        ]

    def propose(self, observations: NDArray) -> Proposal:
        """What the controller proposes on whole observations (B, m)."""
        actions = self.layout.encode(self.controller.act(observations[:, : self._columns]))
        seen = np.concatenate([observations[:, self._columns :], actions], axis=1)
        iteration = np.rint(observations[:, ITERATION] * self._unit)
        return Proposal(actions, iteration >= self.corrected_from, seen.astype(np.float32))

    def last(self, observation: NDArray) -> NDArray:
        """What the policy sees, (k,), of one observation to which nothing is proposed: zeros."""
        proposal = np.zeros(len(self.layout.labels))
        return np.concatenate([observation[self._columns :], proposal]).astype(np.float32)

    def observation_space(self, space: Box) -> Box:
        """The space of what the policy sees, from that of the whole observation."""
        low = np.concatenate([space.low[self._columns :], self.layout.space.low])
        high = np.concatenate([space.high[self._columns :], self.layout.space.high])
        return Box(low.astype(np.float32), high.astype(np.float32), dtype=np.float32)
