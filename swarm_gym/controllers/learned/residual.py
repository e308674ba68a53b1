"""Residual policies: a policy adds corrections to the decisions of an existing controller, its base.

Source: T. Silver et al., "Residual policy learning", arXiv 1812.06298 (2018). Decisions and corrections are
added in an action layout scaled to [-1, 1]. So a policy whose output is zero decides as its base does.
"""

import copy
from typing import NamedTuple

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

from swarm_gym.action import Action, includes, require_same_decisions
from swarm_gym.controllers.controller import Controller, require_fitting
from swarm_gym.observation import ITERATION, make_observation
from swarm_gym.settings import Settings


class Proposal(NamedTuple):
    """Decisions of the base for B swarms, which a policy may correct.

    Attributes:
        actions: (B, k) decisions in [-1, 1].
        correctable: (B,) True where corrections are added already.
        seen: (B, n) observations of the policy, float32.
    """

    actions: NDArray
    correctable: NDArray[np.bool_]
    seen: NDArray

    def corrected(self, corrections: NDArray) -> NDArray:
        """Return (B, k) actions: decisions plus corrections (B, k), both clipped to [-1, 1]."""
        allowed = np.where(self.correctable[:, None], np.clip(corrections, -1.0, 1.0), 0.0)
        return np.clip(self.actions + allowed, -1.0, 1.0)


def carried_out(decided: NDArray, proposal: Proposal | None) -> NDArray:
    """Return (B, k) actions in [-1, 1] from a policy's outputs: corrections of a proposal, or all of them."""
    return np.clip(decided, -1.0, 1.0) if proposal is None else proposal.corrected(decided)


class Base:
    """A controller whose decisions a policy corrects.

    The columns of the controller's observation layout come first, then the policy's columns. The
    policy observes its own columns and the decisions that the controller proposes.

    Args:
        controller: controller to correct; its action layout is `natural`, `extended` or `sourced`.
        layout: action layout of the sum, scaled to [-1, 1].
        corrected_from: first iteration, counted from 0, in which corrections are added.
        max_evaluations: evaluation budget of an episode; None is no budget.

    Attributes:
        columns: number of columns that the controller observes.
        iteration_unit: number of iterations that a 1 in the controller's column of the iteration stands
            for: 1, or all 100 where the column has shares.

    Raises:
        ValueError: for a controller that cannot be corrected in this layout, or needs other episodes.
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
        if not includes(layout.name, controller.action) or not scaled or paced:
            raise ValueError(
                f"a controller with actions {controller.action!r} cannot be corrected in the layout "
                f"{layout.name!r}"
            )
        require_same_decisions(controller.made_for, controller.action, layout.optimizer)
        require_fitting(controller, max_evaluations)
        self.controller = controller
        self.layout = layout
        self.corrected_from = corrected_from
        features = make_observation(controller.observation).features
        self.columns = len(features)
        # Layouts have the iteration in this column, as a number or as a share of all iterations; those of bit
        # strings have none, and need none where corrections begin at once.
        self._counts = not any(feature.needs_bits for feature in features)
        if corrected_from > 0 and not self._counts:
            raise ValueError(
                f"corrected_from {corrected_from}: the controller observes {controller.observation!r}, which "
                "has no iteration; set corrected_from to 0"
            )
        has_number = not self._counts or features[ITERATION].name == "iteration"
        self.iteration_unit = 1 if has_number else Settings.iterations

    def stretched(self, factor: float) -> "Base":
        """Return the base with its controller stretched, see `Controller.stretched`."""
        other = copy.copy(self)
        other.controller = self.controller.stretched(factor)
        if self.iteration_unit == 1:  # else a share of the iterations, which stays
            other.corrected_from = round(factor * self.corrected_from)
        return other

    def features(self, observation: str) -> list[str]:
        """Return the names of the policy's observation features."""
        return [
            *(feature.name for feature in make_observation(observation).features),
            *(f"proposed {label}" for label in self.layout.labels),
        ]

    def propose(self, observations: NDArray) -> Proposal:
        """Return the controller's decisions, given the columns of both layouts (B, m)."""
        actions = self.layout.encode(self.controller.act(observations[:, : self.columns]))
        seen = np.concatenate([observations[:, self.columns :], actions], axis=1)
        correctable = np.ones(len(actions), dtype=np.bool_)
        if self._counts:
            correctable = np.rint(observations[:, ITERATION] * self.iteration_unit) >= self.corrected_from
        return Proposal(actions, correctable, seen.astype(np.float32))

    def last(self, observation: NDArray) -> NDArray:
        """Return the policy's (k,) features at the end of an episode, where the proposal is zeros."""
        proposal = np.zeros(len(self.layout.labels))
        return np.concatenate([observation[self.columns :], proposal]).astype(np.float32)

    def observation_space(self, space: Box) -> Box:
        """Return the space of the policy's features, given the space of both layouts."""
        low = np.concatenate([space.low[self.columns :], self.layout.space.low])
        high = np.concatenate([space.high[self.columns :], self.layout.space.high])
        return Box(low.astype(np.float32), high.astype(np.float32), dtype=np.float32)
