"""A learned controller: the forward pass of a feedforward actor in NumPy."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from swarm_gym.action import Action, make_action
from swarm_gym.controllers.controller import Controller, SizeLimits
from swarm_gym.controllers.learned.manifest import FEEDFORWARD, PRICED, PolicyFileError, require_features
from swarm_gym.controllers.learned.policy_file import Weights
from swarm_gym.controllers.learned.residual import Base, carried_out
from swarm_gym.errors import SettingError
from swarm_gym.optimizers import get_optimizer
from swarm_gym.settings import Settings


class FeedforwardController(Controller):
    """Deterministic actions (the mean of the policy) of a trained actor.

    Sums run along one row at a time, so that a decision does not depend on how many swarms are decided
    for at once; and no torch is needed.

    Args:
        path: the file, for messages; see `load.load_learned`.
        weights: what the file holds, as `policy_file.load_policy` has checked it.
        manifest: what it says of them.
        limits: the sizes that the environment allows.
        price: what evaluations cost, for a policy that sees it.

    Attributes:
        manifest: what is known of the policy: layouts, configuration, seeds, versions.
        network: the kind of network, as the manifest names it.

    Raises:
        PolicyFileError: if the policy is for something else.
    """

    network = FEEDFORWARD

    def __init__(
        self, path: Path, weights: Weights, manifest: dict[str, Any], limits: SizeLimits, price: float | None
    ):
        self.manifest = manifest
        trained = SizeLimits(manifest["min_population_size"], manifest["max_population_size"])
        if trained != limits:
            raise PolicyFileError(f"{path}: trained for population sizes {trained}, asked for {limits}")
        self.price = self._checked_price(path, price)
        self.observation = self.manifest["observation"]
        self.action = self.manifest["action"]
        self.initial_population_size = self.manifest["initial_population_size"]
        self.max_evaluations = self.manifest.get("max_evaluations")
        self._base = self._make_base(path, self._make_layout(path, limits), limits)
        self._read_weights(weights)

    def reset(self, num_swarms: int, seed: int = 0) -> None:
        """The policy itself has no memory and takes no chances; the controller that it corrects may."""
        if self._base is not None:
            self._base.controller.reset(num_swarms, seed)

    def act(self, observations: NDArray) -> NDArray:
        """Actions of each swarm, in the layout that the policy was trained with."""
        proposal = None
        if self._base is not None:
            proposal = self._base.propose(observations)
            observations = proposal.seen
        hidden = self._features(np.asarray(observations, dtype=np.float32))
        for weight, bias in self._layers[:-1]:
            hidden = np.tanh(affine(hidden, weight, bias))
        return carried_out(affine(hidden, *self._layers[-1]), proposal)

    def _read_weights(self, weights: Weights) -> None:
        """Keep the weights, layer by layer."""
        numbers = range(len(self.manifest["hidden_layers"]) + 1)
        self._layers = [(weights[f"{number}.weight"], weights[f"{number}.bias"]) for number in numbers]

    def _features(self, seen: NDArray) -> NDArray:
        """What the first layer gets, of what the policy sees, (B, number of features) float32."""
        return seen

    def _checked_price(self, path: Path, price: float | None) -> float | None:
        """The price that is shown to the policy; without one, the middle of those it was trained with."""
        if PRICED not in self.manifest["observation"].split("+"):
            if price is not None:
                raise PolicyFileError(f"{path}: this policy does not see a price, got {price:g}")
            return None
        low, high = self.manifest["price"][0], self.manifest["price"][-1]
        if price is None:
            return float(np.sqrt(low * high))
        if not low <= price <= high:
            raise PolicyFileError(f"{path}: trained with prices in [{low:g}, {high:g}], got {price:g}")
        return price

    def _make_layout(self, path: Path, limits: SizeLimits) -> Action:
        """The layout of the decisions, which are as many as the last layer says."""
        settings = Settings(
            action=self.action,
            min_population_size=limits.smallest,
            max_population_size=limits.largest,
            initial_population_size=limits.smallest,
            max_evaluations=self.max_evaluations,
        )
        try:
            layout = make_action(settings, get_optimizer(self.manifest["optimizer"]))
        except SettingError as error:
            raise PolicyFileError(f"{path}: {error}") from error
        if len(layout.labels) != self.manifest["num_decisions"]:
            raise PolicyFileError(
                f"{path}: num_decisions must be {len(layout.labels)} with action {self.action!r} "
                f"({', '.join(layout.labels)}), got {self.manifest['num_decisions']}"
            )
        return layout

    def _make_base(self, path: Path, layout: Action, limits: SizeLimits) -> Base | None:
        name = self.manifest["base"]
        if name == "none":
            return None
        from swarm_gym.controllers.registry import make_controller

        corrected_from = self.manifest.get("corrected_from", 0)
        try:
            base = Base(make_controller(name, limits), layout, corrected_from, self.max_evaluations)
        except ValueError as error:
            raise PolicyFileError(f"{path}: base {name!r}: {error}") from error
        require_features(path, self.manifest, base.features(self.observation))
        self.corrects = base.controller
        self.observation = f"{self.corrects.observation}+{self.observation}"
        return base


def affine(values: NDArray, weight: NDArray, bias: NDArray) -> NDArray:
    """(..., outputs) of values (..., inputs), weight (..., outputs, inputs) and bias (..., outputs), float32.

    Each sum is made alone, in float64, so that it is the same in any company.
    """
    return (values[..., None, :] * weight).sum(axis=-1, dtype=np.float64).astype(np.float32) + bias
